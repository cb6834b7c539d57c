//! Paths in jobs: relative to the file that holds the job, so that both can move together.

use std::path::{Component, Path, PathBuf};

/// `path`, seen from `directory`, with `/` between its parts; absolute where they share no folder, as on two drives:
/// then they will not move together. Links are followed first, so that `..` means what it says.
pub(super) fn relative_to(path: &Path, directory: &Path) -> String {
    let (path, directory) = (real(path), real(directory));
    let common = path.components().zip(directory.components()).take_while(|(a, b)| a == b).count();
    let shared = path.components().take(common);
    if !shared.into_iter().any(|part| matches!(part, Component::Normal(_))) {
        return path.to_string_lossy().into_owned();
    }
    let up = directory.components().skip(common).map(|_| "..".into());
    let down = path.components().skip(common).map(|part| part.as_os_str().to_string_lossy());
    let parts: Vec<_> = up.chain(down).collect();
    if parts.is_empty() { ".".to_owned() } else { parts.join("/") }
}

/// Absolute and without links if the file exists, else as close to that as possible.
fn real(path: &Path) -> PathBuf {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf())
}

/// What `path` in a file in `directory` means: beside that file; for a picture, which may have been moved alone, also
/// from the current folder.
pub(super) fn find(path: &str, directory: &Path, in_picture: bool) -> PathBuf {
    let beside = tidy(&directory.join(path));
    if in_picture && !beside.exists() && Path::new(path).exists() { PathBuf::from(path) } else { beside }
}

/// Without `./` in front.
fn tidy(path: &Path) -> PathBuf {
    let parts: PathBuf = path.components().filter(|part| *part != Component::CurDir).collect();
    if parts.as_os_str().is_empty() { PathBuf::from(".") } else { parts }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_go_up_and_down() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        std::fs::create_dir_all(at("a/b")).unwrap();
        std::fs::create_dir_all(at("c")).unwrap();
        std::fs::write(at("c/s.txt"), "").unwrap();
        assert_eq!(relative_to(&at("c/s.txt"), &at("a/b")), "../../c/s.txt");
        assert_eq!(relative_to(&at("c/s.txt"), &at("c")), "s.txt");
        assert_eq!(relative_to(&at("c"), &at("c")), ".");
        assert_eq!(find("../../c/s.txt", &at("a/b"), false), at("a/b/../../c/s.txt"));
        assert_eq!(
            relative_to(&at("c/s.txt"), Path::new("/")),
            at("c/s.txt").canonicalize().unwrap().to_string_lossy()
        );
        assert_eq!(find("s.txt", Path::new("."), false), Path::new("s.txt"));
    }
}
