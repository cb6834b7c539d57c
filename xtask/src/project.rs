//! The project's folders and its tools.

use anyhow::{Context as _, Result, bail};
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The root of the checkout.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the root").to_path_buf()
}

/// Where the thesis' meshes may lie: they are not part of the project.
pub(crate) fn shared_models() -> PathBuf {
    root().join("../shared/models")
}

/// The `cargo` that runs this task, in the root.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// A command as it would be typed; programs and files of the project without their folder.
pub(crate) fn shown(command: &Command) -> String {
    let root = root();
    let short = |text: &std::ffi::OsStr| {
        let path = Path::new(text);
        path.strip_prefix(&root).unwrap_or(path).display().to_string()
    };
    let program = Path::new(command.get_program()).file_stem().unwrap_or_default().display().to_string();
    std::iter::once(program).chain(command.get_args().map(short)).collect::<Vec<_>>().join(" ")
}

/// Says what is run, and runs it; fails if it fails.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    println!("$ {}", shown(command));
    let status = command.status().with_context(|| format!("cannot run `{}`", shown(command)))?;
    if !status.success() {
        bail!("`{}` failed: {status}", shown(command));
    }
    Ok(())
}

/// Builds packages for speed and returns the folder of their programs.
pub(crate) fn build_for_speed(packages: &[&str]) -> Result<PathBuf> {
    run(cargo().args(["build", "--release"]).args(packages.iter().flat_map(|package| ["--package", package])))?;
    // This program lies in the target folder's `debug` or `release`, whatever the target folder is called.
    let this = env::current_exe().context("cannot tell where this program is")?;
    let target = this.parent().and_then(Path::parent).context("this program lies in no target folder")?;
    Ok(target.join("release"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_shown_as_typed() {
        let mut command = Command::new("/somewhere/bin/lightcuts");
        command.arg("render").arg(root().join("scenes").join("a.txt")).args(["--samples", "4"]);
        let expected = Path::new("scenes").join("a.txt");
        assert_eq!(shown(&command), format!("lightcuts render {} --samples 4", expected.display()));
    }
}
