//! Pictures of other programs: what is said of how their numbers are taken, in `compare`, in scenes and in `info`.

use crate::support::{Folder, stderr, stdout};
use exr::prelude::{self as foreign, WritableImage as _};
use lightcuts::image::{Image, Layers, read_exr, write_exr};

/// Rows of grey above rows of red.
fn color(y: usize) -> (f32, f32, f32) {
    if y < 8 { (0.5, 0.5, 0.5) } else { (0.5, 0.1, 0.1) }
}

/// What a file says beside its pixels: of its part, and of the whole.
type Said<'a> = (&'a mut foreign::LayerAttributes, &'a mut foreign::ImageAttributes);

/// An EXR of 16 x 16 pixels with attributes as `change` leaves them.
fn write_foreign(folder: &Folder, name: &str, change: impl FnOnce(Said<'_>)) {
    let pixels = foreign::SpecificChannels::rgb(|at: foreign::Vec2<usize>| color(at.1));
    let (part, encoding) = (foreign::LayerAttributes::default(), foreign::Encoding::SMALL_LOSSLESS);
    let mut image = foreign::Image::from_layer(foreign::Layer::new((16, 16), part, encoding, pixels));
    change((&mut image.layer_data.attributes, &mut image.attributes));
    image.write().non_parallel().to_file(folder.at(name)).unwrap();
}

fn aces() -> foreign::attribute::Chromaticities {
    foreign::attribute::Chromaticities {
        red: foreign::Vec2(0.7347, 0.2653),
        green: foreign::Vec2(0.0, 1.0),
        blue: foreign::Vec2(0.0001, -0.077),
        white: foreign::Vec2(0.32168, 0.33767),
    }
}

fn placed(x: i32, y: i32, frame: usize) -> impl FnOnce(Said<'_>) {
    move |(part, whole)| {
        part.layer_position = foreign::Vec2(x, y);
        whole.display_window.size = foreign::Vec2(frame, frame);
    }
}

fn tagged(id: &str) -> impl FnOnce(Said<'_>) {
    let value = foreign::attribute::AttributeValue::Text(id.into());
    move |(part, _)| drop(part.other.insert("colorInteropID".into(), value))
}

#[test]
fn colours_of_other_primaries_are_converted_and_that_is_said() {
    let folder = Folder::new();
    write_foreign(&folder, "rec709.exr", |_| ());
    write_foreign(&folder, "aces.exr", |(_, whole)| whole.chromaticities = Some(aces()));
    let assert = folder.run("compare rec709.exr aces.exr --metrics rmse --json").code(1);
    let found: serde_json::Value = serde_json::from_str(&stdout(&assert)).unwrap();
    let warning = found["warnings"][0].as_str().unwrap();
    assert!(
        warning.starts_with("aces.exr: its colours were converted from its chromaticities (red 0.7347"),
        "{warning}"
    );
    assert!(stderr(&assert).contains("aces.exr: its colours were converted"), "{}", stderr(&assert));
    // Grey stays grey, red becomes what Blender makes of it.
    let converted = read_exr(folder.at("aces.exr")).unwrap().into_beauty();
    for (found, expected) in [(converted.get(0, 0), [0.5; 3]), (converted.get(0, 8), [1.109, -0.011, 0.094])] {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}");
    }
    let broken = foreign::attribute::Chromaticities { white: foreign::Vec2(0.0, 0.0), ..aces() };
    write_foreign(&folder, "broken.exr", |(_, whole)| whole.chromaticities = Some(broken));
    let said = stderr(&folder.run("compare rec709.exr broken.exr").code(2));
    assert!(said.contains("chromaticities") && said.contains("span no space of colours"), "{said}");
}

#[test]
fn an_identifier_of_other_than_linear_light_is_said() {
    let folder = Folder::new();
    write_foreign(&folder, "plain.exr", |_| ());
    for (id, expected) in [
        ("srgb_rec709_display", Some("its colorInteropID is \"srgb_rec709_display\", not of linear light")),
        ("g24_rec709_scene", Some("not of linear light")),
        ("unknown", Some("not of linear light")),
        ("lin_ap1_scene", Some("converted from its colorInteropID (red 0.7130")),
        ("lin_rec709_scene", None),
        ("data", None),
    ] {
        write_foreign(&folder, "tagged.exr", tagged(id));
        let said = stderr(&folder.run("compare plain.exr tagged.exr --fail rmse>9"));
        match expected {
            Some(expected) => assert!(said.contains(expected), "{id}: {said}"),
            None => assert_eq!(said, "", "{id}"),
        }
    }
}

