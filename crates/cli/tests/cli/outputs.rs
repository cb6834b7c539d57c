//! Outputs: refused before the render where they cannot be written, and each tried after it.

use crate::support::{Folder, stderr};
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

/// The folder of one output vanishes during the render, which waits for its standard error to be read.
#[cfg(unix)]
#[test]
fn one_failed_output_does_not_stop_the_others() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::Stdio;
    let folder = Folder::new();
    fs::create_dir(folder.at("gone")).unwrap();
    let arguments =
        "render scene.txt --size 64x64 --samples 512 -j1 --progress json -o gone/a.png -o b.png --stats s.json";
    let mut child = folder.command(arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    stderr.read_line(&mut line).unwrap();
    assert!(line.contains("first_pass"), "{line}");
    fs::remove_dir(folder.at("gone")).unwrap();
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest}");
    assert!(rest.contains("gone/a.png"), "{rest}");
    assert!(folder.has("b.png") && folder.has("s.json"));
}
