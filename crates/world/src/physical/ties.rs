//! Surfaces that shine or have holes and lie in one place with others: a lamp flush with the ceiling, the same face
//! twice, a decal.
//!
//! Rounding alone would decide which of them a ray meets, while light that is drawn from an emitter stops short of all
//! of them and so would count each. Both go by one rule, for which the ties are listed here: of surfaces in one place
//! the first that shines towards a ray is met, else the first in file order.

use super::overlap::Outlines;
use crate::bvh::{ChildRef, LANES, TriangleBlock};
use crate::{Shapes, physical::PhysicalWorld};
use glam::{DVec2, DVec3, Vec3};
use lightcuts_kernel::intersect::{Sphere, Square};
use lightcuts_kernel::ray::NONE;
use lightcuts_kernel::rounding::UNIT;

/// How far surfaces may be apart to count as in one place, relative to the size of the one that shines or has holes.
const RELATIVE_DISTANCE: f64 = 1e-5;

/// The same in roundings of coordinates.
const ROUNDINGS: f64 = 8.0 * UNIT as f64;

/// The same in roundings of the coordinates that a mesh was given with: seven digits of text may be wrong by as much as
/// eight of them, on either side.
const ROUNDINGS_GIVEN: f64 = 20.0 * UNIT as f64;

/// Share of the smaller surface that must be in both: neighbours share no more than rounding makes of an edge.
const LEAST_SHARE: f64 = 1e-4;

/// Least cosine between the planes of what lies in one place.
const LEAST_SLOPE: f64 = 0.999;

/// Which primitives lie in one place with which others.
#[derive(Debug, Clone, Default)]
pub struct Ties {
    /// First of each primitive's `tied`, and their end; empty where nothing is tied.
    starts: Vec<u32>,
    tied: Vec<Tied>,
    /// How far rays begin off a tied primitive, in scene units, so that they are past all of those in its place.
    slacks: Vec<f32>,
}

/// A primitive in the place of another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tied {
    /// Its number.
    pub primitive: u32,
    /// Its corners, if it is a triangle; else of no use.
    pub corners: [Vec3; 3],
}

impl Ties {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.tied.is_empty()
    }

    /// The primitives in the place of this one.
    pub fn of(&self, primitive: u32) -> &[Tied] {
        if self.tied.is_empty() {
            return &[];
        }
        let [first, end] = [0, 1].map(|k| self.starts[primitive as usize + k] as usize);
        &self.tied[first..end]
    }

    /// How far rays begin off this primitive to be past those in its place, in scene units; 0 where there are none.
    pub fn slack(&self, primitive: u32) -> f32 {
        if self.tied.is_empty() { 0.0 } else { self.slacks[primitive as usize] }
    }

    /// Finds the ties of the primitives for which `is_asked`, by what these are without the overlap of their borders.
    fn find(shapes: &Shapes, outlines: &Outlines, is_asked: impl Fn(usize) -> bool) -> Self {
        let mut pairs = Vec::new();
        let asked = |primitive: u32| (primitive as usize) < shapes.primitives.len() && is_asked(primitive as usize);
        let lanes = shapes.triangles.iter().flat_map(|block| (0..LANES).map(move |lane| (block, lane)));
        let lanes = lanes.filter(|(block, lane)| asked(block.primitive[*lane]));
        let forms = lanes.map(|(block, lane)| Form::triangle(shapes, outlines, block, lane));
        let forms = forms.chain(shapes.spheres.iter().filter(|sphere| asked(sphere.primitive)).map(Form::sphere));
        let squares = outlines.squares.iter().filter(|square| asked(square.primitive));
        let forms = forms.chain(squares.map(Form::square));
        for form in forms {
            visit(shapes, outlines, &form, |other| {
                let (mine, others) = (form.tied, other.tied);
                let tolerance = form.tolerance(other.error);
                if others.primitive != mine.primitive && form.is_in_place_of(&other, tolerance) {
                    pairs.push((mine.primitive, others, tolerance));
                    pairs.push((others.primitive, mine, tolerance));
                }
            });
        }
        Self::listed(pairs, shapes.primitives.len())
    }

    /// Lists by primitive; pairs of two that were asked for are there twice.
    fn listed(mut pairs: Vec<(u32, Tied, f64)>, primitives: usize) -> Self {
        if pairs.is_empty() {
            return Self::default();
        }
        pairs.sort_by_key(|(primitive, tied, _)| (*primitive, tied.primitive));
        let mut ties = Self { starts: vec![0; primitives + 1], tied: Vec::new(), slacks: vec![0.0; primitives] };
        let mut last = None;
        for (primitive, tied, tolerance) in pairs {
            let slack = &mut ties.slacks[primitive as usize];
            *slack = slack.max(2.0 * tolerance as f32);
            if last != Some((primitive, tied.primitive)) {
                ties.tied.push(tied);
                ties.starts[primitive as usize + 1] += 1;
            }
            last = Some((primitive, tied.primitive));
        }
        for k in 0..primitives {
            ties.starts[k + 1] += ties.starts[k];
        }
        ties
    }
}

