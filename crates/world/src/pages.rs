//! Memory for what is read here and there: in large pages, where the system has them.
//!
//! Rays through a large scene touch a new page with almost every node. Each costs the processor a walk through its page tables
//! as soon as they no longer fit its cache of them, and in pages of 2 MiB they fit.

use bytemuck::Pod;
use memmap2::MmapMut;
use std::fmt;
use std::ops::Deref;

/// A large page of today's 64-bit processors, in bytes.
const LARGE_PAGE: usize = 2 << 20;

/// A slice that never changes, on large pages if it fills one and the system gives them. Costs at most two more than it needs.
pub struct Pages<T>(Memory<T>);

enum Memory<T> {
    Usual(Vec<T>),
    /// Values from a byte of a mapping on, so many bytes of them.
    Mapped {
        mapping: MmapMut,
        first: usize,
        bytes: usize,
    },
}

impl<T: Pod> From<Vec<T>> for Pages<T> {
    fn from(values: Vec<T>) -> Self {
        Self(map(&values).unwrap_or(Memory::Usual(values)))
    }
}

/// The values on large pages. `None` if they do not fill one or the system has none.
#[cfg(target_os = "linux")]
fn map<T: Pod>(values: &[T]) -> Option<Memory<T>> {
    let values: &[u8] = bytemuck::cast_slice(values);
    let bytes = values.len();
    if bytes < LARGE_PAGE || align_of::<T>() > LARGE_PAGE {
        return None;
    }
    let mut mapping = MmapMut::map_anon(bytes.next_multiple_of(LARGE_PAGE) + LARGE_PAGE).ok()?;
    // Before anything is written: pages are given when they are first touched.
    mapping.advise(memmap2::Advice::HugePage).ok()?;
    let first = mapping.as_ptr().align_offset(LARGE_PAGE);
    mapping.get_mut(first..first + bytes)?.copy_from_slice(values);
    Some(Memory::Mapped { mapping, first, bytes })
}

/// Other systems have large pages for programs with privileges only.
#[cfg(not(target_os = "linux"))]
fn map<T: Pod>(_: &[T]) -> Option<Memory<T>> {
    None
}

impl<T: Pod> Deref for Pages<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.0 {
            Memory::Usual(values) => values,
            Memory::Mapped { mapping, first, bytes } => bytemuck::cast_slice(&mapping[*first..first + bytes]),
        }
    }
}

impl<T: Pod> Default for Pages<T> {
    fn default() -> Self {
        Self(Memory::Usual(Vec::new()))
    }
}

impl<T: Pod> Clone for Pages<T> {
    fn clone(&self) -> Self {
        self.to_vec().into()
    }
}

impl<T: Pod + fmt::Debug> fmt::Debug for Pages<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.deref().fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_the_same_on_pages_of_any_size() {
        for length in [0, 1, 100, LARGE_PAGE / 8, LARGE_PAGE / 8 + 1, 3 * LARGE_PAGE / 8 + 17] {
            let values: Vec<[u32; 2]> = (0..length as u32).map(|k| [k, !k]).collect();
            let pages = Pages::from(values.clone());
            assert_eq!(pages[..], values[..]);
            assert_eq!(pages.clone()[..], values[..]);
            let is_mapped = matches!(pages.0, Memory::Mapped { .. });
            assert!(!is_mapped || length >= LARGE_PAGE / 8);
            if is_mapped {
                assert_eq!(pages.as_ptr().align_offset(LARGE_PAGE), 0);
            }
        }
    }
}
