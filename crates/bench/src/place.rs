//! Where things lie.

use anyhow::{Context as _, Result, ensure};
use std::env::{self, consts::EXE_SUFFIX};
use std::path::{Path, PathBuf};

/// The root of the checkout.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("this crate lies in crates/bench").to_path_buf()
}

/// Where the thesis' meshes may lie: they are not part of the project.
pub(crate) fn shared_models() -> PathBuf {
    root().join("../shared/models")
}

/// The `lightcuts` command, which `cargo xtask bench` builds beside this program.
pub(crate) fn cli() -> Result<PathBuf> {
    let this = env::current_exe().context("cannot tell where this program is")?;
    let cli = this.with_file_name(format!("lightcuts{EXE_SUFFIX}"));
    ensure!(cli.is_file(), "there is no {}: run this by `cargo xtask bench`", cli.display());
    Ok(cli)
}
