//! Vector operations in a fixed order of arithmetic, named so that devices without `glam` compute the same bits.

use glam::Vec3;

/// Least normal number above 0.
pub const MIN_POSITIVE: f32 = f32::MIN_POSITIVE;

/// The dot product, summed from x to z.
pub fn dot3(a: Vec3, b: Vec3) -> f32 {
    a.dot(b)
}

/// The cross product.
pub fn cross3(a: Vec3, b: Vec3) -> Vec3 {
    a.cross(b)
}

/// Length.
pub fn length3(v: Vec3) -> f32 {
    v.length()
}

/// Largest component.
pub fn max_element(v: Vec3) -> f32 {
    v.max_element()
}

/// Smallest component.
pub fn min_element(v: Vec3) -> f32 {
    v.min_element()
}

/// `magnitude` with the sign of `sign`, that of zeros included.
pub fn copy_sign(magnitude: f32, sign: f32) -> f32 {
    magnitude.copysign(sign)
}
