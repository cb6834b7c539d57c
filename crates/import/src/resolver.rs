//! How names in files become bytes: from the file system, or from memory for tests and fuzzing.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It does not exist, may not be read, or the device failed.
    #[error("`{}`: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        error: io::Error,
    },
    /// It is a directory, a pipe or a device.
    #[error("`{}` is {found}; expected a regular file", path.display())]
    NotRegular {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// It is longer than accepted.
    #[error("`{}` has {length} bytes; expected at most {limit}", path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
        /// Its length in bytes, as far as it is known.
        length: u64,
        /// The limit in bytes.
        limit: u64,
    },
}

/// Finds and opens the files that a scene names.
pub trait Resolver {
    /// The file that `name` means when it stands in a file beside `beside` (`None`: in the scene itself), else the
    /// places that were searched in vain.
    fn find(&self, name: &str, beside: Option<&Path>) -> Result<PathBuf, Vec<PathBuf>>;

    /// Opens a file for reading; fails if it is not a regular file or longer than `limit` bytes.
    /// The reader ends after `limit + 1` bytes even if the file grows meanwhile.
    fn open(&self, path: &Path, limit: u64) -> Result<Box<dyn Read>, FileError>;

    /// Equal for two paths that lead to the same file.
    fn identity(&self, path: &Path) -> PathBuf {
        path.to_path_buf()
    }
}

/// Reads a whole file of at most `limit` bytes.
pub(crate) fn read(resolver: &dyn Resolver, path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    let io_error = |error| FileError::Io { path: path.to_path_buf(), error };
    resolver.open(path, limit)?.read_to_end(&mut bytes).map_err(io_error)?;
    if bytes.len() as u64 > limit {
        return Err(FileError::TooLong { path: path.to_path_buf(), length: bytes.len() as u64, limit });
    }
    Ok(bytes)
}

/// Looks beside the naming file, beside the scene, then in the search paths, in this order.
#[derive(Debug, Clone)]
pub struct FileResolver {
    folders: Vec<PathBuf>,
}

impl FileResolver {
    /// For the scene file at `scene`.
    pub fn new(scene: &Path, search_paths: &[PathBuf]) -> Self {
        let beside = scene.parent().unwrap_or(Path::new("")).to_path_buf();
        Self { folders: std::iter::once(beside).chain(search_paths.iter().cloned()).collect() }
    }
}

impl Resolver for FileResolver {
    fn find(&self, name: &str, beside: Option<&Path>) -> Result<PathBuf, Vec<PathBuf>> {
        let name = name.replace('\\', "/");
        let first = beside.and_then(Path::parent).map(Path::to_path_buf);
        let mut searched: Vec<PathBuf> = Vec::new();
        for candidate in first.iter().chain(&self.folders).map(|folder| folder.join(&name)) {
            if !searched.contains(&candidate) {
                searched.push(candidate);
            }
        }
        // A regular file wins; a directory of that name is still worth a message of its own.
        let regular = searched.iter().find(|path| path.is_file());
        match regular.or_else(|| searched.iter().find(|path| path.symlink_metadata().is_ok())) {
            Some(path) if !name.is_empty() => Ok(path.clone()),
            _ => Err(searched),
        }
    }

    fn open(&self, path: &Path, limit: u64) -> Result<Box<dyn Read>, FileError> {
        let io_error = |error| FileError::Io { path: path.to_path_buf(), error };
        // Looked at before it is opened: opening a pipe waits for its writer.
        let metadata = fs::metadata(path).map_err(io_error)?;
        if !metadata.is_file() {
            let found = if metadata.is_dir() { "a directory" } else { "a device or pipe" };
            return Err(FileError::NotRegular { path: path.to_path_buf(), found });
        }
        if metadata.len() > limit {
            return Err(FileError::TooLong { path: path.to_path_buf(), length: metadata.len(), limit });
        }
        let file = File::open(path).map_err(io_error)?;
        Ok(Box::new(file.take(limit.saturating_add(1))))
    }

    fn identity(&self, path: &Path) -> PathBuf {
        path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
    }
}

/// Files in memory, addressed by name; folders play no role. For tests, fuzzing and scenes that come without files.
#[derive(Debug, Clone, Default)]
pub struct MemoryResolver {
    /// The files' contents by name.
    pub files: BTreeMap<String, Vec<u8>>,
}

impl<const N: usize> From<[(&str, &[u8]); N]> for MemoryResolver {
    fn from(files: [(&str, &[u8]); N]) -> Self {
        Self { files: files.into_iter().map(|(name, bytes)| (name.to_owned(), bytes.to_vec())).collect() }
    }
}

impl Resolver for MemoryResolver {
    fn find(&self, name: &str, _beside: Option<&Path>) -> Result<PathBuf, Vec<PathBuf>> {
        let path = PathBuf::from(name);
        if self.files.contains_key(name) { Ok(path) } else { Err(vec![path]) }
    }

    fn open(&self, path: &Path, limit: u64) -> Result<Box<dyn Read>, FileError> {
        let bytes = path
            .to_str()
            .and_then(|name| self.files.get(name))
            .ok_or_else(|| FileError::Io { path: path.to_path_buf(), error: io::ErrorKind::NotFound.into() })?;
        let length = bytes.len() as u64;
        if length > limit {
            return Err(FileError::TooLong { path: path.to_path_buf(), length, limit });
        }
        Ok(Box::new(io::Cursor::new(bytes.clone())))
    }
}
