//! What tests need of the system: found, or installed from the system's packages where that is possible.

use anyhow::{Context as _, Result, anyhow, ensure};
use std::env::{self, consts::EXE_SUFFIX};
use std::fs;
use std::process::{Command, Stdio};
use std::sync::Once;

/// Something of the system without which some tests cannot run.
pub(crate) struct Need {
    /// The tests that need it, in the plural, as messages name them.
    pub(crate) tests: &'static str,
    /// What they need, in the plural, as messages name it.
    pub(crate) things: &'static str,
    /// Looks for it. A look must be cheap: it is taken before each run of cargo.
    pub(crate) is_there: fn() -> bool,
    /// The packages that bring it on Debian.
    pub(crate) debian: &'static [&'static str],
    /// The packages that bring it on Ubuntu.
    pub(crate) ubuntu: &'static [&'static str],
}

impl Need {
    /// Installs it unless it is there, if that is allowed; says what it does. That it cannot be installed is no error:
    /// tests skip then.
    pub(crate) fn provide(&self, may_install: bool) {
        if (self.is_there)() {
            return;
        }
        println!("{} need {}, which are not here", self.tests, self.things);
        let installed =
            if may_install { self.install() } else { Err(anyhow!("nothing is installed with --no-install")) };
        if let Err(obstacle) = installed {
            let fate = if is_server() { "fail" } else { "skip" };
            println!("note: {obstacle}; without {} those tests {fate}", self.things);
        }
    }

    /// Whether tests shall fail without it: where it is, and on build servers.
    pub(crate) fn is_required(&self) -> bool {
        is_server() || (self.is_there)()
    }

    fn install(&self) -> Result<()> {
        let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
        let packages = self.packages(&release).context("this task installs them only on Debian and Ubuntu")?;
        let prefix = privileges().with_context(|| {
            format!("no permission to install them; as root: apt-get install {}", packages.join(" "))
        })?;
        refresh_lists(prefix);
        let options = ["install", "--yes", "--no-install-recommends"];
        ensure!(apt_get(prefix, &[&options, packages].concat()), "that failed");
        Ok(())
    }

    /// The packages' names on a system with this `/etc/os-release`.
    fn packages(&self, release: &str) -> Option<&'static [&'static str]> {
        let id = release.lines().find_map(|line| line.strip_prefix("ID="))?;
        match id.trim_matches('"') {
            "debian" => Some(self.debian),
            "ubuntu" => Some(self.ubuntu),
            _ => None,
        }
    }
}

/// Whether a program of this name is in one of the folders where commands are searched.
pub(crate) fn is_installed(program: &str) -> bool {
    let file = format!("{program}{EXE_SUFFIX}");
    env::var_os("PATH").is_some_and(|path| env::split_paths(&path).any(|folder| folder.join(&file).is_file()))
}

/// Whether this is a build server, where a skipped test would go unnoticed.
fn is_server() -> bool {
    env::var("CI").is_ok_and(|value| !["", "0", "false"].contains(&value.as_str()))
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

/// Fetches the lists of packages, once for all needs. Where that fails, lists may be there from before.
fn refresh_lists(prefix: &[&str]) {
    static FETCHED: Once = Once::new();
    FETCHED.call_once(|| {
        apt_get(prefix, &["update"]);
    });
}

fn apt_get(prefix: &[&str], arguments: &[&str]) -> bool {
    let words = [prefix, &["apt-get"], arguments].concat();
    println!("$ {}", words.join(" "));
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).env("DEBIAN_FRONTEND", "noninteractive").stdin(Stdio::null()).stdout(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEED: Need = Need { tests: "", things: "", is_there: || true, debian: &["d"], ubuntu: &["u", "v"] };

    #[test]
    fn packages_are_those_of_the_system() {
        let debian = "PRETTY_NAME=\"Debian GNU/Linux 12\"\nVERSION_ID=\"12\"\nID=debian\n";
        assert_eq!(NEED.packages(debian), Some(&["d"][..]));
        assert_eq!(NEED.packages("NAME=x\nID=\"ubuntu\"\nID_LIKE=debian\n"), Some(&["u", "v"][..]));
        assert_eq!(["ID=fedora\n", "ID_LIKE=debian\n", ""].map(|release| NEED.packages(release)), [None; 3]);
    }

    #[test]
    fn what_is_there_is_required() {
        assert!(NEED.is_required());
        assert_eq!(Need { is_there: || false, ..NEED }.is_required(), is_server());
    }

    #[test]
    fn programs_are_found_by_their_files() {
        assert!(is_installed("cargo"));
        assert!(!is_installed("no-such-program-of-lightcuts"));
    }
}
