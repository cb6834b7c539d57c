//! Scene files from end to end: equal scenes in every spelling, and a message for everything that can be wrong.

mod malformed;
mod physical;

use lightcuts_import::{
    FileResolver, ImportError, ImportOptions, Imported, Limits, MemoryResolver, load, parse_thesis,
};
use lightcuts_scene::{
    LightKind, Location, MaterialId, PerDevice, Projection, SamplerKind, SceneDesc, ShapeDesc, TextureMode,
};
use malformed::Expectation;
use std::fs;
use std::path::{Path, PathBuf};

const CAMERA: &str = "C | STRAT | PERS(10) | C{0, 0, 960} | V{0, 0, -1} | U{0, 1, 0} |\n";
const LIGHT: &str = "L | OMNI | POS{0, 100, 0} | ATTEN(1) | S{1, 1, 1} | D{1, 1, 1} | A{1, 1, 1} |\n";
const SURFACE: &str = "| FRKE{0, 0, 1, 1} | S{0, 0, 0} | D{1, 1, 1} | A{0, 0, 0} | SH(20)";

/// Material that is not part of the project; tests that need it are skipped without it.
const SHARED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");

fn memory<const N: usize>(text: &str, files: [(&str, &[u8]); N]) -> Result<Imported, ImportError> {
    parse_thesis(text, "test.txt", &MemoryResolver::from(files), &Limits::default())
}

fn scene(text: &str) -> SceneDesc {
    memory(text, []).map_or_else(|error| panic!("{text}\n{error}"), |imported| imported.scene)
}

fn warnings(imported: &Imported) -> Vec<String> {
    imported.warnings.iter().map(ToString::to_string).collect()
}

/// The scene without the places it was described at, which differ between spellings.
fn without_places(mut scene: SceneDesc) -> SceneDesc {
    scene.lights.iter_mut().for_each(|light| light.location = Location::default());
    scene.objects.iter_mut().for_each(|object| object.location = Location::default());
    scene
}

