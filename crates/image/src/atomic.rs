//! Files that appear whole or not at all.

use std::io::Write as _;
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

use crate::ImageError;

/// Writes `bytes` to `path` atomically: a reader sees the old file or the new one, never a part.
///
/// The bytes go to a temporary file in the same directory (a rename is atomic only within a file system), reach the
/// disk (fsync) and take the name `path` by a rename. On failure the old file is untouched and no temporary file stays.
/// The new file has the ordinary permissions (0o666 less the umask), whatever the old one had.
///
/// Fails with [`ImageError::MissingDirectory`] or [`ImageError::Io`]; both name `path`.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), ImageError> {
    let path = path.as_ref();
    let directory = parent_of(path);
    if !directory.is_dir() {
        return Err(ImageError::MissingDirectory { path: path.to_owned(), directory: directory.to_owned() });
    }
    let failed = |source| ImageError::io("write", path, source);
    // A drop of `file` before `persist` removes it: that is what keeps the directory clean on every early return.
    let mut file = temporary_file_in(directory).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    sync_directory(directory);
    Ok(())
}

/// The directory of `path`; `.` for a bare file name.
fn parent_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn temporary_file_in(directory: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".lightcuts-").suffix(".tmp");
    // tempfile's own choice is 0o600, right for secrets; a picture should be as readable as any other file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(directory)
}

/// Makes the rename itself survive a power cut. Not every file system can do it; the file is complete either way.
fn sync_directory(directory: &Path) {
    #[cfg(unix)]
    if let Ok(directory) = std::fs::File::open(directory) {
        let _ = directory.sync_all();
    }
    #[cfg(not(unix))]
    let _ = directory;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn names_in(directory: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn writes_and_replaces_a_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.json");
        write_atomic(&path, b"old").unwrap();
        write_atomic(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names_in(directory.path()), ["a.json"]);
    }

    #[test]
    fn a_missing_directory_is_named() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("none/a.json");
        let error = write_atomic(&path, b"x").unwrap_err();
        assert!(matches!(error, ImageError::MissingDirectory { .. }));
        assert!(error.to_string().contains("none/a.json"), "{error}");
    }

    #[test]
    fn a_failed_write_leaves_everything_as_it_was() {
        let directory = tempfile::tempdir().unwrap();
        // A rename onto a directory that is not empty fails for every user, root included.
        let path = directory.path().join("taken");
        fs::create_dir(&path).unwrap();
        fs::write(path.join("old"), b"old").unwrap();
        let error = write_atomic(&path, b"new").unwrap_err();
        assert!(error.to_string().contains("taken"), "{error}");
        assert_eq!(names_in(directory.path()), ["taken"]);
        assert_eq!(fs::read(path.join("old")).unwrap(), b"old");
    }

    #[cfg(unix)]
    #[test]
    fn the_file_has_the_permissions_of_an_ordinary_one() {
        use std::os::unix::fs::PermissionsExt as _;
        let directory = tempfile::tempdir().unwrap();
        let mode = |name: &str| fs::metadata(directory.path().join(name)).unwrap().permissions().mode();
        fs::write(directory.path().join("ordinary"), b"").unwrap();
        write_atomic(directory.path().join("atomic"), b"").unwrap();
        assert_eq!(mode("atomic"), mode("ordinary"));
    }
}
