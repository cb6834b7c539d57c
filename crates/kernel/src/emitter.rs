//! Lights of the physical model, each by itself: a direction towards it, what comes from there, and how dense the
//! directions are.

use crate::sampling::{frame, sin_cos_turns};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::f32::consts::PI;

/// A point that shines equally in all directions.
pub const POINT: u32 = 0;
/// A point that shines into a cone.
pub const SPOT: u32 = 1;
/// Directional light.
pub const PARALLEL: u32 = 2;
/// An emissive triangle.
pub const TRIANGLE_LIGHT: u32 = 3;
/// An emissive rectangle.
pub const RECTANGLE_LIGHT: u32 = 4;
/// An emissive sphere.
pub const SPHERE_LIGHT: u32 = 5;

/// A light. 96 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Emitter {
    /// Position; a corner of surfaces, the centre of a sphere.
    pub position: Vec3,
    /// One of the kinds.
    pub kind: u32,
    /// First edge of a surface.
    pub edge1: Vec3,
    /// Area of a surface, in square units.
    pub area: f32,
    /// Second edge of a surface.
    pub edge2: Vec3,
    /// Radius of a sphere.
    pub radius: f32,
    /// Unit normal of a surface, axis of a spot, direction of travel of directional light.
    pub direction: Vec3,
    /// Cosine of the angle up to which a spot is full.
    pub cos_inner: f32,
    /// Radiance, radiant intensity, or irradiance.
    pub color: Vec3,
    /// Cosine of the angle from which on a spot is dark.
    pub cos_outer: f32,
    /// Whether a surface shines on both sides.
    pub two_sided: u32,
    /// Primitive of a surface, or [`crate::ray::NONE`].
    pub primitive: u32,
    /// Image of the radiance, or [`crate::ray::NONE`].
    pub image: u32,
    /// How far rays begin and end off a surface, in scene units; see [`crate::rounding`].
    pub slack: f32,
}

/// Light from one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmitterSample {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Distance, infinite for directional light.
    pub distance: f32,
    /// Radiance, without its image; of lights without extent what arrives across the direction, per area.
    pub color: Vec3,
    /// Density of the direction per steradian; 0 for lights without extent.
    pub pdf: f32,
    /// Where on a surface: coordinates of the edges.
    pub place: [f32; 2],
}

/// How much of a spot's intensity goes in a direction, by the cosine to its axis.
pub fn spot_falloff(emitter: &Emitter, cos: f32) -> f32 {
    let width = emitter.cos_inner - emitter.cos_outer;
    if cos <= emitter.cos_outer {
        return 0.0;
    }
    if cos >= emitter.cos_inner || width <= 0.0 {
        return 1.0;
    }
    let t = (cos - emitter.cos_outer) / width;
    t * t * (3.0 - 2.0 * t)
}

/// Draws a direction from `point` towards a light. Without color where it does not shine this way.
pub fn sample_emitter(emitter: &Emitter, point: Vec3, random: [f32; 2]) -> EmitterSample {
    match emitter.kind {
        PARALLEL => EmitterSample {
            direction: -emitter.direction,
            distance: f32::INFINITY,
            color: emitter.color,
            pdf: 0.0,
            place: [0.0; 2],
        },
        SPHERE_LIGHT => sample_sphere(emitter, point, random),
        TRIANGLE_LIGHT => {
            // Uniform over the triangle (Turk 1990).
            let root = random[0].sqrt();
            sample_surface(emitter, point, [root * (1.0 - random[1]), root * random[1]])
        }
        RECTANGLE_LIGHT => sample_surface(emitter, point, random),
        _ => {
            let to_light = emitter.position - point;
            let distance_sq = to_light.length_squared().max(f32::MIN_POSITIVE);
            let distance = distance_sq.sqrt();
            let direction = to_light / distance;
            let cos = -direction.dot(emitter.direction);
            let falloff = if emitter.kind == SPOT { spot_falloff(emitter, cos) } else { 1.0 };
            let color = emitter.color * (falloff / distance_sq);
            EmitterSample { direction, distance, color, pdf: 0.0, place: [0.0; 2] }
        }
    }
}

fn sample_surface(emitter: &Emitter, point: Vec3, place: [f32; 2]) -> EmitterSample {
    let target = emitter.position + emitter.edge1 * place[0] + emitter.edge2 * place[1];
    let to_light = target - point;
    let distance = to_light.length().max(f32::MIN_POSITIVE);
    let direction = to_light / distance;
    let pdf = surface_pdf(emitter, direction, distance);
    EmitterSample { direction, distance, color: radiance_towards(emitter, emitter.direction, direction), pdf, place }
}

/// Density, per steradian, of a direction that meets a flat light at a distance.
fn surface_pdf(emitter: &Emitter, direction: Vec3, distance: f32) -> f32 {
    let cos = emitter.direction.dot(direction).abs();
    if cos < 1e-7 { 0.0 } else { distance * distance / (cos * emitter.area) }
}