#[test]
fn every_spelling_means_the_same_scene() {
    const SPELLINGS: &[&str] = &[
        "S | BK{0.1, 0.2, 0.3} |\nC | LOW_DISC | PERS(10) | C{0, 0, 960} | V{0, 0, -1} | U{0, 1, 0} |\n\
         L | OMNI | POS{0, 100, 0} | DIR{0, -1, 0} | ATTEN(1) | S{1, 1, 1} | D{1, 1, 1} | A{1, 1, 1} |\n\
         P | SPH | FRKE{0, 0, 0.7, 1} | C{0, 0, 0}R(60) | S{0.2, 0.2, 0.2} | D{0, 0, 0} | A{0, 0, 0} | SH(20) |\n\
         P | SQU | FRKE{0, 0, 0.6, 1} | C{0, -2, 0}N{0, 1, 0}H{0, 0, 1}:W(400)H(300) | S{0, 0, 0}D{0, 0, 0}A{0, 0, 0}SH(1)\n",
        "s|bk{.1,.2,.3}\r\nc|low_disc|pers(1e1)|c{0,0,960}|v{0,0,-1}|u{0,1,0}\r\n\
         l|omni|pos{0,100,0}|atten(1)|s{1,1,1}|d{1,1,1}|a{1,1,1}\r\n\
         p|sph|frke{0,0,.7,1}|c{0,0,0}|r(60)|s{.2,.2,.2}|d{0,0,0}|a{0,0,0}|sh(20)\r\n\
         p|squ|frke{0,0,.6,1}|c{0,-2,0}|n{0,1,0}|h{0,0,1}|W400:H300|s{0,0,0}|d{0,0,0}|a{0,0,0}|sh(1)",
        "\u{feff}S BK {0.1,\n 0.2,\n0.3}\nC\tLOW_DISC PERS:10 C\n{0, 0,\n960}\n V{0, 0, -1}\n\n U{0, 1, 0}\n\
         L OMNI POS{0, 100, 0} ATTEN(1)\nS{1, 1, 1}\nD{1, 1, 1}\nA{1, 1, 1}\n\
         P SPH FRKE{0, 0,\n# a comment between\n0.7, 1}\nC{0, 0, 0}\nR(60)\n| S {0.2, 0.2, 0.2}|\nD{0, 0, 0}\nA{0, 0, 0} SH(20) |\n\
         P : SQU : FRKE{0, 0, 0.6, 1} : C{0, -2, 0}\nN{0, 1, 0}\nH{0, 0, 1}W(400)H(300)S{0, 0, 0}D{0, 0, 0}A{0, 0, 0}SH(1)",
        "  C | U{0, +1, 0} | V{0, 0, -1.0} | C{0., 0, 9.6e2} | PERS ( 10 ) | LOW_DISC\n\
         L | A{1, 1, 1} | D{1, 1, 1} | S{1, 1, 1} | ATTEN 1 | POS{0, 100, 0} | OMNI ||\n  S|BK{0.1, 0.2, 0.3}\n\
         # caf\u{e9} L | OMNI\n\
         P | SH(20) | A{0, 0, 0} | D{0, 0, 0} | S{0.2, 0.2, 0.2} | R60 | C{0, 0, 0} | FRKE{0, 0, 0.7, 1} | SPH\n\
         P | SQU | S{0, 0, 0} | D{0, 0, 0} | A{0, 0, 0} | SH1 | :H300:W400 | H{0, 0, 1} | N{0, 1, 0} | C{0, -2, 0} | FRKE{0, 0, 0.6, 1}",
        "C | LOW_DISC | PERS(10) | C{0, 0, 960} | V{0, 0, -1} | U{0, 1, 0} # not a field\nS\n|\nBK{0.1, 0.2, 0.3}\n\
         L\nOMNI\nPOS{0, 100, 0}\nATTEN(1)\nS\n{1, 1, 1}\nD{1, 1, 1}\nA{1, 1, 1}\n\
         P SPH FRKE{0, 0, 0.7, 1}C{0, 0, 0}R(60)S{0.2, 0.2, 0.2}D{0, 0, 0}A{0, 0, 0}SH(20)\n\
         P SQU FRKE{0, 0, 0.6, 1}C{0, -2, 0}N{0, 1, 0}H{0, 0, 1}W400H300S{0, 0, 0}D{0, 0, 0}A{0, 0, 0}SH1\u{1a}",
    ];
    let first = scene(SPELLINGS[0]);
    assert_eq!((first.lights.len(), first.objects.len(), first.camera.sampler), (1, 2, SamplerKind::LowDiscrepancy));
    assert!(matches!(first.objects[1].shape, ShapeDesc::Square { width: 400.0, height: 300.0, .. }));
    for text in SPELLINGS {
        let imported = memory(text, []).unwrap_or_else(|error| panic!("{text}\n{error}"));
        assert_eq!(warnings(&imported), [""; 0], "{text}");
        assert_eq!(without_places(imported.scene), without_places(first.clone()), "{text}");
    }
}

#[test]
fn every_light_camera_and_shape_is_read() {
    let colors = "| ATTEN(0.5) | S{1, 1, 1} | D{0.5, 0.5, 0.5} | A{0, 0, 0}";
    let text = format!(
        "C | BEST_CANDID | ORTHO | C{{0, 0, 9}} | V{{0, 0, -1}} | U{{0, 1, 0}}\n\
         L | DIRP | POS{{1, 2, 3}} | DIR{{0, -1, 0}} {colors}\nL | DIR | DIR{{0, -1, 0}} {colors}\n\
         L | SQU_A | C{{0, 9, 0}}N{{0, -1, 0}}H{{1, 0, 0}}:W(20)H(10):DS(2.5) {colors}\n\
         P | CUB {SURFACE} | L(1)W(2)H(3)C{{4, 5, 6}}V{{0, 1, 0}}H{{1, 0, 0}}\n"
    );
    let scene = scene(&text);
    assert_eq!((scene.camera.projection, scene.camera.sampler), (Projection::Orthographic, SamplerKind::BestCandidate));
    assert!(matches!(scene.lights[0].kind, LightKind::Hemisphere { .. }));
    assert!(matches!(scene.lights[1].kind, LightKind::Directional { .. }));
    assert_eq!(scene.lights[2].kind.subdivision(), Some((8, 4)));
    assert_eq!((scene.lights[2].attenuation, scene.lights[2].location), (0.5, Location { line: 4, column: 1 }));
    assert!(matches!(scene.objects[0].shape, ShapeDesc::Cube { length: 1.0, width: 2.0, height: 3.0, .. }));
    assert_eq!(scene.objects[0].location, Location { line: 5, column: 1 });
}

