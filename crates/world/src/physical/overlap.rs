//! Meshes and squares made to reach a little beyond their borders.
//!
//! Triangles that share an edge leave no gap, for rays see its ends at the same place from either side
//! (`kernel::watertight`). But where a mesh ends another may begin whose corners were rounded otherwise, or lie along the
//! edge: there both reach into each other. Every corner moves as one, so that what it joins stays joined.

use crate::shapes::Builder;
use glam::{DVec3, Vec3};
use lightcuts_kernel::intersect::Square;
use lightcuts_kernel::rounding::UNIT;
use rustc_hash::{FxBuildHasher, FxHashMap};

/// How far borders reach, in roundings of their greatest coordinate or size, as they are or as they were given: more than
/// the errors of their corners, those of text of seven digits too.
const CORNER_ERRORS: f64 = 32.0;

/// The same in roundings of the scene's extent: from so far away rays miss edges by as much.
const RAY_ERRORS: f64 = 16.0;

/// But for this no more than this share of a primitive's size.
const MOST_OF_SIZE: f64 = 1e-4;

/// And never more than this share of what lies behind the edge.
const MOST_OF_HEIGHT: f64 = 1e-3;

/// How far a corner of a sharp border moves at most, by how far its edges do.
const MOST_OF_EDGES: f64 = 2.0;

/// What the builder's triangles and squares are without the overlap.
pub(super) struct Outlines {
    /// Corners of the triangles, in file order.
    pub(super) points: Vec<[Vec3; 3]>,
    pub(super) squares: Vec<Square>,
    /// As in the builder.
    given: Vec<(usize, f64)>,
    /// The greatest coordinate of them all.
    pub(super) greatest_given: f64,
}

impl Outlines {
    /// The greatest coordinate that the corners of a triangle's mesh were given with, in scene units.
    pub(super) fn given(&self, triangle: usize) -> f64 {
        given(&self.given, triangle)
    }
}

fn given(of_meshes: &[(usize, f64)], triangle: usize) -> f64 {
    let next = of_meshes.partition_point(|(first, _)| *first <= triangle);
    next.checked_sub(1).map_or(0.0, |mesh| of_meshes[mesh].1)
}

/// Makes primitives reach beyond their borders; `extent` is the diagonal of the scene. Gives what they were.
pub(super) fn overlap(builder: &mut Builder, extent: f32) -> Outlines {
    let (points, squares) = (builder.points.clone(), builder.squares.clone());
    let given = std::mem::take(&mut builder.given);
    let greatest_given = given.iter().map(|(_, given)| *given).fold(0.0, f64::max);
    let outlines = Outlines { points, squares, given, greatest_given };
    let extent = f64::from(extent);
    move_borders(&mut builder.points, &outlines.given, extent);
    for square in &mut builder.squares {
        let size = square.half_width.min(square.half_height);
        let coordinate = square.center.abs().max_element().max(square.half_width).max(square.half_height);
        let more = overlap_of(f64::from(coordinate), f64::from(size), extent) as f32;
        square.half_width += more;
        square.half_height += more;
    }
    builder.fit_boxes();
    outlines
}

/// How far a primitive reaches beyond its edges, in scene units.
fn overlap_of(coordinate: f64, size: f64, extent: f64) -> f64 {
    let unit = f64::from(UNIT);
    coordinate.max(size) * CORNER_ERRORS * unit + (extent * RAY_ERRORS * unit).min(size * MOST_OF_SIZE)
}

/// What the edges of a border that meet at a corner ask of it.
#[derive(Debug, Clone, Copy, Default)]
struct Pull {
    /// Sum of the outward unit directions, and how many there are.
    sum: DVec3,
    edges: u32,
    /// How far the edges are to move: the least that one is.
    length: f64,
}

impl Pull {
    fn add(&mut self, outward: DVec3, length: f64) {
        self.length = if self.edges == 0 { length } else { self.length.min(length) };
        self.sum += outward;
        self.edges += 1;
    }

    /// The way of the corner: two edges move as far as they are to, but for those of a spike.
    fn way(&self) -> DVec3 {
        let sum = self.sum.length();
        if sum == 0.0 {
            return DVec3::ZERO;
        }
        self.sum / sum * self.length * (f64::from(self.edges) / sum).min(MOST_OF_EDGES)
    }
}

/// Moves the corners of all edges that belong to one triangle alone; `of_meshes` is the builder's `given`.
fn move_borders(points: &mut [[Vec3; 3]], of_meshes: &[(usize, f64)], extent: f64) {
    let (names, places) = named(points);
    let borders = borders(&names);
    if borders.is_empty() {
        return;
    }
    let mut pulls = vec![Pull::default(); places];
    for (triangle, from) in borders {
        let [a, b, c] = [from, (from + 1) % 3, (from + 2) % 3].map(|k| points[triangle][k].as_dvec3());
        let normal = (b - a).cross(c - a);
        let outward = (b - a).cross(normal).normalize_or_zero();
        let height = outward.dot(a - c);
        let size = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let coordinate = [a, b, c].iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let coordinate = coordinate.max(given(of_meshes, triangle));
        let length = overlap_of(coordinate, size, extent).min(height * MOST_OF_HEIGHT);
        for k in [from, (from + 1) % 3] {
            pulls[names[triangle][k] as usize].add(outward, length);
        }
    }
    for (points, names) in points.iter_mut().zip(&names) {
        for (point, name) in points.iter_mut().zip(names) {
            let pull = &pulls[*name as usize];
            if pull.edges > 0 {
                *point = (point.as_dvec3() + pull.way()).as_vec3();
            }
        }
    }
}

