//! Test helpers: where shared material lies, and how a test says that it skips.
//!
//! Other people's material is not part of the project; it may lie in a folder `shared` beside the checkout.

use std::path::{Path, PathBuf};

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