/// Radiance of a surface against a direction that arrives at it.
pub fn radiance_towards(emitter: &Emitter, normal: Vec3, direction: Vec3) -> Vec3 {
    if emitter.two_sided != 0 || normal.dot(direction) < 0.0 { emitter.color } else { Vec3::ZERO }
}

/// 1 - cos of the half angle under which a sphere is seen; `None` from within.
fn sphere_cap(emitter: &Emitter, distance_sq: f32) -> Option<f32> {
    let sin_sq = emitter.radius * emitter.radius / distance_sq;
    (sin_sq < 1.0 - 1e-5).then(|| sin_sq / (1.0 + (1.0 - sin_sq).sqrt()))
}

fn sample_sphere(emitter: &Emitter, point: Vec3, random: [f32; 2]) -> EmitterSample {
    let to_center = emitter.position - point;
    let distance_sq = to_center.length_squared();
    let (sin_turn, cos_turn) = sin_cos_turns(random[1]);
    let Some(cap) = sphere_cap(emitter, distance_sq) else {
        // From within, uniform over the surface.
        let z = 1.0 - 2.0 * random[0];
        let r = (1.0 - z * z).max(0.0).sqrt();
        let normal = Vec3::new(r * cos_turn, r * sin_turn, z);
        let to_light = emitter.position + normal * emitter.radius - point;
        let distance = to_light.length().max(f32::MIN_POSITIVE);
        let direction = to_light / distance;
        let pdf = inside_pdf(emitter, normal, direction, distance);
        return EmitterSample {
            direction,
            distance,
            color: radiance_towards(emitter, normal, direction),
            pdf,
            place: [0.0; 2],
        };
    };
    let center_distance = distance_sq.sqrt();
    let axis = to_center / center_distance;
    let fall = random[0] * cap;
    let cos = 1.0 - fall;
    let sin_sq = fall * (2.0 - fall);
    let (tangent, bitangent) = frame(axis);
    let direction = (tangent * cos_turn + bitangent * sin_turn) * sin_sq.max(0.0).sqrt() + axis * cos;
    // The nearer of the two meetings with the sphere.
    let half_chord = (emitter.radius * emitter.radius - distance_sq * sin_sq).max(0.0).sqrt();
    let distance = center_distance * cos - half_chord;
    let normal = (point + direction * distance - emitter.position) / emitter.radius;
    EmitterSample {
        direction,
        distance,
        color: radiance_towards(emitter, normal, direction),
        pdf: 1.0 / (2.0 * PI * cap),
        place: [0.0; 2],
    }
}

fn inside_pdf(emitter: &Emitter, normal: Vec3, direction: Vec3, distance: f32) -> f32 {
    let cos = normal.dot(direction).abs();
    if cos < 1e-7 { 0.0 } else { distance * distance / (cos * 4.0 * PI * emitter.radius * emitter.radius) }
}

/// The density with which [`sample_emitter`] draws a direction from `point` that meets the light at a distance.
pub fn emitter_pdf(emitter: &Emitter, point: Vec3, direction: Vec3, distance: f32) -> f32 {
    match emitter.kind {
        TRIANGLE_LIGHT | RECTANGLE_LIGHT => surface_pdf(emitter, direction, distance),
        SPHERE_LIGHT => {
            let distance_sq = (emitter.position - point).length_squared();
            if let Some(cap) = sphere_cap(emitter, distance_sq) {
                return 1.0 / (2.0 * PI * cap);
            }
            let normal = (point + direction * distance - emitter.position) / emitter.radius;
            inside_pdf(emitter, normal, direction, distance)
        }
        _ => 0.0,
    }
}