/// A number for each place where corners are, the same for all that are there; and how many there are.
fn named(points: &[[Vec3; 3]]) -> (Vec<[u32; 3]>, usize) {
    let mut places = FxHashMap::with_capacity_and_hasher(points.len(), FxBuildHasher);
    let mut name = |point: Vec3| {
        let next = places.len() as u32;
        // Minus zero is where zero is.
        *places.entry((point + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
    };
    let names = points.iter().map(|points| points.map(&mut name)).collect();
    (names, places.len())
}

/// Edges that belong to one triangle alone: that triangle, and the first of both corners in it.
fn borders(names: &[[u32; 3]]) -> Vec<(usize, usize)> {
    // The triangle and the corner of each edge, or none where there are more.
    let mut edges = FxHashMap::with_capacity_and_hasher(2 * names.len(), FxBuildHasher);
    for (triangle, names) in names.iter().enumerate() {
        for from in 0..3 {
            let (a, b) = (names[from], names[(from + 1) % 3]);
            let alone = Some((triangle, from));
            edges.entry((a.min(b), a.max(b))).and_modify(|of| *of = None).or_insert(alone);
        }
    }
    let mut borders: Vec<(usize, usize)> = edges.into_values().flatten().collect();
    borders.sort_unstable();
    borders
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::rng::random4;

    fn vector(k: u32, what: u32) -> Vec3 {
        let [x, y, z, _] = random4(k, what, 0, 95);
        Vec3::new(x, y, z) - 0.5
    }

    /// A grid of `across` by `down` quads of two triangles each.
    fn grid(across: usize, down: usize, place: impl Fn(f32, f32) -> Vec3) -> Vec<[Vec3; 3]> {
        let at = |i: usize, j: usize| place(i as f32 / across as f32, j as f32 / down as f32);
        let quads = (0..down).flat_map(|j| (0..across).map(move |i| (i, j)));
        let halves = |(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        quads.flat_map(halves).collect()
    }

    /// The border of a sheet moves outwards by what it is to, whatever it is made of; nothing within it moves.
    #[test]
    fn borders_move_and_nothing_else() {
        for (across, down) in [(1, 1), (4, 4), (100, 1), (3, 40)] {
            let (right, up) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.8, 0.6, 0.0) * 0.5);
            let plain = grid(across, down, |u, v| right * u + up * v);
            let mut moved = plain.clone();
            move_borders(&mut moved, &[], 4.0);
            let mut at_border = 0;
            for (plain, moved) in plain.as_flattened().iter().zip(moved.as_flattened()) {
                let inside = |p: Vec3| {
                    let (u, v) = (p.dot(right), p.dot(up) / up.length());
                    u.min(1.0 - u).min(v).min(0.5 - v)
                };
                let (before, after) = (inside(*plain), inside(*moved));
                if before > 1e-4 {
                    assert_eq!(plain, moved);
                    continue;
                }
                at_border += 1;
                // 32 of the greatest size, and 16 of the extent.
                let most = 96.0 * UNIT * 1.2;
                assert!(after < before && before - after < most, "{across} x {down}: {before} to {after}");
                assert!(moved.distance(*plain) < 2.5 * most, "{across} x {down}: {plain} to {moved}");
            }
            println!("{across} x {down}: {at_border} corners at the border");
            assert!(at_border > 0);
        }
    }

    /// A closed surface has no border, whatever order its corners have.
    #[test]
    fn closed_surfaces_stay() {
        let corners: [Vec3; 4] = std::array::from_fn(|k| vector(k as u32, 0));
        let [a, b, c, d] = corners;
        let closed = vec![[a, b, c], [b, a, d], [d, c, b], [c, d, a]];
        let mut moved = closed.clone();
        move_borders(&mut moved, &[], 10.0);
        assert_eq!(closed, moved);
        let mut open = closed[1..].to_vec();
        move_borders(&mut open, &[], 10.0);
        assert!(open.as_flattened().iter().zip(closed[1..].as_flattened()).any(|(a, b)| a != b));
        // What was in one place still is.
        let (names, places) = named(&open);
        assert_eq!((names, places), named(&closed[1..]));
    }

    /// Triangles of all forms by themselves: every edge moves outwards, by no more than a share of what lies behind it.
    #[test]
    fn lone_triangles_grow_a_little() {
        for k in 0..10_000 {
            let [narrow, far, ..] = random4(k, 4, 0, 95);
            let place = vector(k, 3) * 10.0_f32.powf(3.0 * far);
            let plain = [vector(k, 0), vector(k, 0) + vector(k, 1) * 10.0_f32.powf(-3.0 * narrow), vector(k, 2)]
                .map(|p| p + place);
            let mut moved = [plain];
            move_borders(&mut moved, &[], 2.0);
            let [plain, moved] = [plain, moved[0]].map(|of| of.map(Vec3::as_dvec3));
            for from in 0..3 {
                let [a, b, c] = [from, (from + 1) % 3, (from + 2) % 3].map(|j| plain[j]);
                let outward = (b - a).cross((b - a).cross(c - a)).normalize_or_zero();
                let height = outward.dot(a - c);
                let rounding = 2.0 * f64::from(UNIT) * f64::from(place.abs().max_element() + 1.0);
                for j in [from, (from + 1) % 3] {
                    let way = outward.dot(moved[j] - plain[j]);
                    assert!(way > -rounding && way < MOST_OF_EDGES * MOST_OF_HEIGHT * height + rounding, "{k}: {way}");
                }
            }
        }
    }
}
