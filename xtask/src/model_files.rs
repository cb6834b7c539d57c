//! `cargo xtask models`: the generated models as files.

use crate::{models, project};
use anyhow::{Context as _, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Compare with the files in scenes/models instead of writing them.
    #[arg(long)]
    check: bool,
}

/// Writes the models, or checks that they are there as they would be written.
pub(crate) fn run(args: &Args) -> Result<()> {
    let kept = project::root().join("scenes/models");
    if !args.check {
        models::generate(&kept)?;
        println!("wrote {} files to scenes/models", files(&kept)?.len());
        return Ok(());
    }
    let fresh = tempfile::tempdir().context("cannot make a folder for the models")?;
    models::generate(fresh.path())?;
    let differing = differing(fresh.path(), &kept)?;
    if !differing.is_empty() {
        bail!("not as they would be written: {}; run `cargo xtask models`", differing.join(", "));
    }
    println!("the files in scenes/models are as they would be written");
    Ok(())
}

/// Names of files in `fresh` that are absent from `kept` or have other bytes there.
fn differing(fresh: &Path, kept: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for path in files(fresh)? {
        let name = path.file_name().unwrap_or_default();
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        if fs::read(kept.join(name)).ok().as_ref() != Some(&bytes) {
            names.push(name.display().to_string());
        }
    }
    Ok(names)
}

fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absent_and_changed_files_are_named() {
        let [fresh, kept] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        for (name, text) in [("a", "1"), ("b", "2"), ("c", "3")] {
            fs::write(fresh.path().join(name), text).unwrap();
        }
        fs::write(kept.path().join("a"), "1").unwrap();
        fs::write(kept.path().join("c"), "4").unwrap();
        assert_eq!(differing(fresh.path(), kept.path()).unwrap(), ["b", "c"]);
    }
}
