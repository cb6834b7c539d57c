//! What an MTL file makes of a material: in the sense of its format, of Blender, and of whoever writes roughness.

use super::models::{OBJECT, VERTICES, library, scattering};
use super::{CLAY, HEAD, memory, opaque_png};
use glam::Vec3;
use lightcuts_scene::physical::{PhysicalScene, Scattering};

fn only_warning(text: &str) -> (Scattering, String) {
    let (scene, warnings) = library(text);
    assert_eq!(warnings.len(), 1, "{text}: {warnings:?}");
    (scene.materials.last().expect("there is one").scattering.clone(), warnings[0].clone())
}

#[test]
fn what_is_ignored_of_a_library_is_told() {
    let warned = |text: &str, fragment: &str| {
        let (_, warning) = only_warning(text);
        assert!(warning.contains(fragment), "{text}: {warning}");
    };
    warned("Pr 0.5\nmap_Ks c.png\nPm 0", "m.mtl:3:1: not supported, and ignored in the material `a`: `map_Ks`");
    warned(
        "Pc 0.5\nPcr 0.1\nPs 0\nbump c.png",
        "m.mtl:2:1: not supported, and ignored in the material `a`: `Pc`, `Pcr`, `bump`",
    );
    warned("illum 3", "m.mtl:2:1: mirrors and glass with a diffuse colour are not supported: `a` is opaque");
    warned("illum 11", "m.mtl:2:1: illumination model 11 is unknown");
    warned("map_Kd none.png", "m.mtl:2:1: the image `none.png` was not found");
    warned("map_Kd -clamp on c.png", "m.mtl:2:1: `-clamp on` is not supported");
    warned("map_Kd -bm 2 -t 1 1 1 -imfchan r c.png", "m.mtl:2:1: not supported, and ignored: `-t`, `-imfchan`");
    warned("map_Ka c.png", "`map_Ka`");
    warned("Kd spectral a.rfl 2", "m.mtl:2:1: `spectral` colours are not supported");
}

#[test]
fn values_that_make_no_sense_are_errors() {
    let text = format!("{HEAD}{OBJECT}");
    let model = format!("{VERTICES}usemtl a\nf 1 2 3\n");
    let error = |library: &[u8]| {
        memory(&text, &[("m.obj", model.as_bytes()), ("m.mtl", library)]).expect_err("it is broken").to_string()
    };
    assert!(error(b"newmtl a\nKe x").starts_with("m.mtl:2:4: `x` is not a number"), "{}", error(b"newmtl a\nKe x"));
    assert!(error(b"newmtl a\nKd -1 0 nan").starts_with("m.mtl:2:9: `nan` is not a number"));
}

/// Each value in turn, with those of all writers: what is out of range is warned about once, where it is, and clamped.
#[test]
fn values_out_of_range_are_clamped_with_a_warning() {
    for (text, warning) in [
        ("Kd -1 0 0", "`Kd` of the material `a` is [-1, 0, 0]: [0, 0, 0] is used"),
        ("Ks 0.5 -0.25 0", "`Ks` of the material `a` is [0.5, -0.25, 0]: [0.5, 0, 0] is used"),
        ("Ke 3 -1 0", "`Ke` of the material `a` is [3, -1, 0]: [3, 0, 0] is used"),
        ("Ke 3 1e16 0", "`Ke` of the material `a` is [3, 10000000000000000, 0]: [3, 1000000000000000, 0] is used"),
        ("Tr -0.5", "`Tr` of the material `a` is -0.5: 0 is used"),
        ("d 1.5", "`d` of the material `a` is 1.5: 1 is used"),
        ("Kd 0.3 0.2", "`Kd` has 2 numbers instead of 1 or 3: 0.3 is used for blue as well"),
        ("Ke 0.3 0.2", "`Ke` has 2 numbers instead of 1 or 3: 0.3 is used for blue as well"),
        ("Kd 0\nillum 4\nPr -1", "`Pr` of the material `a` is -1: 0 is used"),
        ("Kd 2 1 -1\nPr 0.5", "`Kd` of the material `a` is [2, 1, -1]: [2, 1, 0] is used"),
    ] {
        let (scene, warnings) = library(text);
        assert_eq!(scene.validate(), []);
        let found = warnings.iter().filter(|found| found.ends_with(warning)).count();
        assert_eq!(found, 1, "{text}: {warnings:?}");
        let line = 2 + text.lines().count() - 1;
        assert!(warnings[0].starts_with(&format!("m.mtl:{line}:1: ")) || text.contains("Pr 0"), "{warnings:?}");
    }
    assert_eq!(
        scattering("Kd 0.2 0.1 0.3\nd 1\nTr 0"),
        Scattering::Lambert { albedo: Vec3::new(0.2, 0.1, 0.3).into() }
    );
    let (scene, warnings) = of_blender("Kd 1.5 0 0\nKs -1\nNs 2000\nTf -1\nKa 7\nNi 1.5\nillum 3");
    assert_eq!((scene.validate().len(), warnings.len()), (0, 5), "{warnings:?}");
}

