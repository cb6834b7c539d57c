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
    assert!(said.contains("or 0, no limit, where there is one of time or noise"), "{said}");
}

/// A picture that is too large for its time is whole: every pixel of the floor is there.
#[test]
fn a_picture_without_time_is_whole() {
    let folder = folder();
    let options = "--size 1000x800 --time-limit 0.02s --progress none -o a.exr";
    let said = stdout(&folder.run(&format!("render ball.toml {options}")).success());
    assert!(said.contains("time was up") && said.contains("show the nearest of a coarse preview"), "{said}");
    let layers = read_exr(folder.at("a.exr")).unwrap();
    assert_eq!(layers.attribute("lightcuts:complete"), None);
    let Some(LayerData::Id(ids)) = layers.get("object_id") else { panic!("an EXR has ids") };
    // Rows below the ball see nothing but the floor, up to some cells from its edge.
    assert!((500..740).all(|y| ids.row(y)[400..600].iter().all(|&id| id > 0)));
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
    for (arguments, expected) in [
        ("ball.toml --caustics-radius 2", "--caustics-radius has no meaning in the physical model"),
        ("ball.toml --threshold 1", "in the physical model --cut-error takes the place of --threshold"),
        ("ball.toml --max-depth 3", "--max-depth has no meaning in the physical model"),
        ("ball.toml --no-second-pass", "--no-second-pass has no meaning in the physical model"),
        ("ball.toml --bloom --ao-step 3", "--ao-step, --bloom have no meaning in the physical model"),
        ("ball.toml --reproduce", "--reproduce has no meaning in the physical model"),
        ("ball.toml --write-vpls v.csv", "--write-vpls has no meaning in the physical model"),
        ("ball.toml --gpu-budget 30", "--gpu-budget has no meaning in the physical model"),
        ("scene.txt --vpls 10", "--vpls has no meaning in the thesis' model"),
        ("scene.txt --vpls 10", "in the thesis' model --vpl-probability takes the place of --vpls"),
        ("scene.txt --integrator path", "--integrator has no meaning in the thesis' model"),
        ("scene.txt --model physical --threshold 1", "leave it out, or render with --model thesis"),
        ("scene.txt --gather auto", "--gather is auto; expected `all`, `lightcuts` or `lightcuts-exhaustive`"),
        ("ball.toml --samples 0", "--samples is 0; expected 1 to 16777216"),
        ("scene.txt --size 0x5", "the width of --size is 0; expected 1 to 65536"),
    ] {
        let said = stderr(&folder.run(&format!("render {arguments}")).code(2));
        assert!(unwrapped(&said).contains(expected), "{arguments}: {said}");
    }
    let said = stdout(&folder.run("info ball.toml").success());
    assert!(said.contains("physical") && said.contains("1 emissive surface"), "{said}");
}

#[test]
fn options_of_vpls_are_said_to_do_nothing_for_paths() {
    let folder = folder();
    let said = |options: &str| {
        let ran = folder.run(&format!("render ball.toml {options} --dry-run"));
        String::from_utf8(ran.success().get_output().stderr.clone()).unwrap()
    };
    let told = said("--integrator path --gather all --vpls 10 --samples 2");
    assert!(told.contains("--gather, --vpls have no effect with the integrator `path`"), "{told}");
    assert!(!said("--integrator auto --gather all --vpls 10").contains("no effect"));
    assert!(!said("--integrator path --samples 2 --noise 0.1").contains("no effect"));
}

