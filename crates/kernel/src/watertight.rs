//! Rays against triangles without gaps: of those that meet at an edge or a corner a ray through it hits one at least.
//!
//! After Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection": seen along the ray, corners that triangles
//! share lie at the same place for each, and on which side of an edge the ray passes comes out with opposite signs for
//! both. Differs: a ray right through an edge hits both, which needs no wider numbers; and the distance is that of the
//! triangle's plane, next to which rays begin, but no nearer and no farther than its corners.

use crate::ray::{Hit, Ray};
use glam::Vec3;

/// Space as a ray sees it: axes turned so that its longest comes last, and moved along that one so that it is the ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear {
    /// The axes in turned order; the last is the one along which the ray is longest.
    pub axes: [usize; 3],
    /// How far the ray goes along the first two while it goes one unit along the last.
    pub slope: [f32; 2],
    /// The ray's parameter per unit of the last axis.
    pub scale: f32,
}

impl Shear {
    /// That of a direction, of any length.
    #[inline]
    pub fn new(direction: Vec3) -> Self {
        let axes = TURNED[longest_axis(direction) % 4];
        let along = picked(direction, axes);
        let scale = 1.0 / along.z;
        Self { axes, slope: [along.x * scale, along.y * scale], scale }
    }

    /// A vector's components in turned order.
    #[inline]
    pub fn turned(&self, v: Vec3) -> Vec3 {
        picked(v, self.axes)
    }
}

/// The axes in turned order, by the last; a fourth so that there is nothing to check.
const TURNED: [[usize; 3]; 4] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2]];

/// Components of a vector.
#[inline]
fn picked(v: Vec3, axes: [usize; 3]) -> Vec3 {
    let v = [v.x, v.y, v.z, 0.0];
    Vec3::from(axes.map(|axis| v[axis % 4]))
}

/// The axis along which a direction is longest; of equal ones the first.
#[inline]
fn longest_axis(direction: Vec3) -> usize {
    let [x, y, z] = direction.abs().to_array();
    // Without branches, which nothing foretells.
    usize::from(x < y.max(z)) * (2 - usize::from(y >= z))
}