/// Whatever the numbers of a statement, a library makes a scene that can be rendered.
#[test]
fn no_number_refuses_a_scene() {
    let numbers = ["-1e99", "-3e38", "-1", "-0", "1e-40", "0.5", "2", "1e15", "3e38", "1e400"];
    let keywords = ["Kd", "Ks", "Ke", "Ka", "Ns", "Ni", "d", "Tr", "Tf", "Pr", "Pm", "illum", "Kd xyz", "Ke xyz"];
    for (i, number) in numbers.iter().enumerate() {
        for keyword in keywords {
            let values = format!("{keyword} {number} {} {number}", numbers[(i + 3) % numbers.len()]);
            for rest in ["", "illum 5\nKd 0\n", "illum 7\nKd 0\n", "Pm 0.5\n"] {
                assert_eq!(library(&format!("{rest}{values}")).0.validate(), [], "{rest}{values}");
            }
            assert_eq!(of_blender(&format!("illum 3\nTf 0.5\n{values}")).0.validate(), [], "{values}");
        }
    }
}

#[test]
fn more_than_all_light_is_scaled_down_with_a_warning() {
    let half = Vec3::splat(0.5);
    let (made, warning) = only_warning("Kd 1 1 1\nKs 1 1 1\nNs 7");
    assert_eq!(made, Scattering::Phong { diffuse: half.into(), specular: half.into(), exponent: 7.0 });
    assert!(warning.starts_with("m.mtl:3:1: `Kd` and `Ks` together are 2.0000 in the material `a`"), "{warning}");
    assert!(warning.ends_with("multiplied by 0.5000"), "{warning}");
    let (made, warning) = only_warning("Kd 2 1 0");
    assert_eq!(made, Scattering::Lambert { albedo: Vec3::new(1.0, 0.5, 0.0).into() });
    assert!(warning.contains("`Kd` is 2.0000"), "{warning}");
    let (made, _) = only_warning("Kd 0 0 0\nKs 2 2 2\nillum 5");
    assert_eq!(made, Scattering::Mirror { reflectance: Vec3::ONE.into() });
}

#[test]
fn illumination_models_decide_about_highlights() {
    let matt = Scattering::Lambert { albedo: Vec3::splat(0.5).into() };
    for model in ["0", "1", "1 # flat"] {
        assert_eq!(scattering(&format!("Kd 0.5\nKs 0.5\nNs 10\nillum {model}")), matt);
    }
    for model in ["2", "8", "9", "10"] {
        let made = scattering(&format!("Kd 0.5\nKs 0.5\nNs 10\nillum {model}"));
        assert!(matches!(made, Scattering::Phong { exponent: 10.0, .. }), "{model}: {made:?}");
    }
}

/// Every form that the format allows, and what exporters write beside it: none of it refuses a scene.
#[test]
fn no_legal_value_refuses_a_scene() {
    let glass = "Kd 0 0 0\nKs 0.5\nillum";
    for (text, count) in [
        (format!("{glass} 4\nTf 1 1 1\nNi 1.00"), 1),
        (format!("{glass} 6\nNi 0"), 1),
        (format!("{glass} 7\nNi 10\nTf 2 0 0"), 2),
        (format!("{glass} 9\nNi 0.001"), 1),
        ("d -halo 1.0".to_owned(), 1),
        ("d -halo 0.7".to_owned(), 2),
        ("d 1.5\nTr 0".to_owned(), 1),
        ("Kd 0.2\nKs 0.2\nNs -5".to_owned(), 1),
        ("Kd 0.2\nKs 0.2\nNs 1e7".to_owned(), 1),
        ("Kd xyz 0.2 0.3 0.1\nKs xyz 0.1\nTf spectral x.rfl\nsharpness 60\nmap_aat on".to_owned(), 0),
        ("Tf xyz 0.5\nillum 0\nKa 1".to_owned(), 0),
        ("refl -type sphere -mm 0 1 c.png\ndisp -s 1 1 1 c.png\ndecal c.png".to_owned(), 1),
        ("Pr 2\nPm -1".to_owned(), 2),
        ("Ks spectral x.rfl\nKd 0.5".to_owned(), 1),
    ] {
        let (_, warnings) = library(&text);
        assert_eq!(warnings.len(), count, "{text}: {warnings:?}");
    }
    let (black, warning) = only_warning(&format!("{glass} 4\nTf 1 1 1\nNi 1.00"));
    assert_eq!(black, Scattering::Lambert { albedo: Vec3::ZERO.into() });
    assert!(warning.contains("glass of index 1 refracts nothing"), "{warning}");
}

