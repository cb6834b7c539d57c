//! `cargo xtask bench`: measurements that are kept in `docs/benchmarks.md` and `benches/LOG.md`.

mod equal_time;
mod experiment;
mod format;
mod gpu;
mod measure;
mod physical;
mod rays;
mod record;
mod room;
mod row;
mod scaling;
mod scatter;
mod table;
mod thesis;

use crate::project;
use anyhow::Result;
use clap::Subcommand;
use std::env;

#[derive(Debug, Subcommand)]
pub(crate) enum Bench {
    /// The thesis' experiment: its three scenes without and with lightcuts, against the original program.
    Thesis(thesis::Args),
    /// A GPU: the thesis' scenes, rays, choice of VPLs, and how long its submissions take.
    Gpu(gpu::Args),
    /// Rays on the CPU, one by one and eight at a time, against obvhs and Embree.
    Rays(rays::Args),
    /// The physical model: the work of cuts for a thousand to a million VPLs, against the sum over all of them.
    Scaling(scaling::Args),
    /// The physical model: its integrators' errors after the same time, and other renderers'.
    EqualTime(equal_time::Args),
    /// The physical model: error against time, as a chart in docs/images.
    Convergence(equal_time::ConvergenceArgs),
}

/// Runs a benchmark, built for speed: other tasks need not wait for that.
pub(crate) fn run(bench: &Bench) -> Result<()> {
    if cfg!(debug_assertions) {
        let mut command = project::cargo();
        command.args(["run", "--quiet", "--release", "--package", "xtask", "--"]).args(env::args_os().skip(1));
        return project::run(&mut command);
    }
    match bench {
        Bench::Thesis(args) => thesis::run(args),
        Bench::Gpu(args) => gpu::run(args),
        Bench::Rays(args) => rays::run(args),
        Bench::Scaling(args) => scaling::run(args),
        Bench::EqualTime(args) => equal_time::run(args),
        Bench::Convergence(args) => equal_time::run_convergence(args),
    }
}
