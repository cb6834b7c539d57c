//! Polygons cut into triangles.
//!
//! A polygon of n corners becomes n - 2 triangles. Where the fan around its first corner covers it, as it does every convex
//! polygon, it becomes that fan: the order of triangles decides which of two equally near hits wins, and the thesis' results
//! rest on it. Any other has its ears cut off (Meisters, "Polygons Have Ears", 1975), in the plane across its normal. Holes hang
//! on bridges from the outline that are walked both ways: corners that occur twice.

mod crossing;
mod ears;
mod faces;

pub(crate) use faces::Faces;

use glam::{DVec2, DVec3, Vec3};
use lightcuts_scene::{MeshDesc, MeshTriangle};
use std::ops::Range;

/// Share of the squared extent that a triangle of a fan may be turned over by: coordinates in text have some six digits.
const TOLERANCE: f64 = 1e-6;

/// Least share of the squared extent that is an area.
const NO_AREA: f64 = 1e-12;

/// Comparisons that all polygons of a file may cost, so that no file takes for ever: some ten seconds.
const MAX_WORK: u64 = 1 << 32;

/// Which polygons become fans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// All: so does the thesis' reader.
    Fans,
    /// Those that a fan covers; others are cut along their outlines.
    Outlines,
}

/// What came of a polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Its triangles cover it.
    Covered,
    /// It became a fan that does not: it crosses itself, has no area, or is too intricate.
    Broken,
}

/// Indices into the lists of a mesh.
#[derive(Debug, Clone, Copy)]
struct Corner {
    position: u32,
    normal: Option<u32>,
    texture_coordinates: Option<u32>,
}

/// Cuts polygons, and keeps its memory from one to the next.
#[derive(Debug)]
pub(crate) struct Cutter {
    cut: Cut,
    /// Comparisons that are left.
    work: u64,
    corners: Vec<Corner>,
    /// The corners in the plane, counterclockwise, as seen from the first.
    flat: Vec<DVec2>,
    /// Area below which a triangle counts as none, times two.
    slack: f64,
    triangles: Vec<[u32; 3]>,
}

impl Cutter {
    pub(crate) fn new(cut: Cut) -> Self {
        Self { cut, work: MAX_WORK, corners: Vec::new(), flat: Vec::new(), slack: 0.0, triangles: Vec::new() }
    }

    /// Cuts a polygon that stands in a mesh as a fan around its first corner: its triangles change where they have to.
    pub(crate) fn recut(&mut self, mesh: &mut MeshDesc, fan: Range<usize>) -> Outcome {
        if self.cut == Cut::Fans || fan.len() < 2 {
            return Outcome::Covered;
        }
        let triangles = &mut mesh.triangles[fan];
        self.corners.clear();
        self.corners.extend([corner(&triangles[0], 0), corner(&triangles[0], 1)]);
        self.corners.extend(triangles.iter().map(|triangle| corner(triangle, 2)));
        let points: Vec<Vec3> = self.corners.iter().map(|corner| mesh.positions[corner.position as usize]).collect();
        let (cut, outcome) = self.cut(&points);
        let cut: Vec<[u32; 3]> = cut.to_vec();
        for (triangle, corners) in triangles.iter_mut().zip(cut) {
            *triangle = joined(corners.map(|i| self.corners[i as usize]));
        }
        outcome
    }

    /// The triangles of a polygon of at least 3 corners, as indices into `corners`; n - 2 of them in any case.
    fn cut(&mut self, corners: &[Vec3]) -> (&[[u32; 3]], Outcome) {
        self.triangles.clear();
        let outcome = self.cut_outline(corners);
        if self.triangles.is_empty() {
            self.triangles.extend(fan(corners.len()));
        }
        (&self.triangles, outcome)
    }

    /// Leaves no triangles where a fan is wanted.
    fn cut_outline(&mut self, corners: &[Vec3]) -> Outcome {
        if !self.flatten(corners) {
            return Outcome::Broken;
        }
        if self.is_covered_by_fan() {
            return Outcome::Covered;
        }
        if crossing::crosses_itself(&self.flat, &mut self.work)
            || !ears::cut_off(&self.flat, self.slack, &mut self.work, &mut self.triangles)
        {
            self.triangles.clear();
            return Outcome::Broken;
        }
        Outcome::Covered
    }

    /// Projects the corners along the polygon's normal, in which it shows the greatest area; false if it has none.
    fn flatten(&mut self, corners: &[Vec3]) -> bool {
        let origin = corners[0].as_dvec3();
        let point = |i: usize| corners[i % corners.len()].as_dvec3() - origin;
        // Newell's normal, which is defined for polygons that are not quite flat too.
        let normal = (0..corners.len()).fold(DVec3::ZERO, |sum, i| sum + point(i).cross(point(i + 1)));
        let area = normal.length();
        let (across, along) = normal.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend((0..corners.len()).map(|i| DVec2::new(point(i).dot(across), point(i).dot(along))));
        let (low, high) = self.flat.iter().fold((DVec2::ZERO, DVec2::ZERO), |(l, h), p| (l.min(*p), h.max(*p)));
        let extent = (high - low).length();
        // Far from the origin coordinates are coarse.
        let reach = f64::from(corners.iter().fold(0.0, |most: f32, p| most.max(p.abs().max_element())));
        self.slack = extent * (TOLERANCE * extent + f64::from(f32::EPSILON) * reach);
        area > NO_AREA * extent * extent
    }

    /// Whether all triangles of the fan are turned the same way, and together go round the first corner at most once.
    fn is_covered_by_fan(&self) -> bool {
        let first = self.flat[1];
        self.flat[1..].windows(2).enumerate().all(|(i, pair)| {
            let [now, next] = [pair[0], pair[1]];
            let goes_on = i > 0 && now.perp_dot(first) > self.slack && first.perp_dot(next) > self.slack;
            now.perp_dot(next) >= -self.slack && !goes_on
        })
    }
}

fn corner(triangle: &MeshTriangle, i: usize) -> Corner {
    Corner {
        position: triangle.positions[i],
        normal: triangle.normals.map(|normals| normals[i]),
        texture_coordinates: triangle.texture_coordinates.map(|coordinates| coordinates[i]),
    }
}

/// A triangle without a material; all corners have the same attributes.
fn joined(corners: [Corner; 3]) -> MeshTriangle {
    let [a, b, c] = corners;
    let all = |of: fn(&Corner) -> Option<u32>| Some([of(&a)?, of(&b)?, of(&c)?]);
    MeshTriangle {
        positions: corners.map(|corner| corner.position),
        normals: all(|corner| corner.normal),
        texture_coordinates: all(|corner| corner.texture_coordinates),
        material: None,
    }
}

/// Triangles (0, 1, 2), (0, 2, 3), ...: the order of the thesis' reader.
fn fan(corners: usize) -> impl Iterator<Item = [u32; 3]> {
    (2..corners as u32).map(|i| [0, i - 1, i])
}

/// Twice the area of the triangle a, b, c: above 0 if it runs counterclockwise.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

#[cfg(test)]
mod tests;