#[test]
fn run_parameters_come_from_the_comments() {
    let scene = scene(&format!("# Simple: VPL(0.0001/0.7/GPU:0.08-CPU:0.075) and LC(1*10^-6)\n{CAMERA}"));
    let vpl = scene.defaults.vpl.expect("the comment has them");
    assert_eq!((vpl.probability.cpu, vpl.attenuation), (0.0001, PerDevice { cpu: 0.075, gpu: 0.08 }));
    assert_eq!(scene.defaults.threshold, Some(PerDevice::from(1e-6)));
}

#[test]
fn errors_are_collected_and_bounded() {
    let text = format!("{CAMERA}{LIGHT}S | BK{{nan, 0, 0}}\nP | SPH\nL | OMNI\n");
    let error = memory(&text, []).expect_err("three lines are wrong");
    let lines: Vec<u32> = error.faults().iter().map(|fault| fault.location().line).collect();
    assert_eq!(lines, [3, 4, 5]);
    assert_eq!(error.to_string(), "test.txt:3:8: `nan` is not a number; expected a number such as 1, -0.5 or 1e-3");
    let many = memory(&"P | SPH |\n".repeat(100_000), []).expect_err("all lines are wrong");
    assert_eq!(many.faults().len(), 20);
    let long = memory(&format!("{CAMERA}S | BK{{{}x}}", " ".repeat(1 << 20)), []).expect_err("x is no number");
    assert_eq!(long.faults()[0].location(), Location { line: 2, column: (1 << 20) + 8 });
    assert!(format!("{:?}", miette::Report::new(long)).len() < 2000);
}

#[test]
fn the_report_shows_line_caret_and_expectation() {
    let error = memory("C | STRAT | PERS[10] |", []).expect_err("wrong brackets");
    let report = format!("{:?}", miette::Report::new(error));
    for part in ["test.txt:1:17", "C | STRAT | PERS[10] |", "unexpected `[`", "expected a field such as"] {
        assert!(report.contains(part), "{part} is not in {report}");
    }
}

