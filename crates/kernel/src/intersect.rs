//! Rays against the primitives: triangles, spheres and squares.

use crate::Rules;
use crate::ray::{Hit, ORIGINAL_EPSILON, Ray};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Least determinant of a triangle hit in the original, in its units of volume: thin triangles can vanish.
pub const ORIGINAL_MIN_DETERMINANT: f32 = 0.001;

/// Kind of primitive: a triangle.
pub const TRIANGLE: u32 = 0;
/// Kind of primitive: a sphere.
pub const SPHERE: u32 = 1;
/// Kind of primitive: a square.
pub const SQUARE: u32 = 2;

/// A triangle as rays see it. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Triangle {
    /// First corner, in scene units.
    pub corner: Vec3,
    /// Primitive in file order.
    pub primitive: u32,
    /// Second corner minus first.
    pub edge1: Vec3,
    /// Unused; keeps the vectors at multiples of 16 bytes.
    pub padding0: u32,
    /// Third corner minus first.
    pub edge2: Vec3,
    /// Unused.
    pub padding1: u32,
}

/// A sphere. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Sphere {
    /// Centre in scene units.
    pub center: Vec3,
    /// Radius in scene units.
    pub radius: f32,
    /// Primitive in file order.
    pub primitive: u32,
    /// Unused; keeps the record a multiple of 16 bytes.
    pub padding: [u32; 3],
}

/// A rectangle around a centre. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Square {
    /// Centre in scene units.
    pub center: Vec3,
    /// Half the extent along `along`.
    pub half_height: f32,
    /// Unit normal.
    pub normal: Vec3,
    /// Half the extent along `across`.
    pub half_width: f32,
    /// Unit direction of the height (the thesis' head).
    pub along: Vec3,
    /// Primitive in file order.
    pub primitive: u32,
    /// Unit direction of the width: along x normal.
    pub across: Vec3,
    /// Unused; keeps the record a multiple of 16 bytes.
    pub padding: u32,
}

/// Least determinant that counts as a hit.
pub fn min_determinant(rules: Rules) -> f32 {
    match rules {
        Rules::Original => ORIGINAL_MIN_DETERMINANT,
        Rules::Repaired => f32::MIN_POSITIVE,
    }
}

/// A triangle (Moeller & Trumbore 1997). Arithmetic in the order of the formulas, no fma, so that SIMD lanes and other
/// devices give the same bits.
pub fn intersect_triangle(triangle: &Triangle, ray: &Ray, min_determinant: f32) -> Option<Hit> {
    let Triangle { corner, edge1, edge2, .. } = *triangle;
    let p = ray.direction.cross(edge2);
    let determinant = edge1.dot(p);
    if determinant.abs() < min_determinant {
        return None;
    }
    let inverse = 1.0 / determinant;
    let to_origin = ray.origin - corner;
    let u = to_origin.dot(p) * inverse;
    let q = to_origin.cross(edge1);
    let v = ray.direction.dot(q) * inverse;
    let t = edge2.dot(q) * inverse;
    // NaN fails every comparison and so misses.
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > ray.t_min && t < ray.t_max;
    inside.then_some(Hit { t, primitive: triangle.primitive, u, v })
}

/// A sphere. Repaired: the nearest root between the ray's ends, from a form that keeps its precision for far, small
/// spheres (Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection").
///
/// Original: from outside the near root if it is above 0, else the far one; inside the far one; a root in (0, 0.001]
/// hides the sphere.
pub fn intersect_sphere(sphere: &Sphere, ray: &Ray, rules: Rules) -> Option<Hit> {
    let root = match rules {
        Rules::Original => sphere_root_original(sphere, ray),
        Rules::Repaired => sphere_root(sphere, ray),
    };
    root.filter(|&t| t > ray.t_min && t < ray.t_max).map(|t| Hit { t, primitive: sphere.primitive, u: 0.0, v: 0.0 })
}

fn sphere_root(sphere: &Sphere, ray: &Ray) -> Option<f32> {
    let offset = ray.origin - sphere.center;
    let a = ray.direction.length_squared();
    let half_b = -offset.dot(ray.direction);
    let nearest = offset + ray.direction * (half_b / a);
    let discriminant = a * (sphere.radius * sphere.radius - nearest.length_squared());
    if discriminant < 0.0 || a == 0.0 {
        return None;
    }
    let c = offset.length_squared() - sphere.radius * sphere.radius;
    let q = half_b + discriminant.sqrt().copysign(half_b);
    let (first, second) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
    let (near, far) = if first < second { (first, second) } else { (second, first) };
    Some(if near > ray.t_min { near } else { far })
}

