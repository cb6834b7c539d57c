//! Scenes of the physical model from end to end.

mod geometry;
mod libraries;
mod malformed;
mod models;
mod schema;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use lightcuts_import::{
    AnyScene, ImportError, ImportOptions, Imported, Limits, MemoryResolver, load, load_any, parse_physical,
};
use lightcuts_scene::physical::{
    EmitterKind, ImageId, PhysicalScene, PhysicalShape, Pixels, Scattering, SurfaceDesc, SurfaceId, View,
};
use std::f32::consts::PI;
use std::fs;
use std::path::Path;

/// The start of every scene here: six lines.
const HEAD: &str = "format = \"lightcuts-scene\"\nversion = 1\n[camera]\nposition = [0, 1, 5]\ntarget = [0, 1, 0]\n\n";

fn memory(text: &str, files: &[(&str, &[u8])]) -> Result<Imported<PhysicalScene>, ImportError> {
    let mut resolver = MemoryResolver::default();
    resolver.files.extend(files.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec())));
    parse_physical(text, "folder/test.toml", &resolver, &Limits::default())
}

/// A scene without warnings other than about what it lacks.
fn scene(body: &str, files: &[(&str, &[u8])]) -> PhysicalScene {
    let imported = memory(&format!("{HEAD}{body}"), files).unwrap_or_else(|error| panic!("{body}\n{error}"));
    let odd: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
    let odd: Vec<&String> = odd.iter().filter(|warning| !warning.contains("the scene has no")).collect();
    assert!(odd.is_empty(), "{body}\n{odd:?}");
    assert_eq!(imported.scene.validate(), []);
    imported.scene
}

fn material(body: &str) -> SurfaceDesc {
    scene(&format!("[[material]]\nname = \"m\"\n{body}"), &[]).materials.remove(0)
}

fn png(texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_raw(texels.len() as u32, 1, texels.concat()).expect("the length is right");
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("an image in memory can be encoded");
    bytes.into_inner()
}