#[test]
fn large_garbage_ends_soon() {
    let mut texts = vec!["S{".repeat(1 << 20), "C\n".repeat(1 << 18), "(".repeat(1 << 20), "a\n".repeat(1 << 19)];
    texts.push(format!("{CAMERA}# {}", "VPL(".repeat(1 << 18)));
    texts.push(format!("{CAMERA}O {}", "PATH:a.obj".repeat(1 << 17)));
    texts.push(format!("{CAMERA}O PATH:{}", "S{ ".repeat(1 << 18)));
    texts.push(format!("{CAMERA}{}", "X | y\n".repeat(1 << 18)));
    texts.push(format!("{CAMERA}S | {}", "W1:".repeat(1 << 18)));
    let start = std::time::Instant::now();
    let model = [b"mtllib ", "m.mtl ".repeat(1 << 16).as_bytes(), b"\n", TRIANGLE].concat();
    let library = "newmtl red\n".repeat(1 << 10);
    let mesh = format!("{CAMERA}{LIGHT}O {SURFACE} | PATH:m.obj | MAT(0)");
    assert!(memory(&mesh, [("m.obj", &model), ("m.mtl", library.as_bytes())]).is_ok());
    for text in texts {
        let outcome = memory(&text, []);
        let count = outcome.as_ref().map_or_else(|error| error.faults().len(), |imported| imported.warnings.len());
        assert!((1..=100).contains(&count), "{count} messages");
    }
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl red\nf 1 2 3\n";

#[test]
fn meshes_are_placed_and_shared() {
    let line = |fields: &str| format!("O {SURFACE} | PATH:a b.obj {fields}\n");
    let text = [
        CAMERA,
        LIGHT,
        &line(""),
        &line("| SMTH(0) | TRAN{1, 2, 3} | SCAL(2) | ROT{0, 1, 0}:-45 | MAT(1)"),
        &line("ROT{0,1,0}(30)MAT(0)"),
    ]
    .concat();
    let imported = memory(&text, [("a b.obj", TRIANGLE)]).expect("it is sound");
    assert_eq!((imported.scene.meshes.len(), imported.scene.objects.len()), (1, 3));
    assert_eq!(imported.files, [PathBuf::from("a b.obj")]);
    let ShapeDesc::Mesh { transform, smooth, override_material, .. } = imported.scene.objects[1].shape else {
        panic!("a mesh")
    };
    assert_eq!((transform.degrees, transform.scale.x, transform.translation.z), (-45.0, 2.0, 3.0));
    assert!(!smooth && override_material);
    assert!(matches!(imported.scene.objects[2].shape, ShapeDesc::Mesh { override_material: false, smooth: true, .. }));
    assert_eq!(
        warnings(&imported),
        ["a b.obj:6:1: the material `red` is not defined; its faces take the material of the O line"]
    );
}

#[test]
fn polygons_become_fans_and_indices_may_be_relative() {
    let model = b"v 0 0 0 1\nv 1 0 0\nv 1 1 0\nv 0 1 0 0.5 0.5 0.5\nvt 0\nvn 0 0 1\nf 1 2 3 4\nf -4//1 -3//1 \\\n -2//-1\nf 1/1/1 2/1/1 3/1\n\
                  f 5 6 7\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let imported =
        memory(&format!("{CAMERA}{LIGHT}O {SURFACE} | PATH:m.obj"), [("m.obj", model)]).expect("it is sound");
    let triangles = &imported.scene.meshes[0].triangles;
    let positions: Vec<[u32; 3]> = triangles.iter().map(|t| t.positions).collect();
    assert_eq!(positions, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 1, 2], [4, 5, 6]]);
    assert_eq!(triangles[2].normals, Some([0; 3]));
    assert_eq!((triangles[3].normals, triangles[3].texture_coordinates), (None, Some([0; 3])));
}

