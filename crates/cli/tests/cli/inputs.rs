//! Inputs that are wrong: a message with the place, the right exit code, never a panic.

use crate::malformed::{self, Expectation};
use crate::support::{Folder, stderr};

#[test]
fn every_malformed_scene_ends_with_a_message() {
    let folder = Folder::new();
    std::fs::create_dir(folder.at("bad")).unwrap();
    for case in malformed::write(&folder.at("bad")) {
        let file = format!("bad/{}", case.file);
        let assert = folder.run(&format!("render {file} --size 4x4 -q -o out.png"));
        let said = stderr(&assert);
        let (code, fragment, line) = match case.expectation {
            Expectation::Error(fragment, line) => (3, fragment, line),
            Expectation::Warning(fragment, line) => (0, fragment, Some(line)),
        };
        assert_eq!(assert.get_output().status.code(), Some(code), "{file}:\n{said}");
        assert!(said.contains(fragment), "{file}: {fragment:?} is missing in:\n{said}");
        assert!(
            line.is_none_or(|line| said.contains(&format!(":{line}:"))),
            "{file}: line {line:?} is missing in:\n{said}"
        );
        assert!(!said.contains("panicked"), "{file}:\n{said}");
    }
}

#[test]
fn pictures_without_a_job_or_damaged_cannot_be_rendered_again() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 8x8 -o a.exr -o a.png").success();
    folder.write("cut.exr", &folder.bytes("a.exr")[..300]);
    folder.write("cut.png", &folder.bytes("a.png")[..60]);
    folder.write("text.exr", "no picture");
    folder.write("empty.png", "");
    std::fs::create_dir(folder.at("folder.exr")).unwrap();
    for name in ["cut.exr", "cut.png", "text.exr", "empty.png", "folder.exr", "none.exr"] {
        for command in [format!("render {name} -o b.exr"), format!("info {name}")] {
            let said = stderr(&folder.run(&command).code(3));
            assert!(said.contains(name) && !said.contains("panicked"), "{said}");
        }
    }
}

#[test]
fn a_hostile_job_in_a_picture_is_only_a_message() {
    let folder = Folder::new();
    for job in ["", "scene = 3", "scene = '/'", "scene = 'scene.txt'\n[image]\nwidth = 4294967295\n"] {
        let mut layers = lightcuts::image::Layers::new(lightcuts::image::Image::new(2, 2));
        layers.set_attribute("lightcuts:job", job).unwrap();
        lightcuts::image::write_exr(folder.at("a.exr"), &layers).unwrap();
        let assert = folder.run("render a.exr -o b.exr").failure();
        assert!([Some(2), Some(3)].contains(&assert.get_output().status.code()), "{job:?}");
        assert!(!stderr(&assert).contains("panicked"), "{job:?}");
    }
}

#[test]
fn malformed_vpls_are_placed() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 16x16 --write-vpls v.csv").success();
    let mut lines: Vec<_> = folder.text("v.csv").lines().map(str::to_owned).collect();
    lines[2] = format!("x{}", lines[2]);
    folder.write("bad.csv", lines.join("\n"));
    let said = stderr(&folder.run("render scene.txt --read-vpls bad.csv").code(3));
    assert!(said.contains("bad.csv:3:1: found 'x"), "{said}");
    folder.write("empty.csv", "");
    for name in ["empty.csv", "none.csv", "."] {
        folder.run(&format!("render scene.txt --read-vpls {name}")).code(3);
    }
}

#[test]
fn bad_usage_is_told_apart() {
    let folder = Folder::new();
    let cases = [
        "",
        "render",
        "paint scene.txt",
        "render scene.txt --samples 0",
        "render scene.txt --samples x",
        "render scene.txt --threshold -1",
        "render scene.txt --threshold nan",
        "render scene.txt --model magical",
        "render scene.txt --size 0x5",
        "render scene.txt --size 65536x65536",
        "render scene.txt --threads 100000",
        "render scene.txt --reproduce --samples 2",
        "render scene.txt --progress loud",
        "completions tcsh-like",
    ];
    for arguments in cases {
        let assert = folder.run(arguments).code(2);
        assert!(!stderr(&assert).contains("panicked") && !stderr(&assert).is_empty(), "{arguments}");
    }
    folder.run("render none.txt").code(3);
}
