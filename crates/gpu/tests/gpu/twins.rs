//! All twins as one WGSL text, under declarations of the buffers that they read.

use lightcuts_kernel::wgsl::TWINS;
use std::fmt::Write as _;

/// Buffers that twins read, with the types of their elements, in the order of their bindings.
pub(crate) const BUFFERS: [(&str, &str); 8] = [
    ("nodes", "CompressedNode"),
    ("items", "LeafItem"),
    ("squares", "Square"),
    ("spheres", "Sphere"),
    ("primitives", "Primitive"),
    ("corners", "TriangleCorners"),
    ("texels", "u32"),
    ("photons", "Photon"),
];

/// Functions that programs declare for the buffers that they may split.
const ACCESSORS: [(&str, &str); 4] = [
    ("nodes", "compressed_node"),
    ("items", "leaf_item"),
    ("corners", "triangle_corners"),
    ("primitives", "primitive_record"),
];

/// The text.
pub(crate) fn joined() -> String {
    let mut text = String::new();
    for (binding, (name, element)) in BUFFERS.iter().enumerate() {
        let _ = writeln!(text, "@group(0) @binding({binding}) var<storage, read> {name}: array<{element}>;");
        if let Some((_, function)) = ACCESSORS.iter().find(|(buffer, _)| buffer == name) {
            let _ = writeln!(text, "fn {function}(index: u32) -> {element} {{ return {name}[index]; }}");
        }
    }
    text.extend(TWINS.iter().map(|twin| twin.text));
    text
}

/// A text as naga reads it.
pub(crate) fn parse(wgsl: &str) -> naga::Module {
    naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|error| panic!("{}", error.emit_to_string(wgsl)))
}

/// The names that a WGSL text declares with a keyword, such as `fn`.
pub(crate) fn declared<'t>(text: &'t str, keyword: &str) -> Vec<&'t str> {
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let name = |line: &'t str| line.strip_prefix(keyword)?.strip_prefix(' ')?.split(|c| !is_of_name(c)).next();
    text.lines().filter_map(name).collect()
}
