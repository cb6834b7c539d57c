//! Jobs: who wins over whom, what a typo is told.

use crate::support::{Folder, stderr};

/// A resolved value in the job that a dry run writes.
fn resolved(folder: &Folder, arguments: &str, table: &str, key: &str) -> String {
    let name = "resolved.toml";
    folder.run(&format!("render {arguments} --dry-run -q --write-job {name}")).success().stdout("");
    let job: toml::Table = toml::from_str(&folder.text(name)).unwrap();
    job[table][key].to_string()
}

#[test]
fn defaults_give_way_to_scene_job_and_flags_in_this_order() {
    let folder = Folder::new();
    folder.write("plain.txt", crate::support::SCENE.split_once('\n').unwrap().1);
    folder.write("job.toml", "scene = 'scene.txt'\n[gather]\nthreshold = 5\n[sampling]\nsamples = 3\n");
    let threshold = |arguments: &str| resolved(&folder, arguments, "gather", "threshold");
    assert_eq!(threshold("plain.txt"), "0.000001");
    assert_eq!(threshold("scene.txt"), "0.0000002");
    assert_eq!(threshold("scene.txt --job job.toml"), "5.0");
    assert_eq!(threshold("job.toml"), "5.0");
    assert_eq!(threshold("job.toml --threshold 0.5"), "0.5");
    // Other keys of the tables stay.
    assert_eq!(resolved(&folder, "job.toml --threshold 0.5", "sampling", "samples"), "3");
    assert_eq!(resolved(&folder, "job.toml", "vpl", "attenuation"), "0.03");
    assert_eq!(resolved(&folder, "plain.txt --job job.toml", "vpl", "attenuation"), "0.075");
    assert!(!folder.has("scene.png"), "a dry run renders nothing");
}

#[test]
fn a_written_job_gives_the_same_bytes() {
    let folder = Folder::new();
    let flags = "--size 16x12 --samples 2 --filter mitchell --filter-radius 1.7 --threshold 1e-7 --seed 9 --bloom";
    folder.run(&format!("render scene.txt {flags} -o a.exr --write-job job.toml")).success();
    folder.run("render --job job.toml -o b.exr").success();
    folder.run("render job.toml -o c.exr --write-job again.toml").success();
    assert!(folder.bytes("a.exr") == folder.bytes("b.exr") && folder.bytes("a.exr") == folder.bytes("c.exr"));
    assert_eq!(folder.text("job.toml"), folder.text("again.toml"));
    assert_eq!(folder.text("job.toml"), folder.job_of("a.exr"));
}

#[test]
fn a_picture_lends_its_job_to_another_scene() {
    let folder = Folder::new();
    folder.write("other.txt", crate::support::SCENE);
    folder.run("render scene.txt --size 9x7 -o a.exr").success();
    assert_eq!(resolved(&folder, "other.txt --job a.exr", "image", "width"), "9");
    assert!(folder.text("resolved.toml").starts_with("scene = \"other.txt\""));
}

#[test]
fn paths_in_a_job_are_relative_to_it() {
    let folder = Folder::new();
    for name in ["jobs", "models"] {
        std::fs::create_dir(folder.at(name)).unwrap();
    }
    folder.write("models/a.obj", "v 0 0 0\nv 50 0 0\nv 0 50 0\nf 1 2 3\n");
    let mesh = "O FRKE{0,0,1,1}|PATH:a.obj|SMTH(0)|MAT(1)|S{0,0,0}|D{1,1,1}|A{0,0,0}|SH(20)\n";
    folder.write("scene.txt", format!("{}{mesh}", crate::support::SCENE));
    folder
        .write("jobs/j.toml", "scene = '../scene.txt'\nsearch-path = ['../models']\n[image]\nwidth = 8\nheight = 8\n");
    folder.run("render jobs/j.toml -o a.exr").success();
    assert!(folder.job_of("a.exr").starts_with("scene = \"scene.txt\"\nsearch-path = [\"models\"]\n"));
    folder.run("render scene.txt").code(3);
    folder.run("render scene.txt --size 8x8 --search-path models -o b.exr").success();
    let mut command = folder.command("render scene.txt --size 8x8 -o c.exr -q");
    assert!(command.env("LIGHTCUTS_PATH", folder.at("models")).status().unwrap().success());
    assert!(folder.bytes("a.exr") == folder.bytes("b.exr") && folder.bytes("a.exr") == folder.bytes("c.exr"));
}

#[test]
fn a_typo_is_shown_with_its_line_and_the_nearest_key() {
    let folder = Folder::new();
    folder.write("job.toml", "scene = 'scene.txt'\n\n[sampling]\nsmaples = 4\n");
    let said = stderr(&folder.run("render job.toml").code(2));
    for expected in ["job.toml:4:1", "unknown key `smaples`", "smaples = 4", "did you mean `samples`?"] {
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
    assert!(!said.contains('\u{1b}'), "colours in a pipe");
}

#[test]
fn bad_jobs_are_bad_usage() {
    let folder = Folder::new();
    let cases: [(&[u8], &str); 11] = [
        (b"scene = 'scene.txt'\n[image]\nwidth = 0\n", "job.toml:3:9: image.width is 0; expected 1 to 65536"),
        (b"scene = 'scene.txt'\n[gather]\nthreshold = nan\n", "job.toml:3:13: gather.threshold is NaN"),
        (b"scene = 'scene.txt'\n[vpl]\nprobability = 1e300\n", "job.toml:3:15: vpl.probability is inf"),
        (b"scene = 'scene.txt'\n[gather]\nstrategy = 'some'\n", "unknown value `some`"),
        (b"scene = 'scene.txt'\n[image\n", "job.toml:2:7"),
        (b"[image]\nwidth = 8\n", "job.toml names no scene"),
        (b"", "job.toml is empty, or holds only comments: it is neither a scene nor a job"),
        (
            b"# later\n",
            "a scene begins with the line `format = \"lightcuts-scene\"`; a job has a line `scene = \"file\"`",
        ),
        (b"scene = ['scene.txt']\n", "job.toml:1:9: wrong kind of value: a list"),
        (b"\xff\xfe", "not UTF-8"),
        (b"scene = 'scene.txt'\n[run]\nreproduce = true\n[image]\nwidth = 8", "expected 512 x 512 pixels"),
    ];
    for (text, expected) in cases {
        folder.write("job.toml", text);
        let said = stderr(&folder.run("render job.toml").code(2));
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
    let said = stderr(&folder.run("render scene.txt --reproduce --size 8x8").code(2));
    assert!(said.contains("--reproduce needs 512 x 512 pixels"), "{said}");
    // What is not there is a scene that is not there, unless it is said to be a job.
    folder.run("render none.toml").code(3);
    folder.run("render --job none.toml").code(2);
    folder.run("render scene.txt --job none.toml").code(2);
    folder.run("render scene.txt --job scene.txt").code(2);
}

#[test]
fn a_scene_that_is_not_there_is_told_as_one() {
    let folder = Folder::new();
    std::fs::create_dir(folder.at("folder.toml")).unwrap();
    for name in ["none", "none.txt", "none.toml", "none.TOML", "none/a.toml", "folder.toml"] {
        let said = stderr(&folder.run(&format!("render {name}")).code(3));
        assert!(said.contains("cannot read the scene") && said.contains(name), "{name}: {said}");
    }
}
