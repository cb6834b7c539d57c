//! Faces, normals and colours of models in scenes of the physical model.

use super::{CLAY, HEAD, memory};
use glam::Vec3;
use lightcuts_scene::physical::{PhysicalScene, PhysicalShape};
use std::fmt::Write as _;

/// A scene with one object per text, all of the model `m.obj` or `m.ply`, and its warnings.
fn objects(file: &str, content: &[u8], keys: &[&str]) -> (PhysicalScene, Vec<String>) {
    let mut text = format!("{HEAD}{CLAY}[[mesh]]\nname = \"m\"\nfile = \"{file}\"\n");
    for keys in keys {
        write!(text, "[[object]]\ntype = \"mesh\"\nmesh = \"m\"\nmaterial = \"clay\"\n{keys}\n")
            .expect("a text takes all");
    }
    let imported = memory(&text, &[(file, content)]).unwrap_or_else(|error| panic!("{text}\n{error}"));
    assert_eq!(imported.scene.validate(), []);
    let warnings = imported.warnings.iter().map(ToString::to_string);
    (imported.scene, warnings.filter(|warning| !warning.contains("the scene has no")).collect())
}

fn area(scene: &PhysicalScene) -> f32 {
    let mesh = &scene.meshes[0];
    let of = |corners: [u32; 3]| {
        let [a, b, c] = corners.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    mesh.triangles.iter().map(|triangle| of(triangle.positions)).sum()
}

const ARROW: &str = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0.25 0.5\nvn 0 0 1\n";

#[test]
fn concave_polygons_keep_their_outline() {
    let (scene, warnings) = objects("m.obj", format!("{ARROW}f 1/1/1 2/2/1 3/3/1 4/4/1\n").as_bytes(), &[""]);
    assert!((area(&scene) - 1.5).abs() < 1e-6 && warnings.is_empty(), "{warnings:?}");
    for triangle in &scene.meshes[0].triangles {
        assert_eq!((triangle.texture_coordinates, triangle.normals), (Some(triangle.positions), Some([0; 3])));
    }
    // Vertices may come behind the faces.
    let early = format!("f 1 2 3 4\n{ARROW}");
    let (scene, _) = objects("m.obj", early.as_bytes(), &[""]);
    assert!((area(&scene) - 1.5).abs() < 1e-6, "{}", area(&scene));
    let ply = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 4\n\
               property float x\nproperty float y\nproperty float z\nend_header\n4 0 1 2 3\n0 0 0\n2 1 0\n0 2 0\n0.5 1 0\n";
    assert!((area(&objects("m.ply", ply.as_bytes(), &[""]).0) - 1.5).abs() < 1e-6);
    let crossing = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\nf 4 3 2 1\n";
    let (scene, warnings) = objects("m.obj", crossing.as_bytes(), &[""]);
    assert_eq!((scene.meshes[0].triangles.len(), warnings.len()), (4, 1));
    assert!(warnings[0].starts_with("m.obj:5:1: 2 polygons cross themselves or have no area"), "{warnings:?}");
}

/// A ground that is a sphere, and an object of size 2 on it in every form.
#[test]
fn spheres_too_large_for_the_smallest_object_are_told() {
    let cube = "type = \"box\"\ncenter = [0, 5, 0]\nsize";
    for object in [
        "type = \"sphere\"\ncenter = [0, 5, 0]\nradius = 1",
        "type = \"rectangle\"\ncenter = [0, 5, 0]\nnormal = [0, 1, 0]\nhead = [1, 0, 0]\nwidth = 2\nheight = 0.1",
        &format!("{cube} = [0.1, 2, 1]"),
        &format!("{cube} = [1, 1, 0.5]\nscale = [-2, 1, 1]"),
        &format!("{cube} = [2, 1e-3, 0.5]\nrotate = {{ axis = [0, 1, 0], degrees = 90 }}"),
    ] {
        for (radius, count) in [("1", 0), ("1.9e6", 0), ("2.1e6", 1), ("9e8", 1)] {
            let ground = format!("[[object]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = {radius}\n");
            let text = format!("{HEAD}{CLAY}{ground}material = \"clay\"\n[[object]]\nmaterial = \"clay\"\n{object}\n");
            let imported = memory(&text, &[]).unwrap_or_else(|error| panic!("{text}\n{error}"));
            let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
            let told =
                |warning: &&String| warning.contains("1 sphere of a radius over 1e6 times the size of the smallest");
            assert_eq!(warnings.iter().filter(told).count(), count, "{text} {warnings:?}");
        }
    }
}

#[test]
fn what_is_no_face_is_counted() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1\nf\nl 1 2\nl 2 3\np 1\nf 1 2 3\ncurv2 1 2\n";
    let (scene, warnings) = objects("m.obj", text.as_bytes(), &[""]);
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    let expected = [
        "m.obj:4:1: 3 faces of fewer than 3 corners are ignored",
        "m.obj:7:1: ignored: 2 line elements (`l`); only faces are read",
        "m.obj:9:1: ignored: 1 point element (`p`); only faces are read",
        "m.obj:11:1: ignored: 1 free-form curve or surface",
    ];
    assert!(warnings.iter().zip(expected).all(|(w, e)| w.starts_with(e)) && warnings.len() == 4, "{warnings:?}");
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 3\n\
               property list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n\
               0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n0\n7\n";
    let (scene, warnings) = objects("m.ply", ply.as_bytes(), &[""]);
    assert_eq!(scene.meshes[0].triangles.len(), 1);
    assert!(warnings[0].contains("m.ply:9:1: the element `edge` is ignored"), "{warnings:?}");
    assert!(warnings[1].contains("m.ply:15:1: 2 faces of fewer than 3 corners"), "{warnings:?}");
}

