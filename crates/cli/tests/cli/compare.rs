//! `compare`: verdicts and exit codes, JSON, conditions, maps, and pictures that cannot be compared.

use crate::support::{Folder, stderr, stdout};
use lightcuts::image::{Image, LayerData, Layers, Plane, Transfer, read_png, write_exr, write_png};
use serde_json::Value;

const SIDE: usize = 48;

/// A soft ramp: no edges, nothing at the ends of the range.
fn ramp(gain: f32) -> Image {
    Image::from_fn(SIDE, SIDE, |x, y| [0.2 + 0.01 * x as f32, 0.3, 0.2 + 0.01 * y as f32].map(|value| gain * value))
}

/// A folder with `a.exr`, `same.exr` (equal), `near.exr` (0.5 % brighter) and `far.exr` (twice as bright).
fn folder() -> Folder {
    let folder = Folder::new();
    for (name, gain) in [("a.exr", 1.0), ("same.exr", 1.0), ("near.exr", 1.005), ("far.exr", 2.0)] {
        write_exr(folder.at(name), &Layers::new(ramp(gain))).unwrap();
    }
    folder
}

fn json(folder: &Folder, arguments: &str, code: i32) -> Value {
    serde_json::from_str(&stdout(&folder.run(&format!("compare {arguments} --json")).code(code))).unwrap()
}

#[test]
fn the_exit_code_is_the_verdict() {
    let folder = folder();
    let same = stdout(&folder.run("compare a.exr same.exr").code(0));
    assert!(same.ends_with("verdict      same\n"), "{same}");
    let near = stdout(&folder.run("compare a.exr near.exr").code(0));
    assert!(near.ends_with("verdict      same\n"), "{near}");
    let far = stdout(&folder.run("compare a.exr far.exr").code(1));
    let verdict = far.lines().last().unwrap();
    let (pdiff, flip) = verdict.split_once(", flip_ldr 0.").expect("both are told");
    assert!(pdiff.starts_with("verdict      differs: pdiff_pass fail: "), "{verdict}");
    assert!(pdiff.ends_with(" pixels look different (fewer than 100 pass)") && flip.contains(" > 0.05"), "{verdict}");
    for quiet in ["compare a.exr same.exr -q", "compare a.exr far.exr --quiet"] {
        let assert = folder.run(quiet);
        assert_eq!((stdout(&assert), stderr(&assert)), (String::new(), String::new()));
    }
}

#[test]
fn the_table_has_a_line_per_metric_with_its_time() {
    let folder = folder();
    let said = stdout(&folder.run("compare a.exr near.exr").code(0));
    assert!(said.contains("size         48 x 48, channels R, G, B\n"), "{said}");
    let lines: Vec<Vec<&str>> = said.lines().map(|line| line.split_whitespace().collect()).collect();
    let of = |key: &str| lines.iter().find(|words| words[0] == key).unwrap_or_else(|| panic!("{key}:\n{said}"));
    assert_eq!(of("metric")[1..5], ["value", "unit", "seconds", "meaning"]);
    assert_eq!(of("pdiff_pass")[1], "pass");
    assert_eq!(of("psnr")[2], "dB");
    // Every channel is 0.5 % off, so the mean is 0.005 times the mean of the reference.
    let mean = ramp(1.0).pixels().iter().flatten().copied().map(f64::from).sum::<f64>() / (3.0 * 48.0 * 48.0);
    let mae: f64 = of("mae")[1].parse().unwrap();
    assert!((mae / (0.005 * mean) - 1.0).abs() < 1e-3, "{mae}");
    assert!(of("flip_ldr")[2].parse::<f64>().unwrap() >= 0.0, "the third word is the time where there is no unit");
    let order: Vec<_> = lines.iter().map(|words| words[0]).collect();
    assert_eq!(order[3..6], ["metric", "non_finite", "pdiff_px"], "pixels that are no numbers come first");
}

