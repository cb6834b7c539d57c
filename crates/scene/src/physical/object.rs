use super::SurfaceId;
use crate::{Location, MeshId};
use glam::{DAffine3, DVec3, Vec3};

/// A thing that rays can hit.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalObject {
    /// Name shown to people; may be empty.
    pub name: String,
    /// Its surface.
    pub shape: PhysicalShape,
    /// Its material; a mesh's triangles may name others.
    pub material: SurfaceId,
    /// Where it was described.
    pub location: Location,
}

/// The forms of surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PhysicalShape {
    /// A sphere; its normal points outwards.
    Sphere {
        /// Centre in scene units.
        center: DVec3,
        /// Radius in scene units, above zero.
        radius: f32,
    },
    /// A rectangle.
    Rectangle {
        /// Centre in scene units.
        center: DVec3,
        /// Its normal, any length but zero.
        normal: Vec3,
        /// Direction of the edges of length `height`, not parallel to `normal`.
        head: Vec3,
        /// Edge length across `head`, in scene units, above zero.
        width: f32,
        /// Edge length along `head`, in scene units, above zero.
        height: f32,
    },
    /// An instance of a triangle mesh; a triangle's normal is that about which its corners run counterclockwise.
    Mesh {
        /// The triangles, in the mesh's own space.
        mesh: MeshId,
        /// From the mesh's space to the scene's.
        placement: DAffine3,
        /// Whether vertex normals are interpolated; else each triangle is flat.
        smooth: bool,
        /// Whether the object's material replaces those of the mesh.
        override_material: bool,
    },
}