/// The material `a` of a file of Blender.
fn of_blender(text: &str) -> (PhysicalScene, Vec<String>) {
    let model = format!("{VERTICES}usemtl a\nf 1 2 3\n");
    let library = format!("# Blender 5.2.3 LTS MTL File: 'None'\n# www.blender.org\n\nnewmtl a\n{text}");
    let image = opaque_png([255, 0, 0]);
    let files: [(&str, &[u8]); 3] = [("m.obj", model.as_bytes()), ("m.mtl", library.as_bytes()), ("c.png", &image)];
    let imported = memory(&format!("{HEAD}{OBJECT}"), &files).unwrap_or_else(|error| panic!("{text}\n{error}"));
    assert_eq!(imported.scene.validate(), []);
    let warnings = imported.warnings.iter().map(ToString::to_string);
    (imported.scene, warnings.filter(|warning| !warning.contains("the scene has no")).collect())
}

fn principled(text: &str) -> Scattering {
    let (scene, warnings) = of_blender(text);
    assert_eq!(warnings, [""; 0], "{text}");
    scene.materials.last().expect("there is one").scattering.clone()
}

#[test]
fn blender_means_its_principled_material() {
    let red = Vec3::new(0.8, 0.1, 0.1);
    let base = "Kd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.5\nd 1\n";
    let expected = Scattering::Plastic { albedo: red.into(), ior: 1.5, roughness: 0.5 };
    for text in ["Ka 1 1 1\nNs 250\nillum 2", "illum 2\nPr 0.5\nPm 0\nPs 0\nPc 0\nPcr 0.03\naniso 0\nanisor 0"] {
        let made = principled(&format!("{base}{text}"));
        let Scattering::Plastic { ior, roughness, albedo } = &made else { panic!("{made:?}") };
        assert!(
            (ior - 1.5).abs() < 1e-4 && (roughness - 0.5).abs() < 1e-4 && albedo.color == red,
            "{expected:?} {made:?}"
        );
    }
    // Roughness 0.3 is Ns 490.
    for text in ["Ka 1 1 1\nNs 490\nillum 3", "illum 3\nPr 0.3\nPm 1"] {
        let made = principled(&format!("{base}{text}"));
        let Scattering::Conductor { eta, k, roughness } = made else { panic!("{made:?}") };
        let reflectance = ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
        assert!((reflectance - red).abs().max_element() < 1e-4 && (roughness - 0.3).abs() < 1e-4, "{reflectance}");
    }
    let lambert = Scattering::Lambert { albedo: red.into() };
    assert_eq!(principled("Kd 0.8 0.1 0.1\nKs 0 0 0\nNi 1.5\nillum 1\nNs 0"), lambert);
    assert_eq!(principled("Kd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nNi 1\nillum 2\nNs 360"), lambert);
    // Specular level 1 doubles the reflectance at normal incidence: 0.08.
    let made = principled("Kd 0.8\nKs 1\nNi 1.5\nNs 250\nillum 2");
    assert!(
        matches!(made, Scattering::Plastic { ior, .. } if (((ior - 1.0) / (ior + 1.0)).powi(2) - 0.08).abs() < 1e-5)
    );
    // Partly metallic is partly so.
    assert!(matches!(principled(&format!("{base}illum 3\nPr 0.3\nPm 0.25")), Scattering::Mix { weight: 0.25, .. }));
    assert!(matches!(
        principled(&format!("{base}illum 3\nKa 0.5 0.5 0.5\nNs 490")),
        Scattering::Mix { weight: 0.5, .. }
    ));
    // Light that comes through twice is tinted once.
    let glass = principled("Kd 0.81 0.64 1\nKs 0.5\nNi 1.45\nPr 0\nPm 0\nTf 1 1 1\nillum 2");
    let transmittance = Vec3::new(0.9, 0.8, 1.0);
    assert!(
        matches!(glass, Scattering::Dielectric { ior: 1.45, roughness: 0.0, transmittance: t } if (t - transmittance).length() < 1e-6)
    );
}

