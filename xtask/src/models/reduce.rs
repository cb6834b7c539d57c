//! Mesh reduction by edge collapse with quadric errors (Garland and Heckbert 1997).
//!
//! Differs: a small cost on the length of an edge keeps flat regions in well-shaped triangles, and a collapse that
//! would turn a triangle over, make it a needle, or break the surface is refused. Every collapse of a closed mesh
//! removes two triangles, so an even target is met exactly.

use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

use anyhow::{Result, ensure};

use super::part::Part;
use super::vector::{Vec3, vec3};

/// Least shape of a triangle, 1 for an equilateral one and 0 for a degenerate one.
const LEAST_SHAPE: f64 = 0.22;
/// Least cosine between a triangle's normal before and after a collapse.
const LEAST_TURN: f64 = 0.3;
/// Cost of an edge's squared length, against the squared distance to the planes weighted by their area.
const LENGTH_COST: f64 = 0.004;

/// Sum of squared distances to planes: the upper half of a symmetric 4 x 4 matrix, row by row.
#[derive(Clone, Copy, Debug, Default)]
struct Quadric([f64; 10]);

impl Quadric {
    fn of_triangle([a, b, c]: [Vec3; 3]) -> Self {
        let area = (b - a).cross(c - a);
        let n = area.normalised();
        let (w, d) = (area.length() * 0.5, -n.dot(a));
        Self([n.x * n.x, n.x * n.y, n.x * n.z, n.x * d, n.y * n.y, n.y * n.z, n.y * d, n.z * n.z, n.z * d, d * d])
            .scaled(w)
    }

    fn scaled(self, factor: f64) -> Self {
        Self(self.0.map(|value| value * factor))
    }

    fn plus(self, other: Self) -> Self {
        let mut sum = self;
        sum.0.iter_mut().zip(other.0).for_each(|(value, more)| *value += more);
        sum
    }

    fn error(&self, p: Vec3) -> f64 {
        let [xx, xy, xz, xw, yy, yz, yw, zz, zw, ww] = self.0;
        let rows =
            vec3(xx * p.x + 2.0 * (xy * p.y + xz * p.z + xw), yy * p.y + 2.0 * (yz * p.z + yw), zz * p.z + 2.0 * zw);
        (rows.dot(p) + ww).max(0.0)
    }

    /// The point of least error, unless the planes leave it open.
    fn best(&self) -> Option<Vec3> {
        let [xx, xy, xz, xw, yy, yz, yw, zz, zw, _] = self.0;
        let (a, b, c) = (vec3(xx, xy, xz), vec3(xy, yy, yz), vec3(xz, yz, zz));
        let right = vec3(-xw, -yw, -zw);
        let determinant = a.dot(b.cross(c));
        let scale = (xx + yy + zz) / 3.0;
        (determinant > 1.0e-4 * scale * scale * scale)
            .then(|| (b.cross(c) * right.x + c.cross(a) * right.y + a.cross(b) * right.z) * (1.0 / determinant))
    }
}

/// An edge that may be collapsed on to `target`; stale if either end has changed since.
#[derive(Debug)]
struct Candidate {
    cost: f64,
    ends: [usize; 2],
    versions: [u32; 2],
    target: Vec3,
}

impl Ord for Candidate {
    /// The cheapest is the greatest; ties by index, so that the order is total.
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then_with(|| other.ends.cmp(&self.ends))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

struct Reduction {
    positions: Vec<Vec3>,
    quadrics: Vec<Quadric>,
    versions: Vec<u32>,
    /// Removed triangles are `None`.
    triangles: Vec<Option<[usize; 3]>>,
    /// The triangles at each vertex.
    around: Vec<BTreeSet<usize>>,
    queue: BinaryHeap<Candidate>,
    /// Starts at [`LEAST_SHAPE`], lowered only when nothing else is left.
    least_shape: f64,
}

/// The closed triangle mesh `part` with exactly `target` triangles. `detail` weighs the error at each point: above one
/// keeps more triangles there.
pub(super) fn reduce(part: &Part, target: usize, detail: impl Fn(Vec3) -> f64) -> Result<Part> {
    let mut reduction = Reduction::new(part, detail);
    let mut left = part.triangle_count();
    let mut left_at_offer = usize::MAX;
    while left > target {
        let Some(candidate) = reduction.queue.pop() else {
            // Edges that were refused may be fine now that their surroundings have changed.
            if left == left_at_offer {
                reduction.least_shape *= 0.8;
                ensure!(reduction.least_shape > 0.05, "{left} triangles are left, {target} were wanted");
            }
            left_at_offer = left;
            reduction.offer_all();
            continue;
        };
        if reduction.is_current(&candidate)
            && let Some(target) = reduction.place(&candidate)
        {
            reduction.collapse(candidate.ends, target);
            left -= 2;
        }
    }
    ensure!(left == target, "{left} triangles are left, {target} were wanted");
    Ok(reduction.into_part())
}

impl Reduction {
    fn new(part: &Part, detail: impl Fn(Vec3) -> f64) -> Self {
        let count = part.positions.len();
        let mut reduction = Self {
            positions: part.positions.clone(),
            quadrics: vec![Quadric::default(); count],
            versions: vec![0; count],
            triangles: part.triangles().map(Some).collect(),
            around: vec![BTreeSet::new(); count],
            queue: BinaryHeap::new(),
            least_shape: LEAST_SHAPE,
        };
        for (index, corners) in part.triangles().enumerate() {
            let points = corners.map(|corner| part.positions[corner]);
            let quadric = Quadric::of_triangle(points).scaled(detail(points[0]));
            for corner in corners {
                reduction.quadrics[corner] = reduction.quadrics[corner].plus(quadric);
                reduction.around[corner].insert(index);
            }
        }
        reduction
    }

