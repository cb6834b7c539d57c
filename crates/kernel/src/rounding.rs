//! Rounding errors of hits: points put back onto their surfaces, and how far off these they may still be.
//!
//! After Pharr, Jakob & Humphreys 2023, "Physically Based Rendering", section 6.8; differs: bounds are of the distance
//! from the surface's plane, component by component, so that what lies in a plane across an axis has next to none,
//! however large it is.

use crate::intersect::{Sphere, Square};
use glam::Vec3;

/// Half the spacing of 32-bit floats between 1 and 2: the greatest relative error of an operation.
pub const UNIT: f32 = f32::EPSILON / 2.0;

/// Operations on coordinates from a ray's end to a point that is put back, in each component, twice over.
const POINT_ERRORS: f32 = 12.0;

/// The same of what intersections compute, on distances within a primitive.
const TEST_ERRORS: f32 = 8.0;

/// The same on a sphere, whose roots are of squares.
const SPHERE_ERRORS: f32 = 4.0;

/// Least distance from a surface, in roundings of the greatest coordinate.
const LEAST_ERRORS: f32 = 2.0;

/// By how much a ray to a place is longer than the way there, relative to it: walls that meet at the place are found.
pub const REACH: f32 = 1.0 + 8.0 * UNIT;

/// How far a place keeps off its own surface, relative to the way of a ray to it: more than the error of a hit from
/// there.
pub const APPROACH: f32 = 16.0 * UNIT;

/// The point of the plane `normal . x = offset` nearest to one.
pub fn onto_plane(point: Vec3, normal: Vec3, offset: f32) -> Vec3 {
    point - normal * (normal.dot(point) - offset)
}

/// The point of a square's plane nearest to one.
pub fn onto_square(point: Vec3, square: &Square) -> Vec3 {
    point - square.normal * square.normal.dot(point - square.center)
}

/// The point of a sphere nearest to one; the point itself at the centre.
pub fn onto_sphere(point: Vec3, sphere: &Sphere) -> Vec3 {
    let offset = point - sphere.center;
    let length = offset.length();
    if length > 0.0 { sphere.center + offset * (sphere.radius / length) } else { point }
}

/// Bound on the distance between a plane and a point that was put back onto it, and on errors of intersections near the
/// point; `slack` is what the primitive's own size adds, such as [`triangle_slack`]. In scene units.
pub fn plane_error(point: Vec3, normal: Vec3, slack: f32) -> f32 {
    UNIT * (POINT_ERRORS * normal.abs().dot(point.abs()) + LEAST_ERRORS * point.abs().max_element()) + slack
}

/// The slack of a square at a point of it.
pub fn square_slack(point: Vec3, square: &Square) -> f32 {
    UNIT * TEST_ERRORS * square.normal.abs().dot((point - square.center).abs())
}

/// The slack of a sphere.
pub fn sphere_slack(radius: f32) -> f32 {
    UNIT * SPHERE_ERRORS * radius
}

