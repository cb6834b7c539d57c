//! `develop`, `--exposure`, and the messages of `heatmap`.

use crate::support::{Folder, stderr, stdout};
use lightcuts::image::{Image, Layers, Transfer, read_png, write_exr};

/// A ramp of grey from 0 to 1 and a row four times as bright.
fn ramp() -> Image {
    Image::from_fn(16, 2, |x, y| [(if y == 0 { 1.0 } else { 4.0 }) * x as f32 / 15.0; 3])
}

fn codes(folder: &Folder, name: &str) -> Vec<u8> {
    let picture = read_png(folder.at(name), Transfer::Linear).unwrap();
    picture.pixels().iter().map(|pixel| (pixel[1] * 255.0).round() as u8).collect()
}

#[test]
fn light_is_exposed_transferred_and_rounded() {
    let folder = Folder::new();
    write_exr(folder.at("a.exr"), &Layers::new(ramp())).unwrap();
    for (options, exposure, transfer) in [
        ("", 1.0, Transfer::Srgb),
        ("--exposure 0.25", 0.25, Transfer::Srgb),
        ("--exposure 3 --transfer linear", 3.0, Transfer::Linear),
    ] {
        let said = stdout(&folder.run(&format!("develop a.exr {options} -o b.png")).success());
        assert!(
            said.contains(&format!("exposure     {exposure}\n")) && said.contains("wrote        b.png\n"),
            "{said}"
        );
        let expected: Vec<u8> = ramp().pixels().iter().map(|pixel| transfer.quantise(exposure * pixel[1])).collect();
        assert_eq!(codes(&folder, "b.png"), expected, "{options}");
    }
    assert!(
        stdout(&folder.run("develop a.exr --exposure 0.25").success()).contains("above white  0.00 % of the pixels")
    );
    assert!(folder.has("a.png"), "the default name");
    assert_eq!(stdout(&folder.run("develop a.exr -q").success()), "");
}

#[test]
fn above_white_is_what_the_file_shows_white() {
    let folder = Folder::new();
    // White lamps and yellow ones in a dark room; grey and white walls.
    let lamps = Image::from_fn(16, 16, |x, y| match (x % 4, y % 4) {
        (1, 1) => [900.0; 3],
        (3, 3) => [900.0, 800.0, 0.0],
        _ => [0.05; 3],
    });
    let walls = Image::from_fn(16, 16, |x, y| [[4.0; 3], [4.0, 0.5, 0.5], [0.5; 3], [1.0; 3]][(x + y) % 4]);
    for (picture, options, white, clipped) in [
        (&lamps, "--tone-mapping none", "6.25", "12.50"),
        (&lamps, "--exposure auto --tone-mapping local", "6.25", "12.50"),
        (&lamps, "--exposure 1e-4", "0.00", "0.00"),
        (&walls, "--tone-mapping none", "25.00", "50.00"),
    ] {
        write_exr(folder.at("a.exr"), &Layers::new(picture.clone())).unwrap();
        let said = stdout(&folder.run(&format!("develop a.exr {options} -o a.png")).success());
        let expected = format!("above white  {white} % of the pixels; {clipped} % in at least one channel\n");
        assert!(said.contains(&expected), "{options}: {said}");
        let written = read_png(folder.at("a.png"), Transfer::Linear).unwrap();
        let share = |is_white: fn(&&[f32; 3]) -> bool| written.pixels().iter().filter(is_white).count() as f64 / 2.56;
        // 1 itself is white, and not above it.
        let at_one = if std::ptr::eq(picture, &raw const walls) { 25.0 } else { 0.0 };
        assert_eq!(format!("{:.2}", share(|pixel| **pixel == [1.0; 3]) - at_one), white, "{options}");
        assert_eq!(format!("{:.2}", share(|pixel| pixel.contains(&1.0)) - at_one), clipped, "{options}");
    }
}

#[test]
fn an_automatic_exposure_does_not_depend_on_the_level() {
    let folder = Folder::new();
    let mut pictures = Vec::new();
    for level in [1e-3, 1.0, 512.0] {
        let picture = Image::from_fn(32, 32, |x, y| [level * (1 + x + y) as f32 / 64.0; 3]);
        write_exr(folder.at("a.exr"), &Layers::new(picture)).unwrap();
        let said = stdout(&folder.run("develop a.exr --exposure auto -o a.png").success());
        assert!(said.contains(" (auto)\n"), "{said}");
        pictures.push(codes(&folder, "a.png"));
    }
    let differ = |a: &[u8], b: &[u8]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    assert!(!differ(&pictures[0], &pictures[1]) && !differ(&pictures[1], &pictures[2]));
}