#[test]
fn blender_writes_maps_emitters_and_alpha_its_own_way() {
    let (scene, warnings) =
        of_blender("Ks 0.5\nKe 5 2.5 1.25\nNi 1.5\nNs 250\nillum 2\nmap_Kd c.png\nmap_Bump -bm 1.000000 c.png");
    assert_eq!(warnings, [""; 0]);
    let made = &scene.materials[0];
    assert!(
        matches!(&made.scattering, Scattering::Plastic { albedo, .. } if albedo.color == Vec3::ONE && albedo.image.is_some())
    );
    assert!(made.normal_map.is_some() && made.emission.is_some_and(|e| e.two_sided && e.radiance.x == 5.0));
    let (scene, warnings) = of_blender("Kd 0.8\nKs 0.5\nNi 1.5\nd 0.4\nillum 9\nNs 250");
    assert!(scene.materials[0].alpha.is_some() && warnings.len() == 1, "{warnings:?}");
    let (scene, _) = of_blender("Ks 0.5\nNi 1.5\nillum 3\nPr 0\nPm 1\nmap_Kd c.png");
    assert!(
        matches!(&scene.materials[0].scattering, Scattering::Mirror { reflectance } if reflectance.image.is_some())
    );
    let (scene, _) = of_blender("Ks 0.5\nNi 1.5\nillum 3\nPr 0.5\nPm 1\nmap_Kd c.png");
    assert!(matches!(&scene.materials[0].scattering, Scattering::Phong { exponent: 30.0, .. }));
}

#[test]
fn roughness_and_metalness_are_understood_of_every_writer() {
    let made = scattering("Kd 0.5\nPr 0.2\nPm 0\nKs 0.9");
    let Scattering::Plastic { ior, roughness: 0.2, .. } = made else { panic!("{made:?}") };
    assert!((ior - 1.5).abs() < 1e-5);
    assert!(matches!(scattering("Kd 0.5\nPm 1"), Scattering::Conductor { roughness: 0.5, .. }));
    // Glass stays what the format says.
    assert!(matches!(
        scattering("Kd 0\nillum 7\nNi 1.3\nPr 0.1"),
        Scattering::Dielectric { ior: 1.3, roughness: 0.1, .. }
    ));
}

/// The scene of a model, and its warnings.
fn model(text: &str, files: &[(&str, &[u8])]) -> (PhysicalScene, Vec<String>) {
    let all: Vec<(&str, &[u8])> = [("m.obj", text.as_bytes())].into_iter().chain(files.iter().copied()).collect();
    let imported = memory(&format!("{HEAD}{OBJECT}"), &all).unwrap_or_else(|error| panic!("{text}\n{error}"));
    let warnings = imported.warnings.iter().map(ToString::to_string);
    (imported.scene, warnings.filter(|warning| !warning.contains("the scene has no")).collect())
}

#[test]
fn libraries_and_materials_that_are_nowhere_leave_grey_faces() {
    let body = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let (scene, warnings) = model(&format!("mtllib none.mtl\n{body}usemtl a\nf 1 2 3\n"), &[]);
    assert_eq!(scene.materials[0].scattering, Scattering::default());
    assert!(
        warnings[0].contains("m.obj:1:1: the material library `none.mtl` was not found; searched none.mtl"),
        "{warnings:?}"
    );
    assert!(
        warnings[1].contains("m.obj:5:1: the material `a` is not defined; its faces are diffuse grey"),
        "{warnings:?}"
    );
    assert_eq!(warnings.len(), 2);
    let (_, warnings) = model(&format!("mtllib m.mtl\n{body}usemtl a\nf 1 2 3\n"), &[("m.mtl", b"newmtl b")]);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    // A library alone, and neither.
    assert_eq!(model(&format!("mtllib none.mtl\n{body}f 1 2 3\n"), &[]).1.len(), 1);
    // One that is not used either: the object has a material of its own.
    let own = format!("{HEAD}{CLAY}{OBJECT}material = \"clay\"\n");
    let text = format!("mtllib none.mtl\n{body}usemtl a\nf 1 2 3\n");
    let files = [("m.obj", text.as_bytes())];
    let warnings: Vec<String> = memory(&own, &files).unwrap().warnings.iter().map(ToString::to_string).collect();
    let unused =
        "m.obj:1:1: the material library `none.mtl` was not found; searched none.mtl; none of its materials is used";
    assert!(warnings.iter().any(|warning| warning.contains(unused)), "{warnings:?}");
    let plain = format!("{body}f 1 2 3\n");
    let error = memory(&format!("{HEAD}{OBJECT}"), &[("m.obj", plain.as_bytes())]).expect_err("it has none");
    assert!(error.to_string().contains("`material` is missing, and the model has none of its own"), "{error}");
}