/// A triangle by its corners, from either side; its plane is the more exact the shorter the edges at the first corner are.
/// `shear` is that of the ray's direction. Arithmetic in the order of the formulas, no fma: else edges would have other
/// signs from either side, and devices other bits.
pub fn intersect_watertight(corners: &[Vec3; 3], primitive: u32, ray: &Ray, shear: &Shear) -> Option<Hit> {
    let corners = corners.map(|corner| shear.turned(corner));
    let [a, b, c] = corners.map(|corner| corner - shear.turned(ray.origin));
    let flat = |p: Vec3| [p.x - shear.slope[0] * p.z, p.y - shear.slope[1] * p.z];
    let edge = |p: [f32; 2], q: [f32; 2]| p[0] * q[1] - p[1] * q[0];
    let [flat_a, flat_b, flat_c] = [flat(a), flat(b), flat(c)];
    let (of_a, of_b, of_c) = (edge(flat_b, flat_c), edge(flat_c, flat_a), edge(flat_a, flat_b));
    let sum = (of_a + of_b) + of_c;
    let is_inside = (of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0) || (of_a <= 0.0 && of_b <= 0.0 && of_c <= 0.0);
    // A triangle without extent across the ray has nothing to hit.
    if !is_inside || sum == 0.0 {
        return None;
    }
    let inverse = 1.0 / sum;
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let of_plane = normal.dot(a) / normal.dot(shear.turned(ray.direction));
    let [at_a, at_b, at_c] = [a.z, b.z, c.z].map(|z| z * shear.scale);
    // A triangle that has no plane, or is seen from its side, is where its corners are.
    let t = of_plane.max(at_a.min(at_b).min(at_c)).min(at_a.max(at_b).max(at_c));
    (t > ray.t_min && t < ray.t_max).then_some(Hit { t, primitive, u: of_b * inverse, v: of_c * inverse })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;
    use crate::rounding::UNIT;
    use crate::rounding::tests::{ray, vector};

    fn hit(corners: &[Vec3; 3], ray: &Ray) -> Option<Hit> {
        intersect_watertight(corners, 0, ray, &Shear::new(ray.direction))
    }

    #[test]
    fn barycentrics_are_of_the_second_and_the_third_corner() {
        let corners = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0];
        let down = ray(Vec3::new(1.0, 2.0, 1.0), Vec3::NEG_Z * 0.5);
        assert_eq!(hit(&corners, &down), Some(Hit { t: 2.0, primitive: 0, u: 0.25, v: 0.5 }));
        assert_eq!(
            hit(&[corners[0], corners[2], corners[1]], &down),
            Some(Hit { t: 2.0, primitive: 0, u: 0.5, v: 0.25 })
        );
        assert_eq!(hit(&corners, &Ray { t_max: 2.0, ..down }), None);
        assert_eq!(hit(&corners, &ray(Vec3::new(3.0, 2.0, 1.0), Vec3::NEG_Z)), None);
        assert_eq!(hit(&corners, &ray(Vec3::new(1.0, 2.0, 1.0), Vec3::Z)), None);
    }

    #[test]
    fn what_has_no_extent_is_not_hit() {
        for k in 0..1000 {
            let (p, q) = (vector(k, 0), vector(k, 1));
            let start = ray(vector(k, 2), p);
            assert_eq!(hit(&[q; 3], &start), None);
            assert_eq!(hit(&[q; 3], &ray(q, p)), None);
        }
        assert_eq!(hit(&[Vec3::ZERO, Vec3::X, Vec3::Y], &ray(Vec3::Z, Vec3::ZERO)), None);
    }

    /// Everywhere on a fan of triangles about a corner, most rays right at its edges and at the corner itself: nothing
    /// goes through, however flat the view.
    #[test]
    fn nothing_goes_between_triangles() {
        const BLADES: usize = 7;
        let mut hits = 0;
        for k in 0..200_000 {
            let normal = vector(k, 1).normalize();
            let (right, up) = (normal.any_orthonormal_vector(), normal.cross(normal.any_orthonormal_vector()));
            let middle = vector(k, 2) * [1.0, 100.0][k as usize % 2];
            let rim: [Vec3; BLADES] = std::array::from_fn(|j| {
                let (sin, cos) = ((j as f32 + 0.4 * random4(k, j as u32, 1, 93)[0]) * 0.89).sin_cos();
                middle + right * cos + up * sin
            });
            let [along, which, lift, turn] = random4(k, 3, 0, 93);
            let towards = rim[(which * BLADES as f32) as usize % BLADES] - middle;
            let target = middle + towards * [0.9 * along, 1e-6 * along, 0.0][k as usize / 2 % 3];
            let height = 10.0_f32.powf(-3.0 * lift);
            let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
            let origin = target + (right * cos + up * sin) * 3.0 + normal * height;
            let start = ray(origin, (target - origin) * [1.0, 0.01][k as usize % 2]);
            let of_blade = |j: usize| hit(&[middle, rim[j], rim[(j + 1) % BLADES]], &start);
            let found: Vec<Hit> = (0..BLADES).filter_map(of_blade).collect();
            assert!(!found.is_empty(), "{k}: nothing from {origin} to {target}");
            hits += found.len();
            for hit in &found {
                let off = (start.origin + start.direction * hit.t - target).length();
                // As far along the plane as the ray's own rounding may carry it.
                assert!(off < 1e-4 / height, "{k}: {hit:?} is {off} off");
                assert!(hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v < 1.0 + 4.0 * UNIT, "{k}: {hit:?}");
            }
        }
        println!("{hits} hits by 200000 rays");
    }

    /// Seen from its side a triangle is no nearer and no farther than its corners.
    #[test]
    fn distances_stay_with_the_corners() {
        let mut hits = 0;
        for k in 0..100_000 {
            let place = vector(k, 0) * 20.0;
            let corners = [1, 2, 3].map(|what| place + vector(k, what) * [1.0, 1e-3][k as usize % 2]);
            let [a, b, s, _] = random4(k, 4, 0, 93);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
            let target = corners[0].lerp(corners[1], a).lerp(corners[2], b);
            let direction = corners[0] - corners[2] + normal * 10.0_f32.powf(-7.0 * s);
            let start = ray(target - direction.normalize() * 5.0, direction.normalize());
            let Some(hit) = hit(&corners, &start) else { continue };
            hits += 1;
            let Shear { axes, scale, .. } = Shear::new(start.direction);
            let along = corners.map(|corner| (corner - start.origin)[axes[2]] * scale);
            let (least, greatest) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
            assert!(hit.t > least - 1e-5 && hit.t < greatest + 1e-5, "{k}: {} of {least} to {greatest}", hit.t);
        }
        println!("{hits} of 100000 rays hit");
        assert!(hits > 50_000);
    }
}