fn png(width: u32, texel: [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_pixel(width, 1, image::Rgb(texel));
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("an image in memory can be encoded");
    bytes.into_inner()
}

#[test]
fn library_materials_take_their_optics_from_the_scene() {
    let library = b"newmtl red\nKd 1 0 0\nKs 0 1 0\nKa 0 0 1\nNs 7\nmap_Kd -clamp on t.png\n";
    let model = [b"mtllib m.mtl\n", TRIANGLE, b"usemtl none\nf 1 2 3\n"].concat();
    let o = |k: &str, mat: &str| {
        format!(
            "O | FRKE{{0.5, 0, {k}, 1}} | PATH:m.obj | MAT({mat}) | S{{0,0,0}} | D{{1,1,1}} | A{{0,0,0}} | SH(20)\n"
        )
    };
    let text = [CAMERA, LIGHT, &o("1", "1"), &o("1", "0"), &o("1", "0"), &o("2", "0")].concat();
    let texture = png(2, [1, 2, 3]);
    let imported = memory(&text, [("m.obj", &model), ("m.mtl", library), ("t.png", &texture)]).expect("it is sound");
    let scene = imported.scene;
    assert_eq!((scene.meshes.len(), scene.images.len(), scene.objects.len()), (2, 1, 4));
    let named: Vec<Option<MaterialId>> =
        scene.meshes.iter().flat_map(|mesh| mesh.triangles.iter().map(|t| t.material)).collect();
    let ratio = |id: Option<MaterialId>| id.map(|id| scene.materials[id.0 as usize].refraction_ratio);
    assert_eq!(named.iter().map(|id| ratio(*id)).collect::<Vec<_>>(), [Some(1.0), None, Some(2.0), None]);
    let red = &scene.materials[named[0].expect("it has one").0 as usize];
    assert_eq!((red.diffuse.x, red.specular.y, red.ambient.z, red.exponent, red.reflection), (1.0, 1.0, 1.0, 7.0, 0.5));
    assert_eq!(red.texture.map(|texture| texture.mode), Some(TextureMode::Straight));
    assert_eq!(scene.images[0].texels, [[1, 2, 3]; 2]);
}

#[test]
fn textures_are_read_once() {
    let ball = |texture: &str| format!("P SPH {SURFACE} | C{{0,0,0}}R(1) | TEX:{texture}\n");
    let text =
        [CAMERA, LIGHT, &ball("my wood.png REPEAT"), &ball("my wood.png straight |"), &ball("my wood.png")].concat();
    let scene = memory(&text, [("my wood.png", &png(1, [9; 3]))]).expect("it is sound").scene;
    let modes: Vec<_> = scene.materials.iter().filter_map(|m| m.texture.map(|t| t.mode)).collect();
    assert_eq!(
        (scene.images.len(), modes),
        (1, vec![TextureMode::Repeat, TextureMode::Straight, TextureMode::Stretch])
    );
}

#[test]
fn limits_are_kept() {
    let parse = |text: &str, limits: Limits| {
        let resolver = MemoryResolver::from([("m.obj", TRIANGLE), ("t.png", &png(9, [0; 3]))]);
        parse_thesis(text, "test.txt", &resolver, &limits).expect_err("the limit is passed").to_string()
    };
    let model = format!("{CAMERA}O {SURFACE} | PATH:m.obj");
    let texture = format!("{CAMERA}P SPH {SURFACE} | C{{0,0,0}}R(1) | TEX:t.png");
    let error = parse(&format!("{CAMERA}{LIGHT}"), Limits { directives: 1, ..Limits::default() });
    assert!(error.contains("more than 1 directives"), "{error}");
    let error = parse(&model, Limits { model_bytes: 10, ..Limits::default() });
    assert!(error.starts_with("test.txt:2:") && error.contains("expected at most 10"), "{error}");
    let error = parse(&model, Limits { mesh_elements: 4, ..Limits::default() });
    assert!(error.starts_with("m.obj:5:1: the meshes have more than 4"), "{error}");
    let error = parse(&texture, Limits { texture_bytes: 10, ..Limits::default() });
    assert!(error.contains("expected at most 10"), "{error}");
    let error = parse(&texture, Limits { texture_side: 8, ..Limits::default() });
    assert!(error.contains("9 x 1 texels, but at most 8 x 8"), "{error}");
}

#[test]
fn every_malformed_file_is_answered() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let cases = malformed::write(directory.path());
    assert!(cases.len() >= 40, "{} cases", cases.len());
    for case in &cases {
        let start = std::time::Instant::now();
        let outcome = load(&directory.path().join(&case.file), &ImportOptions::default());
        match (case.expectation, outcome) {
            (Expectation::Error(fragment, line), Err(error)) => {
                assert!(error.to_string().contains(fragment), "{}: {error}", case.file);
                assert_eq!(error.faults().first().map(|fault| fault.location().line), line, "{}: {error}", case.file);
                let place = line.map_or_else(String::new, |line| format!(":{line}:"));
                assert!(error.to_string().contains(&place), "{}: {error}", case.file);
            }
            (Expectation::Warning(fragment, line), Ok(imported)) => {
                let all = warnings(&imported);
                let here = format!(":{line}:");
                assert!(
                    all.iter().any(|text| text.contains(fragment) && text.contains(&here)),
                    "{}: {all:?}",
                    case.file
                );
            }
            (expectation, Ok(imported)) => panic!("{}: {expectation:?}, but got {:?}", case.file, warnings(&imported)),
            (expectation, Err(error)) => panic!("{}: {expectation:?}, but got {error}", case.file),
        }
        assert!(start.elapsed().as_secs() < 2, "{} took {:?}", case.file, start.elapsed());
    }
}

#[cfg(unix)]
#[test]
fn devices_and_loops_are_refused() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let link = directory.path().join("loop.txt");
    std::os::unix::fs::symlink(&link, &link).expect("links are possible");
    let error = |path: &Path| load(path, &ImportOptions::default()).expect_err("it is no file").to_string();
    assert!(error(&link).contains("cannot read the scene"));
    assert!(error(Path::new("/dev/zero")).contains("is a device or pipe; expected a regular file"));
    let text = format!("{CAMERA}O {SURFACE} | PATH:/dev/zero");
    fs::write(directory.path().join("a.txt"), text).expect("the directory is writable");
    assert!(error(&directory.path().join("a.txt")).contains("a.txt:2:"));
}

