//! Broken scenes, with what must be said about each and where.

use super::{HEAD, memory};

/// A sound material, which ends in line 9; what is odd follows from line 10 on.
const CLAY: &str = "[[material]]\nname = \"clay\"\ntype = \"lambert\"\n";

/// The text after the head, and line, column and message of the error.
const BODIES: &[(&str, &str)] = &[
    ("lihgt = 1", "7:1: unknown key `lihgt` of the camera"),
    ("[cam]", "7:2: unknown key `cam` of a scene; expected one of `format`, `version`"),
    ("[[camera]]", "7:3: duplicate key"),
    ("[material]", "7:1: `material` is not a list of tables; expected `[[material]]`"),
    ("[[environment]]", "7:1: `environment` is not a table; expected `[environment]`"),
    (
        "[environment]\nimage = \"no.exr\"",
        "8:9: the image `no.exr` was not found; searched no.exr; expected a PNG, JPEG, EXR",
    ),
    ("[environment]\nimage = \"a.txt\"", "8:9: the image `a.txt` is no PNG, JPEG, EXR, Radiance HDR or PFM image"),
    (
        "[environment]\nimage = \"nan.pfm\"",
        "8:9: the image `nan.pfm` holds [0.0, NaN, 0.0] in row 1, column 1; expected finite numbers of at most 1e15",
    ),
    ("[environment]\nrotate = 400", "8:10: `rotate`: degrees is 400; expected a number from -360 to 360"),
    ("[environment]\nradiance = -1", "8:12: `radiance` is [-1, -1, -1]; expected three numbers from 0"),
    // Materials.
    ("[[material]]\ntype = \"mirror\"", "7:1: `name` is missing; expected a string such as"),
    ("[[material]]\nname = \"a\"", "7:1: `type` is missing; expected one of `lambert`, `phong`"),
    (
        "[[material]]\nname = \"a\"\ntype = \"lamber\"",
        "9:8: unknown type `lamber`: did you mean `lambert`?; expected one of",
    ),
    (
        "[[material]]\nname = \"clay\"\ntype = \"mirror\"\n[[material]]\nname = \"clay\"\ntype = \"mirror\"",
        "11:8: there is a material `clay` above",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"mirror\"\nroughness = 1",
        "10:1: unknown key `roughness` of a mirror; expected one of `name`, `type`",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nalbedo = 2",
        "10:10: `albedo` is [2, 2, 2]; expected three numbers from 0 to 1",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nalbedo = [1, 2]",
        "10:10: `albedo` has 2 items instead of 3; expected a number or three",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nalbedo = true",
        "10:10: `albedo` is true or false; expected a number or three",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nalbedo = { factor = 1 }",
        "10:10: `image` is missing; expected the name of a file",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nalbedo = { image = \"x.png\", scale = 1 }",
        "10:29: unknown key `scale` of a colour; expected one of `image`, `factor`",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"phong\"\ndiffuse = 1\nspecular = 1\nexponent = 5",
        "11:12: `specular` and diffuse add up to more than 1",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"phong\"\ndiffuse = 1\nspecular = 0",
        "7:1: `exponent` is missing; expected a number",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"conductor\"",
        "7:1: `eta` or `reflectance` or `metal` is missing; expected one of them",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"conductor\"\nmetal = \"gold\"\nreflectance = 1",
        "10:9: `metal` beside `reflectance`; expected one of them alone",
    ),
    ("[[material]]\nname = \"a\"\ntype = \"conductor\"\nmetal = \"gold\"\nk = [1, 1, 1]", "11:5: `k` beside `metal`"),
    ("[[material]]\nname = \"a\"\ntype = \"conductor\"\neta = [1, 1, 1]", "7:1: `k` is missing"),
    (
        "[[material]]\nname = \"a\"\ntype = \"conductor\"\nmetal = \"tin\"",
        "10:9: unknown metal `tin`; expected one of `gold`, `silver`",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"conductor\"\nreflectance = 1.5",
        "10:15: `reflectance` is [1.5, 1.5, 1.5]; expected three numbers from 0 to 1",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"conductor\"\neta = [1, 1, 1]\nk = [1, 1, 1000]",
        "11:5: `k` is 1000; expected a number from 0 to 100",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"dielectric\"\nior = 1",
        "10:7: `ior` is 1, so near to 1 that nothing is refracted",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"mix\"\nfirst = \"a\"\nsecond = \"a\"\nweight = 0.5",
        "10:9: `first` leads through more than 8 mixes, or back to itself",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"mix\"\nfirst = \"b\"\nsecond = \"a\"\nweight = 0.5",
        "10:9: there is no material `b`; expected the name of a [[material]]",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nemission = { colour = 1 }",
        "10:14: unknown key `colour` of an emission",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nemission = [1, -1, 1]",
        "10:12: `emission`: radiance is [1, -1, 1]",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nalpha = { threshold = 0.5 }",
        "10:9: `image` is missing; expected the name of a file",
    ),
    (
        "[[material]]\nname = \"a\"\ntype = \"lambert\"\nnormal-map = 3",
        "10:14: `normal-map` is a number; expected the name of a file",
    ),
    // Meshes.
    ("[[mesh]]\nfile = \"a.obj\"", "7:1: `name` is missing"),
    ("[[mesh]]\nname = \"a\"", "7:1: `file` is missing; expected the name of a file"),
    (
        "[[mesh]]\nname = \"a\"\nfile = \"no.ply\"",
        "9:8: the model `no.ply` was not found; searched no.ply; expected an OBJ or PLY file",
    ),
    ("[[mesh]]\nname = \"a\"\nfile = \"a.txt\"", "9:8: `a.txt` ends neither in .obj nor in .ply"),
    (
        "[[mesh]]\nname = \"t\"\nfile = \"t.obj\"\n[[mesh]]\nname = \"t\"\nfile = \"t.obj\"",
        "11:8: there is a mesh `t` above",
    ),
    ("[[mesh]]\nname = \"t\"\nfile = \"far.obj\"", "9:8: `file`: positions hold"),
    // Objects; clay ends in line 9.
    (
        "{clay}[[object]]\ntype = \"torus\"",
        "11:8: unknown type `torus`; expected one of `mesh`, `sphere`, `rectangle`, `box`",
    ),
    (
        "{clay}[[object]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1",
        "10:1: `material` is missing; expected the name of a [[material]]",
    ),
    (
        "{clay}[[object]]\ntype = \"sphere\"\nmaterial = \"clya\"\ncenter = [0, 0, 0]\nradius = 1",
        "12:12: there is no material `clya`: did you mean `clay`?",
    ),
    (
        "{clay}[[object]]\ntype = \"sphere\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nradius = -1",
        "14:10: `radius` is -1; expected a length above 0",
    ),
    (
        "{clay}[[object]]\ntype = \"sphere\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nradius = 1\ntranslate = [0, 0, 0]",
        "15:1: unknown key `translate` of a sphere",
    ),
    (
        "{clay}[[object]]\ntype = \"rectangle\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nhead = [0, 2, 0]\nwidth = 1\nheight = 1",
        "15:8: `head` is [0, 2, 0], parallel to normal",
    ),
    (
        "{clay}[[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nsize = [1, 0, 1]",
        "14:8: `size` is [1, 0, 1]; expected three lengths above 0",
    ),
    (
        "{clay}[[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\nrotate = 5",
        "15:10: `rotate` is not a table; expected a rotation such as",
    ),
    (
        "{clay}[[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\nrotate = [{ axis = [0, 0, 0], degrees = 5 }]",
        "15:20: `axis` is [0, 0, 0]; expected a direction",
    ),
    (
        "{clay}[[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\nscale = [1, 0, 1]",
        "15:9: `scale`: placement flattens the mesh",
    ),
    (
        "{clay}[[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\nscale = 2\nmatrix = []",
        "15:9: `scale` beside `matrix`",
    ),
    (
        "{clay}[[object]]\ntype = \"box\"\nmaterial = \"clay\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\nmatrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]",
        "15:10: the last row of `matrix` is [0, 0, 1, 1]; expected [0, 0, 0, 1]",
    ),
    (
        "{clay}[[object]]\ntype = \"mesh\"\nmesh = \"m\"\nmaterial = \"clay\"",
        "12:8: there is no mesh `m`; expected the name of a [[mesh]]",
    ),
    (
        "{clay}[[mesh]]\nname = \"t\"\nfile = \"t.obj\"\n[[object]]\ntype = \"mesh\"\nmesh = \"t\"",
        "13:1: `material` is missing, and the model has none of its own",
    ),
    (
        "{clay}[[mesh]]\nname = \"t\"\nfile = \"t.obj\"\n[[object]]\ntype = \"mesh\"\nmesh = \"t\"\nmaterial = \"clay\"\nsmooth = 1",
        "17:10: `smooth` is a number; expected true or false",
    ),
    (
        "{clay}[[object]]\ntype = \"sphere\"\nmaterial = \"clay\"\ncenter = [0, 2e9, 0]\nradius = 1",
        "13:10: `center` is",
    ),
    // Lights.
    (
        "[[light]]\ntype = \"area\"",
        "8:8: unknown type `area`: did you mean `rectangle`?; expected one of `point`, `spot`",
    ),
    ("[[light]]\ntype = \"point\"\nposition = [0, 0, 0]", "7:1: `intensity` or `power` is missing"),
    ("[[light]]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = 1\npower = 1", "11:9: `power` beside `intensity`"),
    ("[[light]]\ntype = \"point\"\nposition = [0, 0, 0]\npower = -1", "10:9: `power`: intensity is"),
    (
        "[[light]]\ntype = \"spot\"\nposition = [0, 0, 0]\ntarget = [0, 0, 0]\nintensity = 1\ninner = 1\nouter = 2",
        "10:10: `target`: direction is [0, 0, 0]; expected a direction of non-zero length",
    ),
    (
        "[[light]]\ntype = \"spot\"\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nintensity = 1\ninner = 30\nouter = 20",
        "13:9: `outer`: outer degrees is 20; expected a number from 30 to 180",
    ),
    ("[[light]]\ntype = \"directional\"\ndirection = [0, 0, 0]\nirradiance = 1", "9:13: `direction` is [0, 0, 0]"),
    (
        "[[light]]\ntype = \"rectangle\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nhead = [1, 0, 0]\nwidth = 0\nheight = 1\npower = 1",
        "12:9: `width` is 0; expected a length above 0",
    ),
    (
        "[[light]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nradiance = -1",
        "11:12: `radiance` is [-1, -1, -1]",
    ),
    (
        "[[light]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nintensity = 1",
        "11:1: unknown key `intensity` of a sphere light",
    ),
];

/// Cameras, after the two lines that every scene starts with.
const CAMERAS: &[(&str, &str)] = &[
    ("", "1:1: the scene has no camera; expected a table `[camera]`"),
    ("[camera]\ntarget = [0, 0, 0]", "3:1: `position` is missing; expected three numbers"),
    ("[camera]\nposition = [0, 0, 0]", "3:1: `target` or `direction` is missing"),
    ("[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, 0]", "5:10: `target`: direction is [0, 0, 0]"),
    ("[camera]\nposition = [0, 0, 0]\ndirection = [0, 1, 0]", "3:1: `up` is [0, 1, 0], parallel to direction"),
    ("[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\ntarget = [0, 1, 0]", "5:13: `direction` beside `target`"),
    (
        "[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nfov = 180",
        "6:7: `fov`: degrees is 180; expected a number from 0.01 to 179",
    ),
    ("[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nfov = 18\nheight = 1", "7:10: `height` beside `fov`"),
    ("[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nlens-radius = -1", "6:15: `lens-radius` is -1"),
    ("[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nfocus = [0, 0, -1]", "6:9: `focus`: focus distance is -1"),
    (
        "[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nfocus = [0, 0, 1]\nfocus-distance = 1",
        "6:9: `focus` beside `focus-distance`",
    ),
    (
        "[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nnear = inf",
        "6:8: `near` is too large for a 32-bit number",
    ),
    ("[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nfov = '40'", "6:7: `fov` is a string; expected a number"),
    ("[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nshutter = 1", "6:1: unknown key `shutter` of the camera"),
];

/// What is wrong with the answer to a text, if anything.
fn check(text: &str, expected: &str) -> Option<String> {
    let nan = super::pfm([0.0, f32::NAN, 0.0]);
    let files: [(&str, &[u8]); 4] = [
        ("a.txt", b"hello"),
        ("t.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("far.obj", b"v 0 0 1e20\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("nan.pfm", &nan),
    ];
    let faults: Vec<String> = match memory(text, &files) {
        Ok(_) => Vec::new(),
        Err(error) => error.faults().iter().map(ToString::to_string).collect(),
    };
    let expected = format!("folder/test.toml:{expected}");
    let is_good = faults.len() == 1 && faults[0].starts_with(&expected);
    (!is_good).then(|| format!("{text}\nexpected {expected}\nfound {faults:#?}"))
}

fn check_all(cases: impl Iterator<Item = (String, &'static str)>) {
    let wrong: Vec<String> = cases.filter_map(|(text, expected)| check(&text, expected)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_mistake_is_named_where_it_is() {
    check_all(BODIES.iter().map(|(body, expected)| (format!("{HEAD}{}", body.replace("{clay}", CLAY)), *expected)));
}

#[test]
fn cameras_are_checked() {
    let head = "format = \"lightcuts-scene\"\nversion = 1\n";
    check_all(CAMERAS.iter().map(|(body, expected)| (format!("{head}{body}"), *expected)));
}

#[test]
fn errors_are_collected() {
    let body = "[[light]]\ntype = \"x\"\n[[light]]\ntype = \"point\"\n[[object]]\ntype = \"box\"\n".repeat(20);
    let error = memory(&format!("{HEAD}{body}"), &[]).expect_err("it is full of errors");
    assert_eq!(error.faults().len(), 20);
}
