//! Models in scenes of the physical model: PLY, OBJ, and what an MTL file makes of its faces.

use super::{CLAY, HEAD, memory, opaque_png, png, scene};
use glam::Vec3;
use lightcuts_import::{FileResolver, Limits, parse_physical};
use lightcuts_scene::MeshId;
use lightcuts_scene::physical::{PhysicalScene, PhysicalShape, Pixels, Scattering};
use lightcuts_testkit::shared;
use std::fmt::Write as _;
use std::fs;

pub(super) const OBJECT: &str = "[[mesh]]\nname = \"m\"\nfile = \"m.obj\"\n[[object]]\ntype = \"mesh\"\nmesh = \"m\"\n";
pub(super) const VERTICES: &str = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// The scattering of the only library material `a` of a model, and the warnings.
pub(super) fn library(text: &str) -> (PhysicalScene, Vec<String>) {
    let model = format!("{VERTICES}usemtl a\nf 1 2 3\n");
    let (color, mask) = (opaque_png([9, 8, 7]), png(&[[0, 0, 0, 50]]));
    let library = format!("newmtl a\n{text}");
    let files: [(&str, &[u8]); 4] =
        [("m.obj", model.as_bytes()), ("m.mtl", library.as_bytes()), ("c.png", &color), ("mask.png", &mask)];
    let imported = memory(&format!("{HEAD}{OBJECT}"), &files).unwrap_or_else(|error| panic!("{text}\n{error}"));
    assert_eq!(imported.scene.validate(), []);
    let warnings = imported.warnings.iter().map(ToString::to_string);
    (imported.scene, warnings.filter(|warning| !warning.contains("the scene has no")).collect())
}

pub(super) fn scattering(text: &str) -> Scattering {
    let (scene, warnings) = library(text);
    assert_eq!(warnings, [""; 0], "{text}");
    scene.materials[0].scattering.clone()
}

#[test]
fn library_materials_become_physical_ones() {
    let half = Vec3::splat(0.5);
    assert_eq!(
        scattering("Kd 1 0.5 0\nKa 1 1 1\nNs 7\nillum 2"),
        Scattering::Lambert { albedo: Vec3::new(1.0, 0.5, 0.0).into() }
    );
    assert_eq!(
        scattering("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 7"),
        Scattering::Phong { diffuse: half.into(), specular: half.into(), exponent: 7.0 }
    );
    assert_eq!(
        scattering("Kd 0.25 0.25 0.25\nKs 0.5 0.5 0.5\nNs 0"),
        Scattering::Phong { diffuse: Vec3::splat(0.25).into(), specular: half.into(), exponent: 1.0 }
    );
    assert_eq!(scattering("Kd 0 0 0\nKs 0.5 0.5 0.5\nillum 3"), Scattering::Mirror { reflectance: half.into() });
    assert_eq!(scattering("Kd 0 0 0\nillum 5"), Scattering::Mirror { reflectance: Vec3::ONE.into() });
    assert_eq!(
        scattering("Kd 0 0 0\nillum 7\nNi 1.33\nTf 0.5 0.5 0.5\nd 0.1"),
        Scattering::Dielectric { ior: 1.33, roughness: 0.0, transmittance: half }
    );
    let textured = scattering("map_Kd c.png");
    assert!(matches!(&textured, Scattering::Lambert { albedo } if albedo.color == Vec3::ONE && albedo.image.is_some()));
}

#[test]
fn library_materials_shine_and_are_cut_out() {
    let (scene, _) = library("Ke 1 2 3\nmap_d mask.png\nnorm c.png");
    let material = &scene.materials[0];
    assert_eq!(material.emission.map(|emission| emission.radiance), Some(Vec3::new(1.0, 2.0, 3.0)));
    assert!(material.normal_map.is_some() && material.alpha.is_some_and(|alpha| alpha.threshold == 0.5));
    assert_eq!(library("Ke 0 0 0").0.materials[0].emission, None);
    let (scene, warnings) = library("d 0.75");
    assert_eq!(scene.materials[0].alpha, None);
    assert!(warnings[0].starts_with("m.mtl:2:1: partly transparent surfaces are not supported: `a` is opaque"));
    let (scene, warnings) = library("Tr 0.75");
    let mask = scene.materials[0].alpha.expect("it is cut out");
    assert_eq!(scene.images[mask.image.0 as usize].pixels, Pixels::Linear(vec![[0; 4]]));
    assert!(warnings[0].contains("`a` is left out"), "{warnings:?}");
}