fn sphere_root_original(sphere: &Sphere, ray: &Ray) -> Option<f32> {
    let offset = ray.origin - sphere.center;
    let a = ray.direction.dot(ray.direction);
    let b = 2.0 * ray.direction.dot(offset);
    let c = offset.dot(offset) - sphere.radius * sphere.radius;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let near = (-b - root) / (2.0 * a);
    let t = if !ray.inside && near > 0.0 { near } else { (-b + root) / (2.0 * a) };
    (t > ORIGINAL_EPSILON).then_some(t)
}

/// A square, from either side.
pub fn intersect_square(square: &Square, ray: &Ray) -> Option<Hit> {
    let slope = ray.direction.dot(square.normal);
    if slope == 0.0 {
        return None;
    }
    let t = (square.center - ray.origin).dot(square.normal) / slope;
    if !(t > ray.t_min && t < ray.t_max) {
        return None;
    }
    let offset = ray.origin + ray.direction * t - square.center;
    let inside =
        offset.dot(square.along).abs() <= square.half_height && offset.dot(square.across).abs() <= square.half_width;
    inside.then_some(Hit { t, primitive: square.primitive, u: 0.0, v: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, inside: false }
    }

    #[test]
    fn spheres_from_outside_and_inside() {
        let sphere = Sphere { center: Vec3::ZERO, radius: 2.0, primitive: 3, padding: [0; 3] };
        for rules in [Rules::Original, Rules::Repaired] {
            let outside = intersect_sphere(&sphere, &ray(Vec3::Z * 5.0, Vec3::NEG_Z), rules).unwrap();
            assert_eq!((outside.t, outside.primitive), (3.0, 3));
            let inside = intersect_sphere(&sphere, &ray(Vec3::ZERO, Vec3::X * 0.5), rules).unwrap();
            assert_eq!(inside.t, 4.0);
            assert!(intersect_sphere(&sphere, &ray(Vec3::Z * 5.0, Vec3::Z), rules).is_none());
            assert!(intersect_sphere(&sphere, &ray(Vec3::new(0.0, 2.1, 5.0), Vec3::NEG_Z), rules).is_none());
        }
    }

    #[test]
    fn a_far_small_sphere_keeps_its_precision() {
        let sphere = Sphere { center: Vec3::ZERO, radius: 0.01, primitive: 0, padding: [0; 3] };
        let hit = intersect_sphere(&sphere, &ray(Vec3::Z * 10_000.0, Vec3::NEG_Z), Rules::Repaired).unwrap();
        assert!((hit.t - 9_999.99).abs() < 0.002);
    }

    #[test]
    fn a_root_just_above_zero_hides_the_original_sphere() {
        let sphere = Sphere { center: Vec3::ZERO, radius: 1.0, primitive: 0, padding: [0; 3] };
        let start = ray(Vec3::X * 1.0005, Vec3::NEG_X);
        assert!(intersect_sphere(&sphere, &start, Rules::Original).is_none());
        assert!(intersect_sphere(&sphere, &start, Rules::Repaired).is_some());
    }

    #[test]
    fn squares_have_edges_and_two_sides() {
        let square = Square {
            center: Vec3::ZERO,
            half_height: 2.0,
            normal: Vec3::Z,
            half_width: 1.0,
            along: Vec3::Y,
            primitive: 0,
            across: Vec3::X,
            padding: 0,
        };
        let at =
            |x: f32, y: f32, dz: f32| intersect_square(&square, &ray(Vec3::new(x, y, -dz), Vec3::Z * dz)).map(|h| h.t);
        assert_eq!(at(1.0, 2.0, 1.0), Some(1.0));
        assert_eq!(at(0.0, 0.0, -2.0), Some(1.0));
        assert_eq!(at(1.1, 0.0, 1.0), None);
        assert_eq!(at(0.0, 2.1, 1.0), None);
    }

    #[test]
    fn triangles_report_barycentrics() {
        let triangle = Triangle { edge1: Vec3::X * 4.0, edge2: Vec3::Y * 4.0, primitive: 9, ..Triangle::zeroed() };
        let r = ray(Vec3::new(1.0, 2.0, 1.0), Vec3::NEG_Z);
        assert_eq!(intersect_triangle(&triangle, &r, 0.001), Some(Hit { t: 1.0, primitive: 9, u: 0.25, v: 0.5 }));
        assert_eq!(intersect_triangle(&Triangle::zeroed(), &r, f32::MIN_POSITIVE), None);
    }
}
