//! Pixel filters: how much a sample counts for a pixel at some distance.

use crate::power::exp2_polynomial;
use bytemuck::{Pod, Zeroable};

/// Constant.
pub const FILTER_BOX: u32 = 0;
/// Linear falloff.
pub const FILTER_TRIANGLE: u32 = 1;
/// exp(-alpha x^2), lowered to reach 0 at the radius.
pub const FILTER_GAUSSIAN: u32 = 2;
/// Mitchell & Netravali 1988.
pub const FILTER_MITCHELL: u32 = 3;

/// A filter. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PixelFilter {
    /// One of the constants of this module.
    pub kind: u32,
    /// Radius in pixels.
    pub radius: f32,
    /// Falloff of the Gaussian.
    pub alpha: f32,
    /// Mitchell's B.
    pub mitchell_b: f32,
    /// Mitchell's C.
    pub mitchell_c: f32,
    /// Unused; keeps the record a multiple of 16 bytes.
    pub padding: [u32; 3],
}

/// Weight of a sample `x` pixels to the right of and `y` pixels above a pixel's centre. Separable; zero from the radius
/// on, the box excluding its upper end so that a sample on a border belongs to one pixel.
pub fn filter_weight(filter: &PixelFilter, x: f32, y: f32) -> f32 {
    filter_along(filter, x) * filter_along(filter, y)
}

/// Weight along one axis.
pub fn filter_along(filter: &PixelFilter, x: f32) -> f32 {
    let radius = filter.radius;
    if !(x >= -radius && x < radius) {
        return 0.0;
    }
    match filter.kind {
        FILTER_BOX => 1.0,
        FILTER_TRIANGLE => radius - x.abs(),
        FILTER_GAUSSIAN => (gaussian(filter, x) - gaussian(filter, radius)).max(0.0),
        _ => mitchell(filter, x.abs() * 2.0 / radius),
    }
}

/// exp(-alpha x^2).
pub fn gaussian(filter: &PixelFilter, x: f32) -> f32 {
    exp2_polynomial(-(filter.alpha * std::f32::consts::LOG2_E) * (x * x))
}

/// Mitchell & Netravali 1988, "Reconstruction Filters in Computer Graphics", Eq. 8; x in 0..2.
pub fn mitchell(filter: &PixelFilter, x: f32) -> f32 {
    let (b, c) = (filter.mitchell_b, filter.mitchell_c);
    let value = if x < 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)
    } else {
        (((-b - 6.0 * c) * x + (6.0 * b + 30.0 * c)) * x + (-12.0 * b - 48.0 * c)) * x + (8.0 * b + 24.0 * c)
    };
    value / 6.0
}