#[test]
fn models_are_searched_beside_the_scene_then_in_the_search_paths() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let (scenes, models) = (directory.path().join("scenes"), directory.path().join("models"));
    fs::create_dir_all(&scenes).expect("the directory is writable");
    fs::create_dir_all(models.join("sub")).expect("the directory is writable");
    let path = scenes.join("a.txt");
    fs::write(&path, format!("{CAMERA}{LIGHT}O {SURFACE} | PATH:sub\\m.obj | MAT(0)")).expect("it is writable");
    let options = ImportOptions { search_paths: vec![models.clone()], ..ImportOptions::default() };
    let error = load(&path, &options).expect_err("there is no model yet").to_string();
    assert!(error.contains("scenes/sub/m.obj") && error.contains("models/sub/m.obj"), "{error}");
    let model = [b"mtllib m.mtl\n", TRIANGLE].concat();
    fs::write(models.join("sub/m.obj"), model).expect("it is writable");
    fs::write(models.join("sub/m.mtl"), "newmtl red\n").expect("it is writable");
    let imported = load(&path, &options).expect("the model is there now");
    assert_eq!(imported.files, [path.clone(), models.join("sub/m.obj"), models.join("sub/m.mtl")]);
    assert_eq!((imported.scene.name.as_str(), imported.warnings.len()), ("a", 0));
    fs::create_dir(scenes.join("sub")).expect("it is writable");
    fs::write(scenes.join("sub/m.obj"), TRIANGLE).expect("it is writable");
    assert_eq!(load(&path, &options).expect("it is sound").files[1], scenes.join("sub/m.obj"));
}

/// Loads one model through a scene in memory.
fn load_model(path: &Path) -> Result<Imported, ImportError> {
    let text = format!(
        "{CAMERA}{LIGHT}O {SURFACE} | MAT(0) | PATH:{}",
        path.file_name().unwrap_or_default().to_string_lossy()
    );
    parse_thesis(&text, "test.txt", &FileResolver::new(path, &[]), &Limits::default())
}

#[test]
fn the_thesis_models_have_their_triangles() {
    for (name, triangles) in [("galleon.obj", 4698), ("venus.obj", 1418)] {
        let path = Path::new(SHARED).join("models").join(name);
        if !path.exists() {
            eprintln!("skipped: {} is not there", path.display());
            return;
        }
        let imported = load_model(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(imported.scene.meshes[0].triangles.len(), triangles, "{name}");
    }
}

/// Files made to be refused, with the reason.
const REFUSED: [(&str, &str); 6] = [
    ("catmark_torus_creases0.obj", "62:7: normal 1 does not exist"),
    ("smoothing-group-two-squares.obj", "21:6: normal 1 does not exist"),
    ("invalid-relative-texture-index.obj", "2:15: texture coordinate -2 does not exist"),
    ("invalid-relative-vertex-index.obj", "1:3: vertex -4 does not exist"),
    ("issue-140-zero-face-idx.obj", "16:3: index 0"),
    ("test-nan.obj", "12:3: `nan` is not a number"),
];

#[test]
fn models_that_others_made_are_read() {
    let folders = ["scenes/edge/obj-tinyobjloader", "scenes/meshes", "scenes/meshes/spot", "models"];
    for folder in folders.map(|folder| Path::new(SHARED).join(folder)) {
        let Ok(entries) = fs::read_dir(&folder) else {
            eprintln!("skipped: {} is not there", folder.display());
            continue;
        };
        let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path()));
        for path in paths.filter(|path| path.extension().is_some_and(|extension| extension == "obj")) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let reason = REFUSED.iter().find(|(refused, _)| *refused == name).map(|(_, reason)| reason);
            match (load_model(&path), reason) {
                (Ok(_), None) => {}
                (Err(error), Some(reason)) if error.to_string().contains(&format!("{name}:{reason}")) => {}
                (Ok(_), Some(reason)) => panic!("{name} was read in spite of {reason}"),
                (Err(error), _) => panic!("{error}"),
            }
        }
    }
}
