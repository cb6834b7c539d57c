//! Tells the program which revision it is built from: `LIGHTCUTS_REVISION`.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What decides pictures and rows: a change elsewhere makes no revision dirty, and rebuilds nothing.
const SOURCES: [&str; 9] = [
    "../experiment",
    "../image",
    "../import",
    "../kernel",
    "../lightcuts",
    "../render",
    "../scene",
    "../world",
    "../../Cargo.lock",
];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=LIGHTCUTS_REVISION={}", revision().unwrap_or_else(|| "unknown".to_owned()));
}

fn revision() -> Option<String> {
    // In another project's repository, as a dependency of it, the revision would be that project's.
    if git(&["rev-parse", "--show-prefix"])? != "crates/experiment/" {
        return None;
    }
    watch_sources_and_head();
    let revision = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed = git(&[&["status", "--porcelain", "--"][..], &SOURCES].concat())?;
    Some(if changed.is_empty() { revision } else { format!("{revision}-dirty") })
}

/// Asks cargo to run this again after an edit or a commit. A path that is not there would make it run always.
fn watch_sources_and_head() {
    let branch = git(&["symbolic-ref", "--quiet", "HEAD"]);
    let names = ["HEAD", "packed-refs"].into_iter().map(str::to_owned).chain(branch);
    let heads = names.filter_map(|name| git(&["rev-parse", "--git-path", &name])).map(PathBuf::from);
    for path in SOURCES.iter().map(PathBuf::from).chain(heads).filter(|path| Path::exists(path)) {
        println!("cargo::rerun-if-changed={}", path.display());
    }
}

/// The output of a git command in this folder, without changing anything in the repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("--no-optional-locks").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
