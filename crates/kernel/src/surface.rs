//! From a hit to the surface there.

use crate::intersect::{SPHERE, Sphere, Square, TRIANGLE};
use crate::ray::{Hit, Ray, normalize_or_zero};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// What a primitive number stands for. 16 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct Primitive {
    /// [`TRIANGLE`], [`SPHERE`] or [`crate::intersect::SQUARE`].
    pub kind: u32,
    /// Index into the slice of its kind in [`Surfaces`].
    pub index: u32,
    /// Number of its object, from 1 in file order.
    pub object: u32,
    /// Index of its material.
    pub material: u32,
}

/// What a triangle's corners carry. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct TriangleCorners {
    /// Normals; all equal on a flat triangle.
    pub normals: [Vec3; 3],
    /// Texture coordinates.
    pub texture_coordinates: [[f32; 2]; 3],
    /// What the triangle's size adds to the rounding errors of hits, in scene units; 0 in the thesis' model, which does
    /// not ask.
    pub slack: f32,
}

/// All surfaces, as flat slices.
#[derive(Debug, Clone, Copy)]
pub struct Surfaces<'a> {
    /// Primitives in file order.
    pub primitives: &'a [Primitive],
    /// Triangles in file order.
    pub corners: &'a [TriangleCorners],
    /// Spheres in file order.
    pub spheres: &'a [Sphere],
    /// Squares in file order.
    pub squares: &'a [Square],
}

/// A point on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Position in scene units.
    pub point: Vec3,
    /// Unit normal as the scene gives it, never turned towards the ray.
    pub normal: Vec3,
    /// Index of the material.
    pub material: u32,
    /// Number of the object, from 1.
    pub object: u32,
}

/// The surface at a hit of this ray.
pub fn surface_at(surfaces: &Surfaces<'_>, ray: &Ray, hit: &Hit) -> Surface {
    let primitive = surfaces.primitives[hit.primitive as usize];
    let point = ray.origin + ray.direction * hit.t;
    let index = primitive.index as usize;
    let normal = match primitive.kind {
        TRIANGLE => {
            let [a, b, c] = surfaces.corners[index].normals;
            normalize_or_zero(a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v)
        }
        SPHERE => normalize_or_zero(point - surfaces.spheres[index].center),
        _ => surfaces.squares[index].normal,
    };
    Surface { point, normal, material: primitive.material, object: primitive.object }
}
