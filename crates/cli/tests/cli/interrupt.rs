//! Signals: the first ends the render in good order, the second at once.

#![cfg(unix)]

use crate::physical::SCENE;
use crate::support::{Folder, stdout};
use lightcuts::image::{LayerData, read_exr};
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Stdio};

/// A render that would take hours, in its first pass.
fn slow_render(folder: &Folder) -> (Child, BufReader<ChildStderr>) {
    let arguments = "render scene.txt --size 512x512 --samples 4096 --progress json -o a.exr -o a.png --stats s.json";
    let mut child = folder.command(arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    // A second line: a tile is done, so there is something to write.
    for _ in 0..2 {
        stderr.read_line(&mut line).unwrap();
    }
    assert!(line.contains("first_pass"), "{line}");
    (child, stderr)
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn an_interrupted_render_writes_what_there_is() {
    for name in ["INT", "TERM"] {
        let folder = Folder::new();
        let (mut child, mut stderr) = slow_render(&folder);
        signal(&child, name);
        let mut said = String::new();
        stderr.read_to_string(&mut said).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
        assert!(said.contains("interrupted") && said.contains("written so far: a.exr, a.png, s.json"), "{said}");
        let layers = read_exr(folder.at("a.exr")).unwrap();
        assert_eq!((layers.width(), layers.height()), (512, 512));
        assert_eq!(layers.attribute("lightcuts:complete"), Some("false"));
        let told = stdout(&folder.run("info a.exr").success()) + &stdout(&folder.run("info a.png").success());
        assert_eq!(told.matches("complete     no: the render was interrupted").count(), 2, "{told}");
        assert!(folder.has("a.png") && folder.text("s.json").contains("\"complete\": false"));
    }
}

/// Broken off in its first pass, a picture of the physical model has no holes.
#[test]
fn an_interrupted_first_pass_leaves_no_holes() {
    for integrator in ["path", "lightcuts", "auto"] {
        let folder = Folder::new();
        folder.write("ball.toml", SCENE);
        let arguments = format!(
            "render ball.toml --integrator {integrator} --size 1200x900 --samples 1000 --progress json -o a.exr --stats s.json"
        );
        let mut child = folder.command(&arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        let mut said = String::new();
        stderr.read_line(&mut said).unwrap();
        signal(&child, "INT");
        stderr.read_to_string(&mut said).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
        let stats: serde_json::Value = serde_json::from_str(&folder.text("s.json")).unwrap();
        assert!(stats["end"] == "interrupted" && stats["complete"] == false, "{stats}");
        let layers = read_exr(folder.at("a.exr")).unwrap();
        let Some(LayerData::Id(ids)) = layers.get("object_id") else { panic!("an EXR has ids") };
        assert!((560..820).all(|y| ids.row(y)[480..720].iter().all(|&id| id > 0)), "{integrator}");
    }
}

#[test]
fn a_second_signal_needs_no_patience() {
    let folder = Folder::new();
    let (mut child, mut stderr) = slow_render(&folder);
    signal(&child, "INT");
    let mut said = String::new();
    while !said.contains("interrupted") && stderr.read_line(&mut said).unwrap() > 0 {}
    signal(&child, "TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
}
