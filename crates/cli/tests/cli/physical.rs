//! Scenes of the physical model, and layers in false colours.

use crate::support::{Folder, stderr, stdout};
use lightcuts::image::{LayerData, read_exr, read_png};

/// A ball on a floor under a lamp.
pub(crate) const SCENE: &str = "\
format = 'lightcuts-scene'
version = 1
[camera]
position = [0, 1, 4]
target = [0, 0.5, 0]
[[material]]
name = 'white'
type = 'lambert'
albedo = 0.7
[[material]]
name = 'plastic'
type = 'plastic'
albedo = [0.6, 0.1, 0.1]
roughness = 0.4
[[object]]
type = 'rectangle'
material = 'white'
center = [0, 0, 0]
normal = [0, 1, 0]
head = [0, 0, -1]
width = 4
height = 4
[[object]]
type = 'sphere'
material = 'plastic'
center = [0, 0.5, 0]
radius = 0.5
[[light]]
type = 'sphere'
center = [1, 2, 1]
radius = 0.2
radiance = 20
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.toml", SCENE);
    folder
}

#[test]
fn every_integrator_renders_a_scene_in_toml() {
    let folder = folder();
    for (integrator, words) in
        [("path", "samples 3"), ("lightcuts", "in a cut"), ("auto", "samples"), ("path --caustics", "samples 3")]
    {
        let options = format!("--integrator {integrator} --size 20x16 --samples 3 --progress none");
        let said = stdout(&folder.run(&format!("render ball.toml {options} -o a.exr -o a.png")).success());
        assert!(said.contains(words), "{said}");
        let layers = read_exr(folder.at("a.exr")).unwrap();
        let names: Vec<&str> = layers.aovs().map(|(name, _)| name).collect();
        for name in ["direct", "indirect", "variance", "cut_size", "error_bound", "material_id", "position"] {
            assert!(names.contains(&name), "{names:?}");
        }
        assert!(layers.beauty().pixels().iter().any(|p| p[0] > 0.1), "something is seen");
        // The picture holds its job. What `auto` chooses depends on measured times.
        folder.run("render a.exr -o again.exr --progress none").success();
        let again = read_exr(folder.at("again.exr")).unwrap();
        assert!(again.beauty() == layers.beauty() || integrator == "auto", "{integrator}");
    }
}

#[test]
fn a_time_limit_ends_a_render_that_is_complete_then() {
    let folder = folder();
    let options = "--time-limit 0.3s --samples 1000000 --size 16x16 --progress none --stats s.json";
    folder.run(&format!("render ball.toml {options}")).success();
    assert!(folder.text("s.json").contains("\"complete\": true"));
    let said = stderr(&folder.run("render ball.toml --time-limit soon").code(2));
    assert!(said.contains("expected a time such as 10s"), "{said}");
    folder.run("render ball.toml --noise 10 --samples 100000 --size 16x16 --progress none").success();
}

/// The number of samples that a summary and the statistics tell, what ended the render, and what was asked for.
fn samples_of(folder: &Folder, options: &str) -> (String, serde_json::Value) {
    let said = stdout(
        &folder.run(&format!("render ball.toml --size 16x16 --progress none --stats s.json {options}")).success(),
    );
    let line = said.lines().find(|line| line.starts_with("picture")).unwrap_or_else(|| panic!("{said}")).to_owned();
    (line, serde_json::from_str(&folder.text("s.json")).unwrap())
}

#[test]
fn a_render_says_how_many_samples_it_has_and_why_not_more() {
    let folder = folder();
    let (line, stats) = samples_of(&folder, "--samples 3");
    assert!(line.contains(", samples 3; relative error "), "{line}");
    assert!(stats["end"] == "samples" && stats["samples_per_pixel"] == 3.0 && stats["samples_wanted"] == 3, "{stats}");
    let (line, stats) = samples_of(&folder, "--samples 1");
    assert!(line.ends_with(", samples 1") && stats["relative_error"].is_null(), "{line}");
    let (line, stats) = samples_of(&folder, "--samples 1000000 --time-limit 0.2s");
    assert!(line.contains(" of 1000000, time was up; relative error "), "{line}");
    assert!(stats["end"] == "time" && stats["complete"] == true && stats["unsampled_pixels"] == 0, "{stats}");
}

