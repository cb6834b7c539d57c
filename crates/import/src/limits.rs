/// Largest sizes that an importer accepts; beyond them it reports an error instead of reading on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Length of a scene text, in bytes: 64 MiB.
    pub scene_bytes: u64,
    /// Length of a scene in TOML, in bytes: 32 MiB. Less than of other texts, for the whole document is held in memory, which
    /// takes up to 80 times its length.
    pub document_bytes: u64,
    /// Number of directives in a scene text, of materials, meshes, objects and lights in TOML: 1,000,000.
    pub directives: usize,
    /// Length of a model file, in bytes: 2 GiB.
    pub model_bytes: u64,
    /// Number of vertices, normals, texture coordinates and triangles in all meshes together: 150,000,000.
    /// Needed beside the length: a polygon is short in the file and long in memory.
    pub mesh_elements: usize,
    /// Length of an MTL file, in bytes: 16 MiB.
    pub material_bytes: u64,
    /// Length of a texture file, in bytes: 256 MiB.
    pub texture_bytes: u64,
    /// Size of all images of a physical scene in memory, in bytes: 16 GiB.
    pub image_bytes: u64,
    /// Width and height of a texture, in texels: 16,384 each.
    pub texture_side: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            scene_bytes: 64 << 20,
            document_bytes: 32 << 20,
            directives: 1_000_000,
            model_bytes: 2 << 30,
            mesh_elements: 150_000_000,
            material_bytes: 16 << 20,
            texture_bytes: 256 << 20,
            image_bytes: 16 << 30,
            texture_side: 16_384,
        }
    }
}
