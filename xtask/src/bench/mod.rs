//! `cargo xtask bench`: measurements that are kept in `docs/benchmarks.md` and `benches/LOG.md`.

mod experiment;
mod format;
mod gpu;
mod measure;
mod rays;
mod record;
mod room;
mod row;
mod scatter;
mod table;
mod thesis;

use anyhow::Result;
use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Bench {
    /// The thesis' experiment: its three scenes without and with lightcuts, against the original program.
    Thesis(thesis::Args),
    /// A GPU: the thesis' scenes, rays, choice of VPLs, and how long its submissions take.
    Gpu(gpu::Args),
    /// Rays on the CPU, one by one and eight at a time, against obvhs and Embree.
    Rays(rays::Args),
}

/// Runs a benchmark.
pub(crate) fn run(bench: &Bench) -> Result<()> {
    match bench {
        Bench::Thesis(args) => thesis::run(args),
        Bench::Gpu(args) => gpu::run(args),
        Bench::Rays(args) => rays::run(args),
    }
}
