//! `cargo xtask bench rays`: how many rays per second the CPU traces, against other tracers.

mod batches;
mod embree;
mod methods;

use crate::format::grouped;
use crate::measure::middle;
use crate::place;
use crate::record;
use crate::room::Room;
use crate::table::Table;
use anyhow::{Context as _, Result, ensure};
use batches::{Batch, batches};
use methods::{Method, Reference};
use rayon::ThreadPool;
use std::path::PathBuf;
use std::time::Instant;

/// What the help ends with.
const AFTER_HELP: &str = "\
Examples:
  cargo xtask bench rays --quick             does everything work? A minute or less
  cargo xtask bench rays --append            figures to keep, in benches/LOG.md
  cargo xtask bench rays --triangles 100000  one room only
  cargo xtask bench rays --embree libembree4.so.4   Embree on the same rays in the same run

What is measured, and how:
  * The rooms are those of `cargo xtask bench gpu`: six walls around a bumpy body.
  * Methods take turns, so that a slow minute of the machine hits all of them; each figure is the
    median of its turns, in millions of rays per second of wall time.
  * Incoherent rays connect random points of the surfaces. Primary rays are those of a camera,
    in blocks of 4 x 2 pixels. Rays to lights go from what the camera sees to 16 random points.
    Neighbours are the 8 points of such a block, each with a ray to the same light.
  * All methods must find the same: packets exactly what single rays find, others all but one ray
    in a thousand, since their tests of triangles round in another way at the edges.
  * Embree takes part where its library is given. The last column is not of this run: Embree 4, one
    thread, on another day, in other rooms with other rays.

For figures worth keeping let nothing else run on the machine; its load is noted in the entry.";

/// What a new log begins with.
const INTRODUCTION: &str = "# Measurements\n\nA log, newest entry last.\n";

const REMARKS: &str = "
Millions of rays per second. The last column was measured on another day, in other rooms with other rays, with one thread and
packets of 16; everything else in one run.
";

const HEADER: [&str; 7] =
    ["triangles", "rays", "method", "1 thread", "2 threads", "times obvhs, 1 thread", "Embree 4, other rays"];

/// Share of rays whose answers may differ between tracers that round differently.
const EDGE_CASES: f64 = 1e-3;

/// Number of threads that are measured.
const THREADS: [usize; 2] = [1, 2];

#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Args {
    /// About how many triangles the room has; may be repeated [default: 1400, 100000, 1000000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(12..=10_000_000))]
    triangles: Vec<u32>,
    /// Three turns instead of nine, and fewer rays.
    #[arg(long)]
    quick: bool,
    /// The shared library of Embree 4, to be measured on the same rays in the same run.
    #[arg(long, value_name = "FILE")]
    embree: Option<PathBuf>,
    /// Append the table to a Markdown file, with the date, the processor and the git revision; benches/LOG.md unless FILE is
    /// given, which is relative to the project's root.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "benches/LOG.md")]
    append: Option<PathBuf>,
    /// Date of the entry, such as 2026-11-30 [default: today, UTC].
    #[arg(long, requires = "append")]
    date: Option<String>,
}

/// Measures all rooms and prints the table. Fails if two methods do not find the same.
pub(crate) fn run(args: &Args) -> Result<()> {
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().filter(|load| !load.is_empty()).map(str::to_owned);
    let (rays, turns) = if args.quick { (1 << 14, 3) } else { (1 << 17, 9) };
    let rooms = if args.triangles.is_empty() { &[1_400, 100_000, 1_000_000][..] } else { &args.triangles };
    let mut table = Table::new(&HEADER);
    for &triangles in rooms {
        eprintln!("rays among {triangles} triangles");
        let room = Room::new(triangles)?;
        let reference = Reference::new(&room, args.embree.as_deref())?;
        for batch in batches(&room, rays) {
            rows(&room, &reference, &batch, turns)?.into_iter().for_each(|row| table.push(row));
        }
    }
    let load = load.map(|load| format!("\nLoad average of the machine before: {load}.\n")).unwrap_or_default();
    let table = table.markdown() + REMARKS + &load;
    println!("{table}");
    if let Some(path) = &args.append {
        let entry = record::entry(args.date.as_deref(), turns, &table);
        record::append(&place::root().join(path), INTRODUCTION, &entry)?;
    }
    Ok(())
}

/// The rows of a batch, one per method.
fn rows(room: &Room, reference: &Reference, batch: &Batch, turns: u32) -> Result<Vec<[String; 7]>> {
    let methods = reference.methods(batch.has_packets);
    let pools = THREADS.map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    let pools: Vec<ThreadPool> = pools.into_iter().collect::<Result<_, _>>().context("cannot start threads")?;
    let mut rates = vec![[Vec::new(), Vec::new()]; methods.len()];
    let mut found = vec![Vec::new(); methods.len()];
    for _ in 0..turns {
        for (method, (rates, found)) in methods.iter().zip(rates.iter_mut().zip(&mut found)) {
            for (pool, rates) in pools.iter().zip(rates) {
                let start = Instant::now();
                *found = pool.install(|| method.trace(room, reference, batch));
                rates.push(batch.rays.len() as f64 / start.elapsed().as_secs_f64() * 1e-6);
            }
        }
    }
    compare(batch, &methods, &found)?;
    let rates: Vec<[f64; 2]> = rates.into_iter().map(|rates| rates.map(|rates| middle(rates, |&rate| rate))).collect();
    let row = |(&method, [one, two]): (&Method, &[f64; 2])| {
        let embree = batch.embree(method, room.size()).map_or_else(|| "-".to_owned(), |rate| format!("{rate:.1}"));
        let times = one / rates[0][0];
        let figures = [format!("{one:.2}"), format!("{two:.2}"), format!("{times:.2}"), embree];
        let [one, two, times, embree] = figures;
        [grouped(room.size()), batch.title.to_owned(), method.title().to_owned(), one, two, times, embree]
    };
    Ok(methods.iter().zip(&rates).map(row).collect())
}

/// Fails if two methods do not find the same. `found` has what each method finds of each ray.
fn compare(batch: &Batch, methods: &[Method], found: &[Vec<f32>]) -> Result<()> {
    let single =
        methods.iter().position(|&method| method == Method::Single).context("single rays are always traced")?;
    for (&method, answers) in methods.iter().zip(found) {
        let pairs = answers.iter().zip(&found[single]);
        let differ = pairs.filter(|&(a, b)| a != b && (method.is_ours() || (a - b).abs() > 1e-3 * b.abs())).count();
        let allowed = if method.is_ours() { 0.0 } else { EDGE_CASES * answers.len() as f64 };
        ensure!(
            differ as f64 <= allowed,
            "{}: {} and single rays find other hits of {differ} in {} rays",
            batch.title,
            method.title(),
            answers.len()
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_methods_find_the_same() {
        let room = Room::new(1_400).unwrap();
        let reference = Reference::new(&room, None).unwrap();
        for batch in batches(&room, 1 << 11) {
            let rows = rows(&room, &reference, &batch, 1).unwrap();
            assert_eq!(rows.len(), 2 + usize::from(batch.has_packets), "{}", batch.title);
            assert_eq!(rows[0][5], "1.00");
        }
    }

    #[test]
    fn methods_that_differ_are_told() {
        let room = Room::new(100).unwrap();
        let [batch, ..] = batches(&room, 1 << 10);
        let found = [vec![0.0; 8], vec![1.0; 8]];
        let error = compare(&batch, &[Method::Obvhs, Method::Single], &found).unwrap_err().to_string();
        assert!(error.contains("8 in 8 rays"), "{error}");
    }
}
