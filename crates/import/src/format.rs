//! Tells files of other formats from scene texts, so that the message says what they are.

use crate::ImportError;
use std::path::Path;

const OBJ_HELP: &str = "write a scene that names the model: a TOML file with `format = \"lightcuts-scene\"`, `version = 1`, a \
                        `[camera]`, an `[environment]`, and `[[mesh]]` `name = \"model\"` `file = \"model.obj\"` with `[[object]]` \
                        `type = \"mesh\"` `mesh = \"model\"`; or a scene of the thesis' model with a line such as \
                        `O | FRKE{0, 0, 1, 1} | PATH:model.obj | SMTH(1) | S{0, 0, 0} | D{0.5, 0.5, 0.5} | A{0, 0, 0} | SH(20)`";

const PLY_HELP: &str = "write a scene that names the model: a TOML file with `format = \"lightcuts-scene\"`, `version = 1`, a \
                        `[camera]`, an `[environment]`, a `[[material]]`, and `[[mesh]]` `name = \"model\"` \
                        `file = \"model.ply\"` with `[[object]]` `type = \"mesh\"` `mesh = \"model\"` `material = \"...\"`";

const TOML_HELP: &str = "render a scene of the physical model as one, or write a scene in the thesis' text format";

const IMAGE: &str = "an image";
const IMAGE_HELP: &str = "`lightcuts info` says what a picture holds, `lightcuts develop` makes a PNG of its light";

/// Extensions that scenes and pictures have elsewhere, and what they mean.
const KNOWN_EXTENSIONS: [(&[&str], &str); 16] = [
    (&["obj"], "an OBJ model without camera and lights"),
    (&["mtl"], "an MTL material library"),
    (&["ply"], "a PLY model"),
    (&["stl"], "an STL model"),
    (&["gltf", "glb"], "a glTF scene"),
    (&["pbrt"], "a pbrt scene"),
    (&["xml"], "an XML file, maybe a Mitsuba scene"),
    (&["json"], "a JSON file"),
    (&["usd", "usda", "usdc", "usdz"], "a USD scene"),
    (&["blend"], "a Blender file"),
    (&["fbx"], "an FBX scene"),
    (&["dae"], "a COLLADA scene"),
    (&["3ds", "max"], "a 3ds Max file"),
    (&["wrl", "vrml", "x3d"], "a VRML or X3D scene"),
    (&["abc"], "an Alembic scene"),
    (&["png", "jpg", "jpeg", "exr", "hdr", "pic", "pfm", "tif", "tiff", "tga", "bmp", "gif", "webp"], IMAGE),
];

/// First bytes that give a format away.
const KNOWN_STARTS: [(&[u8], &str); 16] = [
    (b"glTF", "a glTF scene"),
    (b"ply\n", "a PLY model"),
    (b"ply\r", "a PLY model"),
    (b"<", "an XML file, maybe a Mitsuba scene"),
    (b"{", "a JSON file, maybe a glTF scene"),
    (b"\x89PNG", IMAGE),
    (b"\xff\xd8\xff", IMAGE),
    (b"v/1\x01", IMAGE),
    (b"#?RADIANCE", IMAGE),
    (b"#?RGBE", IMAGE),
    (b"PF\n", IMAGE),
    (b"Pf\n", IMAGE),
    (b"GIF8", IMAGE),
    (b"BLENDER", "a Blender file"),
    (b"PXR-USDC", "a USD scene"),
    (b"mtllib ", "an OBJ model without camera and lights"),
];

/// Fails for a file whose extension belongs to another format, before it is read: models may be large.
pub(crate) fn refuse_known_extensions(path: &Path) -> Result<(), ImportError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let known = KNOWN_EXTENSIONS.iter().find(|(known, _)| known.contains(&&*extension));
    // A directory may be called anything; that it is one is the better message.
    known.filter(|_| path.is_file()).map_or(Ok(()), |(_, found)| Err(unknown(path, found)))
}

/// Fails for content that starts as another format does.
pub(crate) fn refuse_other_content(path: &Path, bytes: &[u8]) -> Result<(), ImportError> {
    let content = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let known = KNOWN_STARTS.iter().find(|(start, _)| content.starts_with(start));
    known.map_or(Ok(()), |(_, found)| Err(unknown(path, found)))
}

/// Whether a file should hold a scene in TOML.
pub(crate) fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// The refusal of a TOML file where a scene of the thesis' model is wanted.
pub(crate) fn toml(path: &Path) -> ImportError {
    ImportError::UnknownFormat {
        path: path.to_path_buf(),
        found: "a TOML file, which holds a job or a scene of the physical model",
        help: Some(TOML_HELP),
    }
}

fn unknown(path: &Path, found: &'static str) -> ImportError {
    let help = match found {
        found if found.starts_with("an OBJ") => Some(OBJ_HELP),
        "a PLY model" => Some(PLY_HELP),
        IMAGE => Some(IMAGE_HELP),
        _ => None,
    };
    ImportError::UnknownFormat { path: path.to_path_buf(), found, help }
}
