//! Rays and hits.

use crate::Rules;
use crate::rounding::UNIT;
use glam::Vec3;

/// Least ray parameter of a hit in the original program, in parameter units.
pub const ORIGINAL_EPSILON: f32 = 0.001;

/// Spacing of secondary rays from their surface, relative to the size of the numbers that the hit was computed from:
/// some hundred times the rounding error of a 32-bit float.
pub const RELATIVE_EPSILON: f32 = 2e-5;

/// Relative slack of slab tests, above twice their rounding error (Ize 2013, "Robust BVH Ray Traversal").
pub const SLAB_SLACK: f32 = 1.0 + 4e-7;

/// Relative slack of the ends of rays in slab tests: what is hit just before the end, or as near as something else, may
/// lie in a box that the ray seems to enter later, by the rounding errors of both. Less than [`APPROACH`], so that rays
/// that end next to a wall do not enter its box.
///
/// [`APPROACH`]: crate::rounding::APPROACH
pub const END_SLACK: f32 = 1.0 + 12.0 * UNIT;

/// No hit, or no primitive.
pub const NONE: u32 = u32::MAX;

/// A ray `origin + t * direction` with hits for `t_min < t < t_max`. The direction need not be normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start, in scene units.
    pub origin: Vec3,
    /// Direction; its length is the unit of `t`.
    pub direction: Vec3,
    /// Hits at or below this parameter do not count.
    pub t_min: f32,
    /// Hits at or above this parameter do not count.
    pub t_max: f32,
    /// Whether the ray travels inside a refractive object (the original's spheres then take the far root).
    pub inside: bool,
}

/// The nearest hit of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f32,
    /// Primitive in file order, or [`NONE`].
    pub primitive: u32,
    /// Barycentric coordinate of the second corner (triangles only).
    pub u: f32,
    /// Barycentric coordinate of the third corner (triangles only).
    pub v: f32,
}

impl Hit {
    /// "Nothing before `t_max`".
    pub const fn none(t_max: f32) -> Self {
        Self { t: t_max, primitive: NONE, u: 0.0, v: 0.0 }
    }

    /// Whether anything was hit.
    pub const fn is_some(&self) -> bool {
        self.primitive != NONE
    }

    /// Takes `other` if it is nearer, or equally near and earlier in file order.
    pub fn take_nearer(&mut self, other: Self) {
        if other.t < self.t || (other.t == self.t && other.primitive < self.primitive) {
            *self = other;
        }
    }
}

/// How far a ray that starts at `point`, found `distance` along another ray, must be before its hits count; also the
/// offset of VPLs from their surface. In scene units.
pub fn spawn_epsilon(rules: Rules, point: Vec3, distance: f32) -> f32 {
    match rules {
        Rules::Original => ORIGINAL_EPSILON,
        Rules::Repaired => RELATIVE_EPSILON * point.abs().max_element().max(distance),
    }
}

/// The ray that asks whether `point + to_light` is seen from `point`; its parameter runs from 0 to 1. `epsilon` is
/// [`spawn_epsilon`] of the point.
///
/// The original excludes 0.1 % of the distance at the near end only, whatever the distance.
pub fn shadow_ray(rules: Rules, point: Vec3, to_light: Vec3, epsilon: f32) -> Ray {
    let (t_min, t_max) = match rules {
        Rules::Original => (ORIGINAL_EPSILON, 1.0),
        Rules::Repaired => {
            // Both ends keep their distance, so that neither surface hides the other from itself.
            let relative = epsilon / to_light.length().max(f32::MIN_POSITIVE);
            (relative, 1.0 - relative)
        }
    };
    Ray { origin: point, direction: to_light, t_min, t_max, inside: false }
}

/// Component-wise reciprocal of a direction that is safe in slab tests: zeros become huge, never infinite.
pub fn safe_reciprocal(direction: Vec3) -> Vec3 {
    Vec3::new(safe_component(direction.x), safe_component(direction.y), safe_component(direction.z))
}

/// What smaller components count as in [`safe_reciprocal`].
pub const SAFE_LEAST: f32 = 1e-20;

/// One component of [`safe_reciprocal`].
pub fn safe_component(c: f32) -> f32 {
    1.0 / if c.abs() < SAFE_LEAST { SAFE_LEAST.copysign(c) } else { c }
}

/// `v` times the reciprocal of its length, or zero where it has none.
///
/// The original multiplies by the reciprocal too: dividing instead changes the last bit and, at edges, the number of
/// hits.
pub fn normalize_or_zero(v: Vec3) -> Vec3 {
    v.normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_hits_go_to_the_first_in_file_order() {
        let mut hit = Hit { t: 1.0, primitive: 5, u: 0.0, v: 0.0 };
        hit.take_nearer(Hit { t: 1.0, primitive: 7, u: 0.0, v: 0.0 });
        assert_eq!(hit.primitive, 5);
        hit.take_nearer(Hit { t: 1.0, primitive: 2, u: 0.0, v: 0.0 });
        assert_eq!(hit.primitive, 2);
    }

    #[test]
    fn reciprocals_are_finite() {
        let r = safe_reciprocal(Vec3::new(0.0, -0.0, 2.0));
        assert!(r.is_finite() && r.x > 0.0 && r.y < 0.0);
        assert_eq!(r.z, 0.5);
    }

    #[test]
    fn nothing_is_normalised_to_nan() {
        assert_eq!(normalize_or_zero(Vec3::ZERO), Vec3::ZERO);
    }
}
