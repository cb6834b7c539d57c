//! The Vulkan driver for tests of the GPU: found, or one that computes on the CPU installed where that is possible.

use crate::packages::Need;
use std::env::{self, consts::ARCH};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// If set, tests fail where there is no adapter; else they skip.
pub(crate) const REQUIRED: &str = "LIGHTCUTS_REQUIRE_ADAPTER";
/// The loader, as programs open it, and Mesa's drivers: one of them, lavapipe, needs no GPU.
const PACKAGES: &[&str] = &["libvulkan1", "mesa-vulkan-drivers"];
/// The loader's file, by the name under which wgpu opens it.
const LOADER: &str = "libvulkan.so.1";
/// Variables that name manifests of drivers to the loader; it looks into no folder then.
const MANIFEST_VARIABLES: [&str; 2] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];
/// Where the loader looks for manifests of drivers for all users.
const MANIFEST_FOLDERS: [&str; 3] = ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

const NEED: Need = Need {
    tests: "tests of the GPU",
    things: "Vulkan's loader and a driver",
    is_there: || has_loader(variable) && has_driver(&MANIFEST_FOLDERS, variable),
    debian: PACKAGES,
    ubuntu: PACKAGES,
};

/// Installs a driver unless one is there, if that is allowed; says what it does. Without one tests of the GPU skip.
///
/// Nothing is to be done where the system itself brings an interface to GPUs: Metal, Direct3D 12.
pub(crate) fn provide(may_install: bool) {
    if !cfg!(any(target_os = "macos", windows)) {
        NEED.provide(may_install);
    }
}

/// Whether tests shall fail without an adapter: where a driver is, and on build servers.
pub(crate) fn is_required() -> bool {
    NEED.is_required()
}

/// A variable of the surroundings; an empty one counts as none, as the loader and the XDG rules for folders have it.
fn variable(name: &str) -> Option<OsString> {
    env::var_os(name).filter(|value| !value.is_empty())
}

/// Whether the loader is where the system's linker looks for it; `variable` gives the surroundings.
fn has_loader(variable: impl Fn(&str) -> Option<OsString>) -> bool {
    let own = variable("LD_LIBRARY_PATH").unwrap_or_default();
    let multiarch = format!("/usr/lib/{ARCH}-linux-gnu");
    let common = [multiarch.as_str(), "/usr/lib64", "/usr/lib", "/usr/local/lib"].map(PathBuf::from);
    env::split_paths(&own).chain(common).any(|folder| folder.join(LOADER).is_file())
}

/// Whether a driver is announced by a variable, in `folders` or in the user's own folder.
fn has_driver(folders: &[&str], variable: impl Fn(&str) -> Option<OsString>) -> bool {
    MANIFEST_VARIABLES.iter().any(|name| variable(name).is_some())
        || folders.iter().any(|folder| has_manifest(Path::new(folder)))
        || user_folder(variable).is_some_and(|folder| has_manifest(&folder))
}

/// Where the loader looks for manifests of drivers for this user.
fn user_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let home = || variable("HOME").map(|home| Path::new(&home).join(".local/share"));
    let data = variable("XDG_DATA_HOME").map(PathBuf::from).or_else(home)?;
    Some(data.join("vulkan/icd.d"))
}

/// Whether this folder is there and has a manifest of a driver in it.
fn has_manifest(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else { return false };
    entries.flatten().any(|entry| entry.path().extension().is_some_and(|extension| extension == "json"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::tempdir;

    /// Surroundings with one variable.
    fn only(name: &str, value: &Path) -> impl Fn(&str) -> Option<OsString> {
        move |asked| (asked == name).then(|| value.into())
    }

    #[test]
    fn a_driver_is_found_by_its_manifest() {
        let folder = tempdir().unwrap();
        let name = folder.path().to_str().unwrap();
        fs::write(folder.path().join("readme.txt"), "").unwrap();
        assert!(!has_driver(&[name, "/no/such/folder"], |_| None));
        fs::write(folder.path().join("lvp_icd.json"), "{}").unwrap();
        assert!(has_driver(&["/no/such/folder", name], |_| None));
    }

    #[test]
    fn a_driver_is_found_by_a_variable() {
        let file = Path::new("lvp_icd.json");
        assert!(MANIFEST_VARIABLES.iter().all(|name| has_driver(&[], only(name, file))));
        assert!(!has_driver(&[], only("VK_LAYER_PATH", file)));
    }

    #[test]
    fn a_driver_is_found_in_the_users_folder() {
        let folder = tempdir().unwrap();
        for (name, data) in [("XDG_DATA_HOME", "a"), ("HOME", "b/.local/share")] {
            let root = folder.path().join(&data[..1]);
            assert!(!has_driver(&[], only(name, &root)));
            let manifests = folder.path().join(data).join("vulkan/icd.d");
            fs::create_dir_all(&manifests).unwrap();
            fs::write(manifests.join("x.json"), "{}").unwrap();
            assert!(has_driver(&[], only(name, &root)));
        }
    }

    #[test]
    fn the_loader_is_found_by_its_file() {
        let folder = tempdir().unwrap();
        fs::write(folder.path().join(LOADER), "").unwrap();
        assert!(has_loader(only("LD_LIBRARY_PATH", folder.path())));
    }
}
