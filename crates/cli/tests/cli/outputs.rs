//! Outputs: refused before the render where they cannot be written, and each tried after it.

use crate::support::{Folder, stderr, stdout};
use assert_cmd::assert::OutputAssertExt;
use std::fs;

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_render() {
    let folder = Folder::new();
    folder.write("taken.png", "old");
    fs::create_dir(folder.at("folder.png")).unwrap();
    let mut permissions = fs::metadata(folder.at("taken.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(folder.at("taken.png"), permissions).unwrap();
    let cases = [
        ("-o a.jpg", "ends in .exr or .png"),
        ("-o a", "ends in .exr or .png"),
        ("-o none/a.png", "there is no folder none"),
        ("-o folder.png", "not a regular file"),
        ("-o taken.png", "read-only"),
        ("-o a.png -o ./a.png", "two outputs"),
        ("--write-vpls scene.txt", "an input of this render"),
        ("--stats none/s.json", "there is no folder none"),
        ("--write-job ../.", "it"),
    ];
    for (outputs, expected) in cases {
        // So many samples would take hours.
        let said = stderr(&folder.run(&format!("render scene.txt --samples 4096 {outputs}")).code(2));
        assert!(said.contains(expected), "{outputs}: {expected} is missing in:\n{said}");
    }
    // A dry run refuses them too.
    folder.run("render scene.txt --dry-run -o none/a.png").code(2);
    assert_eq!(folder.text("taken.png"), "old");
    assert!(!folder.has("a.png") && !folder.has("scene.png"));
}

#[test]
fn no_output_replaces_a_file_that_the_scene_needs() {
    let folder = Folder::new();
    folder.write("model.png", "v 0 0 0\nv 50 0 0\nv 0 50 0\nf 1 2 3\n");
    let mesh = "O FRKE{0,0,1,1}|PATH:model.png|SMTH(0)|MAT(1)|S{0,0,0}|D{1,1,1}|A{0,0,0}|SH(20)\n";
    folder.write("scene.txt", format!("{}{mesh}", crate::support::SCENE));
    let said = stderr(&folder.run("render scene.txt --size 4x4 -o model.png").code(2));
    assert!(said.contains("an input of this render"), "{said}");
    folder.run("render scene.txt --size 4x4 -o a.exr").success();
    folder.run("render a.exr -o a.exr").code(2);
    folder.run("render scene.txt --size 4x4 -o b.exr -q").success().stdout("");
}

/// No file may become longer than 8 blocks: a picture fails after the render, the short texts do not.
#[cfg(unix)]
#[test]
fn one_failed_output_does_not_stop_the_others() {
    let folder = Folder::new();
    let limited = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
    let arguments =
        "render scene.txt --size 64x64 --vpl-probability 0.000002 -o a.exr --write-vpls v.csv --write-job j.toml";
    let mut command = std::process::Command::new("sh");
    command.args(["-c", limited, env!("CARGO_BIN_EXE_lightcuts")]).args(arguments.split(' '));
    let assert = command.current_dir(folder.at(".")).assert().code(1);
    assert!(stderr(&assert).contains("cannot write a.exr"), "{}", stderr(&assert));
    assert!(stdout(&assert).contains("wrote        v.csv") && !stdout(&assert).contains("a.exr"));
    assert!(folder.has("v.csv") && folder.has("j.toml") && !folder.has("a.exr"));
}