#[test]
fn pictures_of_other_places_are_never_the_same() {
    let folder = Folder::new();
    write_foreign(&folder, "a.exr", placed(8, 8, 40));
    write_foreign(&folder, "same.exr", placed(8, 8, 40));
    folder.run("compare a.exr same.exr -q").code(0);
    for (name, x, y, frame) in
        [("left.exr", 0, 8, 40), ("up.exr", 8, 0, 40), ("wide.exr", 8, 8, 41), ("whole.exr", 0, 0, 16)]
    {
        write_foreign(&folder, name, placed(x, y, frame));
        for arguments in [format!("a.exr {name}"), format!("{name} a.exr")] {
            let said = stderr(&folder.run(&format!("compare {arguments}")).code(2));
            assert!(said.contains("16 x 16 at column 8, row 8 of a display window of 40 x 40"), "{said}");
            assert!(said.contains("--ignore-windows"), "{said}");
        }
        folder.run(&format!("compare a.exr {name} --ignore-windows -q")).code(0);
    }
}

#[test]
fn a_picture_compared_with_itself_repeats_no_remark() {
    let folder = Folder::new();
    write_foreign(&folder, "a.exr", |(part, whole)| {
        whole.chromaticities = Some(aces());
        part.other.insert("colorInteropID".into(), foreign::attribute::AttributeValue::Text("g24_rec709_scene".into()));
    });
    let found = stdout(&folder.run("compare a.exr a.exr --metrics rmse --json").code(0));
    let found: serde_json::Value = serde_json::from_str(&found).unwrap();
    let warnings: Vec<&str> = found["warnings"].as_array().unwrap().iter().map(|it| it.as_str().unwrap()).collect();
    let told: std::collections::HashSet<&str> = warnings.iter().copied().collect();
    assert!(warnings.len() > 1 && told.len() == warnings.len(), "{warnings:?}");
}

#[test]
fn twice_the_light_is_never_the_same() {
    let folder = Folder::new();
    let base = |kind: usize| {
        Image::from_fn(32, 32, |x, y| match kind {
            0 => [1.0, 0.8, 0.6],
            1 => [0.2 + x as f32 / 32.0, y as f32 / 32.0, 0.3],
            2 => [10.0_f32.powi((x as i32 + y as i32) % 9 - 4); 3],
            _ => [if (x, y) == (5, 7) { 1.0 } else { 0.0 }; 3],
        })
    };
    for (kind, level) in (0..4).flat_map(|kind| [1e-12, 1e-3, 1.0, 5.0, 1e9].map(|level| (kind, level))) {
        let picture = base(kind).map(|pixel| pixel.map(|value| level * value));
        write_exr(folder.at("a.exr"), &Layers::new(picture.clone())).unwrap();
        write_exr(folder.at("b.exr"), &Layers::new(picture.map(|pixel| pixel.map(|value| 2.0 * value)))).unwrap();
        let assert = folder.run("compare a.exr b.exr --metrics non_finite").code(1);
        assert!(stdout(&assert).contains("relbias 1 > 0.1"), "{kind} {level}: {}", stdout(&assert));
        folder.run("compare b.exr a.exr --metrics non_finite -q").code(1);
        folder.run("compare a.exr a.exr --metrics non_finite -q").code(0);
    }
}

#[test]
fn the_scale_of_a_float_map_is_said() {
    let folder = Folder::new();
    for scale in ["1", "2"] {
        let pixel = [1.0_f32, 0.5, 0.25].map(f32::to_le_bytes).concat();
        folder.write(&format!("{scale}.pfm"), [format!("PF\n1 1\n-{scale}\n").as_bytes(), &pixel].concat());
    }
    let said = stderr(&folder.run("compare 1.pfm 2.pfm").code(1));
    assert!(said.contains("2.pfm: the header's scale is -2: the samples were multiplied by 2"), "{said}");
    assert!(!said.contains("1.pfm: "), "{said}");
}