#[test]
fn colours_of_vertices_are_said_to_be_unused() {
    for vertex in ["0 0 0 1 0 0", "0 0 0 1 0 0 1"] {
        let text = format!("v {vertex}\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
        let (_, warnings) = objects("m.obj", text.as_bytes(), &["", ""]);
        assert!(
            warnings.len() == 1 && warnings[0].starts_with("m.obj:1:2: the model has vertex colours"),
            "{warnings:?}"
        );
    }
    assert!(objects("m.obj", b"v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n", &[""]).1.is_empty());
    for colors in ["red green blue", "red green blue alpha", "diffuse_red diffuse_green diffuse_blue"] {
        let properties: String = colors.split(' ').flat_map(|name| ["property uchar ", name, "\n"]).collect();
        let values = " 255".repeat(colors.split(' ').count());
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{properties}\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0{values}\n1 0 0{values}\n0 1 0{values}\n3 0 1 2\n"
        );
        let (_, warnings) = objects("m.ply", text.as_bytes(), &[""]);
        assert!(
            warnings.len() == 1 && warnings[0].starts_with("m.ply:3:1: the model has vertex colours"),
            "{warnings:?}"
        );
    }
}

#[test]
fn comments_and_long_lines_stand_anywhere() {
    let text = "# c:\\models\\\nv 0 0 0 # first\nv\t1 0 0#x\r\nv 0 \\\n 1 0\nvt 0 0 # t\nvn 0 0 1# n\ns 1 # on\ng a # b\nf 1/1/1 2/1/1 \\\r\n 3/1/1 # all\n";
    let (scene, warnings) = objects("m.obj", text.as_bytes(), &[""]);
    assert_eq!((warnings, area(&scene)), (Vec::new(), 0.5));
    // A `#` belongs to a name unless it stands behind a blank and the name without it is known.
    let model =
        b"mtllib m#1.mtl # mine\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a #1\nf 1 2 3\nusemtl b # the other\nf 1 2 3\n";
    let files: [(&str, &[u8]); 2] = [("m.obj", model), ("m#1.mtl", b"newmtl a #1\nKd 1\nnewmtl b\nKd 0.25\n")];
    let text = format!("{HEAD}{}", super::models::OBJECT);
    let imported = memory(&text, &files).expect("it is sound");
    let names: Vec<&str> = imported.scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!((names.len(), names[0]), (2, "a #1"));
    assert!(imported.warnings.iter().all(|warning| warning.to_string().contains("the scene has no")));
}

