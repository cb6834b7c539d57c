//! What makes a job another job, and what does not.

use crate::support::{Folder, HEAD, LIBRARY, MESH, MODEL, PAIR, SCENE};
use std::collections::HashSet;

/// Hashes of `plain` and of `cuts`, which is compared with it.
fn hashes(folder: &Folder, text: &str) -> [String; 2] {
    let jobs = folder.plan(text).jobs;
    let of = |name: &str| jobs.iter().find(|job| job.configuration == name && job.run == 1).unwrap().hash.clone();
    [of("plain"), of("cuts")]
}

fn text() -> String {
    format!("{HEAD}{PAIR}")
}

#[test]
fn hashes_are_64_digits_and_distinct() {
    let plan = Folder::new().plan(&format!("runs = 3\nseeds = [1, 2]\n{}[[point]]\nname = 'p'\n", text()));
    assert!(plan.jobs.iter().all(|job| job.hash.len() == 64 && job.hash.bytes().all(|c| c.is_ascii_hexdigit())));
    let distinct: HashSet<_> = plan.jobs.iter().map(|job| &job.hash).collect();
    assert_eq!(distinct.len(), 12, "runs and seeds are other jobs");
}

#[test]
fn what_decides_the_picture_or_its_time_makes_another_job() {
    let folder = Folder::new();
    let before = hashes(&folder, &text());
    let changes = [
        ("a general setting", text().replace("width = 24", "width = 25")),
        ("the display", text().replace("[settings]\n", "[settings]\ndisplay = { transfer = 'srgb' }\n")),
        ("threads", format!("threads = 2\n{}", text())),
        ("the seed", format!("seeds = [2]\n{}", text())),
    ];
    for (what, text) in changes {
        let after = hashes(&folder, &text);
        assert!(before[0] != after[0] && before[1] != after[1], "{what}");
    }
    let own = hashes(&folder, &text().replace("1e-5", "2e-5"));
    assert!(before[0] == own[0] && before[1] != own[1], "a configuration's setting");
}

#[test]
fn every_file_of_a_scene_counts() {
    let folder = Folder::new();
    folder.write("scene.txt", format!("{SCENE}{MESH}"));
    folder.write("a.obj", MODEL);
    let mut seen = HashSet::new();
    let library = |texture: &str| format!("{LIBRARY}map_Kd {texture}\n");
    let pixel = |red: f32| lightcuts::image::Image::filled(2, 2, [red, 0.0, 0.0]);
    lightcuts::image::write_png(folder.at("t.png"), &pixel(0.25), lightcuts::image::Transfer::Linear).unwrap();
    folder.write("a.mtl", library("t.png"));
    assert!(seen.insert(hashes(&folder, &text())));
    lightcuts::image::write_png(folder.at("t.png"), &pixel(0.75), lightcuts::image::Transfer::Linear).unwrap();
    assert!(seen.insert(hashes(&folder, &text())), "the texture");
    folder.write("a.mtl", library("t.png").replace("0.5", "0.4"));
    assert!(seen.insert(hashes(&folder, &text())), "the library");
    folder.write("a.obj", MODEL.replace("50", "51"));
    assert!(seen.insert(hashes(&folder, &text())), "the model");
    folder.write("scene.txt", format!("{SCENE}{MESH}# a remark\n"));
    assert!(seen.insert(hashes(&folder, &text())), "the scene");
}

#[test]
fn rows_change_with_what_they_are_compared_with() {
    let folder = Folder::new();
    let before = hashes(&folder, &text());
    let reference = hashes(&folder, &text().replace("strategy = 'all'", "strategy = 'lightcuts-exhaustive'"));
    assert!(before[0] != reference[0] && before[1] != reference[1], "the reference's picture");
    let metrics = hashes(&folder, &format!("metrics = ['mse']\n{}", text()));
    assert!(before[0] == metrics[0] && before[1] != metrics[1], "references are not measured");
    let renamed = folder.plan(&text().replace("plain", "all"));
    assert_eq!(renamed.jobs[0].hash, before[0], "the picture is the same");
    assert_ne!(renamed.jobs[1].hash, before[1], "the row names its reference");
}

#[test]
fn names_titles_paths_and_the_report_do_not_count() {
    let folder = Folder::new();
    let before = hashes(&folder, &text());
    std::fs::create_dir(folder.at("moved")).unwrap();
    folder.write("moved/s.txt", SCENE);
    let changes = [
        ("runs", format!("runs = 5\n{}", text())),
        ("more seeds", format!("seeds = [7, 1]\n{}", text())),
        ("title", format!("title = 'T'\ndescription = 'D'\n{}", text())),
        ("name", text().replace("small", "other").replace("room", "hall")),
        ("path", text().replace("scene.txt", "moved/s.txt")),
        ("section", format!("{}[[section]]\nid = 'x'\ntitle = 'x'\nshows = 'text'\n", text())),
        ("a setting said twice", text().replace("[settings]\n", "[settings]\nrun = { max-depth = 4 }\n")),
        ("every metric named", format!("metrics = [{}]\n{}", every_metric(), text())),
        ("another configuration", format!("{}[[configuration]]\nname = 'more'\n", text())),
    ];
    for (what, text) in changes {
        let plan = folder.plan(&text);
        let seed_one = plan.jobs.iter().filter(|job| job.settings.run.seed == 1 && job.run == 1);
        let hashes: Vec<_> = seed_one.map(|job| &job.hash).collect();
        assert!(before.iter().all(|hash| hashes.contains(&hash)), "{what}");
    }
}

fn every_metric() -> String {
    lightcuts::image::metrics::Metric::ALL.map(|metric| format!("'{metric}'")).join(", ")
}