#[test]
fn remarks_on_images_are_warnings_of_their_scene() {
    let folder = Folder::new();
    write_foreign(&folder, "sky.exr", |(part, whole)| {
        whole.chromaticities = Some(aces());
        placed(8, 8, 40)((part, whole));
    });
    folder.write(
        "scene.toml",
        "format = \"lightcuts-scene\"\nversion = 1\n[camera]\nposition = [0, 0, 3]\ntarget = [0, 0, 0]\n\
         [environment]\nimage = \"sky.exr\"\n",
    );
    let said = stderr(&folder.run("info scene.toml").success());
    assert!(said.contains("scene.toml:7:9: the image `sky.exr`: its colours were converted"), "{said}");
    assert!(said.contains("its pixels are 16 x 16 at column 8, row 8"), "{said}");
}

#[test]
fn info_knows_every_picture() {
    let folder = Folder::new();
    folder.write("a.hdr", [&b"#?RADIANCE\n\n-Y 1 +X 2\n"[..], &[128, 64, 0, 129, 0, 0, 0, 0]].concat());
    folder.write("a.pfm", [&b"Pf\n2 1\n-1\n"[..], &[0; 8]].concat());
    folder.write("unnamed", folder.bytes("a.hdr"));
    write_foreign(&folder, "crop.exr", placed(8, 4, 40));
    let ids = foreign::FlatSamples::U32(vec![1, 2]);
    let channels = |names: &[&str]| {
        let channels = names.iter().map(|name| foreign::AnyChannel::new(*name, ids.clone())).collect();
        foreign::Image::from_channels((2, 1), foreign::AnyChannels::sort(channels))
    };
    channels(&["R", "G", "B"]).write().to_file(folder.at("integers.exr")).unwrap();
    channels(&["Y"]).write().to_file(folder.at("grey.exr")).unwrap();
    channels(&["id.ID"]).write().to_file(folder.at("alone.exr")).unwrap();
    for (name, format, layer) in [
        ("a.hdr", "Radiance HDR", "beauty (color)"),
        ("unnamed", "Radiance HDR", "beauty (color)"),
        ("a.pfm", "PFM", "beauty (grey)"),
        ("integers.exr", "EXR", "beauty (color)"),
        ("grey.exr", "EXR", "beauty (grey)"),
        ("alone.exr", "EXR", "id (id)"),
    ] {
        let said = stdout(&folder.run(&format!("info {name}")).success());
        for expected in
            [format!("format       {format}\n"), "size         2 x 1\n".into(), format!("layers       {layer}\n")]
        {
            assert!(said.contains(&expected), "{name}: {expected} is missing in:\n{said}");
        }
    }
    let said = stdout(&folder.run("info crop.exr").success());
    assert!(
        said.contains("data window  16 x 16 at column 8, row 4\ndisplay      40 x 40 at column 0, row 0\n"),
        "{said}"
    );
    folder.write("short.hdr", "#?RADIANCE\n\n-Y 2 +X 2\n");
    assert!(stderr(&folder.run("info short.hdr").code(3)).contains("scan line 1: the file ends"));
}

#[test]
fn a_picture_is_no_scene_and_none_of_its_bytes_are_shown() {
    let folder = Folder::new();
    let bytes = [&b"#?RADIANCE\n\n-Y 1 +X 2\n"[..], &[128, 200, 0, 129, 27, 91, 155, 0]].concat();
    for (name, bytes) in [("a.hdr", &bytes[..]), ("a.txt", &bytes[..]), ("b.txt", &[0xe2, 0x9b, 0xf3, 1, 0][..])] {
        folder.write(name, bytes);
        let said = folder.run(&format!("render {name} -o o.png")).code(3);
        let said = said.get_output().stderr.clone();
        assert!(!said.contains(&27), "{}", String::from_utf8_lossy(&said));
        let said = String::from_utf8(said).unwrap();
        let expected = if name == "b.txt" { "(binary)" } else { "lightcuts develop" };
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn ids_are_floats_in_files_and_can_be_compared_by_name() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 16x16 -o a.exr").success();
    let file = foreign::read_all_flat_layers_from_file(folder.at("a.exr")).unwrap();
    let channels = &file.layer_data[0].channel_data.list;
    assert!(channels.iter().all(|channel| matches!(channel.sample_data, foreign::FlatSamples::F32(_))));
    folder.run("compare a.exr a.exr --layer object_id -q").code(0);
    assert!(stdout(&folder.run("info a.exr").success()).contains("object_id (id)"));
}