fn opaque_png(texel: [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_pixel(1, 1, image::Rgb(texel));
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("an image in memory can be encoded");
    bytes.into_inner()
}

fn pfm(values: [f32; 3]) -> Vec<u8> {
    [b"PF\n1 1\n-1\n".to_vec(), values.iter().flat_map(|value| value.to_le_bytes()).collect()].concat()
}

#[test]
fn the_camera_has_defaults_for_all_but_where_it_looks() {
    let camera = scene("", &[]).camera;
    assert_eq!((camera.position, camera.direction, camera.up), (DVec3::new(0.0, 1.0, 5.0), Vec3::Z * -5.0, Vec3::Y));
    assert_eq!(camera.view, View::Perspective { degrees: 40.0 });
    assert_eq!((camera.near, camera.lens_radius, camera.focus_distance), (0.0, 0.0, 5.0));
    let start = "format = \"lightcuts-scene\"\nversion = 1\nname = \"n\"\n[camera]\nposition = [1, 0, 0]\n";
    let text = format!(
        "{start}direction = [0, 0, -2]\nup = [1, 1, 0]\nheight = 3\nnear = 0.5\nlens-radius = 0.1\nfocus = [5, 5, -7]"
    );
    let imported = memory(&text, &[]).expect("it is sound");
    let camera = imported.scene.camera;
    assert_eq!((imported.scene.name.as_str(), camera.view), ("n", View::Orthographic { height: 3.0 }));
    assert_eq!((camera.near, camera.lens_radius, camera.focus_distance), (0.5, 0.1, 7.0));
    let imported = memory(&format!("{start}direction = [0, 0, -2]\nfov = 60\n"), &[]).expect("it is sound");
    assert_eq!(imported.scene.camera.focus_distance, 1.0);
    assert_eq!(imported.scene.camera.view, View::Perspective { degrees: 60.0 });
    let imported = memory(&format!("{start}target = [1, 0, -2]\nfocus-distance = 9\n"), &[]).expect("it is sound");
    assert_eq!(imported.scene.camera.focus_distance, 9.0);
    assert_eq!(scene("", &[]).name, "test");
}

#[test]
fn every_material_is_read() {
    let grey = Vec3::splat(0.5).into();
    assert_eq!(material("type = \"lambert\"").scattering, Scattering::Lambert { albedo: grey });
    assert_eq!(
        material("type = \"phong\"\ndiffuse = 0.5\nspecular = [0.1, 0.2, 0.5]\nexponent = 20").scattering,
        Scattering::Phong { diffuse: grey, specular: Vec3::new(0.1, 0.2, 0.5).into(), exponent: 20.0 }
    );
    assert_eq!(
        material("type = \"conductor\"\neta = [1, 2, 3]\nk = [4, 5, 6]\nroughness = 0.25").scattering,
        Scattering::Conductor { eta: Vec3::new(1.0, 2.0, 3.0), k: Vec3::new(4.0, 5.0, 6.0), roughness: 0.25 }
    );
    let gold = material("type = \"conductor\"\nmetal = \"gold\"").scattering;
    assert!(matches!(gold, Scattering::Conductor { eta, roughness: 0.0, .. } if eta.x == 0.18299), "{gold:?}");
    let bright = material("type = \"conductor\"\nreflectance = 1").scattering;
    assert!(matches!(bright, Scattering::Conductor { eta: Vec3::ONE, .. }), "{bright:?}");
    assert_eq!(
        material("type = \"dielectric\"").scattering,
        Scattering::Dielectric { ior: 1.5, roughness: 0.0, transmittance: Vec3::ONE }
    );
    assert_eq!(
        material("type = \"dielectric\"\nior = 1.33\nroughness = 0.5\ntransmittance = [0.9, 1, 1]").scattering,
        Scattering::Dielectric { ior: 1.33, roughness: 0.5, transmittance: Vec3::new(0.9, 1.0, 1.0) }
    );
    assert_eq!(
        material("type = \"plastic\"").scattering,
        Scattering::Plastic { albedo: grey, ior: 1.5, roughness: 0.1 }
    );
    assert_eq!(material("type = \"mirror\"").scattering, Scattering::Mirror { reflectance: Vec3::ONE.into() });
    let mixed = scene(
        "[[material]]\nname = \"m\"\ntype = \"mix\"\nfirst = \"b\"\nsecond = \"a\"\nweight = 0.25\n\
         [[material]]\nname = \"a\"\ntype = \"mirror\"\n[[material]]\nname = \"b\"\ntype = \"lambert\"\n",
        &[],
    );
    let (first, second) = (SurfaceId(2), SurfaceId(1));
    assert_eq!(mixed.materials[0].scattering, Scattering::Mix { first, second, weight: 0.25, image: None });
}

#[test]
fn emission_has_three_spellings() {
    let emission = |text: &str| material(&format!("type = \"lambert\"\nemission = {text}")).emission;
    assert_eq!(emission("2").map(|e| (e.radiance, e.two_sided)), Some((Vec3::splat(2.0), false)));
    assert_eq!(emission("[1, 2, 3]").map(|e| e.radiance), Some(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(emission("{ radiance = 4, two-sided = true }").map(|e| (e.radiance.x, e.two_sided)), Some((4.0, true)));
    assert_eq!(emission("0"), None);
}

#[test]
fn images_are_read_once_per_meaning() {
    let body = "[environment]\nimage = \"sky.pfm\"\nradiance = 2\nrotate = 90\n\
        [[material]]\nname = \"a\"\ntype = \"lambert\"\nalbedo = \"c.png\"\nnormal-map = \"c.png\"\nalpha = \"mask.png\"\n\
        emission = { image = \"sky.pfm\" }\n\
        [[material]]\nname = \"b\"\ntype = \"plastic\"\nalbedo = { image = \"c.png\", factor = [1, 0.5, 0] }\n\
        alpha = { image = \"c.png\", threshold = 0.25 }\n\
        [[material]]\nname = \"m\"\ntype = \"mix\"\nfirst = \"a\"\nsecond = \"b\"\nweight = { image = \"c.png\", factor = 0.5 }\n";
    let (color, mask, sky) = (opaque_png([10, 20, 30]), png(&[[1, 2, 3, 4]]), pfm([0.5, 2.0, -0.001]));
    let files: [(&str, &[u8]); 3] = [("c.png", &color), ("mask.png", &mask), ("sky.pfm", &sky)];
    let made = scene(body, &files);
    let pixels: Vec<&Pixels> = made.images.iter().map(|image| &image.pixels).collect();
    let expected = [
        Pixels::Srgb(vec![[10, 20, 30, 255]]),
        Pixels::Float(vec![[0.5, 2.0, 0.0]]),
        Pixels::Linear(vec![[10, 20, 30, 10]]),
        Pixels::Linear(vec![[1, 2, 3, 4]]),
    ];
    assert_eq!(pixels, expected.iter().collect::<Vec<_>>());
    assert_eq!(made.images[0].name, "c.png");
    let [a, b, m] = &made.materials[..] else { panic!("there are three") };
    assert!(
        matches!(&a.scattering, Scattering::Lambert { albedo } if albedo.image == Some(ImageId(0)) && albedo.color == Vec3::ONE)
    );
    assert_eq!((a.normal_map, a.alpha.map(|alpha| alpha.image.0)), (Some(ImageId(2)), Some(3)));
    assert_eq!(a.emission.map(|e| (e.radiance, e.image)), Some((Vec3::ONE, Some(ImageId(1)))));
    assert!(matches!(&b.scattering, Scattering::Plastic { albedo, .. } if albedo.color == Vec3::new(1.0, 0.5, 0.0)));
    assert_eq!(b.alpha.map(|alpha| (alpha.image.0, alpha.threshold)), Some((2, 0.25)));
    assert!(matches!(m.scattering, Scattering::Mix { weight: 0.5, image: Some(ImageId(2)), .. }));
    let environment = made.environment.expect("it has one");
    assert_eq!(
        (environment.image, environment.radiance, environment.degrees),
        (Some(ImageId(1)), Vec3::splat(2.0), 90.0)
    );
    let imported = memory(&format!("{HEAD}{body}"), &files).expect("it is sound");
    let names: Vec<String> = imported.files.iter().map(|path| path.display().to_string()).collect();
    assert_eq!(names, ["c.png", "sky.pfm", "mask.png"]);
}

#[test]
fn images_brighter_than_surfaces_can_show_are_told() {
    let body = "[[material]]\nname = \"a\"\ntype = \"lambert\"\nemission = { image = \"lamp.pfm\" }\n\
        [environment]\nimage = \"lamp.pfm\"\n";
    let warned = |value: f32| {
        let file = pfm([1.0, value, 0.0]);
        let imported = memory(&format!("{HEAD}{body}"), &[("lamp.pfm", &file)]).expect("it is sound");
        imported.warnings.iter().any(|warning| warning.to_string().contains("holds values above 65504"))
    };
    assert!(!warned(65504.0) && warned(65536.0) && warned(1e15));
    let error =
        memory(&format!("{HEAD}{body}"), &[("lamp.pfm", &pfm([1.0, 1e16, 0.0]))]).expect_err("it is too bright");
    assert!(error.to_string().contains("expected finite numbers of at most 1e15"), "{error}");
}

#[test]
fn every_light_is_read() {
    let made = scene(
        "[[light]]\ntype = \"point\"\nposition = [1, 2, 3]\nintensity = [4, 5, 6]\n\
         [[light]]\ntype = \"point\"\nposition = [1, 2, 3]\npower = 100\n\
         [[light]]\ntype = \"spot\"\nposition = [1, 2, 3]\ntarget = [1, 0, 3]\nintensity = 1\ninner = 10\nouter = 20\n\
         [[light]]\ntype = \"directional\"\ndirection = [0, -1, 0]\nirradiance = 3\n\
         [[light]]\ntype = \"rectangle\"\ncenter = [0, 2, 0]\nnormal = [0, -1, 0]\nhead = [1, 0, 0]\nwidth = 2\nheight = 3\n\
         radiance = [7, 8, 9]\n\
         [[light]]\ntype = \"rectangle\"\ncenter = [0, 2, 0]\nnormal = [0, -1, 0]\nhead = [1, 0, 0]\nwidth = 2\nheight = 3\n\
         power = 60\ntwo-sided = true\n\
         [[light]]\ntype = \"sphere\"\ncenter = [0, 2, 0]\nradius = 0.5\npower = 10\n",
        &[],
    );
    let kinds: Vec<EmitterKind> = made.lights.iter().map(|light| light.kind).collect();
    let position = DVec3::new(1.0, 2.0, 3.0);
    assert_eq!(kinds[0], EmitterKind::Point { position, intensity: Vec3::new(4.0, 5.0, 6.0) });
    let EmitterKind::Point { intensity, .. } = kinds[1] else { panic!("a point") };
    assert!((intensity.x * 4.0 * PI - 100.0).abs() < 1e-4);
    let (direction, intensity) = (Vec3::new(0.0, -2.0, 0.0), Vec3::ONE);
    assert_eq!(
        kinds[2],
        EmitterKind::Spot { position, direction, intensity, inner_degrees: 10.0, outer_degrees: 20.0 }
    );
    assert_eq!(kinds[3], EmitterKind::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(3.0) });
    let emission = |i: usize| made.materials[made.objects[i].material.0 as usize].emission.expect("it shines");
    assert_eq!((emission(0).radiance, emission(0).two_sided), (Vec3::new(7.0, 8.0, 9.0), false));
    // Power is what leaves: pi times radiance and area, on both sides.
    assert!((emission(1).radiance.x * PI * 6.0 * 2.0 - 60.0).abs() < 1e-4 && emission(1).two_sided);
    assert!((emission(2).radiance.x * PI * 4.0 * PI * 0.25 - 10.0).abs() < 1e-5);
    assert_eq!(made.materials[0].scattering, Scattering::Lambert { albedo: Vec3::ZERO.into() });
    assert_eq!((made.lights[3].location.line, made.lights[3].location.column), (22, 1));
}

const CLAY: &str = "[[material]]\nname = \"clay\"\ntype = \"lambert\"\n";

#[test]
fn every_object_is_read() {
    let made = scene(
        &format!(
            "{CLAY}[[object]]\ntype = \"sphere\"\nmaterial = \"clay\"\ncenter = [1, 2, 3]\nradius = 4\nname = \"ball\"\n\
             [[object]]\ntype = \"rectangle\"\nmaterial = \"clay\"\ncenter = [1, 2, 3]\nnormal = [0, 1, 0]\n\
             head = [0, 0, 1]\nwidth = 5\nheight = 6\n"
        ),
        &[],
    );
    let center = DVec3::new(1.0, 2.0, 3.0);
    assert_eq!(made.objects[0].shape, PhysicalShape::Sphere { center, radius: 4.0 });
    let (normal, head) = (Vec3::Y, Vec3::Z);
    assert_eq!(made.objects[1].shape, PhysicalShape::Rectangle { center, normal, head, width: 5.0, height: 6.0 });
    assert_eq!((made.objects[0].name.as_str(), made.objects[0].location.line), ("ball", 10));
}

/// The placement of the one object.
fn placed(made: &PhysicalScene, i: usize) -> DAffine3 {
    let PhysicalShape::Mesh { placement, .. } = made.objects[i].shape else { panic!("a mesh") };
    placement
}

#[test]
fn objects_are_scaled_turned_and_moved() {
    let object = "[[object]]\ntype = \"mesh\"\nmesh = \"t\"\nmaterial = \"clay\"\n";
    let body = format!(
        "{CLAY}[[mesh]]\nname = \"t\"\nfile = \"t.obj\"\n{object}scale = [1, 2, 3]\n\
         rotate = [{{ axis = [0, 0, 2], degrees = 90 }}, {{ axis = [1, 0, 0], degrees = 90 }}]\ntranslate = [10, 20, 30]\n\
         {object}smooth = false\nscale = 2\nrotate = {{ axis = [0, 1, 0], degrees = 90 }}\n\
         {object}matrix = [[1, 0, 0, 4], [0, 0, -1, 5], [0, 1, 0, 6], [0, 0, 0, 1]]\n{object}"
    );
    let made = scene(&body, &[("t.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")]);
    let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-5, "{a} {b}");
    // x is scaled by 1, turned to y and then to z.
    near(placed(&made, 0).transform_point3(DVec3::X), DVec3::new(10.0, 20.0, 31.0));
    near(placed(&made, 0).transform_point3(DVec3::Y), DVec3::new(8.0, 20.0, 30.0));
    near(placed(&made, 1).transform_point3(DVec3::X), DVec3::new(0.0, 0.0, -2.0));
    near(placed(&made, 2).transform_point3(DVec3::Y), DVec3::new(4.0, 5.0, 7.0));
    assert_eq!(placed(&made, 3), DAffine3::IDENTITY);
    assert_eq!((made.meshes.len(), made.objects.len()), (1, 4));
    assert!(matches!(made.objects[1].shape, PhysicalShape::Mesh { smooth: false, override_material: true, .. }));
}

#[test]
fn boxes_are_placed_cubes() {
    let body = format!(
        "{CLAY}[[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [1, 0, 0]\nsize = [2, 4, 6]\n\
         [[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [1, 0, 0]\nsize = [2, 4, 6]\ntranslate = [0, 1, 0]\n\
         rotate = {{ axis = [0, 0, 1], degrees = 90 }}\n"
    );
    let made = scene(&body, &[]);
    assert_eq!((made.meshes.len(), made.meshes[0].triangles.len()), (1, 12));
    let corner = DVec3::splat(0.5);
    assert_eq!(placed(&made, 0).transform_point3(corner), DVec3::new(2.0, 2.0, 3.0));
    let turned = DQuat::from_rotation_z(f64::from(PI) / 2.0) * DVec3::new(2.0, 2.0, 3.0) + DVec3::Y;
    assert!((placed(&made, 1).transform_point3(corner) - turned).length() < 1e-5);
}

#[test]
fn files_are_told_apart_by_extension() {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).expect("the directory is writable");
        path
    };
    let (toml, thesis) = (write("a.toml", HEAD), write("a.txt", "C|ORTHO|C{0,0,9}|V{0,0,-1}|U{0,1,0}"));
    let (job, odd) = (write("job.toml", "scene = \"a.txt\"\n"), write("b.TOML", "format ="));
    let any = |path: &Path| load_any(path, &ImportOptions::default());
    let imported = any(&toml).expect("it is sound");
    assert_eq!(imported.files, std::slice::from_ref(&toml));
    assert!(matches!(imported.scene, AnyScene::Physical(scene) if scene.name == "a"));
    assert!(matches!(any(&thesis).expect("it is sound").scene, AnyScene::Thesis(scene) if scene.name == "a"));
    let error = any(&job).expect_err("a job is no scene").to_string();
    assert!(error.contains("job.toml:1:1: this is not a scene: the key `format` is missing"), "{error}");
    assert!(any(&odd).expect_err("it is broken").to_string().contains("b.TOML:1:"));
    let error = load(&toml, &ImportOptions::default()).expect_err("it is of the other model").to_string();
    assert!(error.contains("a TOML file, which holds a job or a scene of the physical model"), "{error}");
    let error = any(Path::new("nowhere.toml")).expect_err("it is not there").to_string();
    assert!(error.starts_with("cannot read the scene: `nowhere.toml`"), "{error}");
}

