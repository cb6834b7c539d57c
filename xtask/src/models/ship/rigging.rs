//! Masts, tops, yards and ropes. Ropes are three-sided prisms, thick enough to be seen at the thesis' scale.

use anyhow::Result;

use super::super::model::{Model, Shading};
use super::super::vector::{Vec3, vec3};
use super::hull::gunwale;
use super::{CREASE, spar};

/// Radius of ropes: about one pixel in the thesis' picture.
const ROPE: f64 = 0.17;

/// A mast at `x`: its foot, the height of its platform, and its head.
pub(super) struct Mast {
    pub(super) x: f64,
    pub(super) foot: f64,
    pub(super) top: f64,
    pub(super) head: f64,
    pub(super) radius: f64,
    /// The share of the ship's length where its shrouds are made fast.
    chains: f64,
    ratlines: usize,
}

pub(super) const FORE: Mast =
    Mast { x: 15.0, foot: 0.0, top: 24.5, head: 45.5, radius: 0.85, chains: 0.74, ratlines: 4 };
pub(super) const MAIN: Mast =
    Mast { x: -0.5, foot: -1.0, top: 27.0, head: 50.5, radius: 1.0, chains: 0.46, ratlines: 4 };
pub(super) const MIZZEN: Mast =
    Mast { x: -17.0, foot: 3.0, top: 24.0, head: 38.5, radius: 0.7, chains: 0.2, ratlines: 2 };

/// A yard: height, half length, and radius in the middle.
pub(super) struct Yard(pub(super) f64, pub(super) f64, pub(super) f64);

pub(super) const FORE_YARDS: [Yard; 3] = [Yard(20.5, 15.5, 0.5), Yard(34.0, 11.0, 0.42), Yard(42.5, 6.5, 0.34)];
pub(super) const MAIN_YARDS: [Yard; 3] = [Yard(22.0, 20.0, 0.55), Yard(37.0, 13.0, 0.45), Yard(47.0, 7.5, 0.36)];

/// The bowsprit's heel and its end.
pub(super) const BOWSPRIT: (Vec3, Vec3) = (vec3(22.0, 4.2, 0.0), vec3(41.7, 14.5, 0.0));
/// The lateen yard of the mizzen mast.
pub(super) const LATEEN: (Vec3, Vec3) = (vec3(-6.5, 8.5, 1.1), vec3(-28.5, 34.5, 1.1));

/// The yards are braced round by the angle with this tangent: their starboard arms lie a little aft.
const BRACE: f64 = 0.14;

/// A point on a yard's line: `across` to starboard, `forward` of the mast.
pub(super) fn braced(mast: &Mast, y: f64, across: f64, forward: f64) -> Vec3 {
    vec3(mast.x + forward - BRACE * across, y, across + BRACE * forward)
}

pub(super) fn add(model: &mut Model) -> Result<()> {
    let shading = Shading::Crease(CREASE);
    for mast in [&FORE, &MAIN, &MIZZEN] {
        masthead(model, mast)?;
        shrouds(model, mast)?;
    }
    for (mast, yards) in [(&FORE, &FORE_YARDS), (&MAIN, &MAIN_YARDS)] {
        for Yard(y, half, radius) in yards {
            let at = |share: f64| braced(mast, *y, half * share, mast.radius + radius);
            let ends = radius * 0.5;
            let line = [(at(-1.0), ends), (at(0.0), *radius), (at(1.0), ends)];
            model.add("timber", &spar(&line, 5), shading)?;
        }
    }
    let (heel, end) = BOWSPRIT;
    model.add("timber", &spar(&[(heel, 0.8), (heel.lerp(end, 0.5), 0.7), (end, 0.4)], 6), shading)?;
    let (low, high) = LATEEN;
    model.add("timber", &spar(&[(low, 0.25), (low.lerp(high, 0.4), 0.4), (high, 0.22)], 5), shading)?;
    stays(model)
}

