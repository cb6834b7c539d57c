//! `info`, `completions`, `man`, help, and pipes that close early.

use crate::support::{Folder, stderr, stdout};
use std::process::Stdio;

#[test]
fn info_tells_what_was_understood() {
    let folder = Folder::new();
    let said = stdout(&folder.run("info scene.txt").success());
    let expected = [
        "scene        scene",
        "eye 10 units",
        "1 omni; 1 emitter",
        "objects      3",
        "sphere",
        "0.2 0 0.7 1",
        "0 triangles, 1 sphere, 2 squares",
        "bounds",
        "vpl.attenuation 0.03 (GPU 0.02)",
        "read         scene.txt",
        "warnings     0",
    ];
    for expected in expected {
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
    let info: serde_json::Value =
        serde_json::from_str(&stdout(&folder.run("info scene.txt --json").success())).unwrap();
    assert_eq!(info["objects"][0]["kind"], "sphere");
    assert_eq!(info["totals"]["squares"], 2);
    assert_eq!(info["lights"]["omni"], 1);
    assert_eq!(info["settings"]["vpl"]["probability"].to_string(), "0.002");
    assert!(info["bounds"][1][0].as_f64() > Some(139.0));
}

#[test]
fn info_counts_emitters_triangles_and_warnings() {
    let folder = Folder::new();
    folder.write("a.obj", "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 50 50 0\nf 1 2 4 3\n");
    let extra = "L SQU_A|C{0,190,0}N{0,-1,0}H{0,0,1}:W(40)H(60):DS(20)|ATTEN(1)|S{1,1,1}|D{1,1,1}|A{0,0,0}\n\
                 O FRKE{0,0,1,1}|PATH:a.obj|SMTH(0)|MAT(1)|S{0,0,0}|D{1,1,1}|A{0,0,0}|SH(20)\nX|UNKNOWN(1)\n";
    folder.write("scene.txt", format!("{}{extra}", crate::support::SCENE));
    let assert = folder.run("info scene.txt").success();
    let said = stdout(&assert);
    for expected in
        ["1 area, 1 omni; 7 emitters", "2 triangles, 1 sphere, 3 squares", "read         a.obj", "warnings     1"]
    {
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
    assert!(stderr(&assert).contains("scene.txt:10:1"), "{}", stderr(&assert));
}

#[test]
fn info_shows_a_pictures_job() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 9x7 -o a.exr -o a.png").success();
    for name in ["a.exr", "a.png"] {
        let said = stdout(&folder.run(&format!("info {name}")).success());
        for expected in ["9 x 7", "beauty (color)", "  scene = \"scene.txt\"", "  width = 9"] {
            assert!(said.contains(expected), "{expected} is missing in:\n{said}");
        }
    }
    let info: serde_json::Value = serde_json::from_str(&stdout(&folder.run("info a.exr --json").success())).unwrap();
    assert_eq!((&info["width"], info["layers"].as_array().map(Vec::len)), (&9.into(), Some(8)));
}

#[test]
fn help_completions_and_man_pages_come_from_one_declaration() {
    let folder = Folder::new();
    let help = stdout(&folder.run("render --help").success());
    let headings = [
        "Run:",
        "Image:",
        "Sampling:",
        "Filter:",
        "VPLs:",
        "Gather:",
        "Ambient occlusion:",
        "Caustics:",
        "Bloom:",
        "Display:",
        "Output:",
        "Performance:",
        "Exit codes:",
    ];
    for heading in headings {
        assert!(help.lines().any(|line| line == heading), "{heading} is missing");
    }
    assert!(stdout(&folder.run("--version").success()).contains(env!("CARGO_PKG_VERSION")));
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(
            stdout(&folder.run(&format!("completions {shell}")).success()).contains("vpl-min-illumination"),
            "{shell}"
        );
    }
    assert!(stdout(&folder.run("man").success()).contains(".TH"));
    folder.run("man new/man").success();
    assert!(folder.text("new/man/lightcuts-render.1").contains("vpl\\-min\\-illumination"));
    folder.run("man scene.txt").code(1);
}

#[test]
fn a_pipe_that_closes_early_is_no_failure() {
    let folder = Folder::new();
    for arguments in ["info scene.txt", "render scene.txt --size 8x8", "completions bash", "man", "render --help"] {
        let mut child = folder.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn progress_comes_in_styles() {
    let folder = Folder::new();
    let render =
        |style: &str| stderr(&folder.run(&format!("render scene.txt --size 32x32 --progress {style}")).success());
    for line in render("json").lines() {
        let object: serde_json::Value = serde_json::from_str(line).unwrap();
        for key in ["stage", "done", "total", "elapsed_s", "remaining_s"] {
            assert!(object.get(key).is_some(), "{line}");
        }
    }
    assert!(render("plain").starts_with("first pass ...\n"));
    assert_eq!(render("none"), "");
    // Plain is what a pipe gets.
    assert!(stderr(&folder.run("render scene.txt --size 8x8").success()).starts_with("first pass ...\n"));
    assert!(stderr(&folder.run("-v render scene.txt --size 8x8").success()).contains("read scene.txt"));
}
