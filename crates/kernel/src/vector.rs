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

/// A product that is rounded before anything is added to it.
pub fn rounded_product(a: f32, b: f32) -> f32 {
    a * b
}

/// A vector by a factor; products are rounded before anything is added to them.
pub fn scaled(v: Vec3, factor: f32) -> Vec3 {
    v * factor
}

/// A quotient, correctly rounded, as decisions about edges need it.
pub fn quotient(a: f32, b: f32) -> f32 {
    a / b
}

/// A square root, correctly rounded.
pub fn square_root(x: f32) -> f32 {
    x.sqrt()
}
