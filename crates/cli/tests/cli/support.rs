//! A folder with a small scene, and the binary run in it.

use assert_cmd::assert::{Assert, OutputAssertExt};
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use tempfile::TempDir;

/// A ball in front of a red wall and over a floor; enough VPLs even for few pixels.
pub(crate) const SCENE: &str = "\
# VPL(0.002/0.5/GPU:0.02-CPU:0.03) LC(2e-7)
S BK{0.1, 0.2, 0.3}
C STRAT|PERS(10)|C{0, 0, 960}|V{0, 0, -1}|U{0, 1, 0}
L OMNI|POS{0, 100, 300}|ATTEN(1)|S{1, 1, 1}|D{1, 1, 1}|A{1, 1, 1}
P SPH|FRKE{0.2, 0, 0.7, 1}|C{60, -100, 0}R(80)|S{0.2, 0.2, 0.2}|D{0.3, 0.5, 0.3}|A{0.1, 0.1, 0.1}|SH(20)
P SQU|FRKE{0, 0, 0.6, 1}|C{0, -200, 0}N{0, 1, 0}H{0, 0, 1}|W400:H400|S{0.1, 0.1, 0.1}|D{0.6, 0.6, 0.6}|A{0, 0, 0}|SH(20)
P SQU|FRKE{0, 0, 0.6, 1}|C{-200, 0, 0}N{1, 0, 0}H{0, 1, 0}|W400:H400|S{0, 0, 0}|D{0.9, 0.05, 0.05}|A{0, 0, 0}|SH(20)
";

/// A folder of its own, with `scene.txt` in it.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("scene.txt", SCENE);
        folder
    }

    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.at(name), content).unwrap();
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.at(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.at(name).exists()
    }

    /// The job in a picture's header.
    pub(crate) fn job_of(&self, picture: &str) -> String {
        lightcuts::image::read_exr_attributes(self.at(picture)).unwrap()["lightcuts:job"].clone()
    }

    /// The binary in this folder, untouched by the surroundings. Arguments must not hold blanks.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lightcuts"));
        for variable in ["LIGHTCUTS_PATH", "LIGHTCUTS_LOG", "NO_COLOR", "FORCE_COLOR", "CLICOLOR_FORCE"] {
            command.env_remove(variable);
        }
        command.current_dir(self.0.path()).args(arguments.split_whitespace());
        command
    }

    pub(crate) fn run(&self, arguments: &str) -> Assert {
        self.command(arguments).assert()
    }
}

/// What a command wrote to standard error.
pub(crate) fn stderr(assert: &Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

/// What a command wrote to standard output.
pub(crate) fn stdout(assert: &Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stdout).into_owned()
}
