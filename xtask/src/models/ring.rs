//! The ring: a broad finger ring that lies on its side, for caustics. Its inner wall is nearly a cylinder, which throws
//! the heart-shaped caustic; its outer side is a flat band between two bevels. Our own design.

use std::f64::consts::TAU;

use anyhow::Result;

use super::model::{Material, Model, Shading};
use super::part::Part;
use super::vector::{Vec3, vec3};

pub(super) const TRIANGLES: usize = 3000;
pub(super) const TITLE: &str = "A ring that lies flat, for caustics.";
pub(super) const MATERIALS: [Material; 2] = [
    Material { name: "band", diffuse: [0.60, 0.42, 0.12], specular: [0.50, 0.42, 0.20], exponent: 60.0 },
    Material { name: "inside", diffuse: [0.66, 0.52, 0.24], specular: [0.60, 0.55, 0.35], exponent: 90.0 },
];

const SEGMENTS: usize = 100;
const INNER_RADIUS: f64 = 10.4;
/// The ring's height is twice this; it lies on y = 0.
const HALF_HEIGHT: f64 = 2.75;
/// Points of the inner wall, evenly over its height.
const INNER_POINTS: usize = 7;

pub(super) fn build() -> Result<Model> {
    let profile = profile();
    let mut part = Part::default();
    let size = profile.len();
    for segment in 0..SEGMENTS {
        let (sin, cos) = (TAU * segment as f64 / SEGMENTS as f64).sin_cos();
        let turned =
            |&(radius, height): &(f64, f64)| -> Vec3 { vec3(radius * cos, height + HALF_HEIGHT, radius * sin) };
        part.positions.extend(profile.iter().map(turned));
    }
    for (segment, point) in (0..SEGMENTS).flat_map(|segment| (0..size).map(move |point| (segment, point))) {
        let (here, there, next) = (segment * size, (segment + 1) % SEGMENTS * size, (point + 1) % size);
        part.faces.push(vec![here + point, here + next, there + next, there + point]);
    }
    let mut model = Model::default();
    let material = |face: usize| if face % size < INNER_POINTS - 1 { "inside" } else { "band" };
    model.add_by(material, &part.outward(), Shading::Crease(0.93))?;
    Ok(model)
}

/// The closed section of the band as (radius, height): the slightly domed inner wall, then over the top bevel to the
/// flat outer band and back under.
fn profile() -> Vec<(f64, f64)> {
    let inner = |index: usize| {
        let up = 2.0 * index as f64 / (INNER_POINTS - 1) as f64 - 1.0;
        (INNER_RADIUS + 0.22 * up * up, (HALF_HEIGHT - 0.25) * up)
    };
    let upper = [(10.9, HALF_HEIGHT), (11.5, HALF_HEIGHT), (12.3, HALF_HEIGHT - 0.95), (12.3, 0.0)];
    let lower = upper[..3].iter().rev().map(|&(radius, height)| (radius, -height));
    (0..INNER_POINTS).map(inner).chain(upper).chain(lower).chain([(10.75, -HALF_HEIGHT + 0.05)]).collect()
}
