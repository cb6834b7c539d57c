//! Files that a scene names: searched, opened within limits, and listed.

use crate::Limits;
use crate::resolver::{self, FileError, Resolver};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Why a named file is of no use.
#[derive(Debug, thiserror::Error)]
pub(crate) enum AssetError {
    #[error("the {what} `{name}` was not found; searched {}", list(searched))]
    NotFound { what: &'static str, name: String, searched: Vec<PathBuf> },
    #[error("{}the {what} {error}", lead(error))]
    File { what: &'static str, error: FileError },
    /// It was read, but holds nothing of use.
    #[error("the {what} `{name}` {reason}")]
    Content { what: &'static str, name: String, reason: String },
}

impl AssetError {
    /// What was expected, if it is no other file: `example` then says what a file can be. The other messages say it themselves.
    pub(crate) fn expected(&self, example: &'static str) -> &'static str {
        if matches!(self, Self::NotFound { .. }) { example } else { "" }
    }
}

/// Opens what a scene names and keeps track of it.
pub(crate) struct Files<'a> {
    resolver: &'a dyn Resolver,
    pub(crate) limits: &'a Limits,
    /// Every file that was opened, in order.
    pub(crate) opened: Vec<PathBuf>,
    /// What all meshes have cost so far; see [`Limits::mesh_elements`].
    pub(crate) elements: usize,
}

impl<'a> Files<'a> {
    pub(crate) fn new(resolver: &'a dyn Resolver, limits: &'a Limits) -> Self {
        Self { resolver, limits, opened: Vec::new(), elements: 0 }
    }

    /// The file that `name` means beside the file `beside` (`None`: beside the scene).
    pub(crate) fn find(&self, what: &'static str, name: &str, beside: Option<&Path>) -> Result<PathBuf, AssetError> {
        let not_found = |searched| AssetError::NotFound { what, name: name.to_owned(), searched };
        self.resolver.find(name, beside).map_err(not_found)
    }

    /// The first of these names that a file beside `beside` or in a search path has; the last one if there is no such file.
    pub(crate) fn first_found<'n>(&self, names: impl Iterator<Item = &'n str>, beside: &Path) -> &'n str {
        let mut last = "";
        for name in names {
            last = name;
            if self.resolver.find(name, Some(beside)).is_ok() {
                break;
            }
        }
        last
    }

    /// Equal for two paths that lead to the same file.
    pub(crate) fn identity(&self, path: &Path) -> PathBuf {
        self.resolver.identity(path)
    }

    /// All of a file of at most `limit` bytes.
    pub(crate) fn read(&mut self, what: &'static str, path: &Path, limit: u64) -> Result<Vec<u8>, AssetError> {
        let bytes = resolver::read(self.resolver, path, limit).map_err(|error| AssetError::File { what, error })?;
        self.opened.push(path.to_path_buf());
        Ok(bytes)
    }

    /// A file of at most `limit` bytes, to be read bit by bit.
    pub(crate) fn open(&mut self, what: &'static str, path: &Path, limit: u64) -> Result<Box<dyn Read>, AssetError> {
        let reader = self.resolver.open(path, limit).map_err(|error| AssetError::File { what, error })?;
        self.opened.push(path.to_path_buf());
        Ok(reader)
    }

    /// How many more vertices, normals, texture coordinates and triangles are accepted.
    pub(crate) fn room(&self) -> usize {
        self.limits.mesh_elements.saturating_sub(self.elements)
    }
}

/// What stands before the name of a file: only the system's answer does not say by itself that it cannot be read.
fn lead(error: &FileError) -> &'static str {
    if matches!(error, FileError::Io { .. }) { "cannot read " } else { "" }
}

fn list(paths: &[PathBuf]) -> String {
    let shown: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    shown.join(", ")
}
