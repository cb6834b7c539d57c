//! The browser that tests drive: found, or installed where that is possible.

use std::env::{self, consts::EXE_SUFFIX};
use std::fs;
use std::process::{Command, Stdio};

/// If set, tests fail where there is no browser; else they skip.
pub(crate) const REQUIRED: &str = "LIGHTCUTS_REQUIRE_BROWSER";
/// Names under which systems install the browser.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
const DRIVER: &str = "chromedriver";

/// Installs Chromium and its driver unless they are there; says what it does. Without them tests of pages skip.
pub(crate) fn provide() {
    if is_there() {
        return;
    }
    println!("tests of pages need Chromium and {DRIVER}, which are not here");
    let Some(packages) = packages(&fs::read_to_string("/etc/os-release").unwrap_or_default()) else {
        println!("note: install them to run those tests; they are installed by this task on Debian and Ubuntu alone");
        return;
    };
    let Some(prefix) = privileges() else {
        println!("note: no right to install them; as root: apt-get install {}", packages.join(" "));
        return;
    };
    let install: Vec<&str> = ["install", "--yes", "--no-install-recommends"].iter().chain(packages).copied().collect();
    // Lists of packages that cannot be fetched may be there from before.
    apt_get(prefix, &["update"]);
    if !apt_get(prefix, &install) {
        println!("note: that failed");
    }
}

/// Whether tests shall fail without a browser: where one is, and on build servers.
pub(crate) fn is_required() -> bool {
    let server = env::var("CI").is_ok_and(|value| !["", "0", "false"].contains(&value.as_str()));
    server || is_there()
}

fn is_there() -> bool {
    BROWSERS.iter().any(|name| is_installed(name)) && is_installed(DRIVER)
}

fn is_installed(program: &str) -> bool {
    let file = format!("{program}{EXE_SUFFIX}");
    env::var_os("PATH").is_some_and(|path| env::split_paths(&path).any(|folder| folder.join(&file).is_file()))
}

/// The packages' names on a system with this `/etc/os-release`.
fn packages(release: &str) -> Option<&'static [&'static str]> {
    let id = release.lines().find_map(|line| line.strip_prefix("ID="))?;
    match id.trim_matches('"') {
        "debian" => Some(&["chromium", "chromium-driver"]),
        "ubuntu" => Some(&["chromium-browser", "chromium-chromedriver"]),
        _ => None,
    }
}

/// What to put before a command that only root may run, if there is a way that asks for no password.
fn privileges() -> Option<&'static [&'static str]> {
    let user = Command::new("id").arg("-u").output().ok()?;
    if user.stdout.trim_ascii() == b"0" {
        return Some(&[]);
    }
    let sudo = Command::new("sudo").args(["-n", "true"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    sudo.is_ok_and(|status| status.success()).then_some(&["sudo", "-n"])
}

fn apt_get(prefix: &[&str], arguments: &[&str]) -> bool {
    let words: Vec<&str> = prefix.iter().chain(&["apt-get"]).chain(arguments).copied().collect();
    println!("$ {}", words.join(" "));
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).env("DEBIAN_FRONTEND", "noninteractive").stdin(Stdio::null()).stdout(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_those_of_the_system() {
        let debian = "PRETTY_NAME=\"Debian GNU/Linux 12\"\nVERSION_ID=\"12\"\nID=debian\n";
        assert_eq!(packages(debian), Some(&["chromium", "chromium-driver"][..]));
        assert!(packages("NAME=x\nID=\"ubuntu\"\nID_LIKE=debian\n").is_some());
        assert_eq!([packages("ID=fedora\n"), packages("ID_LIKE=debian\n"), packages("")], [None; 3]);
    }

    #[test]
    fn programs_are_found_by_their_files() {
        assert!(is_installed("cargo"));
        assert!(!is_installed("no-such-program-of-lightcuts"));
    }
}