impl PhysicalWorld {
    /// Moves the emission of tied emitters past what lies in their place.
    pub(super) fn settle_ties(&mut self, outlines: &Outlines) {
        let Self { shapes, primitive_emitters, scatters, .. } = &*self;
        let has_holes = |primitive: usize| scatters[shapes.primitives[primitive].material as usize].mask_image != NONE;
        self.ties =
            Ties::find(shapes, outlines, |primitive| primitive_emitters[primitive] != NONE || has_holes(primitive));
        for emitter in self.emitters.iter_mut().filter(|emitter| emitter.primitive != NONE) {
            emitter.slack = emitter.slack.max(self.ties.slack(emitter.primitive));
        }
    }
}

/// The form of a primitive, for comparison.
struct Form {
    tied: Tied,
    outline: Outline,
    /// Unit normal of its plane; zero of a sphere and of what has no area.
    normal: DVec3,
    /// How far others may be off whose coordinates are exact, but for its own errors.
    distance: f64,
    /// How far rounding may have moved it, or another one with the same coordinates.
    error: f64,
    bounds: (DVec3, DVec3),
}

enum Outline {
    /// Corners in order.
    Triangle([DVec3; 3]),
    Square([DVec3; 4]),
    Sphere(Sphere),
}

impl Outline {
    /// Corners in order; none of a sphere.
    fn corners(&self) -> &[DVec3] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Square(corners) => corners,
            Self::Sphere(_) => &[],
        }
    }
}

impl Form {
    fn triangle(shapes: &Shapes, outlines: &Outlines, block: &TriangleBlock, lane: usize) -> Self {
        let primitive = block.primitive[lane];
        let points = &outlines.points[shapes.primitives[primitive as usize].index as usize];
        let given = outlines.given(shapes.primitives[primitive as usize].index as usize);
        let tied = Tied { primitive, corners: block.lane(lane) };
        Self::flat(tied, Outline::Triangle(points.map(Vec3::as_dvec3)), given)
    }

    fn square(square: &Square) -> Self {
        let (center, across, along) = (square.center.as_dvec3(), square.across.as_dvec3(), square.along.as_dvec3());
        let (across, along) = (across * f64::from(square.half_width), along * f64::from(square.half_height));
        let corners =
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| center + across * u + along * v);
        Self::flat(Tied { primitive: square.primitive, corners: NO_CORNERS }, Outline::Square(corners), 0.0)
    }

    fn flat(tied: Tied, outline: Outline, given: f64) -> Self {
        let corners = outline.corners();
        let lower = corners.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let upper = corners.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let coordinate = lower.abs().max(upper.abs()).max_element();
        let distance = (upper - lower).length() * RELATIVE_DISTANCE;
        let error = (coordinate * ROUNDINGS).max(given * ROUNDINGS_GIVEN);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        Self { tied, outline, normal, distance, error, bounds: (lower, upper) }
    }

    fn sphere(sphere: &Sphere) -> Self {
        let coordinate = f64::from(sphere.center.abs().max_element() + sphere.radius);
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        Self {
            tied: Tied { primitive: sphere.primitive, corners: NO_CORNERS },
            outline: Outline::Sphere(*sphere),
            normal: DVec3::ZERO,
            distance: radius * RELATIVE_DISTANCE,
            error: coordinate * ROUNDINGS,
            bounds: (center - radius, center + radius),
        }
    }

    /// How far this and another one may be apart to be in one place, by how far rounding may have moved the other.
    fn tolerance(&self, error: f64) -> f64 {
        self.distance + self.error.max(error)
    }

    /// A box around what may be in this one's place.
    fn reach(&self, tolerance: f64) -> (Vec3, Vec3) {
        ((self.bounds.0 - tolerance).as_vec3(), (self.bounds.1 + tolerance).as_vec3())
    }

    /// Whether a triangle may lie in the place of this form: finds most of those that do not, before a form is made of
    /// them.
    fn may_hold(&self, triangle: [Vec3; 3], tolerance: f64) -> bool {
        let Some(&corner) = self.outline.corners().first() else { return false };
        let [a, b, c] = triangle.map(Vec3::as_dvec3);
        let cross = (b - a).cross(c - a);
        if cross.dot(self.normal).abs() < 0.999 * LEAST_SLOPE * cross.length() {
            return false;
        }
        let heights = [a, b, c].map(|p| self.normal.dot(p - corner));
        let far = 2.0 * tolerance;
        heights.iter().any(|height| *height <= far) && heights.iter().any(|height| *height >= -far)
    }

    /// Whether a part of this surface lies in another one.
    fn is_in_place_of(&self, other: &Self, tolerance: f64) -> bool {
        match (&self.outline, &other.outline) {
            (Outline::Sphere(a), Outline::Sphere(b)) => {
                let off = a.center.as_dvec3().distance(b.center.as_dvec3()) + f64::from((a.radius - b.radius).abs());
                off <= tolerance
            }
            (Outline::Sphere(_), _) | (_, Outline::Sphere(_)) => false,
            (a, b) => {
                let [a, b] = [(a.corners(), self.normal), (b.corners(), other.normal)];
                meet(self.reach(tolerance), other.reach(0.0)) && are_in_one_place(a, b, tolerance)
            }
        }
    }
}

