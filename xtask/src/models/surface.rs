//! Marching tetrahedra: a fine, closed triangle mesh of a field's surface, whatever its shape.
//!
//! Each cubic cell is cut into the six tetrahedra around its diagonal (Kuhn's cut), which fit those of the next cell.

use std::collections::BTreeMap;

use super::field::project;
use super::part::Part;
use super::vector::{Vec3, vec3};

/// The grid that a field is sampled on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    low: Vec3,
    /// Edge length of a cell.
    cell: f64,
    cells: [usize; 3],
}

/// Rounds of [`smooth`].
const SMOOTHINGS: usize = 4;

/// The corners of the six tetrahedra of a cell; bit 0, 1 and 2 of a corner say low or high x, y and z.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];

impl Grid {
    /// The grid of cubic cells that covers a box.
    pub(super) fn covering(low: Vec3, high: Vec3, cell: f64) -> Self {
        let size = high - low;
        Self { low, cell, cells: [size.x, size.y, size.z].map(|length| (length / cell).ceil() as usize) }
    }

    fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (k * (self.cells[1] + 1) + j) * (self.cells[0] + 1) + i
    }

    fn nodes(&self) -> usize {
        self.cells.iter().map(|cells| cells + 1).product()
    }

    fn position(&self, node: usize) -> Vec3 {
        let (width, height) = (self.cells[0] + 1, self.cells[1] + 1);
        let (i, j, k) = (node % width, node / width % height, node / width / height);
        self.low + vec3(i as f64, j as f64, k as f64) * self.cell
    }

    /// The eight nodes of each cell.
    fn cells(&self) -> impl Iterator<Item = [usize; 8]> {
        let [nx, ny, nz] = self.cells;
        let corner = |i, j, k, bits: usize| self.node(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2));
        let cell = move |i, j, k| std::array::from_fn(|bits| corner(i, j, k, bits));
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| cell(i, j, k))))
    }
}

/// The surface of `field`, which must lie inside the grid.
pub(super) fn surface(field: &impl Fn(Vec3) -> f64, grid: &Grid) -> Part {
    let values = (0..grid.nodes()).map(|node| field(grid.position(node))).collect();
    let mut march = March { grid, values, part: Part::default(), crossings: BTreeMap::new() };
    for cell in grid.cells() {
        let inside = cell.iter().filter(|&&node| march.is_inside(node)).count();
        if inside > 0 && inside < cell.len() {
            for corners in TETRAHEDRA {
                march.tetrahedron(corners.map(|corner| cell[corner]));
            }
        }
    }
    (0..SMOOTHINGS).for_each(|_| smooth(&mut march.part, field, grid.cell));
    march.part
}

/// Moves each vertex to the mean of its neighbours and back on to the surface: evens out the cut tetrahedra's slivers.
fn smooth(part: &mut Part, field: &impl Fn(Vec3) -> f64, cell: f64) {
    let mut sums = vec![(Vec3::default(), 0.0); part.positions.len()];
    for [a, b, c] in part.triangles() {
        for (corner, next) in [(a, b), (b, c), (c, a)] {
            sums[corner].0 = sums[corner].0 + part.positions[next];
            sums[corner].1 += 1.0;
        }
    }
    for (position, (sum, count)) in part.positions.iter_mut().zip(sums) {
        *position = project(field, sum * (1.0 / count), cell * 0.2);
    }
}

struct March<'a> {
    grid: &'a Grid,
    values: Vec<f64>,
    part: Part,
    /// The vertex on each edge of a tetrahedron that the surface crosses.
    crossings: BTreeMap<(usize, usize), usize>,
}

impl March<'_> {
    fn is_inside(&self, node: usize) -> bool {
        self.values[node] < 0.0
    }

    fn tetrahedron(&mut self, nodes: [usize; 4]) {
        let (inside, outside): (Vec<_>, Vec<_>) = nodes.into_iter().partition(|&node| self.is_inside(node));
        match (inside[..].len(), outside[..].len()) {
            (1, 3) => self.polygon(&[(0, 0), (0, 1), (0, 2)], &inside, &outside),
            (3, 1) => self.polygon(&[(0, 0), (1, 0), (2, 0)], &inside, &outside),
            (2, 2) => self.polygon(&[(0, 0), (0, 1), (1, 1), (1, 0)], &inside, &outside),
            _ => {}
        }
    }

    /// Adds the polygon through edges from an inner to an outer node, as triangles that face outwards.
    fn polygon(&mut self, edges: &[(usize, usize)], inside: &[usize], outside: &[usize]) {
        let mut corners: Vec<_> = edges.iter().map(|&(from, to)| self.crossing(inside[from], outside[to])).collect();
        let at = |corner: usize| self.part.positions[corner];
        let outward = self.grid.position(outside[0]) - self.grid.position(inside[0]);
        let normal = (at(corners[1]) - at(corners[0])).cross(at(corners[2]) - at(corners[0]));
        if normal.dot(outward) < 0.0 {
            corners.reverse();
        }
        self.part.faces.extend(corners[1..].windows(2).map(|pair| vec![corners[0], pair[0], pair[1]]));
    }

    /// The vertex between an inner and an outer node, kept a little away from both.
    fn crossing(&mut self, inner: usize, outer: usize) -> usize {
        let (grid, values, part) = (self.grid, &self.values, &mut self.part);
        *self.crossings.entry((inner, outer)).or_insert_with(|| {
            let t = (values[inner] / (values[inner] - values[outer])).clamp(0.1, 0.9);
            part.positions.push(grid.position(inner).lerp(grid.position(outer), t));
            part.positions.len() - 1
        })
    }
}
