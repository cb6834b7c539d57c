//! Forecastle, quarterdeck and poop: blocks on the hull that follow its plan, with rails, posts, doors and windows.

use anyhow::Result;

use super::super::model::{Model, Shading};
use super::super::part::Part;
use super::super::vector::{Vec3, vec3};
use super::hull::{gunwale, side_line};
use super::{CREASE, beam, spar};

/// A raised deck between two shares of the ship's length.
struct Castle {
    from: f64,
    to: f64,
    /// Height of its deck above the gunwale at both ends.
    height: (f64, f64),
    /// How much its sides lean inwards and its ends outwards at deck height.
    lean: f64,
    overhang: (f64, f64),
    points: usize,
    posts: usize,
}

const QUARTERDECK: Castle =
    Castle { from: 0.0, to: 0.36, height: (4.4, 4.4), lean: 0.7, overhang: (1.2, 0.0), points: 5, posts: 4 };
const POOP: Castle =
    Castle { from: 0.0, to: 0.17, height: (9.0, 8.2), lean: 1.5, overhang: (2.6, 0.0), points: 3, posts: 3 };
const FORECASTLE: Castle =
    Castle { from: 0.76, to: 0.955, height: (4.2, 3.6), lean: 0.3, overhang: (0.0, 0.6), points: 4, posts: 4 };

impl Castle {
    fn share(&self, u: f64) -> f64 {
        (u - self.from) / (self.to - self.from)
    }

    /// A point of its starboard edge, `up` as a share of its height.
    fn edge(&self, u: f64, up: f64) -> Vec3 {
        let share = self.share(u);
        let rise = self.height.0 + (self.height.1 - self.height.0) * share;
        let along = self.overhang.1 * share.powi(4) - self.overhang.0 * (1.0 - share).powi(4);
        gunwale(u, 0.0, 0.25) + vec3(along * up, rise * up - 0.6 * (1.0 - up), -self.lean * up)
    }

    fn line(&self, up: f64, lift: f64) -> Vec<Vec3> {
        side_line(self.from, self.to, self.points, |u| self.edge(u, up) + vec3(0.0, lift, 0.0))
    }

    /// The block, from inside the hull up to its deck.
    fn block(&self) -> Part {
        let around = |up: f64| -> Vec<Vec3> {
            let starboard = self.line(up, 0.0);
            let port = starboard.iter().rev().map(|point| vec3(point.x, point.y, -point.z));
            starboard.iter().copied().chain(port).collect()
        };
        Part::loft(&[around(0.0), around(0.55), around(1.0)])
    }

    /// The starboard rail, a moulding below it, and the posts between.
    fn rails(&self) -> Vec<Part> {
        let inset = vec3(0.0, 0.0, -0.3);
        let lifted = |lift: f64| self.line(1.0, lift).into_iter().map(|point| point + inset).collect::<Vec<_>>();
        let mut parts = vec![beam(&lifted(1.9), 0.35, 0.22), beam(&lifted(0.0), 0.55, 0.3)];
        for post in 0..self.posts {
            let u = self.from + (self.to - self.from) * (post as f64 + 0.35) / (self.posts as f64 - 0.3);
            let foot = self.edge(u, 1.0) + inset;
            parts.push(spar(&[(foot, 0.26), (foot + vec3(0.0, 1.9, 0.0), 0.26)], 4));
        }
        parts
    }

    /// The rail across one end.
    fn cross_rail(&self, u: f64) -> Part {
        let end = self.edge(u, 1.0) + vec3(0.0, 1.9, -0.3);
        beam(&[vec3(end.x, end.y, end.z), vec3(end.x, end.y, -end.z)], 0.35, 0.22)
    }
}

pub(super) fn add(model: &mut Model) -> Result<()> {
    let shading = Shading::Crease(CREASE);
    for castle in [QUARTERDECK, POOP, FORECASTLE] {
        model.add("timber", &castle.block(), shading)?;
        for part in castle.rails() {
            model.add("trim", &part, shading)?;
            model.add("trim", &part.mirrored(), shading)?;
        }
        model.add("trim", &castle.cross_rail(castle.from), shading)?;
        model.add("trim", &castle.cross_rail(castle.to), shading)?;
    }
    for part in stern_windows().iter().chain(&doors()) {
        model.add("trim", part, shading)?;
    }
    lantern(model)
}

/// Two rows of windows in the stern.
fn stern_windows() -> Vec<Part> {
    let row = |y: f64, x: f64, count: usize| {
        (0..count).map(move |index| {
            let z = 2.1 * (index as f64 - (count as f64 - 1.0) / 2.0);
            Part::cuboid(vec3(x - 0.35, y, z - 0.65), vec3(x + 0.8, y + 1.9, z + 0.65))
        })
    };
    row(4.3, -31.6, 4).chain(row(8.8, -33.0, 3)).collect()
}

/// Doors in the bulkheads that face the waist and the quarterdeck.
fn doors() -> [Part; 3] {
    let at = |u: f64, y: f64, z: f64| {
        let x = gunwale(u, 0.0, 0.0).x;
        Part::cuboid(vec3(x - 0.3, y, z - 0.8), vec3(x + 0.3, y + 2.9, z + 0.8))
    };
    [at(0.36, -0.6, -2.4), at(0.36, -0.6, 2.4), at(0.17, 5.2, 0.0)]
}

/// A lantern on a bracket above the stern.
fn lantern(model: &mut Model) -> Result<()> {
    let foot = vec3(-33.6, 12.4, 0.0);
    let up = |height: f64| foot + vec3(-0.9, height, 0.0);
    let body = spar(&[(up(1.0), 0.4), (up(1.7), 1.0), (up(3.6), 1.2), (up(4.9), 0.2)], 6);
    model.add("trim", &body, Shading::Crease(CREASE))?;
    model.add("timber", &spar(&[(foot + vec3(0.6, -0.6, 0.0), 0.25), (up(1.4), 0.25)], 4), Shading::Crease(CREASE))
}