    /// Puts every edge into the queue.
    fn offer_all(&mut self) {
        for index in 0..self.triangles.len() {
            let Some([a, b, c]) = self.triangles[index] else { continue };
            [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| from < to).for_each(|ends| self.offer(ends));
        }
    }

    /// Puts an edge into the queue.
    fn offer(&mut self, ends: [usize; 2]) {
        let [a, b] = ends.map(|end| self.positions[end]);
        let quadric = self.quadrics[ends[0]].plus(self.quadrics[ends[1]]);
        let middle = a.lerp(b, 0.5);
        let length_sq = (a - b).dot(a - b);
        let near = |point: &Vec3| (*point - middle).dot(*point - middle) < length_sq;
        let choices = [quadric.best().filter(near).unwrap_or(middle), middle, a, b];
        let target = choices.into_iter().min_by(|p, q| quadric.error(*p).total_cmp(&quadric.error(*q)));
        let target = target.expect("there are four choices");
        let cost = quadric.error(target) + LENGTH_COST * length_sq * length_sq;
        self.queue.push(Candidate { cost, ends, versions: ends.map(|end| self.versions[end]), target });
    }

    fn is_current(&self, candidate: &Candidate) -> bool {
        candidate.ends.map(|end| self.versions[end]) == candidate.versions
    }

    fn corners(&self, triangle: usize) -> [usize; 3] {
        self.triangles[triangle].expect("a vertex lists only triangles that are left")
    }

    fn neighbours(&self, vertex: usize) -> BTreeSet<usize> {
        let corners = self.around[vertex].iter().flat_map(|&triangle| self.corners(triangle));
        corners.filter(|&corner| corner != vertex).collect()
    }

    /// Where the edge may go: its best point or, where that spoils a triangle, its middle or one of its ends.
    fn place(&self, candidate: &Candidate) -> Option<Vec3> {
        let [a, b] = candidate.ends;
        // The ends may share only the two vertices across their edge, or the surface would touch itself.
        if self.neighbours(a).intersection(&self.neighbours(b)).count() != 2 {
            return None;
        }
        let (start, end) = (self.positions[a], self.positions[b]);
        let targets = [candidate.target, start.lerp(end, 0.5), start, end];
        targets.into_iter().find(|&target| self.keeps_shape(candidate.ends, target))
    }

    /// Whether the triangles around an edge stay upright and well shaped when it is collapsed on to `target`.
    fn keeps_shape(&self, [a, b]: [usize; 2], target: Vec3) -> bool {
        let moved = |corner: usize| if corner == a || corner == b { target } else { self.positions[corner] };
        let turned = |triangle: &usize| {
            let corners = self.corners(*triangle);
            (corners.map(|corner| self.positions[corner]), corners.map(moved))
        };
        let changed: Vec<_> = self.around[a].symmetric_difference(&self.around[b]).map(turned).collect();
        let worst_before = changed.iter().map(|(before, _)| shape(*before)).fold(1.0, f64::min);
        changed.into_iter().all(|(before, after)| {
            let turn = area_vector(before).normalised().dot(area_vector(after).normalised());
            // A needle has no normal worth keeping.
            let upright = turn > LEAST_TURN || (shape(before) < LEAST_SHAPE && turn > -LEAST_TURN);
            upright && shape(after) > worst_before.min(self.least_shape)
        })
    }

    fn collapse(&mut self, [kept, gone]: [usize; 2], target: Vec3) {
        self.positions[kept] = target;
        self.quadrics[kept] = self.quadrics[kept].plus(self.quadrics[gone]);
        for triangle in std::mem::take(&mut self.around[gone]) {
            let corners = self.corners(triangle);
            if corners.contains(&kept) {
                self.triangles[triangle] = None;
                for corner in corners {
                    self.around[corner].remove(&triangle);
                }
            } else {
                self.triangles[triangle] = Some(corners.map(|corner| if corner == gone { kept } else { corner }));
                self.around[kept].insert(triangle);
            }
        }
        self.versions[kept] += 1;
        self.versions[gone] += 1;
        for other in self.neighbours(kept) {
            self.offer([kept.min(other), kept.max(other)]);
        }
    }

    fn into_part(self) -> Part {
        let mut part = Part::default();
        let mut places = vec![None; self.positions.len()];
        for corners in self.triangles.into_iter().flatten() {
            let face = corners.map(|corner| {
                *places[corner].get_or_insert_with(|| {
                    part.positions.push(self.positions[corner]);
                    part.positions.len() - 1
                })
            });
            part.faces.push(face.to_vec());
        }
        part
    }
}

fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

/// One for an equilateral triangle, towards zero for a needle.
fn shape([a, b, c]: [Vec3; 3]) -> f64 {
    let sides = (b - a).dot(b - a) + (c - b).dot(c - b) + (a - c).dot(a - c);
    if sides > 0.0 { 2.0 * 3.0_f64.sqrt() * area_vector([a, b, c]).length() / sides } else { 0.0 }
}
