//! Sails and flags: sheets with a thickness, bellied by a wind from astern.

use anyhow::Result;

use super::super::model::{Model, Shading};
use super::super::part::Part;
use super::super::vector::{Vec3, vec3};
use super::rigging::{BOWSPRIT, FORE, FORE_YARDS, LATEEN, MAIN, MAIN_YARDS, MIZZEN, Mast, braced};

/// Thick enough that a shadow ray from one side meets the other.
const THICKNESS: f64 = 0.3;
/// Cosine of 60 degrees: the two sides of a sheet stay apart, each is smooth in itself.
const CREASE: f64 = 0.5;

/// A square sail: half widths and heights of head and foot, depth of its belly.
struct Square {
    mast: &'static Mast,
    head: (f64, f64),
    foot: (f64, f64),
    belly: f64,
    cells: (usize, usize),
}

const SQUARES: [Square; 6] = [
    Square { mast: &MAIN, head: (MAIN_YARDS[0].1 * 0.92, 21.4), foot: (17.0, 6.6), belly: 5.2, cells: (6, 4) },
    Square { mast: &MAIN, head: (MAIN_YARDS[1].1 * 0.92, 36.5), foot: (16.4, 23.2), belly: 4.4, cells: (6, 4) },
    Square { mast: &MAIN, head: (MAIN_YARDS[2].1 * 0.9, 46.6), foot: (11.6, 38.0), belly: 2.8, cells: (4, 3) },
    Square { mast: &FORE, head: (FORE_YARDS[0].1 * 0.92, 20.0), foot: (14.2, 8.6), belly: 4.4, cells: (6, 4) },
    Square { mast: &FORE, head: (FORE_YARDS[1].1 * 0.92, 33.5), foot: (13.8, 21.6), belly: 3.8, cells: (6, 4) },
    Square { mast: &FORE, head: (FORE_YARDS[2].1 * 0.9, 42.1), foot: (9.8, 35.0), belly: 2.4, cells: (4, 3) },
];

impl Square {
    /// The point at `s`, -1 to 1 across, and `t`, 0 at the head and 1 at the foot.
    fn point(&self, s: f64, t: f64) -> Vec3 {
        let width = self.head.0 + (self.foot.0 - self.head.0) * t;
        // The foot is cut as an arch, the sides are drawn in a little.
        let arch = 0.16 * (self.head.1 - self.foot.1) * t * t * (1.0 - s * s);
        let drawn = 1.0 - 0.06 * 4.0 * t * (1.0 - t);
        let full = (1.0 - s * s).max(0.0).powf(0.75) * (2.2 * t - 1.35 * t * t) * 1.12;
        let y = self.head.1 + (self.foot.1 - self.head.1) * t + arch;
        braced(self.mast, y, s * width * drawn, self.mast.radius + 0.7 + self.belly * full)
    }

    fn part(&self) -> Part {
        let (columns, rows) = self.cells;
        sheet(columns, rows, |s, t| self.point(2.0 * s - 1.0, t), vec3(-THICKNESS, 0.0, 0.0))
    }
}

/// A sheet over the unit square.
fn sheet(columns: usize, rows: usize, at: impl Fn(f64, f64) -> Vec3, back: Vec3) -> Part {
    let row = |row: usize| -> Vec<Vec3> {
        (0..=columns).map(|column| at(column as f64 / columns as f64, row as f64 / rows as f64)).collect()
    };
    Part::sheet(&(0..=rows).map(row).collect::<Vec<_>>(), back)
}

pub(super) fn add(model: &mut Model) -> Result<()> {
    let shading = Shading::Crease(CREASE);
    for square in &SQUARES {
        model.add("canvas", &square.part(), shading)?;
    }
    model.add("canvas", &lateen(), shading)?;
    for part in jibs() {
        model.add("canvas", &part, shading)?;
    }
    for mast in [&FORE, &MAIN, &MIZZEN] {
        model.add("trim", &pennant(mast), shading)?;
    }
    Ok(())
}

/// A triangular sail with a short edge instead of its third corner: from `head` (two ends of the long edge) to `clew`.
fn triangular(from: Vec3, to: Vec3, clew: Vec3, belly: Vec3, cells: (usize, usize)) -> Part {
    let at = |s: f64, t: f64| {
        let long = from.lerp(to, s);
        let short = clew + (to - from) * (0.12 * (s - 0.5));
        let full = 4.0 * t * (1.0 - t) * (1.0 - (2.0 * s - 1.0).powi(2)).max(0.0).powf(0.7);
        long.lerp(short, t) + belly * full
    };
    let back = (to - from).cross(clew - from).normalised() * THICKNESS;
    sheet(cells.0, cells.1, at, back)
}

fn lateen() -> Part {
    let (low, high) = LATEEN;
    let shift = vec3(0.0, -0.5, 0.0);
    let along = |share: f64| low.lerp(high, share) + shift;
    triangular(along(0.04), along(0.96), vec3(-31.5, 16.8, 1.6), vec3(0.0, 0.0, 3.0), (4, 3))
}

/// Two headsails on the fore stays.
fn jibs() -> [Part; 2] {
    let (heel, end) = BOWSPRIT;
    let sprit = |share: f64| heel.lerp(end, share);
    let mast = |y: f64| vec3(FORE.x, y, 0.0);
    let stay = |foot: Vec3, head: Vec3, from: f64, to: f64| (foot.lerp(head, from), foot.lerp(head, to));
    let (inner_low, inner_high) = stay(sprit(0.6), mast(FORE.top), 0.1, 0.86);
    let (outer_low, outer_high) = stay(sprit(0.97), mast(FORE.head - 1.5), 0.08, 0.8);
    let belly = vec3(0.0, 0.0, 1.6);
    [
        triangular(inner_low, inner_high, vec3(23.5, 9.2, 0.9), belly, (3, 2)),
        triangular(outer_low, outer_high, vec3(26.5, 14.0, 1.2), belly, (3, 2)),
    ]
}

/// A long flag that waves forward from a mast head.
fn pennant(mast: &Mast) -> Part {
    let length = (mast.head - 20.0) * 0.32;
    let at = |s: f64, t: f64| {
        let half = 1.3 * (1.0 - 0.75 * s);
        let wave = 0.7 * s * (9.0 * s).sin();
        vec3(mast.x + 0.5 + length * s, mast.head + 1.4 + half * (1.0 - 2.0 * t) - 1.6 * s * s, 0.15 + wave)
    };
    sheet(4, 1, at, vec3(0.0, 0.0, -THICKNESS))
}