#[test]
fn every_format_of_light_is_developed_and_what_holds_none_is_refused() {
    let folder = Folder::new();
    folder.write("a.hdr", [&b"#?RADIANCE\n\n-Y 1 +X 1\n"[..], &[127, 127, 127, 129]].concat());
    folder.write("a.pfm", [&b"Pf\n1 1\n-1\n"[..], &1.0_f32.to_le_bytes()].concat());
    for name in ["a.hdr", "a.pfm"] {
        folder.run(&format!("develop {name} -o a.png")).success();
        assert_eq!(codes(&folder, "a.png"), [255], "{name}");
        folder.run(&format!("develop {name} --exposure 0.5 --tone-mapping local --bloom -o a.png")).success();
    }
    assert!(stderr(&folder.run("develop a.png -o b.png").code(3)).contains("expected light: EXR"));
    assert!(stderr(&folder.run("develop scene.txt -o b.png").code(3)).contains("no EXR, Radiance HDR or PFM"));
    assert!(stderr(&folder.run("develop none.exr -o b.png").code(3)).contains("cannot read the picture none.exr"));
    assert!(stderr(&folder.run("develop a.hdr -o b.jpg").code(2)).contains("ends in .png"));
    assert!(stderr(&folder.run("develop a.hdr --layer x -o b.png").code(3)).contains("only EXR files have layers"));
    for wrong in ["0", "-1", "nan", "inf", "1e13"] {
        let said = stderr(&folder.run(&format!("develop a.hdr --exposure {wrong} -o b.png")).code(2));
        assert!(said.contains("--exposure is") && said.contains("or `auto`"), "{said}");
    }
    assert!(stderr(&folder.run("develop a.hdr --exposure bright").code(2)).contains("or `auto`"));
}

#[test]
fn renders_are_exposed_in_both_models_and_1_changes_no_byte() {
    let folder = Folder::new();
    for model in ["thesis", "physical --integrator path --samples 1"] {
        let render =
            |options: &str| folder.run(&format!("render scene.txt --model {model} --size 16x16 {options}")).success();
        render("-o plain.png -o plain.exr");
        render("--exposure 1 -o one.png -o one.exr");
        assert_eq!(folder.bytes("plain.png"), folder.bytes("one.png"), "{model}");
        assert_eq!(folder.bytes("plain.exr"), folder.bytes("one.exr"), "{model}");
        render("--exposure 0.5 -o half.png -o half.exr");
        let transfer = if model == "thesis" { "linear" } else { "srgb" };
        folder.run(&format!("develop plain.exr --exposure 0.5 --transfer {transfer} -o developed.png")).success();
        assert_eq!(codes(&folder, "half.png"), codes(&folder, "developed.png"), "{model}");
        assert_ne!(codes(&folder, "half.png"), codes(&folder, "plain.png"), "{model}");
        folder.run("compare plain.exr half.exr --fail mae>0 -q").code(0);
        assert!(folder.job_of("half.exr").contains("exposure = 0.5\n"));
        assert!(!folder.job_of("one.exr").contains("exposure"));
    }
    folder.write("job.toml", "scene = \"scene.txt\"\n[image]\nwidth = 8\nheight = 8\n[display]\nexposure = \"auto\"\n");
    folder.run("render --job job.toml -o auto.exr").success();
    assert!(folder.job_of("auto.exr").contains("exposure = \"auto\"\n"));
    folder.write("job.toml", "scene = \"scene.txt\"\n[display]\nexposure = -1\n");
    assert!(
        stderr(&folder.run("render --job job.toml -o a.png").code(2)).contains("job.toml:3:12: display.exposure is -1")
    );
}

#[test]
fn heat_maps_take_negative_ranges_and_know_swapped_arguments() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 8x8 -o a.exr").success();
    folder.run("heatmap a.exr lights_selected --log --range -6..-2 -o h.png").success();
    let said = stderr(&folder.run("heatmap depth a.exr").code(2));
    assert!(said.contains("seem to be swapped") && said.contains("lightcuts heatmap a.exr depth"), "{said}");
    assert!(stderr(&folder.run("heatmap none.exr depth").code(3)).contains("cannot read the picture none.exr"));
    folder.run("render scene.txt --size 8x8 --samples 4 --filter mitchell --filter-mitchell-b -.5 -o m.png").success();
}