#[test]
fn json_has_the_promised_keys() {
    let folder = folder();
    let found = json(&folder, "a.exr near.exr", 0);
    let keys = "pdiff_px, pdiff_pass, flip_ldr, flip_hdr, mse, rmse, mae, relmse, mrse, smape, ssim, psnr, bias, \
                relbias, fireflies, non_finite";
    for key in keys.split(", ") {
        let is_kind = if key == "pdiff_pass" { found[key].is_boolean() } else { found[key].is_number() };
        assert!(is_kind, "{key}: {}", found[key]);
        assert!(found["seconds"][key].as_f64() >= Some(0.0), "{key}");
    }
    assert_eq!((&found["verdict"], &found["failed"]), (&"same".into(), &Value::Array(Vec::new())));
    assert_eq!((&found["width"], &found["height"]), (&48.into(), &48.into()));
    assert_eq!((&found["reference"], &found["test"]), (&"a.exr".into(), &"near.exr".into()));
    assert!(found["bias_test"]["worst"]["z"].is_number() && found["exposures"]["count"].as_u64() >= Some(2));
    assert_eq!(found["options"]["pdiff"]["channels"], "bgr");
    assert_eq!(found["options"]["pdiff"]["gamma"].to_string(), "2.2");
    let (rmse, mse) = (found["rmse"].as_f64().unwrap(), found["mse"].as_f64().unwrap());
    assert!((rmse * rmse / mse - 1.0).abs() < 1e-12, "full precision");

    let found = json(&folder, "a.exr same.exr", 0);
    assert_eq!(
        (&found["psnr"], &found["same_display"], &found["same_light"]),
        (&Value::Null, &true.into(), &true.into())
    );
    assert_eq!((&found["ssim"], &found["flip_hdr"]), (&1.0.into(), &0.0.into()));
    let found = json(&folder, "a.exr far.exr", 1);
    assert_eq!((&found["verdict"], &found["failed"][0]["condition"]), (&"differs".into(), &"pdiff_pass<1".into()));
}

#[test]
fn only_the_metrics_asked_for_are_measured_and_those_of_conditions() {
    let folder = folder();
    let found = json(&folder, "a.exr far.exr --metrics mae,psnr --fail ssim<0.1", 0);
    let has = |key: &str| found.get(key).is_some();
    assert!(has("non_finite") && has("mae") && has("psnr") && has("ssim"), "{found}");
    assert!(!has("pdiff_px") && !has("flip_ldr") && !has("mse"), "{found}");
    let found = json(&folder, "a.exr far.exr --metrics mae", 1);
    assert!(found.get("flip_ldr").is_some(), "the default conditions hold: {found}");
}

#[test]
fn conditions_decide() {
    let folder = folder();
    let cases = [
        ("a.exr near.exr --fail flip>0.05", 0),
        ("a.exr near.exr --fail flip>0", 1),
        ("a.exr far.exr --fail flip<0.01", 0),
        ("a.exr same.exr --fail rmse>=1e-9", 0),
        ("a.exr near.exr --fail rmse>=1e-9", 1),
        ("a.exr same.exr --fail psnr<inf", 0),
        ("a.exr near.exr --fail psnr<inf", 1),
        ("a.exr far.exr --fail pdiff_pass<1", 1),
        ("a.exr far.exr --threshold 2305 --fail pdiff_pass<1", 0),
        ("a.exr near.exr --fail ssim<0.5 --fail bias>0.001", 1),
        ("near.exr a.exr --fail ssim<0.5 --fail bias>0.001", 0),
    ];
    for (arguments, code) in cases {
        folder.run(&format!("compare {arguments} --metrics non_finite -q")).code(code);
    }
    let found = json(&folder, "a.exr far.exr --metrics mae --fail mae>0.1 --fail bias>9 --fail rmse!=0", 1);
    let reasons: Vec<_> = found["failed"].as_array().unwrap().iter().map(|failed| &failed["condition"]).collect();
    assert_eq!(reasons, ["mae>0.1", "rmse!=0"]);
    for (condition, mark) in [("flop>1", "────"), ("flip>x", "┬"), ("flip=1", "── here")] {
        let said = stderr(&folder.run(&format!("compare a.exr none.exr --fail {condition}")).code(2));
        assert!(said.contains("expected") && said.contains(condition) && said.contains(mark), "{said}");
    }
}

