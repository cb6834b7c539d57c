//! Broken and odd input files, with what an importer must say about each. Also run through the program itself.

#![allow(unreachable_pub, reason = "shared between test programs by path")]

use std::fs::{self, File};
use std::path::Path;

/// What must come of a scene.
#[derive(Debug, Clone, Copy)]
pub enum Expectation {
    /// An error whose text holds the fragment; in this line if one is given.
    Error(&'static str, Option<u32>),
    /// A scene, and a warning whose text holds the fragment, in this line.
    Warning(&'static str, u32),
}

use Expectation::{Error, Warning};

/// One scene file to load.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name of the scene file in the directory.
    pub file: String,
    /// What must come of it.
    pub expectation: Expectation,
}

const CAMERA: &str = "C | STRAT | PERS(10) | C{0, 0, 960} | V{0, 0, -1} | U{0, 1, 0} |";
const LIGHT: &str = "L | OMNI | POS{0, 100, 0} | ATTEN(1) | S{1, 1, 1} | D{1, 1, 1} | A{1, 1, 1} |";
const BALL: &str = "P | SPH | FRKE{0, 0, 1, 1} | C{0, 0, 0}R(60) | S{0, 0, 0} | D{1, 1, 1} | A{0, 0, 0} | SH(20) |";

/// Scenes in which line 3 is odd, after a sound camera and light; line 4 is a sound ball.
const THIRD_LINES: &[(&str, &str, Expectation)] = &[
    ("unknown-directive", "X | FOO{1, 2}", Warning("unknown directive", 3)),
    ("prose", "and now for something else", Warning("unknown directive", 3)),
    ("unknown-field", "S | BK{0, 0, 0} | FOG(3)", Warning("unused field: FOG", 3)),
    ("duplicate-field", "S | BK{0, 0, 0} | BK{1, 1, 1}", Warning("unused field: BK is given twice", 3)),
    (
        "second-camera",
        "C | ORTHO | C{0, 0, 9} | V{0, 0, -1} | U{0, 1, 0}",
        Warning("the camera of line 1 is replaced", 3),
    ),
    ("malformed-parameters", "# VPL(0.1/x/3)", Warning("the run's parameters cannot be read", 3)),
    ("unknown-light", "L | SPOT | POS{0, 0, 0}", Error("the kind of light is missing; expected OMNI", Some(3))),
    ("unknown-primitive", "P | TORUS | C{0, 0, 0}", Error("the kind of primitive is missing; expected SPH", Some(3))),
    ("empty-primitive", "P", Error("the kind of primitive is missing", Some(3))),
    ("empty-object", "O |", Error("PATH is missing; expected a model file", Some(3))),
    ("truncated-vector", "S | BK{0, 0", Error("unexpected `P`; expected `,` or the `}` that ends BK", Some(4))),
    ("truncated-name", "S | B", Warning("unused field: B is not known", 3)),
    ("nan", "S | BK{0, nan, 0}", Error("`nan` is not a number; expected a number such as", Some(3))),
    ("infinity", "S | BK{0, inf, 0}", Error("`inf` is not a number", Some(3))),
    ("overflow", "S | BK{0, 1e400, 0}", Error("`1e400` is too large", Some(3))),
    ("huge-exponent", "S | BK{0, 1e99999999999999999999, 0}", Error("is too large", Some(3))),
    ("two-points", "S | BK{0, 1.2.3, 0}", Error("`1.2.3` is not a number", Some(3))),
    ("missing-number", "S | BK{0, , 0}", Error("unexpected `,`; expected a number", Some(3))),
    ("empty-vector", "S | BK{}", Error("unexpected `}`; expected a number", Some(3))),
    ("two-numbers", "S | BK{0, 0}", Error("BK has 2 numbers instead of 3", Some(3))),
    ("wrong-brackets", "S | BK(0, 0, 0)", Error("BK has the wrong brackets; expected a background", Some(3))),
    ("mixed-brackets", "S | BK{0, 0, 0)", Error("unexpected `)`; expected `,` or the `}`", Some(3))),
    ("square-brackets", "S | BK[0, 0, 0]", Error("unexpected `[`", Some(3))),
    ("no-commas", "S | BK{0 0 0}", Error("unexpected `0`; expected `,`", Some(3))),
    ("stray-bracket", "S | BK{0, 0, 0} | }", Error("unexpected `}`; expected a field", Some(3))),
    (
        "negative-colour",
        "S | BK{0, -1, 0}",
        Error("BK: background is [0, -1, 0]; expected three numbers from 0", Some(3)),
    ),
    (
        "missing-radius",
        "P | SPH | FRKE{0,0,1,1} | C{0,0,0} | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("R is missing; expected a radius such as R(60)", Some(3)),
    ),
    (
        "negative-radius",
        "P | SPH | FRKE{0,0,1,1} | C{0,0,0}R(-60) | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("R: radius is -60; expected a length above 0", Some(3)),
    ),
    (
        "far-sphere",
        "P | SPH | FRKE{0,0,1,1} | C{0,1e20,0}R(60) | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("C: center is", Some(3)),
    ),
    (
        "zero-square",
        "P | SQU | FRKE{0,0,1,1} | C{0,0,0}N{0,1,0}H{1,0,0}:W0:H4 | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("W: width is 0; expected a length above 0", Some(3)),
    ),
    (
        "parallel-square",
        "P | SQU | FRKE{0,0,1,1} | C{0,0,0}N{0,1,0}H{0,2,0}:W4:H4 | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("H: head is [0, 2, 0], parallel to normal", Some(3)),
    ),
    (
        "flat-cube",
        "P | CUB | FRKE{0,0,1,1} | L(1)W(2)H(0)C{0,0,0}V{0,1,0}H{1,0,0} | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("H: height is 0", Some(3)),
    ),
    (
        "negative-ratio",
        "P | SPH | FRKE{0,0,1,-1} | C{0,0,0}R(6) | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("FRKE: local is -1; expected a number from 0", Some(3)),
    ),
    (
        "three-ratios",
        "P | SPH | FRKE{0,0,1} | C{0,0,0}R(6) | S{0,0,0} | D{1,1,1} | A{0,0,0} | SH(1)",
        Error("FRKE has 3 numbers instead of 4", Some(3)),
    ),
    (
        "no-exponent",
        "P | SPH | FRKE{0,0,1,1} | C{0,0,0}R(6) | S{0,0,0} | D{1,1,1} | A{0,0,0}",
        Error("SH is missing", Some(3)),
    ),
    (
        "no-direction",
        "L | DIR | DIR{0,0,0} | ATTEN(1) | S{1,1,1} | D{1,1,1} | A{1,1,1}",
        Error("DIR: direction is [0, 0, 0]; expected a direction", Some(3)),
    ),
    ("no-attenuation", "L | OMNI | POS{0,0,0} | S{1,1,1} | D{1,1,1} | A{1,1,1}", Error("ATTEN is missing", Some(3))),
    (
        "dense-area-light",
        "L | SQU_A | C{0,0,0}N{0,1,0}H{1,0,0}:W(1e6)H(1e6):DS(1e-3) | ATTEN(1) | S{1,1,1} | D{1,1,1} | A{1,1,1}",
        Error("DS: spacing cuts the light into", Some(3)),
    ),
    (
        "no-projection",
        "C | STRAT | C{0,0,9} | V{0,0,-1} | U{0,1,0}",
        Error("the projection is missing; expected PERS", Some(3)),
    ),
    (
        "upright-camera",
        "C | PERS(1) | C{0,0,9} | V{0,1,0} | U{0,1,0}",
        Error("U: up is [0, 1, 0], parallel to view", Some(3)),
    ),
    ("zero-distance", "C | PERS(0) | C{0,0,9} | V{0,0,1} | U{0,1,0}", Error("PERS: distance is 0", Some(3))),
];

/// Fields of an `O` or `P SPH` line with a file name, in line 3; models and textures are written beside the scene.
const FILE_LINES: &[(&str, &str, Expectation)] = &[
    ("missing-model", "PATH:nowhere.obj", Error("the model `nowhere.obj` was not found; searched", Some(3))),
    ("no-model-name", "PATH:", Error("a file name is missing; expected PATH:model.obj", Some(3))),
    ("no-colon", "PATH(a.obj)", Error("unexpected `(`; expected PATH:model.obj", Some(3))),
    ("model-is-directory", "PATH:folder.obj", Error("is a directory; expected a regular file", Some(3))),
    ("long-model", "PATH:sparse.obj", Error("has 8589934592 bytes; expected at most 2147483648", Some(3))),
    ("binary-model", "PATH:binary.obj", Error("shows that this is not text", Some(2))),
    ("zero-index", "PATH:zero.obj", Error("index 0: indices count from 1", Some(4))),
    ("index-out-of-range", "PATH:range.obj", Error("vertex 4 does not exist: the file has 3", Some(4))),
    ("negative-index", "PATH:negative.obj", Error("vertex -4 does not exist: there are 3 so far", Some(4))),
    ("word-index", "PATH:word.obj", Error("`x` is not an index", Some(4))),
    ("huge-index", "PATH:huge.obj", Error("is not an index", Some(4))),
    ("two-corners", "PATH:corners.obj", Warning("1 face of fewer than 3 corners is ignored", 4)),
    ("nan-vertex", "PATH:nan.obj", Error("`nan` is not a number", Some(1))),
    ("short-vertex", "PATH:short.obj", Error("2 numbers instead of 3", Some(1))),
    ("far-vertex", "PATH:far.obj", Error("PATH: positions hold", Some(3))),
    ("no-faces", "PATH:empty.obj", Warning("the model has no faces", 3)),
    ("unknown-keyword", "PATH:keyword.obj", Warning("unknown keyword `$`", 1)),
    ("no-angle", "PATH:good.obj | ROT{0, 1, 0}", Error("ROT has no angle; expected a rotation such as", Some(3))),
    ("zero-axis", "PATH:good.obj | ROT{0, 0, 0}:45", Error("ROT: axis is [0, 0, 0]", Some(3))),
    (
        "zero-scale",
        "PATH:good.obj | SCAL{1, 0, 1}",
        Error("SCAL: scale is [1, 0, 1]; expected no factor of 0", Some(3)),
    ),
    ("odd-switch", "PATH:good.obj | SMTH(2)", Error("SMTH is 2; expected SMTH(0) or SMTH(1)", Some(3))),
    ("missing-library", "PATH:no-library.obj | MAT(0)", Warning("the material library `none.mtl` was not found", 1)),
    ("self-library", "PATH:self-library.obj | MAT(0)", Warning("`self-library.obj` is the model itself", 1)),
    ("directory-library", "PATH:directory-library.obj | MAT(0)", Warning("is a directory", 1)),
    ("undefined-material", "PATH:undefined.obj | MAT(0)", Warning("the material `none` is not defined", 4)),
    ("library-nan", "PATH:library-nan.obj | MAT(0)", Error("`nan` is not a number", Some(2))),
    ("library-range", "PATH:library-range.obj | MAT(0)", Error("diffuse is [-1, 0, 0]", Some(2))),
    ("library-texture", "PATH:library-texture.obj | MAT(0)", Warning("the texture `none.png` was not found", 2)),
    ("missing-texture", "TEX:none.png STRETCH", Error("the texture `none.png` was not found; searched", Some(3))),
    ("no-texture-name", "TEX: |", Error("a file name is missing; expected TEX:image.png", Some(3))),
    ("scene-as-texture", "TEX:scene-as-texture.txt", Error("is neither a PNG nor a JPEG image", Some(3))),
    ("directory-texture", "TEX:folder.obj", Error("is a directory", Some(3))),
    ("corrupt-png", "TEX:corrupt.png", Error("the texture `corrupt.png` cannot be decoded", Some(3))),
    ("truncated-jpeg", "TEX:truncated.jpg", Error("the texture `truncated.jpg` cannot be decoded", Some(3))),
    ("long-texture", "TEX:sparse.png", Error("has 8589934592 bytes; expected at most 268435456", Some(3))),
];

/// Whole scene files.
const FILES: &[(&str, &[u8], Expectation)] = &[
    ("empty.txt", b"", Error("the file holds no directive", Some(1))),
    ("blank.txt", b" \r\n\t\n", Error("the file holds no directive", Some(1))),
    ("comment.txt", b"# nothing", Error("the file holds no directive", Some(1))),
    ("no-camera.txt", b"S | BK{0, 0, 0}", Error("the scene has no camera; expected a line such as `C |", Some(1))),
    ("nul.txt", b"S | BK{0, 0,\n\0", Error("byte 13 of the file is 0x00, so this is not text", Some(2))),
    ("utf16.txt", b"\xff\xfeS\0 \0|\0", Error("so this is not text", Some(1))),
    ("open-end.txt", b"C | PERS(10) | C{0, 0", Error("the text ends inside C; expected `}`", Some(1))),
    ("open-number.txt", b"C | PERS(10) | C{0, 0,", Error("the text ends too early; expected a number", Some(1))),
    ("open-field.txt", b"C | PERS(10", Error("the text ends inside PERS", Some(1))),
    ("lone-camera.txt", b"C | PERS(10)", Error("C is missing; expected the view plane's centre", Some(1))),
    ("lone-letter.txt", b"c", Error("the projection is missing", Some(1))),
    ("dark.txt", b"C | ORTHO | C{0,0,9} | V{0,0,-1} | U{0,1,0}", Warning("the scene has no light", 1)),
    (
        "model.obj",
        b"v 0 0 0",
        Error("an OBJ model without camera and lights; expected a scene in the thesis' text format", None),
    ),
    ("scene.gltf", b"{}", Error("a glTF scene; expected", None)),
    ("scene.pbrt", b"LookAt 0 0 0", Error("a pbrt scene; expected", None)),
    ("gltf-inside.txt", b" {\"asset\": {}}", Error("a JSON file, maybe a glTF scene; expected", None)),
    ("mitsuba-inside", b"<scene version=\"3\">", Error("an XML file", None)),
    ("image-inside.txt", b"\x89PNG\r\n\x1a\n\0\0", Error("an image; expected", None)),
    ("sky.hdr", b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80", Error("this is an image; expected a scene", None)),
    (
        "light-inside.txt",
        b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80",
        Error("this is an image; expected a scene", None),
    ),
    ("unknown.scene", b"hello world", Error("the file holds no directive", Some(1))),
];

/// Files that scenes of [`FILE_LINES`] name.
const COMPANIONS: &[(&str, &[u8])] = &[
    ("good.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("binary.obj", b"v 0 0 0\nv 1 \x01"),
    ("zero.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
    ("range.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
    ("negative.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 -2 -1\n"),
    ("word.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 x 3\n"),
    ("huge.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n"),
    ("corners.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\n"),
    ("nan.obj", b"v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("short.obj", b"v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("far.obj", b"v 0 0 1e20\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("empty.obj", b""),
    ("keyword.obj", b"$ money\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n$ again\n"),
    ("no-library.obj", b"mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("self-library.obj", b"mtllib self-library.obj\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("directory-library.obj", b"mtllib folder.obj\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("undefined.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl none\nf 1 2 3\n"),
    ("library-nan.obj", b"mtllib nan.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"),
    ("library-range.obj", b"mtllib range.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"),
    ("library-texture.obj", b"mtllib texture.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"),
    ("nan.mtl", b"newmtl a\nKd nan 0 0\n"),
    ("range.mtl", b"newmtl a\nKd -1 0 0\n"),
    ("texture.mtl", b"newmtl a\nmap_Kd none.png\n"),
    ("corrupt.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01"),
    ("truncated.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0\x01\x01"),
];

/// Writes the scenes and their companions into an empty directory.
///
/// # Panics
/// If the directory cannot be written.
pub fn write(directory: &Path) -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |file: String, content: &[u8], expectation: Expectation| {
        fs::write(directory.join(&file), content).expect("the directory is writable");
        cases.push(Case { file, expectation });
    };
    for (name, line, expectation) in THIRD_LINES {
        add(format!("{name}.txt"), format!("{CAMERA}\n{LIGHT}\n{line}\n{BALL}\n").as_bytes(), *expectation);
    }
    for (name, fields, expectation) in FILE_LINES {
        let surface = "| FRKE{0, 0, 1, 1} | S{0, 0, 0} | D{1, 1, 1} | A{0, 0, 0} | SH(20)";
        let line = if fields.starts_with("PATH") {
            format!("O {surface} | {fields}")
        } else {
            format!("P | SPH {surface} | C{{0, 0, 0}}R(60) | {fields}")
        };
        add(format!("{name}.txt"), format!("{CAMERA}\n{LIGHT}\n{line}\n{BALL}\n").as_bytes(), *expectation);
    }
    for (name, content, expectation) in FILES {
        add((*name).to_owned(), content, *expectation);
    }
    for (name, content) in COMPANIONS {
        fs::write(directory.join(name), content).expect("the directory is writable");
    }
    fs::create_dir(directory.join("folder.obj")).expect("the directory is writable");
    fs::create_dir(directory.join("directory.txt")).expect("the directory is writable");
    for name in ["sparse.txt", "sparse.obj", "sparse.png"] {
        let file = File::create(directory.join(name)).expect("the directory is writable");
        file.set_len(8 << 30).expect("sparse files are possible");
    }
    let special = [
        ("directory.txt", Error("is a directory; expected a regular file", None)),
        ("absent.txt", Error("cannot read the scene", None)),
        ("sparse.txt", Error("has 8589934592 bytes; expected at most 67108864", None)),
    ];
    cases.extend(special.map(|(file, expectation)| Case { file: file.to_owned(), expectation }));
    cases
}
