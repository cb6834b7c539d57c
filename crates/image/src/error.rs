//! What can go wrong with pictures and their files.

use std::path::{Path, PathBuf};

/// An error of this crate; every error of a file names its path.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The operating system refused an operation on a file.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried: `read`, `write`, ...
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The directory that should hold a new file does not exist.
    #[error("cannot write {}: there is no directory {}", path.display(), directory.display())]
    MissingDirectory {
        /// The file to be written.
        path: PathBuf,
        /// Its parent.
        directory: PathBuf,
    },
    /// A file's content is damaged, hostile, or uses a feature that this crate does not read.
    #[error("cannot read {}: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A picture could not be encoded.
    #[error("cannot encode {}: {reason}", path.display())]
    Encode {
        /// The file to be written.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Two pictures that must have one size have two, or a pixel list does not fill its picture.
    #[error("{what}: expected {expected_width} x {expected_height} pixels, got {width} x {height}")]
    SizeMismatch {
        /// Which picture.
        what: String,
        /// Width asked for, in pixels.
        expected_width: usize,
        /// Height asked for, in pixels.
        expected_height: usize,
        /// Width found, in pixels.
        width: usize,
        /// Height found, in pixels.
        height: usize,
    },
    /// A list of pixels has the wrong length for its picture.
    #[error("a picture of {width} x {height} pixels cannot hold a list of {length} pixels")]
    PixelCount {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Length of the list.
        length: usize,
    },
    /// The name of a layer or an attribute cannot be stored in an EXR file.
    #[error("the {what} name {name:?} {reason}")]
    Name {
        /// `layer` or `attribute`.
        what: &'static str,
        /// The name.
        name: String,
        /// Why it is refused.
        reason: &'static str,
    },
    /// A parameter of an operator lies outside its range.
    #[error("{parameter} must be {range}, not {value}")]
    Parameter {
        /// The parameter's name as in a job file.
        parameter: &'static str,
        /// The range in words.
        range: &'static str,
        /// The refused value.
        value: f64,
    },
}

impl ImageError {
    /// Wraps an error of the operating system with the file's path.
    pub(crate) fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    /// A file that cannot be decoded, with the reason.
    pub(crate) fn malformed(path: &Path, reason: impl Into<String>) -> Self {
        Self::Malformed { path: path.to_owned(), reason: reason.into() }
    }

    /// A picture that cannot be encoded, with the reason.
    pub(crate) fn encode(path: &Path, reason: impl Into<String>) -> Self {
        Self::Encode { path: path.to_owned(), reason: reason.into() }
    }
}
