//! `cargo xtask bench`: measurements that are kept in `docs/benchmarks.md` and `benches/LOG.md`.

mod experiment;
mod gpu;
mod measure;
mod record;
mod row;
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
}

/// Runs a benchmark.
pub(crate) fn run(bench: &Bench) -> Result<()> {
    match bench {
        Bench::Thesis(args) => thesis::run(args),
        Bench::Gpu(args) => gpu::run(args),
    }
}
