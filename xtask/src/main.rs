//! The tasks of the project's house: `cargo xtask --help`.

mod bench;
mod browser;
mod ci;
#[cfg(test)]
mod docs;
mod gallery;
mod model_files;
mod models;
mod packages;
mod project;
mod tally;
mod test;
mod vulkan;

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Tasks of the lightcuts project.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Run every test, documentation examples included.
    Test,
    /// Check everything that a change must pass: format, lints, documentation, tests.
    Ci,
    /// Write the generated models to scenes/models.
    Models(model_files::Args),
    /// Measure.
    Bench(bench::Args),
    /// Render every scene to out/gallery.
    Gallery(gallery::Args),
}

fn main() -> ExitCode {
    match run(&Cli::parse().task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: &Task) -> Result<()> {
    match task {
        Task::Test => test::run(),
        Task::Ci => ci::run(),
        Task::Models(args) => model_files::run(args),
        Task::Bench(args) => bench::run(args),
        Task::Gallery(args) => gallery::run(args),
    }
}
