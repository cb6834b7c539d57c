//! The project's tasks: `cargo xtask --help`.

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
    /// Run every test, documentation examples included; install what some of them need.
    ///
    /// Tests of report pages need Chromium and chromedriver, those of GPUs a Vulkan driver. On Debian and Ubuntu, as
    /// root or with a sudo that asks for no password, missing packages are installed with apt-get: chromium and
    /// chromium-driver (Ubuntu: chromium-browser and chromium-chromedriver), libvulkan1 and mesa-vulkan-drivers.
    /// Elsewhere, and with --no-install, those tests are skipped where that is missing.
    ///
    /// From a fresh checkout this builds for 15 to 20 minutes on two cores and takes about 3 GB in the target folder.
    Test(test::Args),
    /// Check everything that a change must pass: format, lints, documentation, tests (with what `test` installs).
    Ci(test::Args),
    /// Write the generated models to scenes/models.
    Models(model_files::Args),
    /// Run benchmarks; `cargo xtask bench --help` lists them.
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
        Task::Test(args) => test::run(args),
        Task::Ci(args) => ci::run(args),
        Task::Models(args) => model_files::run(args),
        Task::Bench(args) => bench::run(args),
        Task::Gallery(args) => gallery::run(args),
    }
}