#[test]
fn warnings_are_not_lost_to_errors() {
    let text = format!("{HEAD}{OBJECT}[[object]]\ntype = \"cone\"\n");
    let files: [(&str, &[u8]); 1] = [("m.obj", b"mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n")];
    let error = memory(&text, &files).expect_err("there are no cones");
    let warnings: Vec<String> = error.warnings().iter().map(ToString::to_string).collect();
    assert!(warnings.iter().any(|warning| warning.contains("`none.mtl` was not found")), "{warnings:?}");
}

#[test]
fn maps_that_are_scaled_and_shifted_move_texture_coordinates() {
    let body = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\n";
    let image = opaque_png([1, 2, 3]);
    let library = b"newmtl a\nmap_Kd -s 2 3 1 -o 0.5 0 0 c.png\nmap_Ke -s 2 3 1 -o 0.5 c.png\nnewmtl b\nmap_Kd c.png\n";
    let (scene, warnings) = model(body, &[("m.mtl", library), ("c.png", &image)]);
    assert_eq!(warnings, [""; 0]);
    let shape = scene.objects[0].shape;
    let lightcuts_scene::physical::PhysicalShape::Mesh { mesh, .. } = shape else { panic!("{shape:?}") };
    let placed = |mesh: usize, triangle: usize| {
        let mesh = &scene.meshes[mesh];
        mesh.triangles[triangle].texture_coordinates.expect("it has some").map(|i| mesh.texture_coordinates[i as usize])
    };
    let as_written = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(placed(mesh.0 as usize, 0), [[0.5, 0.0], [2.5, 0.0], [0.5, 3.0]]);
    assert_eq!(placed(mesh.0 as usize, 1), as_written);
    // What an object with a material of its own sees stays as it was.
    assert_eq!((mesh.0, placed(0, 0)), (1, as_written));
    let differing = b"newmtl a\nmap_Kd -s 2 2 2 c.png\nmap_Ke c.png\nnewmtl b\n";
    let (_, warnings) = model(body, &[("m.mtl", differing), ("c.png", &image)]);
    assert!(warnings.len() == 1 && warnings[0].contains("`-s` and `-o` differ from those of `map_Kd`"), "{warnings:?}");
}

#[test]
fn no_damage_ends_the_program() {
    let model = "mtllib m.mtl\nv 0 0 0\nv 2 1 0\nv 0 2 0 1 0 0\nv 0.5 1 0 # in\nvt 0 0\nvt 1 0\ns 1\nusemtl a\nf 1/1 2/2 \\\n 3/1 4/2\nl 1\n";
    let library = "# Blender 5 MTL File\nnewmtl a\nKd .8 .1 .1\nKs .5\nNs 250\nNi 1.5\nd -halo .9\nPr .5\nPm .2\nTf 1\nillum 3\nmap_Kd -s 2 2 -o 1 c.png\n";
    let (text, image) = (format!("{HEAD}{OBJECT}"), opaque_png([1, 2, 3]));
    let parse = |model: &[u8], library: &[u8]| {
        if let Ok(imported) = memory(&text, &[("m.obj", model), ("m.mtl", library), ("c.png", &image)]) {
            assert_eq!(imported.scene.validate(), []);
        }
    };
    for i in 0..model.len().max(library.len()) {
        for byte in [b'0', b' ', b'-', b'#', b'\\', b'\n', b'9', 0xff] {
            let [mut broken_model, mut broken_library] = [model, library].map(|text| text.as_bytes().to_vec());
            for text in [&mut broken_model, &mut broken_library] {
                if let Some(place) = text.get_mut(i) {
                    *place = byte;
                }
            }
            parse(&broken_model, library.as_bytes());
            parse(model.as_bytes(), &broken_library);
        }
    }
}