#[test]
fn limits_are_kept() {
    let parse = |body: &str, limits: Limits| {
        let color = opaque_png([9; 3]);
        let model: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let resolver = MemoryResolver::from([("c.png", &*color), ("m.obj", model), ("n.obj", model)]);
        let text = format!("{HEAD}{body}");
        parse_physical(&text, "test.toml", &resolver, &limits).expect_err("the limit is passed").to_string()
    };
    let defaults = Limits::default;
    let error = parse(&CLAY.repeat(3), Limits { directives: 2, ..defaults() });
    assert!(error.contains("more than 2 tables"), "{error}");
    let meshes = "[[mesh]]\nname = \"a\"\nfile = \"m.obj\"\n[[mesh]]\nname = \"b\"\nfile = \"n.obj\"\n";
    let error = parse(meshes, Limits { mesh_elements: 6, ..defaults() });
    assert!(error.starts_with("n.obj:3:1: the meshes have more than 2"), "{error}");
    let textured = format!("{CLAY}albedo = \"c.png\"\n");
    let error = parse(&textured, Limits { image_bytes: 3, ..defaults() });
    assert!(error.starts_with("test.toml:10:10: the image `c.png` takes 4 bytes"), "{error}");
    let error = parse(&format!("{textured}normal-map = \"c.png\"\n"), Limits { image_bytes: 7, ..defaults() });
    assert!(error.starts_with("test.toml:11:14: the images take more than 7 bytes"), "{error}");
    let error = parse(&textured, Limits { texture_bytes: 10, ..defaults() });
    assert!(error.contains("expected at most 10"), "{error}");
}