/// The mast in two lengths with its platform and button.
fn masthead(model: &mut Model, mast: &Mast) -> Result<()> {
    let shading = Shading::Crease(CREASE);
    let at = |y: f64| vec3(mast.x, y, 0.0);
    let r = mast.radius;
    let lower = [(at(mast.foot - 1.5), r), (at(mast.top * 0.5), r * 0.95), (at(mast.top + 1.6), r * 0.8)];
    let upper = [(at(mast.top - 0.5), r * 0.66), (at(mast.head - 1.0), r * 0.4), (at(mast.head), r * 0.3)];
    model.add("timber", &spar(&lower, 6), shading)?;
    model.add("timber", &spar(&upper, 6), shading)?;
    let top = [(at(mast.top - 1.0), r * 1.3), (at(mast.top), r * 2.5), (at(mast.top + 0.9), r * 2.6)];
    model.add("trim", &spar(&top, 8), shading)?;
    let button = [(at(mast.head - 0.2), 0.3), (at(mast.head + 0.2), 0.6), (at(mast.head + 0.7), 0.3)];
    model.add("trim", &spar(&button, 5), shading)
}

/// Four shrouds to a side, with ratlines across them, and two topmast shrouds.
fn shrouds(model: &mut Model, mast: &Mast) -> Result<()> {
    let foot = |index: f64| gunwale(mast.chains - 0.035 * index, 1.6, 0.35);
    let hounds = vec3(mast.x, mast.top - 0.4, mast.radius * 0.7);
    let rung = |share: f64, index: f64| foot(index).lerp(hounds, share);
    for index in 0..4 {
        rope(model, foot(index as f64), hounds, true)?;
    }
    for line in 0..mast.ratlines {
        let share = 0.12 + 0.62 * line as f64 / (mast.ratlines as f64 - 1.0);
        rope(model, rung(share, -0.15), rung(share, 3.15), true)?;
    }
    for along in [-0.9, 0.9] {
        let edge = vec3(mast.x + along, mast.top + 0.5, mast.radius * 2.2);
        rope(model, edge, vec3(mast.x, mast.head - 4.0, 0.2), true)?;
    }
    Ok(())
}

/// Ropes in the ship's plane: stays forward, backstays aft, and the bowsprit's bobstay.
fn stays(model: &mut Model) -> Result<()> {
    let (heel, end) = BOWSPRIT;
    let sprit = |share: f64| heel.lerp(end, share);
    let at = |mast: &Mast, y: f64| vec3(mast.x, y, 0.0);
    let lines = [
        (at(&FORE, FORE.top), sprit(0.6)),
        (at(&FORE, FORE.head - 1.5), sprit(0.97)),
        (at(&MAIN, MAIN.top), vec3(FORE.x, 5.5, 0.0)),
        (at(&MAIN, MAIN.head - 2.0), at(&FORE, FORE.top + 1.0)),
        (at(&MIZZEN, MIZZEN.top), vec3(MAIN.x, 4.0, 0.0)),
        (at(&MIZZEN, MIZZEN.head - 1.0), at(&MAIN, MAIN.top + 1.0)),
        (sprit(0.75), vec3(28.6, -4.0, 0.0)),
    ];
    lines.into_iter().try_for_each(|(from, to)| rope(model, from, to, false))?;
    // Backstays, from the mast heads to the sides.
    for (mast, u) in [(&FORE, 0.6), (&MAIN, 0.3)] {
        rope(model, at(mast, mast.head - 1.5), gunwale(u, 2.4, 0.2), true)?;
    }
    // Lifts hold the lower yards level.
    for (mast, yards) in [(&FORE, &FORE_YARDS), (&MAIN, &MAIN_YARDS)] {
        for Yard(y, half, _) in &yards[..2] {
            for side in [-0.92, 0.92] {
                rope(model, braced(mast, *y, half * side, mast.radius), at(mast, y + half * 0.55), false)?;
            }
        }
    }
    Ok(())
}

fn rope(model: &mut Model, from: Vec3, to: Vec3, both_sides: bool) -> Result<()> {
    let part = spar(&[(from, ROPE), (to, ROPE)], 3);
    model.add("cordage", &part, Shading::Crease(CREASE))?;
    if both_sides {
        model.add("cordage", &part.mirrored(), Shading::Crease(CREASE))?;
    }
    Ok(())
}
