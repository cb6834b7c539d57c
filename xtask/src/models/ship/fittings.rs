//! What stands on and hangs on the hull: gunports, hatch, capstan, anchors, and the display stand.

use anyhow::Result;

use super::super::model::{Model, Shading};
use super::super::part::Part;
use super::super::vector::{Vec3, vec3};
use super::hull::{sheer, shell};
use super::{CREASE, beam, spar};

/// The floor of the 400-unit room at the thesis' scale and translation: (-200 + 80) / 4.
const FLOOR: f64 = -30.0;
const GUNPORTS: usize = 5;

pub(super) fn add(model: &mut Model) -> Result<()> {
    let shading = Shading::Crease(CREASE);
    for index in 0..GUNPORTS {
        let u = 0.12 + 0.66 * index as f64 / (GUNPORTS - 1) as f64;
        for (material, part) in gunport(u) {
            model.add(material, &part, shading)?;
            model.add(material, &part.mirrored(), shading)?;
        }
    }
    let hatch = Part::cuboid(vec3(2.0, sheer(0.6) - 0.4, -1.9), vec3(7.0, sheer(0.6) + 1.1, 1.9));
    model.add("trim", &hatch, shading)?;
    let capstan = |y: f64| vec3(-7.0, sheer(0.4) + y, 0.0);
    model.add("timber", &spar(&[(capstan(0.0), 0.8), (capstan(1.6), 0.6), (capstan(2.2), 1.1)], 6), shading)?;
    for part in anchor() {
        model.add("cordage", &part, shading)?;
        model.add("cordage", &part.mirrored(), shading)?;
    }
    for part in stand() {
        model.add("trim", &part, shading)?;
    }
    Ok(())
}

/// A gun's muzzle in a dark frame below an open lid, on the starboard side.
fn gunport(u: f64) -> [(&'static str, Part); 3] {
    let at = shell(u, 0.69);
    let box_around = |low: Vec3, high: Vec3| Part::cuboid(at + low, at + high);
    let frame = box_around(vec3(-0.85, -0.75, -0.9), vec3(0.85, 0.75, 0.32));
    let muzzle = spar(&[(at, 0.38), (at + vec3(0.0, 0.05, 1.5), 0.34)], 4);
    let (hinge, edge) = (at + vec3(0.0, 0.85, 0.2), at + vec3(0.0, 1.5, 1.5));
    let across = vec3(0.95, 0.0, 0.0);
    let thick = vec3(0.0, 0.22, -0.1);
    let end = |side: Vec3| vec![hinge + side, edge + side, edge + side + thick, hinge + side + thick];
    [("cordage", frame), ("cordage", muzzle), ("trim", Part::loft(&[end(across * -1.0), end(across)]))]
}

/// The starboard anchor: shank, stock and arms, hung at the bow.
fn anchor() -> [Part; 3] {
    let top = shell(0.9, 1.0) + vec3(0.0, 0.4, 0.9);
    let crown = top + vec3(-0.6, -5.2, -0.2);
    let shank = spar(&[(top, 0.26), (crown, 0.3)], 4);
    let stock = spar(&[(top + vec3(-1.7, -0.6, 0.2), 0.26), (top + vec3(1.7, -0.6, 0.2), 0.26)], 4);
    let arms = beam(
        &[
            crown + vec3(-1.9, 1.5, 0.0),
            crown + vec3(-1.0, 0.2, 0.0),
            crown + vec3(1.0, 0.2, 0.0),
            crown + vec3(1.9, 1.5, 0.0),
        ],
        0.26,
        0.3,
    );
    [shank, stock, arms]
}

/// A stepped board with two cradles.
fn stand() -> Vec<Part> {
    let mut parts = vec![
        Part::cuboid(vec3(-25.0, FLOOR, -8.0), vec3(17.0, FLOOR + 1.6, 8.0)),
        Part::cuboid(vec3(-23.8, FLOOR + 1.6, -6.8), vec3(15.8, FLOOR + 2.4, 6.8)),
    ];
    for x in [-16.0, 7.0] {
        let side = |x: f64| -> Vec<Vec3> {
            let outline = [(6.0, FLOOR + 2.4), (4.4, -23.5), (4.9, -18.5), (6.7, -13.2)];
            let starboard = outline.iter().map(|&(z, y)| vec3(x, y, z));
            let port = outline.iter().rev().map(|&(z, y)| vec3(x, y, -z));
            starboard.chain(port).collect()
        };
        parts.push(cradle(&side(x - 0.9), &side(x + 0.9)));
    }
    parts
}

/// A cradle between two mirror-symmetric outlines; the ends are ladders of quads, as the outline is not convex.
fn cradle(near: &[Vec3], far: &[Vec3]) -> Part {
    let mut part = Part::loft(&[near.to_vec(), far.to_vec()]);
    let size = near.len();
    let caps: Vec<_> = part.faces.drain(part.faces.len() - 2..).collect();
    for cap in caps {
        for rung in 0..size / 2 - 1 {
            part.faces.push(vec![cap[rung], cap[rung + 1], cap[size - 2 - rung], cap[size - 1 - rung]]);
        }
    }
    part
}
