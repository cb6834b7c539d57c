//! Flat materials.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A Phong material with the thesis' optical ratios. 80 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Material {
    /// Factor on a light's specular colour.
    pub specular: Vec3,
    /// Phong exponent.
    pub exponent: f32,
    /// Factor on a light's diffuse colour.
    pub diffuse: Vec3,
    /// F: factor on the colour of the mirrored ray.
    pub reflection: f32,
    /// Factor on a light's ambient colour.
    pub ambient: Vec3,
    /// R: factor on the colour of the refracted ray.
    pub refraction: f32,
    /// Colour that the surface shows by itself (the visible squares of area lights); first pass only.
    pub glow: Vec3,
    /// K: the ratio n1/n2 of refractive indices for a ray that enters.
    pub refraction_ratio: f32,
    /// E: factor on the locally evaluated illumination.
    pub local: f32,
    /// Index of the texture, or [`crate::ray::NONE`].
    pub texture: u32,
    /// One of the modes in [`crate::texture`].
    pub texture_mode: u32,
    /// Unused; keeps the record a multiple of 16 bytes.
    pub padding: u32,
}