/// A prism of twelve sides, 30 degrees apart, without lids.
fn prism(between: &str) -> String {
    let mut text = String::new();
    for i in 0..12 {
        let (y, x) = (i as f32 * std::f32::consts::TAU / 12.0).sin_cos();
        write!(text, "v {x} {y} 0\nv {x} {y} 1\n").expect("a text takes all");
    }
    text.push_str(between);
    for i in 0..12 {
        let j = (i + 1) % 12;
        writeln!(text, "f {} {} {} {}", 2 * i + 1, 2 * j + 1, 2 * j + 2, 2 * i + 2).expect("a text takes all");
    }
    text
}

/// Of each object whether all normals are the radius' direction, and none of them is missing.
fn are_round(scene: &PhysicalScene) -> Vec<bool> {
    let is_round = |shape: &PhysicalShape| {
        let PhysicalShape::Mesh { mesh, smooth, .. } = *shape else { panic!("a mesh") };
        let mesh = &scene.meshes[mesh.0 as usize];
        let corner = |position: u32, normal: u32| {
            let radial = mesh.positions[position as usize] * Vec3::new(1.0, 1.0, 0.0);
            (mesh.normals[normal as usize] - radial).length() < 1e-5
        };
        smooth
            && mesh.triangles.iter().all(|triangle| {
                triangle.normals.is_some_and(|normals| (0..3).all(|i| corner(triangle.positions[i], normals[i])))
            })
    };
    scene.objects.iter().map(|object| is_round(&object.shape)).collect()
}

#[test]
fn meshes_without_normals_get_smooth_ones_up_to_the_angle_of_each_object() {
    let keys =
        ["", "crease-angle = 29", "smooth = false", "crease-angle = 180", "crease-angle = 0", "crease-angle = 29"];
    let (scene, warnings) = objects("m.obj", prism("").as_bytes(), &keys);
    assert_eq!(warnings, [""; 0]);
    assert_eq!(are_round(&scene), [true, false, false, true, false, false]);
    // One mesh for each way.
    assert_eq!(scene.meshes.len(), 4);
    assert_eq!(
        scene.meshes.iter().map(|mesh| mesh.crease_degrees).collect::<Vec<_>>(),
        [Some(40.0), None, Some(180.0), None]
    );
}

#[test]
fn smoothing_groups_count_unless_an_angle_is_given() {
    let round = |between: &str, keys: &str| are_round(&objects("m.obj", prism(between).as_bytes(), &[keys]).0)[0];
    for (between, keys, expected) in [
        ("s 1\n", "", true),
        ("s off\n", "", false),
        ("s 0\n", "", false),
        ("s off\n", "crease-angle = 40", true),
        ("s 1\ns off\ns 3\n", "", true),
    ] {
        assert_eq!(round(between, keys), expected, "{between:?} {keys:?}");
    }
    let halves = prism("s 1\n").replace("f 13 ", "s 2\nf 13 ");
    assert_eq!(are_round(&objects("m.obj", halves.as_bytes(), &[""]).0), [false]);
}

#[test]
fn angles_that_look_like_radians_are_asked_about() {
    let (_, warnings) = objects("m.obj", prism("").as_bytes(), &["crease-angle = 0.7"]);
    assert!(warnings[0].contains("`crease-angle` is 0.7 degrees; 0.7 radians would be 40.107"), "{warnings:?}");
    let head = HEAD.replace("target", "fov = 0.52\ntarget");
    let imported = memory(&format!("{head}{CLAY}"), &[]).expect("it is sound");
    let first = imported.warnings[0].to_string();
    assert!(first.contains("`fov` is 0.52 degrees; 0.52 radians would be 29.79"), "{first}");
    let error = memory(
        &format!(
            "{HEAD}{CLAY}[[mesh]]\nname = \"m\"\nfile = \"m.obj\"\n[[object]]\ntype = \"mesh\"\nmesh = \"m\"\n\
                                 material = \"clay\"\ncrease-angle = 181\n"
        ),
        &[("m.obj", prism("").as_bytes())],
    );
    assert!(
        error
            .expect_err("it is too wide")
            .to_string()
            .contains("`crease-angle` is 181; expected an angle from 0 to 180")
    );
}