#[test]
fn a_pixel_that_is_no_number_is_always_a_failure() {
    let folder = folder();
    let mut broken = ramp(1.0);
    broken.set(3, 4, [f32::NAN, 0.0, f32::INFINITY]);
    write_exr(folder.at("nan.exr"), &Layers::new(broken)).unwrap();
    for arguments in ["a.exr nan.exr", "nan.exr a.exr", "nan.exr nan.exr", "a.exr nan.exr --fail flip>0.9"] {
        let said = stdout(&folder.run(&format!("compare {arguments}")).code(1));
        assert!(said.contains("differs: non_finite"), "{said}");
    }
    let found = json(&folder, "a.exr nan.exr --fail rmse>1e9", 1);
    assert_eq!((&found["non_finite"], &found["rmse"]), (&1.into(), &Value::Null));
    assert_eq!(found["failed"][1]["reason"], "rmse is not a number");
    assert_eq!(found["non_finite_pixels"]["test"], 1);
    // Too small for SSIM: a condition on what has no value fails, in words.
    write_exr(folder.at("tiny.exr"), &Layers::new(Image::filled(4, 4, [0.5; 3]))).unwrap();
    let said = stdout(&folder.run("compare tiny.exr tiny.exr --fail ssim<0.1").code(1));
    assert!(said.contains("ssim has no value for these pictures"), "{said}");
}

#[test]
fn a_black_reference_is_an_answer() {
    let folder = folder();
    write_exr(folder.at("black.exr"), &Layers::new(Image::new(SIDE, SIDE))).unwrap();
    folder.run("compare black.exr black.exr").code(0);
    let found = json(&folder, "black.exr a.exr", 1);
    for key in ["pdiff_px", "flip_ldr", "flip_hdr", "relmse", "mrse", "smape", "ssim", "psnr"] {
        assert!(found[key].is_number(), "{key}: {}", found[key]);
    }
}

