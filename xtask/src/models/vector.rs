//! Three numbers with the few operations that modelling needs.

use std::ops::{Add, Mul, Sub};

/// A point or direction; y is up, x to the right and z towards the viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vec3 {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

/// Short for [`Vec3`]'s fields in order.
pub(super) const fn vec3(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3 { x, y, z }
}

impl Vec3 {
    pub(super) fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    pub(super) fn cross(self, other: Self) -> Self {
        vec3(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    pub(super) fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// The unit vector, or zero for a vector without a direction.
    pub(super) fn normalised(self) -> Self {
        let length = self.length();
        if length > 0.0 { self * (1.0 / length) } else { self }
    }

    /// The point at `t` between `self` (0) and `other` (1).
    pub(super) fn lerp(self, other: Self, t: f64) -> Self {
        self + (other - self) * t
    }

    /// Each field rounded to three decimals, as the OBJ file holds it; never a negative zero.
    pub(super) fn rounded(self) -> Self {
        let round = |value: f64| (value * 1000.0).round() / 1000.0 + 0.0;
        vec3(round(self.x), round(self.y), round(self.z))
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        vec3(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        vec3(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }
}