/// The slack of a triangle for rays that begin next to it: errors of [`crate::watertight::intersect_watertight`] across
/// its plane.
pub fn triangle_slack(edge1: Vec3, edge2: Vec3) -> f32 {
    let lower = edge1.min(edge2).min(Vec3::ZERO);
    let reach = edge1.max(edge2).max(Vec3::ZERO) - lower;
    let (a, b) = (edge1.abs(), edge2.abs());
    // The distance is offset . (a x b) over the length of a x b, and each offset at most `reach`.
    let products =
        Vec3::new(reach.y * a.z + reach.z * a.y, reach.z * a.x + reach.x * a.z, reach.x * a.y + reach.y * a.x);
    let doubled_area = edge1.cross(edge2).length();
    if doubled_area > 0.0 { UNIT * TEST_ERRORS * b.dot(products) / doubled_area } else { 0.0 }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::Rules;
    use crate::intersect::{intersect_sphere, intersect_square};
    use crate::ray::Ray;
    use crate::rng::random4;
    use crate::watertight::{Shear, intersect_watertight};

    /// A vector of up to half a unit each way.
    pub(crate) fn vector(k: u32, what: u32) -> Vec3 {
        let [x, y, z, _] = random4(k, what, 0, 91);
        Vec3::new(x, y, z) - 0.5
    }

    pub(crate) fn ray(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, inside: false }
    }

    /// A direction on one side of a surface, for most draws along it.
    fn leaving(k: u32, side: Vec3) -> Vec3 {
        let [grazing, ..] = random4(k, 6, 0, 91);
        let along = side.cross(vector(k, 5)).normalize();
        let rise = if k.is_multiple_of(4) { 1.0 } else { 10.0_f32.powf(-6.0 * grazing) };
        (along + side * rise).normalize()
    }

    /// A size from 1e-3 to 1e3, and a distance from the origin of up to 1e6 times as much.
    fn scale(k: u32) -> (f32, Vec3) {
        let [s, d, ..] = random4(k, 7, 0, 91);
        let size = 10.0_f32.powf(6.0 * s - 3.0);
        (size, vector(k, 8) * size * 10.0_f32.powf(6.0 * d))
    }

    /// A unit vector, across an axis for each fifth.
    fn normal(k: u32) -> Vec3 {
        if k.is_multiple_of(5) { Vec3::AXES[k as usize / 5 % 3] } else { vector(k, 1).normalize() }
    }

    #[test]
    fn rays_from_a_triangle_do_not_meet_it() {
        for k in 0..200_000 {
            let (size, place) = scale(k);
            let [u, v, narrow, _] = random4(k, 9, 0, 91);
            let n = normal(k);
            let across = n.cross(vector(k, 2)).normalize();
            // From equilateral to needles.
            let edge1 = across * size;
            let edge2 = (across * 0.5 + n.cross(across) * 10.0_f32.powf(-5.0 * narrow)) * size;
            let corner = place;
            let (b, c) = (corner + edge1, corner + edge2);
            let (edge1, edge2) = (b - corner, c - corner);
            let cross = edge1.as_dvec3().cross(edge2.as_dvec3());
            let Some(exact) = cross.try_normalize() else { continue };
            let flat = exact.as_vec3();
            let offset = exact.dot(corner.as_dvec3());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let off = corner + edge1 * u + edge2 * v + vector(k, 4) * size * 0.1;
            let point = onto_plane(off, flat, offset as f32);
            // The plane's own rounding is what worlds add to the slack.
            let misfit = [corner, b, c].map(|p| (flat.as_dvec3().dot(p.as_dvec3()) - offset).abs() as f32);
            let slack = triangle_slack(edge1, edge2) + misfit.into_iter().fold(0.0, f32::max);
            let error = plane_error(point, flat, slack);
            let distance = (exact.dot(point.as_dvec3()) - offset).abs();
            assert!(distance <= f64::from(error), "{k}: {distance:e} off a plane, bound {error:e}");
            let side = if k % 2 == 0 { flat } else { -flat };
            let start = ray(point + side * error, leaving(k, side));
            let hit = intersect_watertight(&[corner, b, c], 0, &start, &Shear::new(start.direction));
            assert!(hit.is_none(), "{k}: {hit:?}");
        }
    }

    #[test]
    fn rays_from_a_square_do_not_meet_it() {
        for k in 0..200_000 {
            let (size, center) = scale(k);
            let n = normal(k);
            let along = n.cross(vector(k, 2)).normalize();
            let square = Square {
                center,
                half_height: size,
                normal: n,
                half_width: size,
                along,
                primitive: 0,
                across: along.cross(n),
                padding: 0,
            };
            let point = onto_square(center + vector(k, 4) * size, &square);
            let error = plane_error(point, n, square_slack(point, &square));
            let side = if k % 2 == 0 { n } else { -n };
            let hit = intersect_square(&square, &ray(point + side * error, leaving(k, side)));
            assert!(hit.is_none(), "{k}: {hit:?}");
        }
    }

    #[test]
    fn rays_from_a_sphere_do_not_meet_it() {
        for k in 0..200_000 {
            let (radius, place) = scale(k);
            let out = vector(k, 4).normalize();
            // Half of them as a ground that touches the origin.
            let center = if k.is_multiple_of(2) { place } else { vector(k, 8) * 1e-4 * radius - out * radius };
            let sphere = Sphere { center, radius, primitive: 0, padding: [0; 3] };
            let point = onto_sphere(center + (out + vector(k, 3) * 1e-3) * radius * 1.001, &sphere);
            let n = (point - center).normalize();
            let error = plane_error(point, n, sphere_slack(radius));
            let hit = intersect_sphere(&sphere, &ray(point + n * error, leaving(k, n)), Rules::Repaired);
            assert!(hit.is_none(), "{k}: {hit:?} radius {radius} at {center}");
        }
    }

    #[test]
    fn what_lies_across_an_axis_keeps_its_place() {
        // A ground of 2,000 units: shadows touch what stands on it.
        let (edge1, edge2) = (Vec3::X * 2000.0, Vec3::Z * 2000.0);
        assert_eq!(triangle_slack(edge1, edge2), 0.0);
        assert!(plane_error(Vec3::new(3.0, 0.0, 4.0), Vec3::Y, 0.0) < 1e-6);
        let tilted = (edge1 + Vec3::Y * 500.0, edge2);
        assert!(triangle_slack(tilted.0, tilted.1) > 1e-4);
    }
}