#[test]
fn one_picture_in_every_format_is_one_picture() {
    let folder = folder();
    write_png(folder.at("a.png"), &ramp(1.0), Transfer::Srgb).unwrap();
    write_png(folder.at("thesis.png"), &ramp(1.0), Transfer::Linear).unwrap();
    for (name, scale) in [("little.pfm", "-1"), ("big.pfm", "1")] {
        let image = ramp(1.0);
        let mut bytes = format!("PF\n{SIDE} {SIDE}\n{scale}\n").into_bytes();
        for row in (0..SIDE).rev().map(|y| image.row(y)) {
            let samples = row.iter().flatten();
            bytes.extend(samples.flat_map(|v| if scale == "1" { v.to_be_bytes() } else { v.to_le_bytes() }));
        }
        folder.write(name, bytes);
    }
    for name in ["little.pfm", "big.pfm"] {
        assert_eq!(json(&folder, &format!("a.exr {name} --fail psnr<inf"), 0)["same_light"], true);
    }
    // Eight bits are coarser than floats, but what is shown is the same.
    let found = json(&folder, "a.exr a.png --fail pdiff_px>0 --fail flip>0 --fail psnr<inf", 0);
    assert_eq!((&found["same_display"], &found["same_light"]), (&true.into(), &false.into()));
    folder.run("compare a.exr thesis.png -q --fail psnr<inf").code(1);
    folder.run("compare a.exr thesis.png -q --fail psnr<inf --transfer linear").code(0);
    folder.write("16.png", DEEP_PNG);
    write_exr(folder.at("16.exr"), &Layers::new(Image::filled(2, 1, [0.2, 0.4, 0.8]))).unwrap();
    assert_eq!(json(&folder, "16.exr 16.png --metrics mae --transfer linear", 0)["same_light"], true);
    // The middle of a step: 128.5 x 2^(128 - 136) in every channel.
    folder.write("grey.hdr", [&b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n"[..], &[128; 8]].concat());
    write_exr(folder.at("grey.exr"), &Layers::new(Image::filled(2, 1, [128.5 / 256.0; 3]))).unwrap();
    assert_eq!(json(&folder, "grey.exr grey.hdr --metrics mae --fail mae>0", 0)["same_light"], true);
}

/// A PNG of 2 x 1 pixels of 16 bits: 13107, 26214 and 52428, which are 0.2, 0.4 and 0.8 of 65535.
const DEEP_PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x02\0\0\0\x01\x10\x02\0\0\0+\xd04\x9e\0\0\0\x11IDATx\xdac06NK;s\x06B\x02\0\x1f\x87\x05\x95\xf0)\xf0Z\0\0\0\0IEND\xaeB`\x82";

#[test]
fn layers_are_compared_by_name() {
    let folder = folder();
    let with_depth = |beauty: f32, depth: f32| {
        let mut layers = Layers::new(ramp(beauty));
        layers.push("depth", LayerData::Depth(Plane::filled(SIDE, SIDE, depth))).unwrap();
        layers
    };
    write_exr(folder.at("d1.exr"), &with_depth(1.0, 5.0)).unwrap();
    write_exr(folder.at("d2.exr"), &with_depth(2.0, 5.0)).unwrap();
    folder.run("compare d1.exr d2.exr -q").code(1);
    let found = json(&folder, "d1.exr d2.exr --layer depth", 0);
    assert_eq!((&found["channels"], &found["same_light"]), (&"Y".into(), &true.into()));
    let said = stderr(&folder.run("compare d1.exr a.exr --layer depth").code(2));
    assert!(said.contains("a.exr: it has no layer depth"), "{said}");
}

#[test]
fn maps_are_pictures_with_a_scale() {
    let folder = folder();
    let maps = "--map flip.png --map flip-hdr=h.png --map pdiff.png --map difference.png --map relmse.png \
                --map absolute=./x=y.png";
    let said = stdout(&folder.run(&format!("compare a.exr far.exr --metrics mae {maps}")).code(1));
    for name in ["flip.png", "h.png", "pdiff.png", "difference.png", "relmse.png", "x=y.png"] {
        let map = read_png(folder.at(name), Transfer::Linear).unwrap();
        assert!(map.width() >= SIDE && map.height() > SIDE, "{name}: a scale lies below the map");
        assert!(said.contains(name), "{said}");
    }
    // Brighter than the reference everywhere: red above blue in every pixel of the signed map.
    let map = read_png(folder.at("difference.png"), Transfer::Linear).unwrap();
    let left = (map.width() - SIDE) / 2;
    assert!((0..SIDE).all(|i| map.get(left + i, i)[0] > map.get(left + i, i)[2]));
    // Equal pictures give the first colour of FLIP's map.
    folder.run("compare a.exr same.exr -q --map flip.png").code(0);
    let map = read_png(folder.at("flip.png"), Transfer::Linear).unwrap();
    assert!(map.get(left + 5, 5).iter().all(|code| *code < 0.02), "{:?}", map.get(left + 5, 5));
}

#[test]
fn maps_that_cannot_be_written_are_refused_before_anything_is_read() {
    let folder = folder();
    write_png(folder.at("b.png"), &ramp(1.0), Transfer::Srgb).unwrap();
    let before = folder.bytes("b.png");
    let cases = [
        ("--map none/flip.png", "there is no folder none"),
        ("--map flip.exr", "ends in .png"),
        ("--map flop=a.png", "there is no map"),
        ("--map b.png", "an input of this comparison"),
        ("--map flip=./b.png", "an input of this comparison"),
        ("--map c.png --map relmse=./c.png", "two outputs"),
        ("--map .png/", "it"),
    ];
    for (maps, expected) in cases {
        // The reference does not exist: that would be the next complaint.
        let said = stderr(&folder.run(&format!("compare none.exr b.png {maps}")).code(2));
        assert!(said.contains(expected), "{maps}: {expected} is missing in:\n{said}");
    }
    assert_eq!(folder.bytes("b.png"), before);
    assert!(!folder.has("c.png"));
}

#[test]
fn pictures_that_do_not_match_are_told_apart() {
    let folder = folder();
    write_exr(folder.at("small.exr"), &Layers::new(Image::filled(3, 2, [0.5; 3]))).unwrap();
    let said = stderr(&folder.run("compare a.exr small.exr").code(2));
    let expected = "a.exr is 48 x 48 with channels R, G, B; small.exr is 3 x 2 with channels R, G, B";
    assert!(said.contains(expected), "{said}");
    folder.write("grey.pfm", [&b"Pf\n3 2\n-1\n"[..], &0.5_f32.to_le_bytes().repeat(6)].concat());
    let said = stderr(&folder.run("compare small.exr grey.pfm --ignore-alpha").code(2));
    assert!(
        said.contains("grey.pfm is 3 x 2 with channels Y") && said.contains("grey can be compared with grey"),
        "{said}"
    );
    folder.run("compare grey.pfm grey.pfm").code(0);

    write_png(folder.at("small.png"), &Image::filled(3, 2, [0.5; 3]), Transfer::Linear).unwrap();
    folder.write("alpha.png", CLEAR_GREY);
    let said = stderr(&folder.run("compare small.png alpha.png").code(2));
    assert!(said.contains("channels R, G, B, A") && said.contains("--ignore-alpha"), "{said}");
    assert_eq!(json(&folder, "small.png alpha.png --ignore-alpha", 0)["same_display"], true);
    folder.run("compare alpha.png alpha.png -q").code(0);
}

/// A PNG of 3 x 2 pixels with the code values 128, 128, 128 and alpha 0, as another program wrote it.
const CLEAR_GREY: &[u8] = b"\x89PNG\x0d\x0a\x1a\x0a\x00\x00\x00\x0dIHDR\x00\x00\x00\x03\x00\x00\x00\x02\x08\x06\x00\x00\x00\x9dtf\x1a\x00\x00\x00\x12IDATx\x9cclhh`\x80\x01&\x06$\x00\x00$N\x01\x84\xcd\xfe\xa6\xb0\x00\x00\x00\x00IEND\xaeB`\x82";

#[test]
fn trouble_has_one_exit_code_and_a_message() {
    let folder = folder();
    let exr = folder.bytes("a.exr");
    folder.write("cut.exr", &exr[..exr.len() / 2]);
    folder.write("text.exr", "no picture");
    folder.write("empty.png", "");
    folder.write("short.pfm", "PF\n99 99\n-1\n");
    folder.write("nan.pfm", "PF\n1 1\nnan\n000000000000");
    folder.write("negative.pfm", "PF\n-1 1\n-1\n000000000000");
    folder.write("short.hdr", "#?RADIANCE\n\n-Y 400 +X 400\n");
    folder.write("cut.hdr", "#?RADIANCE\n\n-Y 3 +X 3\nab");
    std::fs::create_dir(folder.at("folder.exr")).unwrap();
    let names = [
        "cut.exr",
        "text.exr",
        "empty.png",
        "short.pfm",
        "nan.pfm",
        "negative.pfm",
        "short.hdr",
        "cut.hdr",
        "folder.exr",
        "none.exr",
        "scene.txt",
    ];
    for name in names {
        for arguments in [format!("{name} a.exr"), format!("a.exr {name}")] {
            let assert = folder.run(&format!("compare {arguments}")).code(2);
            let said = stderr(&assert);
            assert!(said.contains(name) && !said.contains("panicked"), "{said}");
            assert_eq!(stdout(&assert), "");
        }
    }
    let usages = [
        "a.exr",
        "a.exr same.exr far.exr",
        "a.exr same.exr --metrics speed",
        "a.exr same.exr --metrics mae --fov 0 --fail pdiff_px>1",
        "a.exr same.exr --gamma -1",
        "a.exr same.exr --luminance nan",
        "a.exr same.exr --ppd 0",
        "a.exr same.exr --exposures 1,2",
        "a.exr same.exr --exposures 1,2,0",
        "a.exr same.exr --exposures nan,2,3",
        "a.exr same.exr --transfer log",
        "a.exr same.exr --threads 100000",
    ];
    for arguments in usages {
        let said = stderr(&folder.run(&format!("compare {arguments}")).code(2));
        assert!(!said.is_empty() && !said.contains("panicked"), "{arguments}: {said}");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_is_no_picture_and_is_not_waited_for() {
    let folder = folder();
    let made = std::process::Command::new("mkfifo").arg(folder.at("pipe.exr")).status();
    assert!(made.unwrap().success());
    let said = stderr(&folder.run("compare a.exr pipe.exr").code(2));
    assert!(said.contains("pipe.exr: it is not a regular file"), "{said}");
}

#[test]
fn threads_change_nothing_but_the_time() {
    let folder = folder();
    let values = |threads: u8| {
        let mut found = json(&folder, &format!("a.exr far.exr -j {threads}"), 1);
        for key in ["seconds", "read_seconds", "threads"] {
            found.as_object_mut().unwrap().remove(key);
        }
        found
    };
    assert_eq!(values(1), values(3));
}

#[test]
fn help_lists_the_exit_codes_of_this_command() {
    let folder = folder();
    let said = stdout(&folder.run("compare --help").success());
    for expected in ["they differ", "no verdict", "flip_ldr>0.05", "swaps red and blue", "Yee 2004", "the thesis"] {
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
    assert!(stderr(&folder.run("compare a.exr same.exr --progress plain").code(0)).starts_with("compare ..."));
    assert_eq!(stderr(&folder.run("compare a.exr same.exr").code(0)), "", "nobody waits for small pictures");
}
