//! Photons for caustics: what they are and where they start.

use crate::light::{DIRECTIONAL, HEMISPHERE, Light};
use crate::ray::{Ray, normalize_or_zero};
use crate::sampling::frame;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// How many times the larger of a target's radius and distance from the origin directional light starts before it.
const FAR_SIDE: f32 = 4.0;

/// Light that fell on a point. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Photon {
    /// Where, in scene units.
    pub position: Vec3,
    /// Cell along x.
    pub cell_x: i32,
    /// Unit normal of the surface.
    pub normal: Vec3,
    /// Cell along y.
    pub cell_y: i32,
    /// Colour times the area, in square scene units, that the photon stands for.
    pub power: Vec3,
    /// Cell along z.
    pub cell_z: i32,
}

/// An object to shoot at from a light. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PhotonTarget {
    /// Centre of the object's bounding sphere, in scene units.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
    /// Index of the light.
    pub light: u32,
    /// Number of the object, from 1.
    pub object: u32,
    /// Photons across the disk.
    pub side: u32,
    /// Unused.
    pub padding: u32,
}

/// A photon on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotonStart {
    /// Its ray.
    pub ray: Ray,
    /// Area of the disk that it stands for, times the light's cosine; 0 where there is no photon.
    pub area: f32,
}

/// The photon through a point of the grid on the disk of a target's bounding sphere seen from the light.
pub fn photon_start(light: &Light, target: &PhotonTarget, row: u32, column: u32) -> PhotonStart {
    let spacing = 2.0 * target.radius / target.side as f32;
    let axis =
        if light.kind == DIRECTIONAL { light.direction } else { normalize_or_zero(target.center - light.position) };
    let (right, up) = frame(axis);
    let x = (column as f32 + 0.5) * spacing - target.radius;
    let y = (row as f32 + 0.5) * spacing - target.radius;
    let on_disk = target.center + right * x + up * y;
    let (mut origin, mut direction) = (light.position, normalize_or_zero(on_disk - light.position));
    if light.kind == DIRECTIONAL {
        origin = on_disk - axis * (FAR_SIDE * target.radius.max(on_disk.abs().max_element()));
        direction = axis;
    }
    let cosine = if light.kind == HEMISPHERE { light.direction.dot(direction) } else { 1.0 };
    let outside = x * x + y * y > target.radius * target.radius || axis == Vec3::ZERO;
    let ray = Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, inside: false };
    PhotonStart { ray, area: if outside || cosine <= 0.0 { 0.0 } else { spacing * spacing * cosine } }
}
