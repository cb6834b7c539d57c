//! `cargo xtask ci`: what a change must pass.

use crate::project::{cargo, run as run_command};
use crate::test;
use anyhow::Result;

/// Runs every check, the quick ones first; stops at the first that fails.
pub(crate) fn run(args: &test::Args) -> Result<()> {
    run_command(cargo().args(["fmt", "--all", "--check"]))?;
    run_command(cargo().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    run_command(cargo().args(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-Dwarnings"))?;
    test::run(args)
}
