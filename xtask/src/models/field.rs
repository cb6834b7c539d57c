//! Bodies as fields: functions that are negative inside, zero on the surface and about the distance elsewhere.
//!
//! Only + - * / and the square root are used, so that every machine computes the same field.

use super::vector::{Vec3, vec3};

/// Distance to the segment from `a` to `b` minus a radius that changes from `radius_a` to `radius_b` along it.
pub(super) fn capsule(point: Vec3, a: Vec3, b: Vec3, radius_a: f64, radius_b: f64) -> f64 {
    let axis = b - a;
    let along = ((point - a).dot(axis) / axis.dot(axis)).clamp(0.0, 1.0);
    (point - a.lerp(b, along)).length() - (radius_a + (radius_b - radius_a) * along)
}

/// About the distance to an ellipsoid: exact in sign, first order near the surface.
pub(super) fn ellipsoid(point: Vec3, centre: Vec3, radii: Vec3) -> f64 {
    let p = point - centre;
    let scaled = vec3(p.x / radii.x, p.y / radii.y, p.z / radii.z);
    let steep = vec3(scaled.x / radii.x, scaled.y / radii.y, scaled.z / radii.z);
    let (length, slope) = (scaled.length(), steep.length());
    if slope > 0.0 { length * (length - 1.0) / slope } else { -radii.x.min(radii.y).min(radii.z) }
}

/// Distance to a plane; inside is behind the unit `normal`.
pub(super) fn half_space(point: Vec3, on: Vec3, normal: Vec3) -> f64 {
    (point - on).dot(normal)
}

/// Union of two bodies with a fillet of about `radius` (the polynomial smooth minimum of graphics folklore).
pub(super) fn blend(a: f64, b: f64, radius: f64) -> f64 {
    let overlap = (radius - (a - b).abs()).max(0.0) / radius;
    a.min(b) - overlap * overlap * radius * 0.25
}

/// What of `a` lies in `b` too, the edge rounded by about `radius`.
pub(super) fn common(a: f64, b: f64, radius: f64) -> f64 {
    -blend(-a, -b, radius)
}

/// One at zero, smoothly down to zero at plus and minus one.
pub(super) fn bump(t: f64) -> f64 {
    let s = (1.0 - t * t).max(0.0);
    s * s
}

/// Zero below `low`, one above `high`, smooth between.
pub(super) fn step(low: f64, high: f64, value: f64) -> f64 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The unit normal of the surface of `field` near `point`, by central differences.
pub(super) fn gradient(field: &impl Fn(Vec3) -> f64, point: Vec3) -> Vec3 {
    const STEP: f64 = 0.05;
    let along = |axis: Vec3| (field(point + axis * STEP) - field(point - axis * STEP)) / (2.0 * STEP);
    vec3(along(vec3(1.0, 0.0, 0.0)), along(vec3(0.0, 1.0, 0.0)), along(vec3(0.0, 0.0, 1.0)))
}

/// `point` moved on to the surface of `field` by two Newton steps of at most `reach` each.
pub(super) fn project(field: &impl Fn(Vec3) -> f64, point: Vec3, reach: f64) -> Vec3 {
    (0..2).fold(point, |at, _| {
        let slope = gradient(field, at);
        let steep = slope.dot(slope).max(0.25);
        at - slope * (field(at) / steep).clamp(-reach, reach)
    })
}
