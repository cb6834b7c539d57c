//! Flat lights: the scene's own and virtual point lights.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A point that shines equally in all directions.
pub const OMNI: u32 = 0;
/// A point that shines into the hemisphere around its direction, with a cosine factor.
pub const HEMISPHERE: u32 = 1;
/// Directional light that travels along its direction.
pub const DIRECTIONAL: u32 = 2;

/// A light of the scene. 80 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Light {
    /// Position in scene units (not for [`DIRECTIONAL`]).
    pub position: Vec3,
    /// [`OMNI`], [`HEMISPHERE`] or [`DIRECTIONAL`].
    pub kind: u32,
    /// Unit direction (not for [`OMNI`]).
    pub direction: Vec3,
    /// Factor on the whole contribution.
    pub attenuation: f32,
    /// Colour of the specular term.
    pub specular: Vec3,
    /// Unused.
    pub padding0: f32,
    /// Colour of the diffuse term.
    pub diffuse: Vec3,
    /// Unused.
    pub padding1: f32,
    /// Colour of the ambient term.
    pub ambient: Vec3,
    /// Unused.
    pub padding2: f32,
}

/// A virtual point light: a [`HEMISPHERE`] light with a diffuse colour only (Keller 1997; thesis, section 3.3). 48
/// bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
pub struct Vpl {
    /// Position in scene units, a little off its surface.
    pub position: Vec3,
    /// Factor on the whole contribution.
    pub attenuation: f32,
    /// Unit direction: the normal of its surface.
    pub direction: Vec3,
    /// Unused.
    pub padding0: f32,
    /// Colour of the diffuse term.
    pub diffuse: Vec3,
    /// Unused.
    pub padding1: f32,
}

impl Vpl {
    /// The thesis' intensity: length of the diffuse colour.
    pub fn intensity(&self) -> f32 {
        self.diffuse.length()
    }
}

/// Vector from `point` to the light, unit length for [`DIRECTIONAL`] lights.
pub fn to_light(light: &Light, point: Vec3) -> Vec3 {
    if light.kind == DIRECTIONAL { -light.direction } else { light.position - point }
}

/// Cosine factor of the light for light that leaves it against `unit_to_light`; at most 0 where it does not shine.
pub fn emission_cosine(light: &Light, unit_to_light: Vec3) -> f32 {
    if light.kind == HEMISPHERE { -light.direction.dot(unit_to_light) } else { 1.0 }
}
