//! A part: one closed body of polygons, before it gets its normals.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};

use super::vector::{Vec3, vec3};

/// A closed body made of polygons, anticlockwise as seen from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    pub(super) positions: Vec<Vec3>,
    pub(super) faces: Vec<Vec<usize>>,
}

impl Part {
    /// The body through closed loops of equally many points, with a polygon at each end.
    pub(super) fn loft(loops: &[Vec<Vec3>]) -> Self {
        let (count, size) = (loops.len(), loops[0].len());
        let mut part = Self { positions: loops.concat(), faces: Vec::new() };
        for (ring, point) in (0..count - 1).flat_map(|ring| (0..size).map(move |point| (ring, point))) {
            let (here, next) = (ring * size, (point + 1) % size);
            part.faces.push(vec![here + point, here + next, here + size + next, here + size + point]);
        }
        part.faces.push((0..size).rev().collect());
        part.faces.push((0..size).map(|point| (count - 1) * size + point).collect());
        part.outward()
    }

    /// The box between two opposite corners.
    pub(super) fn cuboid(low: Vec3, high: Vec3) -> Self {
        let level = |y: f64| {
            vec![vec3(low.x, y, low.z), vec3(low.x, y, high.z), vec3(high.x, y, high.z), vec3(high.x, y, low.z)]
        };
        Self::loft(&[level(low.y), level(high.y)])
    }

    /// A sheet over a grid, `rows` of equally many points; its other side is moved by `back`.
    pub(super) fn sheet(rows: &[Vec<Vec3>], back: Vec3) -> Self {
        let (count, size) = (rows.len(), rows[0].len());
        let mut part = Self { positions: rows.concat(), faces: Vec::new() };
        let front = part.positions.len();
        part.positions.extend(rows.concat().into_iter().map(|point| point + back));
        for (row, column) in (0..count - 1).flat_map(|row| (0..size - 1).map(move |column| (row, column))) {
            let corner = row * size + column;
            let quad = [corner, corner + 1, corner + size + 1, corner + size];
            part.faces.push(quad.to_vec());
            // Both sides are cut along the same diagonal, or they would pierce each other where the sheet is twisted.
            part.faces.push([0, 3, 2, 1].map(|index| quad[index] + front).to_vec());
        }
        let border: Vec<usize> = (0..size - 1)
            .chain((0..count - 1).map(|row| row * size + size - 1))
            .chain((1..size).rev().map(|column| (count - 1) * size + column))
            .chain((1..count).rev().map(|row| row * size))
            .collect();
        for (index, &here) in border.iter().enumerate() {
            let next = border[(index + 1) % border.len()];
            part.faces.push(vec![next, here, here + front, next + front]);
        }
        part.outward()
    }

    /// The same body with every face turned, if they faced inwards.
    pub(super) fn outward(mut self) -> Self {
        if self.volume() < 0.0 {
            self.faces.iter_mut().for_each(|face| face.reverse());
        }
        self
    }

    /// The body after `change` of every point.
    pub(super) fn mapped(&self, change: impl Fn(Vec3) -> Vec3) -> Self {
        let positions = self.positions.iter().map(|&point| change(point)).collect();
        Self { positions, faces: self.faces.clone() }.outward()
    }

    /// The mirror image on the other side of the plane z = 0.
    pub(super) fn mirrored(&self) -> Self {
        self.mapped(|point| vec3(point.x, point.y, -point.z))
    }

    /// Triangles after each polygon is cut into a fan.
    pub(super) fn triangle_count(&self) -> usize {
        self.faces.iter().map(|face| face.len() - 2).sum()
    }

    /// The corners of the triangles of each polygon's fan.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [usize; 3]> {
        self.faces.iter().flat_map(|face| face[1..].windows(2).map(|pair| [face[0], pair[0], pair[1]]))
    }

    /// Six times the signed volume is the sum of the determinants.
    fn volume(&self) -> f64 {
        let corner = |index: usize| self.positions[index];
        self.triangles().map(|[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum::<f64>() / 6.0
    }

    /// Refuses a body with an open or doubled edge, or with a triangle of less than `least_area`.
    pub(super) fn check(&self, least_area: f64) -> Result<()> {
        let mut edges = BTreeMap::new();
        for face in &self.faces {
            for (index, &from) in face.iter().enumerate() {
                *edges.entry((from, face[(index + 1) % face.len()])).or_insert(0) += 1;
            }
        }
        for (&(from, to), &uses) in &edges {
            ensure!(uses == 1, "edge {from}-{to} is used {uses} times");
            ensure!(edges.contains_key(&(to, from)), "edge {from}-{to} is open");
        }
        for [a, b, c] in self.triangles() {
            let [a, b, c] = [a, b, c].map(|index| self.positions[index].rounded());
            let area = (b - a).cross(c - a).length() / 2.0;
            ensure!(area >= least_area, "triangle at {a:?} has an area of {area}");
        }
        Ok(())
    }
}