/// Power of a light in W, without its image; of directional light what crosses a square unit.
pub fn emitter_power(emitter: &Emitter) -> Vec3 {
    let sides = if emitter.two_sided != 0 { 2.0 } else { 1.0 };
    match emitter.kind {
        PARALLEL => emitter.color,
        POINT => emitter.color * (4.0 * PI),
        // The smooth step between both cosines has the mean 1/2.
        SPOT => emitter.color * (2.0 * PI * (1.0 - 0.5 * (emitter.cos_inner + emitter.cos_outer))),
        SPHERE_LIGHT => emitter.color * (4.0 * PI * PI * emitter.radius * emitter.radius * sides),
        _ => emitter.color * (PI * emitter.area * sides),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;

    fn surface(kind: u32) -> Emitter {
        let (edge1, edge2) = (Vec3::new(2.0, 0.0, 0.5), Vec3::new(0.0, 0.0, 1.5));
        let cross = edge1.cross(edge2);
        Emitter {
            kind,
            position: Vec3::new(-1.0, 3.0, -0.5),
            edge1,
            edge2,
            area: cross.length() * if kind == TRIANGLE_LIGHT { 0.5 } else { 1.0 },
            direction: -cross.normalize() * cross.y.signum(),
            radius: 0.8,
            color: Vec3::ONE,
            ..Emitter::zeroed()
        }
    }

    /// Irradiance of a surface at `point` that faces `normal`, from samples of the light.
    fn irradiance(emitter: &Emitter, point: Vec3, normal: Vec3) -> f64 {
        let n = 100_000;
        let sum: f64 = (0..n)
            .map(|k| {
                let [a, b, ..] = random4(k, 0, 0, 3);
                let sample = sample_emitter(emitter, point, [a, b]);
                if sample.pdf <= 0.0 {
                    return 0.0;
                }
                let again = emitter_pdf(emitter, point, sample.direction, sample.distance);
                assert!((again / sample.pdf - 1.0).abs() < 2e-3, "{again} {}", sample.pdf);
                f64::from(sample.color.x * normal.dot(sample.direction).max(0.0) / sample.pdf)
            })
            .sum();
        sum / f64::from(n)
    }

    /// Lambert's formula for the irradiance of a polygon of unit radiance (Arvo 1995).
    fn lambert(corners: &[Vec3], point: Vec3, normal: Vec3) -> f64 {
        let d: Vec<_> = corners.iter().map(|&c| (c - point).normalize().as_dvec3()).collect();
        let sum: f64 = (0..d.len())
            .map(|k| {
                let (a, b) = (d[k], d[(k + 1) % d.len()]);
                a.dot(b).clamp(-1.0, 1.0).acos() * a.cross(b).normalize().dot(normal.as_dvec3())
            })
            .sum();
        (sum / 2.0).abs()
    }

    #[test]
    fn flat_lights_have_lamberts_irradiance() {
        for kind in [TRIANGLE_LIGHT, RECTANGLE_LIGHT] {
            let light = surface(kind);
            let (a, b, c) = (light.position, light.position + light.edge1, light.position + light.edge2);
            let corners = if kind == TRIANGLE_LIGHT { vec![a, b, c] } else { vec![a, b, b + light.edge2, c] };
            for point in [Vec3::ZERO, Vec3::new(0.7, 1.0, 0.2)] {
                let (found, exact) = (irradiance(&light, point, Vec3::Y), lambert(&corners, point, Vec3::Y));
                assert!((found / exact - 1.0).abs() < 0.01, "{found} {exact}");
            }
        }
    }

    #[test]
    fn a_sphere_lights_like_its_disk_and_from_within_from_everywhere() {
        let light = surface(SPHERE_LIGHT);
        let point = light.position - Vec3::Y * 2.0;
        // pi sin^2 of the half angle.
        let exact = std::f64::consts::PI * 0.8 * 0.8 / 4.0;
        assert!((irradiance(&light, point, Vec3::Y) / exact - 1.0).abs() < 0.005);
        let within = Emitter { two_sided: 1, ..light };
        let found = irradiance(&within, light.position + Vec3::X * 0.5, Vec3::Y);
        assert!((found / std::f64::consts::PI - 1.0).abs() < 0.02, "{found}");
        // Far away nothing is lost to rounding.
        let far = sample_emitter(&light, light.position - Vec3::Y * 1e5, [0.5, 0.5]);
        assert!(far.pdf.is_finite() && (far.distance / 1e5 - 1.0).abs() < 1e-4);
    }

    #[test]
    fn points_fall_off_with_the_square_and_spots_with_the_angle() {
        let point = Emitter { kind: POINT, position: Vec3::Y * 2.0, color: Vec3::splat(8.0), ..Emitter::zeroed() };
        assert_eq!(sample_emitter(&point, Vec3::ZERO, [0.0; 2]).color, Vec3::splat(2.0));
        let spot = Emitter { kind: SPOT, direction: Vec3::NEG_Y, cos_inner: 0.9, cos_outer: 0.5, ..point };
        assert_eq!(sample_emitter(&spot, Vec3::ZERO, [0.0; 2]).color, Vec3::splat(2.0));
        assert_eq!(spot_falloff(&spot, 0.7), 0.5);
        assert_eq!(sample_emitter(&spot, Vec3::new(9.0, 0.0, 0.0), [0.0; 2]).color, Vec3::ZERO);
        // The power is the intensity over the sphere.
        let n = 4000;
        let mean: f64 =
            (0..n).map(|k| f64::from(spot_falloff(&spot, (k as f32 + 0.5) / n as f32 * 2.0 - 1.0))).sum::<f64>()
                / f64::from(n);
        let exact = mean * 4.0 * std::f64::consts::PI * 8.0;
        assert!((f64::from(emitter_power(&spot).x) / exact - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_back_is_dark_unless_both_sides_shine() {
        let light = surface(RECTANGLE_LIGHT);
        let behind = Vec3::Y * 9.0;
        assert_eq!(sample_emitter(&light, behind, [0.5; 2]).color, Vec3::ZERO);
        assert_eq!(sample_emitter(&Emitter { two_sided: 1, ..light }, behind, [0.5; 2]).color, Vec3::ONE);
    }
}