#[test]
fn a_scene_may_be_one_long_line() {
    let start = std::time::Instant::now();
    let materials: Vec<String> =
        (0..20_000).map(|i| format!("{{ name = \"m{i}\", type = \"mirror\", reflectance = \"i.pfm\" }}")).collect();
    let object = "{ type = \"sphere\", material = \"m9\", center = [0, 0, 0], radius = 1 }, ";
    let text = format!("material = [{}]\nobject = [{}]\n", materials.join(", "), object.repeat(20_000));
    let head = HEAD.split_once("[camera]").expect("it has one");
    let text = format!("{}{text}[camera]{}", head.0, head.1);
    let made = memory(&text, &[("i.pfm", &pfm([1.0; 3]))]).expect("it is sound").scene;
    assert_eq!((made.objects.len(), made.materials.len(), made.images.len()), (20_000, 20_000, 1));
    let columns: Vec<(u32, u32)> = made.objects[..2].iter().map(|o| (o.location.line, o.location.column)).collect();
    assert_eq!(columns, [(4, 11), (4, 11 + object.len() as u32)]);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn large_garbage_ends_soon() {
    let start = std::time::Instant::now();
    let many = |line: &str, count: usize| format!("{HEAD}{}", line.repeat(count));
    let object = "[[object]]\ntype = \"sphere\"\nmaterial = \"nowhere\"\ncenter = [0, 0, 0]\nradius = 1\n";
    let named: Vec<String> =
        (0..20_000).map(|i| format!("[[material]]\nname = \"m{i}\"\ntype = \"mirror\"\n")).collect();
    for text in [
        many("[[light]]\n", 100_000),
        many("[[material]]\nname = \"a\"\n", 100_000),
        format!("{HEAD}{}{}", named.concat(), object.repeat(20_000)),
        format!("{HEAD}x = [{}]", "1, ".repeat(500_000)),
        "\"".repeat(1 << 20),
        "\u{fffd}\0[".repeat(100_000),
        format!("{HEAD}{} = 1", "a.".repeat(100_000)),
    ] {
        let error = memory(&text, &[]).expect_err("it is garbage");
        assert!((1..=20).contains(&error.faults().len()));
        assert!(error.to_string().len() < 10_000);
    }
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}
