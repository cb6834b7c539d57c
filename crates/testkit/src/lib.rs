//! Test helpers: where shared material lies, how a test says that it skips, and whether samples have their density.
//!
//! Other people's material is not part of the project; it may lie in a folder `shared` beside the checkout.

pub mod chi_square;

use std::error::Error;
use std::path::{Path, PathBuf};

/// If set, tests that need a graphics adapter fail where there is none; else they skip.
const REQUIRED: &str = "LIGHTCUTS_REQUIRE_ADAPTER";

/// The project's own files.
pub fn project_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file or folder of the shared material, or `None` with a printed line where it is absent.
pub fn shared(path: &str) -> Option<PathBuf> {
    let found = project_root().join("../shared").join(path);
    if found.exists() {
        Some(found)
    } else {
        println!("skipped: shared material '{path}' is not here");
        None
    }
}

/// Whether an adapter was found; if not a line is printed, or the test fails where one is required.
pub fn has_adapter<T>(found: Result<T, impl Error>) -> bool {
    let Err(why) = found else { return true };
    let is_required = std::env::var_os(REQUIRED).is_some_and(|value| !value.is_empty());
    assert!(!is_required, "{REQUIRED} is set, but {why}");
    println!("skipped: {why}");
    false
}
