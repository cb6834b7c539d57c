//! `cargo xtask bench`: measurements that are kept in `docs/benchmarks.md` and `benches/LOG.md`.

mod equal_time;
mod experiment;
mod format;
mod gpu;
mod measure;
mod physical;
mod place;
mod rays;
mod record;
mod room;
mod row;
mod scaling;
mod scatter;
mod table;
mod thesis;

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Measure.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask bench", bin_name = "cargo xtask bench")]
struct Cli {
    #[command(subcommand)]
    bench: Bench,
}

#[derive(Debug, Subcommand)]
enum Bench {
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

fn main() -> ExitCode {
    match run(&Cli::parse().bench) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(bench: &Bench) -> Result<()> {
    match bench {
        Bench::Thesis(args) => thesis::run(args),
        Bench::Gpu(args) => gpu::run(args),
        Bench::Rays(args) => rays::run(args),
        Bench::Scaling(args) => scaling::run(args),
        Bench::EqualTime(args) => equal_time::run(args),
        Bench::Convergence(args) => equal_time::run_convergence(args),
    }
}
