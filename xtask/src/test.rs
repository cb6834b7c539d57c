//! `cargo xtask test`: all tests, with what they need: a browser for those of pages, a driver for those of the GPU.

use crate::project::{self, shown};
use crate::tally::Tally;
use crate::{browser, vulkan};
use anyhow::{Context as _, Result, bail};
use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Install no packages of the system: tests that need a browser or a Vulkan driver are skipped where there is none.
    #[arg(long)]
    no_install: bool,
}

/// Runs the workspace's tests and documentation examples.
pub(crate) fn run(args: &Args) -> Result<()> {
    browser::provide(!args.no_install);
    vulkan::provide(!args.no_install);
    if has_nextest() {
        println!("tests run with cargo-nextest, documentation examples with cargo test");
        // First, so that the last line is that of nextest. Of the whole workspace: for some of its packages alone, others'
        // features would differ, and half of what nextest needs would be compiled once more.
        run_counted(cargo().args(["test", "--doc", "--workspace", "--no-fail-fast"]), "documentation examples")?;
        project::run(cargo().args(["nextest", "run", "--workspace", "--no-fail-fast"]))
    } else {
        println!("tests run with cargo test; cargo-nextest is used where it is installed");
        run_counted(cargo().args(["test", "--workspace", "--no-fail-fast"]), "all tests")
    }
}

/// `cargo`, with what tests look for in their surroundings.
fn cargo() -> Command {
    let mut command = project::cargo();
    if browser::is_required() {
        command.env(browser::REQUIRED, "1");
    }
    if vulkan::is_required() {
        command.env(vulkan::REQUIRED, "1");
    }
    command
}

fn has_nextest() -> bool {
    let asked = cargo().args(["nextest", "--version"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    asked.is_ok_and(|status| status.success())
}

/// Runs `cargo test`, passes its output on and ends with one line of sums.
fn run_counted(command: &mut Command, what: &str) -> Result<()> {
    let typed = shown(command);
    println!("$ {typed}");
    let mut child = command.stdout(Stdio::piped()).spawn().with_context(|| format!("cannot run `{typed}`"))?;
    let mut tally = Tally::default();
    for line in BufReader::new(child.stdout.take().context("the output is piped")?).lines() {
        let line = line?;
        tally.add(&line);
        println!("{line}");
    }
    let status = child.wait()?;
    println!("{what}: {tally}");
    if !status.success() {
        bail!("`{typed}` failed: {status}");
    }
    Ok(())
}
