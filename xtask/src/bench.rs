//! `cargo xtask bench`: measurements, by a program that is built for speed while tasks are not.

use crate::project;
use anyhow::Result;
use std::ffi::OsString;
use std::process::Command;

#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Args {
    /// What to measure, and how; `--help` tells more.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Builds the program and the command `lightcuts`, and runs the program.
pub(crate) fn run(args: &Args) -> Result<()> {
    let folder = project::build_for_speed(&["lightcuts-bench", "lightcuts-cli"])?;
    project::run(Command::new(folder.join("lightcuts-bench")).args(&args.arguments))
}
