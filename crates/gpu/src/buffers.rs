//! The buffers of programs by their names: what their elements are, and which of them may be split.

/// WGSL type of the elements of each buffer; buffers of one name have one layout in all programs.
const ELEMENTS: [(&str, &str); 41] = [
    ("nodes", "CompressedNode"),
    ("items", "LeafItem"),
    ("squares", "Square"),
    ("spheres", "Sphere"),
    ("primitives", "Primitive"),
    ("corners", "TriangleCorners"),
    ("materials", "Material"),
    ("textures", "Texture"),
    ("texels", "u32"),
    ("lights", "Light"),
    ("samples", "CameraSample"),
    ("node_rays", "NodeRay"),
    ("node_surfaces", "NodeSurface"),
    ("node_colors", "NodeColor"),
    ("node_links", "NodeLink"),
    ("node_totals", "NodeTotal"),
    ("node_occlusion", "f32"),
    ("vpls", "Vpl"),
    ("light_nodes", "PackedLightNode"),
    ("photons", "Photon"),
    ("words", "u32"),
    ("block_sums", "u32"),
    ("counters", "atomic<u32>"),
    ("placed", "Vpl"),
    ("tiles", "TileRecord"),
    ("pixels", "PixelRecord"),
    ("film_places", "Place"),
    ("film_sums", "vec4<f32>"),
    ("seen", "SeenRecord"),
    ("pairs_in", "vec2<u32>"),
    ("pairs_out", "vec2<u32>"),
    ("row_starts", "atomic<u32>"),
    ("shifts", "vec2<f32>"),
    ("probe_rays", "ProbeRay"),
    ("probe_hits", "Hit"),
    ("tone_pairs", "vec2<f32>"),
    ("plane_in", "f32"),
    ("plane_out", "f32"),
    ("blur_weights", "f32"),
    ("picture", "vec4<f32>"),
    ("bloomed", "vec4<f32>"),
];

/// Functions through which programs read the world's large buffers, which may be split over several bindings.
const ACCESSORS: [(&str, &str); 4] = [
    ("nodes", "compressed_node"),
    ("items", "leaf_item"),
    ("corners", "triangle_corners"),
    ("primitives", "primitive_record"),
];

/// The WGSL type of a buffer's elements.
pub fn element(name: &str) -> &'static str {
    look_up(&ELEMENTS, name).expect("buffers are named where they are listed")
}

/// The function through which programs read a buffer that may be split; `None` where it may not.
pub(crate) fn accessor(name: &str) -> Option<&'static str> {
    look_up(&ACCESSORS, name)
}

fn look_up(table: &[(&'static str, &'static str)], name: &str) -> Option<&'static str> {
    table.iter().find(|(listed, _)| *listed == name).map(|(_, value)| *value)
}

/// How the buffers of a name are split: into how many parts of 2^shift elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Split {
    /// Number of buffers.
    pub parts: u32,
    /// Elements of all but the last, as a power of two.
    pub shift: u32,
}

impl Split {
    /// One buffer.
    pub const WHOLE: Self = Self { parts: 1, shift: 31 };
}
