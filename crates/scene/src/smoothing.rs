//! Vertex normals for meshes that bring none.

use crate::MeshDesc;
use glam::{DVec3, Vec3};

/// Cosines differ by this much before they count as different: an angle of just the limit is within it.
const SLACK: f64 = 1e-6;

/// A cosine nearer to 1 than this is that of one plane: coordinates of 32 bits tell no more.
const FLAT: f64 = 1e-11;

/// Gives the triangles without normals some, so that neighbours look like one curved surface unless the angle between
/// them is above `degrees`.
///
/// Two triangles are neighbours where they share an edge, by position, that no third one has, and run along it in
/// opposite directions. `group` says which smoothing group a triangle is in: those of different groups are no
/// neighbours, and `None` stays flat. A corner's normal is the sum over the triangles that it is joined to, each
/// weighted by the sine of its angle there over the lengths of both edges: exact for vertices on a sphere (Max,
/// "Weights for Computing Vertex Normals from Facet Normals", Journal of Graphics Tools 4(2), 1999). Triangles that
/// stay flat stay without normals; for angles of 0 and less all do. Takes time and memory in proportion to the mesh.
pub fn smooth_normals(mesh: &mut MeshDesc, degrees: f32, group: impl Fn(usize) -> Option<u32>) {
    if degrees <= 0.0 {
        return;
    }
    let bare: Vec<Bare> = (0..mesh.triangles.len())
        .filter(|&i| mesh.triangles[i].normals.is_none())
        .filter_map(|i| Bare::new(mesh, i, group(i)?))
        .collect();
    let mut corners = Corners::new(bare.len() * 3);
    let least = f64::from(degrees).to_radians().cos() - SLACK;
    join_neighbors(mesh, &bare, least, &mut corners);
    let (numbers, sums) = corners.sums(&bare);
    let units: Vec<DVec3> = sums.iter().map(|sum| sum.normalize_or_zero()).collect();
    let mut indices: Vec<Option<u32>> = vec![None; units.len()];
    for (triangle, numbers) in bare.iter().zip(numbers.chunks_exact(3)) {
        let is_flat = |number: &u32| units[*number as usize].dot(triangle.normal) > 1.0 - FLAT;
        if numbers.iter().all(is_flat) {
            continue;
        }
        let mut index = |corner: usize| {
            let number = numbers[corner] as usize;
            *indices[number].get_or_insert_with(|| {
                mesh.normals.push(units[number].as_vec3());
                mesh.normals.len() as u32 - 1
            })
        };
        mesh.triangles[triangle.index].normals = Some([index(0), index(1), index(2)]);
        mesh.crease_degrees = Some(degrees);
    }
}

/// A triangle that is to have normals.
struct Bare {
    /// In the mesh.
    index: usize,
    group: u32,
    /// Unit normal.
    normal: DVec3,
    /// What it adds to the normal of each corner.
    shares: [DVec3; 3],
}

impl Bare {
    /// `None` for a triangle without area.
    fn new(mesh: &MeshDesc, index: usize, group: u32) -> Option<Self> {
        let [a, b, c] = mesh.triangles[index].positions.map(|i| mesh.positions[i as usize].as_dvec3());
        let (ab, bc, ca) = (b - a, c - b, a - c);
        let area = ab.cross(-ca);
        let normal = area.try_normalize()?;
        let [ab, bc, ca] = [ab, bc, ca].map(DVec3::length_squared);
        Some(Self { index, group, normal, shares: [area / (ab * ca), area / (ab * bc), area / (bc * ca)] })
    }
}

/// By vertex: the least vertex at the same place.
fn places(positions: &[Vec3]) -> Vec<u32> {
    // 0 and -0 are one place.
    let key = |i: u32| (positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut places = vec![0; positions.len()];
    for same in order.chunk_by(|a, b| key(*a) == key(*b)) {
        for &i in same {
            places[i as usize] = same[0];
        }
    }
    places
}

/// Joins corners of neighbours whose normals have at least the cosine `least` between them.
fn join_neighbors(mesh: &MeshDesc, bare: &[Bare], least: f64, corners: &mut Corners) {
    let places = places(&mesh.positions);
    let place =
        |corner: u32| places[mesh.triangles[bare[corner as usize / 3].index].positions[corner as usize % 3] as usize];
    // A side has the number of the corner where it starts; both directions of an edge have one key.
    let key = |side: u32| {
        let (from, to) = (place(side), place(next_corner(side)));
        (from.min(to), from.max(to))
    };
    let mut sides: Vec<((u32, u32), u32)> = (0..3 * bare.len() as u32).map(|side| (key(side), side)).collect();
    sides.sort_unstable();
    for edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let [(_, side), (_, other)] = *edge else { continue };
        let (a, b) = (&bare[side as usize / 3], &bare[other as usize / 3]);
        if place(side) != place(other) && a.group == b.group && a.normal.dot(b.normal) >= least {
            corners.join(side, next_corner(other));
            corners.join(next_corner(side), other);
        }
    }
}

/// The corner at the end of a side.
fn next_corner(side: u32) -> u32 {
    side - side % 3 + (side + 1) % 3
}

/// Which corners have one normal: a forest, each tree with its least corner as its root.
struct Corners {
    parents: Vec<u32>,
}

impl Corners {
    fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        while self.parents[corner as usize] != corner {
            let parent = self.parents[corner as usize];
            self.parents[corner as usize] = self.parents[parent as usize];
            corner = parent;
        }
        corner
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// By corner the number of its sum, and the sums: what all corners of a tree add up to, in their order.
    fn sums(&mut self, bare: &[Bare]) -> (Vec<u32>, Vec<DVec3>) {
        let (mut numbers, mut sums) = (vec![0; self.parents.len()], Vec::new());
        for corner in 0..self.parents.len() as u32 {
            let root = self.root(corner);
            if root == corner {
                numbers[root as usize] = sums.len() as u32;
                sums.push(DVec3::ZERO);
            }
            let number = numbers[root as usize];
            numbers[corner as usize] = number;
            sums[number as usize] += bare[corner as usize / 3].shares[corner as usize % 3];
        }
        (numbers, sums)
    }
}

#[cfg(test)]
mod tests;