#[test]
fn without_a_number_of_samples_only_time_or_noise_ends_a_render() {
    let folder = folder();
    let more_than_64 = |stats: &serde_json::Value| stats["samples_per_pixel"].as_f64().unwrap() > 64.0;
    let (line, stats) = samples_of(&folder, "--integrator path --time-limit 1s");
    assert!(line.contains(", time was up;") && !line.contains(" of "), "{line}");
    assert!(more_than_64(&stats) && stats["samples_wanted"].is_null(), "{stats}");
    let (line, stats) = samples_of(&folder, "--integrator path --noise 0.03");
    assert!(line.contains(", noise low enough;"), "{line}");
    assert!(more_than_64(&stats) && stats["relative_error"].as_f64().unwrap() <= 0.03, "{stats}");
    // A job file may bring the limit, or the number.
    folder.write("limit.toml", "scene = 'ball.toml'\n[physical]\ntime-limit = 0.1\n");
    folder.write("both.toml", "scene = 'ball.toml'\n[physical]\ntime-limit = 100\n[sampling]\nsamples = 2\n");
    folder.run("render limit.toml --size 8x8 --progress none --write-job j.toml").success();
    assert!(folder.text("j.toml").contains("samples = 0\n"));
    let said = stdout(&folder.run("render both.toml --size 8x8 --progress none").success());
    assert!(said.contains(", samples 2"), "{said}");
    let said = stderr(&folder.run("render ball.toml --samples 0").code(2));
    assert!(said.contains("0 for no limit where there is one of time or noise"), "{said}");
}

/// A picture that is too large for its time is whole: every pixel of the floor is there.
#[test]
fn a_picture_without_time_is_whole() {
    let folder = folder();
    let options = "--size 1000x800 --time-limit 0.02s --progress none -o a.exr";
    let said = stdout(&folder.run(&format!("render ball.toml {options}")).success());
    assert!(said.contains("time was up") && said.contains("show their neighbours'"), "{said}");
    let layers = read_exr(folder.at("a.exr")).unwrap();
    assert_eq!(layers.attribute("lightcuts:complete"), None);
    let Some(LayerData::Id(ids)) = layers.get("object_id") else { panic!("an EXR has ids") };
    // Rows near the lower edge see nothing but the floor.
    assert!((500..800).all(|y| ids.row(y)[400..600].iter().all(|&id| id > 0)));
}

#[test]
fn scenes_of_the_thesis_can_be_rendered_with_it_and_not_the_other_way_round() {
    let folder = folder();
    folder.run("render scene.txt --model physical --size 16x16 --samples 2 --progress none").success();
    let said = stderr(&folder.run("render ball.toml --model thesis").code(2));
    assert!(said.contains("leave out --model"), "{said}");
    for arguments in [
        "--device gpu",
        "--station-device gather=gpu",
        "--write-vpls v.csv",
        "--reproduce",
        "--gather lightcuts-exhaustive",
    ] {
        assert_eq!(
            folder.run(&format!("render ball.toml {arguments}")).get_output().status.code(),
            Some(2),
            "{arguments}"
        );
    }
    assert_eq!(folder.run("render scene.txt --gather stochastic").get_output().status.code(), Some(2));
    for arguments in [
        "ball.toml --caustics-radius 2",
        "ball.toml --max-depth 3",
        "scene.txt --vpls 10",
        "scene.txt --integrator path",
    ] {
        let said = stderr(&folder.run(&format!("render {arguments}")).code(2));
        assert!(said.contains("has no meaning in the"), "{arguments}: {said}");
    }
    let said = stdout(&folder.run("info ball.toml").success());
    assert!(said.contains("physical") && said.contains("1 luminous surface") && said.contains("2 lambert"), "{said}");
    folder.run("info ball.toml --json").success();
}

#[test]
fn faults_of_a_scene_are_told_with_their_place() {
    let folder = Folder::new();
    folder.write("bad.toml", SCENE.replace("albedo = 0.7", "albedo = 1.5"));
    let said = stderr(&folder.run("render bad.toml").code(3));
    assert!(said.contains("bad.toml:") && said.contains("albedo"), "{said}");
}

#[test]
fn layers_are_shown_in_false_colours() {
    let folder = folder();
    folder.run("render ball.toml --size 20x16 --samples 2 -o a.exr --progress none").success();
    let said = stdout(&folder.run("heatmap a.exr cut_size").success());
    assert!(said.contains("a-cut_size.png"), "{said}");
    folder.run("heatmap a.exr depth --range 0..5 -o d.png -q").success();
    folder.run("heatmap a.exr beauty --log -o b.png").success();
    folder.run("heatmap a.exr object_id -o o.png").success();
    let map = read_png(folder.at("d.png"), lightcuts::image::Transfer::Linear).unwrap();
    assert!(map.width() >= 20 && map.height() > 16, "the scale lies below");
    let said = stderr(&folder.run("heatmap a.exr nothing").code(2));
    assert!(said.contains("expected one of beauty, albedo"), "{said}");
    folder.run("heatmap a.exr depth -o d.exr").code(2);
    folder.run("heatmap missing.exr depth").code(3);
}
