//! The ship: a three-masted galleon under sail, shown on a stand as a ship model is. Our own design.
//!
//! The bow points along +x, the keel lies along x, starboard is +z. Every body is closed; bodies may stand in each other.

mod castles;
mod fittings;
mod hull;
mod rigging;
mod sails;

use anyhow::Result;

use super::model::{Material, Model};
use super::part::Part;
use super::vector::{Vec3, vec3};

/// The thesis' own ship has as many.
pub(super) const TRIANGLES: usize = 4698;
pub(super) const TITLE: &str = "A galleon on a stand, stand-in for the thesis' Galleon.";
pub(super) const MATERIALS: [Material; 4] = [
    Material { name: "timber", diffuse: [0.38, 0.22, 0.11], specular: [0.12, 0.10, 0.08], exponent: 20.0 },
    Material { name: "trim", diffuse: [0.62, 0.44, 0.12], specular: [0.35, 0.30, 0.15], exponent: 40.0 },
    Material { name: "canvas", diffuse: [0.74, 0.69, 0.58], specular: [0.02, 0.02, 0.02], exponent: 5.0 },
    Material { name: "cordage", diffuse: [0.16, 0.12, 0.09], specular: [0.05, 0.05, 0.05], exponent: 10.0 },
];

/// Cosine of 40 degrees: the crease between the faces of spars and rounded hulls is smoothed, a box's is not.
const CREASE: f64 = 0.766;

/// The whole model.
pub(super) fn build() -> Result<Model> {
    let mut model = Model::default();
    hull::add(&mut model)?;
    castles::add(&mut model)?;
    fittings::add(&mut model)?;
    rigging::add(&mut model)?;
    sails::add(&mut model)?;
    Ok(model)
}

/// A round spar: circles of `sides` points along a line of (centre, radius).
fn spar(line: &[(Vec3, f64)], sides: usize) -> Part {
    let axis = (line[line.len() - 1].0 - line[0].0).normalised();
    let side = if axis.y.abs() > 0.8 { vec3(1.0, 0.0, 0.0) } else { vec3(0.0, 1.0, 0.0) };
    let u = axis.cross(side).normalised();
    let v = axis.cross(u);
    let circle = |&(centre, radius): &(Vec3, f64)| -> Vec<Vec3> {
        let turn = |index: usize| std::f64::consts::TAU * (index as f64 + 0.5) / sides as f64;
        let at = |(sin, cos): (f64, f64)| centre + u * (radius * cos) + v * (radius * sin);
        (0..sides).map(|index| at(turn(index).sin_cos())).collect()
    };
    Part::loft(&line.iter().map(circle).collect::<Vec<_>>())
}

/// A beam of rectangular section along a line; `half_width` across it and level, `half_height` upright.
fn beam(line: &[Vec3], half_width: f64, half_height: f64) -> Part {
    let section = |index: usize| -> Vec<Vec3> {
        let (before, after) = (line[index.saturating_sub(1)], line[(index + 1).min(line.len() - 1)]);
        let along = after - before;
        let across = vec3(-along.z, 0.0, along.x).normalised() * half_width;
        let up = vec3(0.0, half_height, 0.0);
        let at = line[index];
        vec![at + across + up, at - across + up, at - across - up, at + across - up]
    };
    Part::loft(&(0..line.len()).map(section).collect::<Vec<_>>())
}
