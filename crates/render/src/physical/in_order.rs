//! Work for all threads whose results are added up in order, and at once: they do not pile up.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// Results on their way to `add`.
struct Waiting<T, A> {
    results: BTreeMap<usize, T>,
    /// The number that is added next.
    next: usize,
    add: A,
}

/// Does `work` for each number below `count` on the threads of the current pool, and gives each result to `add`, in the
/// order of numbers. When `add` returns false no more work is begun; what is done by then is added all the same, still
/// in order.
pub(crate) fn in_order<T: Send>(
    count: usize,
    work: impl Fn(usize) -> T + Sync,
    add: impl FnMut(usize, T) -> bool + Send,
) {
    let (begun, is_open) = (AtomicUsize::new(0), AtomicBool::new(true));
    let waiting = Mutex::new(Waiting { results: BTreeMap::new(), next: 0, add });
    let help = || {
        while is_open.load(Relaxed) {
            let number = begun.fetch_add(1, Relaxed);
            if number >= count {
                return;
            }
            let result = work(number);
            // A panic of another thread ends all of them when it is joined.
            let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
            let Waiting { results, next, add } = &mut *waiting;
            results.insert(number, result);
            while let Some(result) = results.remove(next) {
                *next += 1;
                if !add(*next - 1, result) {
                    is_open.store(false, Relaxed);
                }
            }
        }
    };
    rayon::scope(|scope| (0..rayon::current_num_threads()).for_each(|_| scope.spawn(|_| help())));
    let Waiting { results, mut add, .. } = waiting.into_inner().unwrap_or_else(PoisonError::into_inner);
    for (number, result) in results {
        add(number, result);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_once_and_in_order_on_any_number_of_threads() {
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut found = Vec::new();
            pool.install(|| {
                in_order(
                    1000,
                    |k| k * k,
                    |k, square| {
                        found.push((k, square));
                        true
                    },
                );
            });
            assert_eq!(found, (0..1000).map(|k| (k, k * k)).collect::<Vec<_>>(), "{threads}");
        }
    }

    #[test]
    fn nothing_that_was_done_is_lost_when_it_stops() {
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (worked, mut found) = (AtomicUsize::new(0), Vec::new());
            pool.install(|| {
                let work = |k| {
                    worked.fetch_add(1, Relaxed);
                    k
                };
                in_order(10_000, work, |_, k| {
                    found.push(k);
                    k < 20
                });
            });
            assert!(found.len() >= 20 && found.len() < 10_000 && found.is_sorted(), "{}", found.len());
            assert_eq!(found.len(), worked.into_inner());
        }
    }
}