#[test]
fn info_names_what_is_in_a_scene() {
    let folder = folder();
    folder.write("roof.obj", "v -1 0 0\nv 0 0.2 0\nv 1 0 0\nv -1 0 1\nv 0 0.2 1\nv 1 0 1\nf 1 4 5 2\nf 2 5 6 3\n");
    let more = "[[light]]\ntype = 'spot'\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nintensity = 4\ninner = 20\nouter = 30\n\
                [[mesh]]\nname = 'roof'\nfile = 'roof.obj'\n\
                [[object]]\ntype = 'mesh'\nname = 'the roof'\nmesh = 'roof'\nmaterial = 'plastic'\ntranslate = [0, 2, 0]\n\
                [[object]]\ntype = 'box'\nname = 'the box'\nmaterial = 'white'\ncenter = [0, 1, 0]\nsize = [1, 1, 1]\n";
    folder.write("roof.toml", SCENE.to_owned() + more);
    let said = stdout(&folder.run("info roof.toml").success());
    for line in [
        "camera       fov 40 degrees; position (0, 1, 4), direction (0, -0.5, -4), up (0, 1, 0)",
        "environment  none",
        "lights       2; 1 emissive surface",
        "  1  33    spot    at (0, 3, 0), towards (0, -3, 0)",
        "intensity (4, 4, 4)",
        "mesh roof  the roof  plastic   4          (-1, 2, 0) to (1, 2.2, 1)",
        "  box        the box   white     12         (-0.5, 0.5, -0.5) to (0.5, 1.5, 0.5)",
        "  1  lambert  white",
        "  2  plastic  plastic",
        "smoothed     1 mesh without normals, up to 40 degrees between faces",
    ] {
        assert!(said.contains(line), "{line} is missing in\n{said}");
    }
    let json = |options: &str| -> serde_json::Value {
        serde_json::from_str(&stdout(&folder.run(&format!("info roof.toml --json {options}")).success())).unwrap()
    };
    let info = json("");
    assert_eq!((&info["camera"]["fov"], &info["lights"][1]["type"]), (&40.0.into(), &"sphere".into()));
    assert_eq!(info["lights"][1]["value"][0], 20.0);
    let roof = &info["objects"][2];
    assert_eq!(
        (&roof["name"], &roof["mesh"], &roof["crease_angle"]),
        (&"the roof".into(), &"roof".into(), &40.0.into())
    );
    assert_eq!((&info["objects"][3]["type"], &info["objects"][3]["mesh"]), (&"box".into(), &serde_json::Value::Null));
    assert_eq!(info["materials"].as_array().map(Vec::len), Some(2), "those of lights are not among them");
    assert_eq!(json("--crease-angle 25")["smoothed_meshes"], serde_json::json!({ "25": 1 }));
    assert_eq!(json("--crease-angle 20")["smoothed_meshes"], serde_json::json!({}));
    folder.run("info roof.toml --crease-angle 181").code(2);
    for command in ["info scene.txt", "render scene.txt", "render scene.txt --model physical"] {
        let said = stderr(&folder.run(&format!("{command} --crease-angle 30")).code(2));
        assert!(said.contains("--crease-angle has no meaning in the thesis' text format"), "{said}");
    }
}

#[test]
fn a_crease_angle_is_part_of_the_job() {
    let folder = folder();
    folder.run("render ball.toml --crease-angle 12.5 --size 8x8 --samples 1 -o a.exr --progress none").success();
    assert!(folder.job_of("a.exr").contains("crease-angle = 12.5\n"), "{}", folder.job_of("a.exr"));
    folder.run("render a.exr -o b.exr --progress none").success();
    assert!(folder.job_of("b.exr").contains("crease-angle = 12.5\n"));
    folder.write("job.toml", "scene = 'ball.toml'\ncrease-angle = 200\n");
    let said = stderr(&folder.run("render job.toml").code(2));
    assert!(said.contains("job.toml:2:16: crease-angle is 200"), "{said}");
    folder.write("job.toml", "scene = 'scene.txt'\ncrease-angle = 20\n");
    let said = stderr(&folder.run("render job.toml").code(2));
    assert!(said.contains("job.toml:2:16: `crease-angle` has no meaning in the thesis' text format"), "{said}");
}

#[test]
fn lights_of_scenes_in_toml_are_not_scaled() {
    let folder = folder();
    folder.write("job.toml", "scene = 'ball.toml'\n[physical]\nlight-scale = 2.0\n");
    for command in ["render ball.toml --light-scale 2", "render job.toml"] {
        let said = stderr(&folder.run(command).code(2));
        assert!(
            said.contains("physical.light-scale is 2, but only lights of scenes in the thesis' text format"),
            "{said}"
        );
    }
    folder.run("render job.toml --light-scale 1 --size 8x8 --samples 1 -o a.png --progress none").success();
}