/// Of what is no triangle.
const NO_CORNERS: [Vec3; 3] = [Vec3::ZERO; 3];

/// Visits all primitives whose boxes meet that of a form.
fn visit(shapes: &Shapes, outlines: &Outlines, form: &Form, mut report: impl FnMut(Form)) {
    let tolerance = form.tolerance(outlines.greatest_given * ROUNDINGS_GIVEN);
    let reach = form.reach(tolerance);
    let mut open: Vec<u32> = if shapes.nodes.is_empty() { Vec::new() } else { vec![0] };
    while let Some(node) = open.pop() {
        let node = &shapes.nodes[node as usize];
        for lane in 0..LANES {
            if !meet(node.child_box(lane), reach) {
                continue;
            }
            match ChildRef::unpack(node.child[lane]) {
                ChildRef::Node(child) => open.push(child),
                ChildRef::Sphere(i) => report(Form::sphere(&shapes.spheres[i as usize])),
                ChildRef::Square(i) => report(Form::square(&outlines.squares[i as usize])),
                ChildRef::Triangles(i) => {
                    let block = &shapes.triangles[i as usize];
                    (0..LANES)
                        .filter(|&lane| block.primitive[lane] != NONE && form.may_hold(block.lane(lane), tolerance))
                        .for_each(|lane| report(Form::triangle(shapes, outlines, block, lane)));
                }
            }
        }
    }
}

/// Whether two boxes have a point in common.
fn meet((lower, upper): (Vec3, Vec3), other: (Vec3, Vec3)) -> bool {
    lower.cmple(other.1).all() && upper.cmpge(other.0).all()
}

/// Whether two convex outlines, each with the unit normal of its plane, share an area, and their planes are no farther
/// apart there than `tolerance`.
fn are_in_one_place((a, normal): (&[DVec3], DVec3), (b, other): (&[DVec3], DVec3), tolerance: f64) -> bool {
    let slope = normal.dot(other);
    if slope.abs() < LEAST_SLOPE || divides(a, b, normal) || divides(b, a, normal * slope.signum()) {
        return false;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let flat = |p: &DVec3| DVec2::new((*p - a[0]).dot(u), (*p - a[0]).dot(v));
    let (mine, others): (Vec<_>, Vec<_>) = (a.iter().map(flat).collect(), b.iter().map(flat).collect());
    let shared = clipped(&mine, &others);
    let least = area(&mine).abs().min(area(&others).abs());
    if area(&shared).abs() <= least * LEAST_SHARE {
        return false;
    }
    // Where the line across the first plane meets the second one.
    let off = |p: &DVec2| (other.dot(b[0] - (a[0] + u * p.x + v * p.y)) / slope).abs();
    shared.iter().map(off).fold(0.0, f64::max) <= tolerance
}

/// Whether an edge of a convex outline, counterclockwise about a normal, has all of another one on its outer side.
fn divides(outline: &[DVec3], other: &[DVec3], normal: DVec3) -> bool {
    (0..outline.len()).any(|k| {
        let outward = (outline[(k + 1) % outline.len()] - outline[k]).cross(normal);
        other.iter().all(|p| outward.dot(*p - outline[k]) >= 0.0)
    })
}

/// Twice the area, above zero counterclockwise.
fn area(outline: &[DVec2]) -> f64 {
    (0..outline.len()).map(|k| outline[k].perp_dot(outline[(k + 1) % outline.len()])).sum()
}

/// What two convex outlines share (Sutherland & Hodgman 1974).
fn clipped(outline: &[DVec2], by: &[DVec2]) -> Vec<DVec2> {
    let side = area(by).signum();
    let mut rest = outline.to_vec();
    for k in 0..by.len() {
        let (from, edge) = (by[k], by[(k + 1) % by.len()] - by[k]);
        let inside = |p: DVec2| edge.perp_dot(p - from) * side;
        let mut kept = Vec::with_capacity(rest.len() + 1);
        for j in 0..rest.len() {
            let (p, q) = (rest[j], rest[(j + 1) % rest.len()]);
            let (a, b) = (inside(p), inside(q));
            if a >= 0.0 {
                kept.push(p);
            }
            if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                kept.push(p + (q - p) * (a / (a - b)));
            }
        }
        rest = kept;
    }
    rest
}

#[cfg(test)]
mod tests;
