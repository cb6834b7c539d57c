//! The hull: lofted between keel and gunwale, with bulwarks, wales, keel, stem and rudder.

use anyhow::Result;

use super::super::model::{Model, Shading};
use super::super::part::Part;
use super::super::vector::{Vec3, vec3};
use super::{CREASE, beam};

const STATIONS: usize = 17;
/// Points of a section from the keel to the gunwale.
const STRAKES: usize = 7;
const HALF_BEAM: f64 = 8.6;
const KEEL: f64 = -17.6;

/// Height of the gunwale at `u`, 0 at the stern and 1 at the stem: lowest before the middle, the stern highest.
pub(super) fn sheer(u: f64) -> f64 {
    let from_waist = u - 0.55;
    let rise = if from_waist < 0.0 { 14.0 } else { 17.0 };
    rise * from_waist * from_waist - 1.2
}

/// Half the breadth at the gunwale as a share of the greatest: a broad stern, a round bow.
fn plan(u: f64) -> f64 {
    let aft = ((0.5 - u) / 0.5).max(0.0);
    let fore = ((u - 0.5) / 0.5).max(0.0);
    (1.0 - 0.34 * aft.powf(2.2)) * (1.0 - fore.powf(3.2)).max(0.0).sqrt().max(0.045)
}

/// A point of the starboard shell: `v` is 0 at the keel and 1 at the gunwale.
pub(super) fn shell(u: f64, v: f64) -> Vec3 {
    let stern = -27.5 - 3.5 * v * v;
    let stem = 13.0 + 15.5 * v.sqrt();
    // Full amidships, a wine glass towards the stern, a V towards the bow.
    let fullness = 0.32 + 1.5 * (2.0 * (0.48 - u)).max(0.0).powi(2) + 0.8 * (2.0 * (u - 0.48)).max(0.0).powi(2);
    let tumblehome = 1.0 - 0.16 * ((v - 0.62) / 0.38).max(0.0).powi(2);
    let breadth = HALF_BEAM * plan(u) * v.powf(fullness) * tumblehome;
    vec3(stern + (stem - stern) * u, KEEL + (sheer(u) - KEEL) * v, breadth.max(0.35))
}

/// A point of the gunwale, moved up and out.
pub(super) fn gunwale(u: f64, up: f64, out: f64) -> Vec3 {
    shell(u, 1.0) + vec3(0.0, up, out)
}

pub(super) fn add(model: &mut Model) -> Result<()> {
    let smooth = Shading::Crease(CREASE);
    model.add("timber", &shell_and_deck(), smooth)?;
    for part in [bulwark(), wale(0.6, 0.36)] {
        model.add("timber", &part, smooth)?;
        model.add("timber", &part.mirrored(), smooth)?;
    }
    let rail = cap_rail();
    model.add("trim", &rail, smooth)?;
    model.add("trim", &rail.mirrored(), smooth)?;
    for part in backbone() {
        model.add("timber", &part, smooth)?;
    }
    Ok(())
}

/// The shell up to the gunwale and a cambered deck, as one body; its flat ends are ladders of quads.
fn shell_and_deck() -> Part {
    let size = 2 * STRAKES + 1;
    let mut part = Part::default();
    for station in 0..STATIONS {
        let u = station as f64 / (STATIONS - 1) as f64;
        let strake = |index: usize| shell(u, (index as f64 / (STRAKES - 1) as f64).powf(1.25));
        let port = |point: Vec3| vec3(point.x, point.y, -point.z);
        part.positions.extend((0..STRAKES).map(strake));
        part.positions.push(vec3(strake(STRAKES - 1).x, sheer(u) + 0.5, 0.0));
        part.positions.extend((0..STRAKES).rev().map(strake).map(port));
    }
    for (station, point) in (0..STATIONS - 1).flat_map(|station| (0..size).map(move |point| (station, point))) {
        let (here, next) = (station * size, (point + 1) % size);
        part.faces.push(vec![here + point, here + next, here + size + next, here + size + point]);
    }
    let last = (STATIONS - 1) * size;
    for rung in 0..STRAKES - 1 {
        let quad = [rung + 1, rung, size - 1 - rung, size - 2 - rung];
        part.faces.push(quad.to_vec());
        part.faces.push(quad.iter().rev().map(|corner| last + corner).collect());
    }
    let top = [STRAKES, STRAKES - 1, STRAKES + 1];
    part.faces.push(top.to_vec());
    part.faces.push(top.iter().rev().map(|corner| last + corner).collect());
    part.outward()
}

/// A line along the starboard side between two shares of its length.
pub(super) fn side_line(from: f64, to: f64, points: usize, at: impl Fn(f64) -> Vec3) -> Vec<Vec3> {
    (0..points).map(|index| at(from + (to - from) * index as f64 / (points - 1) as f64)).collect()
}

fn bulwark() -> Part {
    beam(&side_line(0.02, 0.985, 8, |u| gunwale(u, 1.1, -0.25)), 0.22, 1.3)
}

fn cap_rail() -> Part {
    beam(&side_line(0.01, 0.99, 8, |u| gunwale(u, 2.55, -0.25)), 0.45, 0.25)
}

/// A thick plank along the outside at height `v`.
fn wale(v: f64, half_height: f64) -> Part {
    beam(&side_line(0.01, 0.985, 8, |u| shell(u, v) + vec3(0.0, 0.0, 0.08)), 0.3, half_height)
}

/// Keel, stem, rudder and the beak under the bowsprit.
fn backbone() -> [Part; 4] {
    let plank = |outline: &[(f64, f64)], half_thickness: f64| {
        let side = |z: f64| outline.iter().map(|&(x, y)| vec3(x, y, z)).collect::<Vec<_>>();
        Part::loft(&[side(-half_thickness), side(half_thickness)])
    };
    let keel = plank(&[(-28.6, -19.2), (13.0, -19.2), (16.5, -17.0), (14.0, -16.6), (-28.2, -17.2)], 0.55);
    let stem_at = |v: f64| shell(1.0, v);
    let (low, middle, high, top) = (stem_at(0.03), stem_at(0.25), stem_at(0.6), stem_at(1.0));
    let stem = plank(
        &[
            (low.x - 0.6, low.y),
            (low.x + 1.0, low.y - 1.2),
            (middle.x + 1.4, middle.y),
            (high.x + 1.4, high.y),
            (top.x + 1.4, top.y + 2.6),
            (top.x - 0.4, top.y + 2.6),
            (high.x - 0.5, high.y),
            (middle.x - 0.6, middle.y),
        ],
        0.5,
    );
    let rudder =
        plank(&[(-27.6, -18.6), (-28.6, -5.0), (-30.6, 0.5), (-32.2, 0.5), (-31.2, -6.0), (-32.0, -18.6)], 0.4);
    let beak = plank(
        &[
            (top.x - 1.0, top.y - 3.6),
            (34.2, top.y + 0.6),
            (36.0, top.y + 3.0),
            (34.4, top.y + 3.2),
            (top.x - 1.0, top.y),
        ],
        0.6,
    );
    [keel, stem, rudder, beak]
}