#[test]
fn what_is_not_there_or_lacks_its_head_is_a_scene() {
    let folder = folder();
    let said = stderr(&folder.run("render nothere.toml").code(3));
    assert!(said.contains("cannot read the scene: `nothere.toml`"), "{said}");
    folder.run("render --job nothere.toml").code(2);
    folder.write("headless.toml", SCENE.replace("format = 'lightcuts-scene'\n", ""));
    for command in ["render", "info"] {
        let said = stderr(&folder.run(&format!("{command} headless.toml")).code(3));
        assert!(said.contains("there is a `[camera]`, as in a scene, but the key `format` is missing"), "{said}");
    }
    folder.write("m.obj", "v 0 0 0\n");
    let said = stderr(&folder.run("render m.obj").code(3));
    assert!(said.contains("[[mesh]]") && said.contains("PATH:model.obj"), "{said}");
}

#[test]
fn warnings_are_shown_beside_errors() {
    let folder = folder();
    folder.write("m.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    let mesh = "[[mesh]]\nname = 'm'\nfile = 'm.obj'\n[[object]]\ntype = 'mesh'\nmesh = 'm'\n";
    folder.write("grey.toml", SCENE.to_owned() + mesh);
    let assert = folder.run("render grey.toml --size 8x8 --samples 1 --progress none").success();
    assert!(stderr(&assert).contains("`none.mtl` was not found") && stderr(&assert).contains("diffuse grey"));
    folder.write("bad.toml", SCENE.to_owned() + mesh + "[[object]]\ntype = 'cone'\n[[object]]\ntype = 'disc'\n");
    let said = stderr(&folder.run("render bad.toml").code(3));
    assert!(said.contains("`none.mtl` was not found") && said.contains("unknown type `cone`"), "{said}");
    assert!(said.contains("unknown type `disc`") && said.matches("expected one of").count() == 2, "{said}");
    assert!(!said.contains("Error:") && !said.contains("lightcuts::"), "{said}");
    std::fs::create_dir(folder.at("folder.obj")).unwrap();
    folder.write("bad.toml", SCENE.to_owned() + "[[mesh]]\nname = 'm'\nfile = 'folder.obj'\n");
    let said = stderr(&folder.run("render bad.toml").code(3));
    assert!(said.contains("the model `folder.obj` is a directory; expected a regular file\n"), "{said}");
}

/// A message on one line.
fn unwrapped(said: &str) -> String {
    said.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn keys_of_the_other_model_in_a_job_are_told_with_their_line() {
    let folder = folder();
    folder.write("glow.toml", "[bloom]\nenabled = true\n");
    folder.write("limit.toml", "[image]\nwidth = 8\n[physical]\ntime-limit = 3\n");
    for (arguments, expected) in [
        ("ball.toml --job glow.toml", "glow.toml:2:11: `bloom.enabled` has no meaning in the physical model of light"),
        ("scene.txt --job limit.toml", "limit.toml:4:14: `physical.time-limit` has no meaning in the thesis' model"),
    ] {
        let said = stderr(&folder.run(&format!("render {arguments}")).code(2));
        assert!(unwrapped(&said).contains(expected), "{arguments}: {said}");
    }
    // A picture's job holds what its model knows; its size and filter can be lent to a scene of the other one.
    folder.run("render scene.txt --size 9x7 --bloom -q -o thesis.exr").success();
    let said = stderr(&folder.run("render ball.toml --job thesis.exr").code(2));
    assert!(unwrapped(&said).contains("run.model is thesis, but the scene is of the physical model"), "{said}");
    folder.run("render ball.toml --job thesis.exr --model physical -q -o lent.exr").success();
    let job = folder.job_of("lent.exr");
    assert!(job.contains("width = 9") && job.contains("[physical]") && !job.contains("bloom"), "{job}");
    assert!(!folder.job_of("thesis.exr").contains("[physical]"));
    folder.run("render thesis.exr -q -o again.exr").success();
    assert!(folder.bytes("thesis.exr") == folder.bytes("again.exr"));
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
    for (command, expected) in [
        ("heatmap a.exr nothing", "the picture has no layer `nothing`"),
        ("heatmap a.exr -o n.png", "no layer is named"),
    ] {
        let said = stderr(&folder.run(command).code(2));
        assert!(said.contains(expected) && said.contains("expected one of beauty, albedo"), "{said}");
    }
    folder.run("heatmap missing.exr").code(3);
    folder.run("heatmap a.exr depth -o d.exr").code(2);
    folder.run("heatmap missing.exr depth").code(3);
}
