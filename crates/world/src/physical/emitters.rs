//! Lights made flat: those of the scene, and every emissive primitive.

use super::overlap::Outlines;
use crate::shapes::Builder;
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use lightcuts_kernel::emitter::{Emitter, PARALLEL, POINT, RECTANGLE_LIGHT, SPHERE_LIGHT, SPOT, TRIANGLE_LIGHT};
use lightcuts_kernel::intersect::{SPHERE, TRIANGLE};
use lightcuts_kernel::ray::{NONE, normalize_or_zero};
use lightcuts_kernel::rounding::{sphere_slack, square_slack};
use lightcuts_kernel::scatter::Scatter;
use lightcuts_scene::physical::{EmitterKind, PhysicalScene};

/// All lights.
pub(super) struct Lights {
    /// First those that have a place.
    pub(super) emitters: Vec<Emitter>,
    pub(super) placed: usize,
    /// Light of each primitive, or [`NONE`].
    pub(super) of_primitives: Vec<u32>,
}

pub(super) fn collect(
    scene: &PhysicalScene,
    origin: DVec3,
    (builder, outlines): (&Builder, &Outlines),
    scatters: &[Scatter],
) -> Lights {
    let mut emitters: Vec<Emitter> = Vec::new();
    let mut of_primitives = vec![NONE; builder.primitives.len()];
    for (number, of_primitive) in of_primitives.iter_mut().enumerate() {
        if let Some(emitter) = emissive(builder, outlines, number, scatters) {
            *of_primitive = emitters.len() as u32;
            emitters.push(emitter);
        }
    }
    let (parallel, placed): (Vec<_>, Vec<_>) =
        scene.lights.iter().map(|light| described(&light.kind, origin)).partition(|emitter| emitter.kind == PARALLEL);
    emitters.extend(placed);
    let placed = emitters.len();
    emitters.extend(parallel);
    Lights { emitters, placed, of_primitives }
}

/// The light of a primitive that shines and has an area.
fn emissive(builder: &Builder, outlines: &Outlines, number: usize, scatters: &[Scatter]) -> Option<Emitter> {
    let primitive = &builder.primitives[number];
    let scatter = &scatters[primitive.material as usize];
    if scatter.radiance == Vec3::ZERO {
        return None;
    }
    let index = primitive.index as usize;
    let base = Emitter {
        color: scatter.radiance,
        two_sided: scatter.two_sided,
        primitive: number as u32,
        image: scatter.radiance_image,
        ..Emitter::zeroed()
    };
    let emitter = match primitive.kind {
        TRIANGLE => {
            let [a, b, c] = outlines.points[index];
            let cross = (b - a).cross(c - a);
            // On the side of the corner normals, as hits have it.
            let mean = builder.corners[index].normals.iter().sum::<Vec3>();
            let direction = normalize_or_zero(cross);
            Emitter {
                kind: TRIANGLE_LIGHT,
                position: a,
                edge1: b - a,
                edge2: c - a,
                area: cross.length() * 0.5,
                slack: builder.corners[index].slack,
                direction: if direction.dot(mean) < 0.0 { -direction } else { direction },
                ..base
            }
        }
        SPHERE => {
            let sphere = &builder.spheres[index];
            let area = 4.0 * std::f32::consts::PI * sphere.radius * sphere.radius;
            Emitter {
                kind: SPHERE_LIGHT,
                position: sphere.center,
                radius: sphere.radius,
                area,
                slack: sphere_slack(sphere.radius),
                ..base
            }
        }
        _ => {
            let square = &outlines.squares[index];
            let (edge1, edge2) = (square.across * (2.0 * square.half_width), square.along * (2.0 * square.half_height));
            Emitter {
                kind: RECTANGLE_LIGHT,
                position: square.center - (edge1 + edge2) * 0.5,
                edge1,
                edge2,
                area: 4.0 * square.half_width * square.half_height,
                direction: square.normal,
                slack: square_slack(square.center + (edge1.abs() + edge2.abs()) * 0.5, square),
                ..base
            }
        }
    };
    (emitter.area > 0.0).then_some(emitter)
}

fn described(kind: &EmitterKind, origin: DVec3) -> Emitter {
    let relative = |position: DVec3| (position - origin).as_vec3();
    let base = Emitter { primitive: NONE, image: NONE, ..Emitter::zeroed() };
    match *kind {
        EmitterKind::Point { position, intensity } => {
            Emitter { kind: POINT, position: relative(position), color: intensity, ..base }
        }
        EmitterKind::Spot { position, direction, intensity, inner_degrees, outer_degrees } => Emitter {
            kind: SPOT,
            position: relative(position),
            direction: normalize_or_zero(direction),
            color: intensity,
            cos_inner: inner_degrees.to_radians().cos(),
            cos_outer: outer_degrees.to_radians().cos(),
            ..base
        },
        EmitterKind::Directional { direction, irradiance } => {
            Emitter { kind: PARALLEL, direction: normalize_or_zero(direction), color: irradiance, ..base }
        }
    }
}
