//! The command `report`.

use crate::support::{Folder, stderr, stdout};

/// An experiment of one small render, which shows its time and its picture.
const EXPERIMENT: &str = r#"
name = "tiny"
title = "A tiny experiment"
settings = { image = { width = 8, height = 8 } }

[[scene]]
name = "ball"
file = "scene.txt"

[[configuration]]
name = "plain"
settings = { gather = { strategy = "all" } }

[[section]]
id = "times"
title = "Times"
shows = "times"
scene = "ball"
configurations = ["plain"]

[[section]]
id = "pictures"
title = "Pictures"
shows = "images"
scene = "ball"
configurations = ["plain"]
"#;

fn folder_with_results() -> Folder {
    let folder = Folder::new();
    folder.write("tiny.toml", EXPERIMENT);
    folder.run("experiment tiny.toml -o out -q").success();
    folder
}

#[test]
fn a_report_is_made_of_results_alone() {
    let folder = folder_with_results();
    let said = stdout(&folder.run("report out/results.jsonl -o new/folder").success());
    for file in ["tables/times.csv", "report.md", "index.html"] {
        assert!(folder.has(&format!("new/folder/{file}")), "{file}");
        assert!(said.contains(&format!("wrote        new/folder/{file}")), "{said}");
    }
    assert!(folder.text("new/folder/index.html").contains("<title>A tiny experiment</title>"));
    // Beside the results unless told otherwise, and again over the files of the first time.
    folder.run("report out/results.jsonl -q").success().stdout("").stderr("");
    folder.run("report out/results.jsonl -q").success();
    assert_eq!(folder.bytes("out/report/index.html"), folder.bytes("new/folder/index.html"));
}

#[test]
fn missing_pictures_are_a_warning() {
    let folder = folder_with_results();
    std::fs::remove_dir_all(folder.at("out/images")).unwrap();
    let said = stderr(&folder.run("report out/results.jsonl").success());
    assert!(said.contains("images/ball--plain.png cannot be shown: there is no such file"), "{said}");
    assert!(folder.text("out/report/index.html").contains("cannot be shown"));
}

#[test]
fn malformed_results_are_refused_with_their_line() {
    let folder = Folder::new();
    let said = stderr(&folder.run("report none.jsonl").code(3));
    assert!(said.contains("none.jsonl"), "{said}");
    folder.write("results.jsonl", "{\"kind\":\"header\"}\n");
    let said = stderr(&folder.run("report results.jsonl -o report").code(3));
    assert!(said.contains("results.jsonl:1:"), "{said}");
    folder.write("results.jsonl", "");
    let said = stderr(&folder.run("report results.jsonl -o report").code(3));
    assert!(said.contains("holds no experiment yet"), "{said}");
    assert!(!folder.has("report"));
}

#[test]
fn a_report_that_cannot_be_written_has_a_code_of_its_own() {
    let folder = folder_with_results();
    folder.write("taken", "");
    let said = stderr(&folder.run("report out/results.jsonl -o taken/report").code(1));
    assert!(said.contains("cannot make the folder taken/report"), "{said}");
}
