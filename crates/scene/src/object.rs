use crate::{Location, MaterialId};
use glam::Vec3;

/// Index into [`crate::SceneDesc::meshes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MeshId(pub u32);

/// A thing that rays can hit.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectDesc {
    /// Name shown to people; may be empty.
    pub name: String,
    /// Its surface.
    pub shape: ShapeDesc,
    /// Its material; a mesh's triangles may name others.
    pub material: MaterialId,
    /// Where it was described.
    pub location: Location,
}

/// The forms of surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShapeDesc {
    /// A sphere (`P SPH`).
    Sphere {
        /// Centre in scene units.
        center: Vec3,
        /// Radius in scene units, above zero.
        radius: f32,
    },
    /// A rectangle (`P SQU`), two-sided for rays, lit on the side of `normal`.
    Square {
        /// Centre in scene units.
        center: Vec3,
        /// Lit side, any length but zero.
        normal: Vec3,
        /// Direction of the edges of length `height`, not parallel to `normal`.
        head: Vec3,
        /// Edge length along cross(head, normal), in scene units, above zero.
        width: f32,
        /// Edge length along `head`, in scene units, above zero.
        height: f32,
    },
    /// A box (`P CUB`).
    Cube {
        /// Centre in scene units.
        center: Vec3,
        /// Direction of `height`.
        vertical: Vec3,
        /// Direction of `length`, not parallel to `vertical`.
        horizontal: Vec3,
        /// Edge length along `horizontal`, in scene units, above zero.
        length: f32,
        /// Edge length across both directions, in scene units, above zero.
        width: f32,
        /// Edge length along `vertical`, in scene units, above zero.
        height: f32,
    },
    /// A triangle mesh (`O`).
    Mesh {
        /// The triangles, in the model's own space.
        mesh: MeshId,
        /// From the model's space to the scene's.
        transform: Transform,
        /// Whether vertex normals are interpolated; else each triangle is flat.
        smooth: bool,
        /// Whether the object's material replaces those of the mesh.
        override_material: bool,
    },
}

/// A model's placement: rotate, then scale, then translate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Rotation axis, any length but zero (ignored when `degrees` is zero).
    pub axis: Vec3,
    /// Rotation angle; positive turns AGAINST the right-hand rule about `axis`, as in the thesis' files.
    pub degrees: f32,
    /// Factor per axis.
    pub scale: Vec3,
    /// Shift in scene units.
    pub translation: Vec3,
}

impl Default for Transform {
    fn default() -> Self {
        Self { axis: Vec3::Y, degrees: 0.0, scale: Vec3::ONE, translation: Vec3::ZERO }
    }
}

/// A triangle mesh in its own space.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshDesc {
    /// Name shown to people, usually the path as the scene gives it.
    pub name: String,
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Vertex normals, any length; zero or non-finite ones are replaced by the triangle's own.
    pub normals: Vec<Vec3>,
    /// Texture coordinates (u right, v up).
    pub texture_coordinates: Vec<[f32; 2]>,
    /// Triangles in file order; a polygon of n vertices is n - 2 of them.
    pub triangles: Vec<MeshTriangle>,
    /// Greatest angle in degrees up to which neighbours were made to look smooth, if any were.
    pub crease_degrees: Option<f32>,
}

/// Three corners, each an index per attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshTriangle {
    /// Indices into [`MeshDesc::positions`].
    pub positions: [u32; 3],
    /// Indices into [`MeshDesc::normals`].
    pub normals: Option<[u32; 3]>,
    /// Indices into [`MeshDesc::texture_coordinates`].
    pub texture_coordinates: Option<[u32; 3]>,
    /// Material of the face; `None` takes the object's.
    pub material: Option<MaterialId>,
}