#[test]
fn an_object_has_its_own_material_or_those_of_the_model() {
    let model = format!("{VERTICES}f 1 2 3\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    let files: [(&str, &[u8]); 2] =
        [("m.obj", model.as_bytes()), ("m.mtl", b"newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n")];
    let again = "[[object]]\ntype = \"mesh\"\nmesh = \"n\"\n[[mesh]]\nname = \"n\"\nfile = \"m.obj\"\n";
    let made = scene(
        &format!("{CLAY}{OBJECT}{again}[[object]]\ntype = \"mesh\"\nmesh = \"m\"\nmaterial = \"clay\"\n"),
        &files,
    );
    let names: Vec<Option<u32>> = made.meshes[0].triangles.iter().map(|t| t.material.map(|m| m.0)).collect();
    assert_eq!((made.meshes.len(), names), (1, vec![None, Some(1), Some(2)]));
    let uses: Vec<_> = made
        .objects
        .iter()
        .map(|object| match object.shape {
            PhysicalShape::Mesh { mesh, override_material, .. } => (mesh, override_material, object.material.0),
            _ => panic!("all are meshes"),
        })
        .collect();
    // Faces without a material are diffuse grey.
    assert_eq!(uses, [(MeshId(0), false, 3), (MeshId(0), false, 3), (MeshId(0), true, 0)]);
    assert_eq!(made.materials[3].scattering, Scattering::default());
}

#[test]
fn models_that_others_made_are_read() {
    let Some(folder) = shared("scenes/edge/ply-assimp") else { return };
    let expected = [
        ("Wuson.ply", Ok(3732)),
        ("cube.ply", Ok(12)),
        ("cube_binary.ply", Ok(12)),
        ("cube_binary_header_with_RN_newline.ply", Ok(12)),
        ("cube_binary_starts_with_nl.ply", Ok(12)),
        ("cube_uv.ply", Ok(12)),
        ("float-color.ply", Ok(1)),
        // Each vertex claims to have a list of indices, but has none.
        ("issue623.ply", Err("15:1: vertex 1 of 24: `7.941797` is not a whole number")),
        ("points.ply", Ok(0)),
    ];
    for (name, outcome) in expected {
        let body = format!("{CLAY}[[mesh]]\nname = \"m\"\nfile = \"{name}\"\n");
        let resolver = FileResolver::new(&folder.join("scene.toml"), &[]);
        let text = format!("{HEAD}{body}");
        match (parse_physical(&text, "scene.toml", &resolver, &Limits::default()), outcome) {
            (Ok(imported), Ok(triangles)) => assert_eq!(imported.scene.meshes[0].triangles.len(), triangles, "{name}"),
            (Err(error), Err(fragment)) => assert!(error.to_string().contains(fragment), "{name}: {error}"),
            (outcome, _) => panic!("{name}: {outcome:?}"),
        }
    }
}

/// The box of the peers' comparison, as `scene.json` beside its models describes it.
#[test]
fn the_cornell_box_is_read() {
    let Some(folder) = shared("data/peers/cornell") else { return };
    let json = fs::read_to_string(folder.join("scene.json")).expect("it is readable");
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    let mut text =
        "format = \"lightcuts-scene\"\nversion = 1\nname = \"cornell\"\n[camera]\nposition = [278, 273, -800]\n\
                    target = [278, 273, 0]\nfov = 39.3077\n"
            .to_owned();
    let meshes = json["meshes"].as_array().expect("a list");
    for mesh in meshes {
        let (name, file) = (&mesh["name"], &mesh["ply"]);
        let (albedo, emission) = (&mesh["albedo"], &mesh["emission"]);
        write!(
            text,
            "[[material]]\nname = {name}\ntype = \"lambert\"\nalbedo = {albedo}\nemission = {emission}\n\
             [[mesh]]\nname = {name}\nfile = {file}\n\
             [[object]]\ntype = \"mesh\"\nmesh = {name}\nmaterial = {name}\n"
        )
        .expect("a text takes all");
    }
    let resolver = FileResolver::new(&folder.join("scene.toml"), &[]);
    let imported = parse_physical(&text, "scene.toml", &resolver, &Limits::default()).expect("it is sound");
    assert_eq!(imported.warnings, []);
    let made = imported.scene;
    assert_eq!((made.objects.len(), made.meshes.len(), made.materials.len()), (8, 8, 8));
    for (mesh, described) in made.meshes.iter().zip(meshes) {
        assert_eq!(Some(mesh.triangles.len() as u64), described["triangles"].as_u64(), "{}", mesh.name);
    }
    let shining: Vec<&str> = made.materials.iter().filter(|m| m.emission.is_some()).map(|m| m.name.as_str()).collect();
    assert_eq!(shining, ["light"]);
    assert_eq!(made.materials[5].emission.map(|emission| emission.radiance), Some(Vec3::new(17.0, 12.0, 4.0)));
    assert_eq!(made.camera.focus_distance, 800.0);
}

/// Models of maps and buildings have coordinates in which 32-bit floats tell nothing below a meter apart.
#[test]
fn models_far_from_their_origin_keep_their_form() {
    let corners =
        [[3_512_345.125, 5_400_000.5, 20.25], [3_512_345.375, 5_400_000.5, 20.25], [3_512_345.125, 5_400_001.5, 21.25]];
    let rows = |start: &str| corners.map(|[x, y, z]| format!("{start}{x} {y} {z}\n")).concat();
    let obj = rows("v ") + "f 1 2 3\n";
    let header = "element vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let text = format!("ply\nformat ascii 1.0\n{header}{}3 0 1 2\n", rows("")).into_bytes();
    let mut binary = format!("ply\nformat binary_little_endian 1.0\n{header}").into_bytes();
    binary.extend(corners.iter().flatten().flat_map(|c: &f64| c.to_le_bytes()));
    binary.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    for (name, file) in [("m.obj", obj.into_bytes()), ("m.ply", text), ("m.ply", binary)] {
        let object = OBJECT.replace("m.obj", name);
        let body = format!("{CLAY}{object}material = \"clay\"\ntranslate = [-3512345, -5400000, 0]\n");
        let made = scene(&body, &[(name, &file)]);
        let (lower, upper) = made.objects[0].shape.bounds(&made.meshes).expect("a triangle");
        assert_eq!((lower.to_array(), upper.to_array()), ([0.125, 0.5, 20.25], [0.375, 1.5, 21.25]), "{name}");
    }
}
