//! Pictures: repeatable, the same on any number of threads, renderable again from their own headers.

use crate::support::{Folder, stdout};
use lightcuts::image::{Transfer, read_exr, read_png};

#[test]
fn the_default_output_is_a_png_in_the_current_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.at("scenes")).unwrap();
    std::fs::rename(folder.at("scene.txt"), folder.at("scenes/box.txt")).unwrap();
    let said = stdout(&folder.run("render scenes/box.txt --size 12x8").success());
    let picture = read_png(folder.at("box.png"), Transfer::Linear).unwrap();
    assert_eq!((picture.width(), picture.height()), (12, 8));
    for expected in ["box (scenes/box.txt)", "12 x 8", "VPLs", "light ratio", "first pass", "wrote        box.png"] {
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
}

#[test]
fn quiet_says_nothing() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 8x8 -q").success().stdout("").stderr("");
}

#[test]
fn threads_and_simd_never_change_a_byte() {
    let folder = Folder::new();
    let effects = "--samples 2 --adaptive-samples 4 --filter gaussian --ao --ao-step 30 --caustics --caustics-step 8 --bloom \
                   --tone-mapping local";
    for variant in ["-j1", "-j2", "-j7", "--simd=off"] {
        let names = format!("-o {variant}.exr -o {variant}.png --write-vpls {variant}.csv").replace("-o -", "-o ./-");
        folder
            .run(&format!("render scene.txt --size 40x24 {effects} {variant} {names}").replace("vpls -", "vpls ./-"))
            .success();
        for extension in ["exr", "png", "csv"] {
            let same = folder.bytes(&format!("-j1.{extension}")) == folder.bytes(&format!("{variant}.{extension}"));
            assert!(same, "{variant}.{extension}");
        }
    }
    assert!(folder.text("-j1.csv").lines().count() > 5, "the scene has VPLs");
}

#[test]
fn a_picture_is_rendered_again_from_its_header() {
    let folder = Folder::new();
    std::fs::create_dir(folder.at("out")).unwrap();
    let given = "--size 20x16 --seed 7 --gather all --samples 2";
    folder.run(&format!("render scene.txt {given} -o out/a.exr -o out/a.png")).success();
    assert!(folder.job_of("out/a.exr").starts_with("scene = \"../scene.txt\"\n"));
    folder.run("render out/a.exr -o out/again.exr -o out/again.png").success();
    assert!(folder.bytes("out/a.exr") == folder.bytes("out/again.exr"));
    assert!(folder.bytes("out/a.png") == folder.bytes("out/again.png"));
    // From elsewhere, and from the PNG.
    folder.command("render a.png -o b.exr -q").current_dir(folder.at("out")).status().unwrap();
    assert!(folder.bytes("out/a.exr") == folder.bytes("out/b.exr"));
    // Flags win over the header.
    folder.run("render out/a.exr --width 10 -o small.exr").success();
    let small = read_exr(folder.at("small.exr")).unwrap();
    assert_eq!((small.width(), small.height()), (10, 16));
}

#[test]
fn a_picture_that_moved_alone_finds_its_scene_from_the_current_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.at("away")).unwrap();
    folder.run("render scene.txt --size 8x8 -o a.exr").success();
    std::fs::rename(folder.at("a.exr"), folder.at("away/a.exr")).unwrap();
    folder.run("render away/a.exr -o b.exr").success();
    assert!(read_exr(folder.at("away/a.exr")).unwrap().beauty() == read_exr(folder.at("b.exr")).unwrap().beauty());
}

#[test]
fn given_vpls_give_the_same_picture() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 24x24 -o a.exr --write-vpls v.csv").success();
    folder.run("render scene.txt --size 24x24 -o b.exr --read-vpls v.csv --write-vpls w.csv").success();
    assert!(read_exr(folder.at("a.exr")).unwrap().aovs().eq(read_exr(folder.at("b.exr")).unwrap().aovs()));
    assert_eq!(folder.text("v.csv"), folder.text("w.csv"));
    assert!(folder.job_of("b.exr").contains("read-vpls = \"v.csv\"\n"));
    folder.run("render b.exr -o c.exr").success();
    assert!(folder.bytes("b.exr") == folder.bytes("c.exr"));
    // They matter: none of them is another picture.
    let header = folder.text("v.csv").lines().next().unwrap().to_owned();
    folder.write("none.csv", header);
    folder.run("render b.exr -o d.exr --read-vpls none.csv").success();
    assert!(read_exr(folder.at("a.exr")).unwrap().beauty() != read_exr(folder.at("d.exr")).unwrap().beauty());
}

#[test]
fn an_exr_holds_every_layer() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 8x8 -o a.exr").success();
    let layers = read_exr(folder.at("a.exr")).unwrap();
    let names: Vec<_> = layers.aovs().map(|(name, _)| name).collect();
    assert_eq!(names, ["albedo", "depth", "first_pass", "lights_selected", "normal", "object_id", "second_pass"]);
    assert_eq!(layers.attribute("lightcuts:version"), Some(env!("CARGO_PKG_VERSION")));
    assert_eq!(layers.attribute("lightcuts:complete"), None);
}

#[test]
fn statistics_are_json() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 16x16 --stats s.json -j 1").success();
    let stats: serde_json::Value = serde_json::from_str(&folder.text("s.json")).unwrap();
    assert_eq!(stats["scene"], "scene");
    assert_eq!(stats["threads"], 1);
    assert_eq!(stats["complete"], true);
    assert_eq!(stats["settings"]["image"]["width"], 16);
    assert_eq!(stats["rays"]["primary"].as_u64(), Some(2 * 16 * 16));
    assert!(stats["vpl_count"].as_u64() > Some(0));
    assert_eq!(stats["passes"][0]["name"], "first_pass");
    if cfg!(target_os = "linux") {
        assert!(stats["peak_memory_bytes"].as_u64() > Some(1 << 20));
    }
}
