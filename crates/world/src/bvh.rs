//! The CPU's bounding volume hierarchy, eight wide: node layout and plain traversal.
//!
//! The CPU device replaces [`closest_hit`] and [`any_hit`] by SIMD versions that are tested against these. Other devices
//! traverse the compressed hierarchy of [`crate::CompressedHierarchy`].

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::{
    Sphere, Square, Triangle, intersect_sphere, intersect_square, intersect_triangle, min_determinant,
};
use lightcuts_kernel::ray::{END_SLACK, Hit, NONE, Ray, SLAB_SLACK, safe_reciprocal};
use lightcuts_kernel::watertight::{Shear, intersect_watertight};

/// Children of a node and triangles of a block; also the width of the SIMD registers that test them.
pub const LANES: usize = 8;

/// Most entries that a traversal can have to remember: 7 per level of the deepest tree that the builder makes.
pub const STACK_SIZE: usize = 512;

/// Levels of the deepest tree that the builder makes.
pub const MAX_LEVELS: usize = STACK_SIZE / (LANES - 1);

/// How blocks hold their triangles, and so how rays are tested against them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TriangleForm {
    /// A corner and two edges, for [`intersect_triangle`]: the thesis' model.
    #[default]
    Edges,
    /// Three corners, for [`intersect_watertight`]: the physical model.
    Corners,
}

/// Eight triangles, component by component. Empty lanes are zero throughout, which no ray hits.
///
/// Blocks and nodes begin where cache lines do: a ray waits for memory longer than it computes, and a block across one line
/// more is one more to wait for.
#[repr(C, align(64))]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct TriangleBlock {
    /// First corners: x of all lanes, y of all lanes, z of all lanes.
    pub a: [[f32; LANES]; 3],
    /// Second corners; as [`TriangleForm::Edges`] less the first ones.
    pub b: [[f32; LANES]; 3],
    /// Third corners; as [`TriangleForm::Edges`] less the first ones.
    pub c: [[f32; LANES]; 3],
    /// Primitive of each lane, or [`NONE`].
    pub primitive: [u32; LANES],
}

impl TriangleBlock {
    /// A block without triangles.
    pub const EMPTY: Self =
        Self { a: [[0.0; LANES]; 3], b: [[0.0; LANES]; 3], c: [[0.0; LANES]; 3], primitive: [NONE; LANES] };

    /// The vectors of one lane.
    pub fn lane(&self, lane: usize) -> [Vec3; 3] {
        [&self.a, &self.b, &self.c].map(|of| Vec3::new(of[0][lane], of[1][lane], of[2][lane]))
    }

    /// The triangle of one lane, of a block of edges.
    pub fn triangle(&self, lane: usize) -> Triangle {
        let [corner, edge1, edge2] = self.lane(lane);
        Triangle { corner, primitive: self.primitive[lane], edge1, padding0: 0, edge2, padding1: 0 }
    }
}

/// Eight children's boxes, component by component, rounded outwards. Empty children have inverted boxes.
#[repr(C, align(64))]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct BvhNode {
    /// Lower corners, then upper ones: of each x of all children, y of all children, z of all children.
    pub bounds: [[[f32; LANES]; 3]; 2],
    /// The children, as [`ChildRef`]s.
    pub child: [u32; LANES],
    /// Which children are blocks of triangles, a bit per lane.
    pub triangles: u32,
    /// Which children are spheres or squares, a bit per lane.
    pub others: u32,
    /// The rest of the last cache line.
    pub padding: [u32; 6],
}

impl BvhNode {
    /// A node without children.
    pub const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; LANES]; 3], [[f32::NEG_INFINITY; LANES]; 3]],
        child: [u32::MAX; LANES],
        triangles: 0,
        others: 0,
        padding: [0; 6],
    };

    /// Lower and upper corner of a child's box.
    pub fn child_box(&self, lane: usize) -> (Vec3, Vec3) {
        let corner = |of: &[[f32; LANES]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        (corner(&self.bounds[0]), corner(&self.bounds[1]))
    }

    /// Gives a lane its child.
    pub fn set_child(&mut self, lane: usize, (lower, upper): (Vec3, Vec3), child: ChildRef) {
        for axis in 0..3 {
            self.bounds[0][axis][lane] = lower[axis];
            self.bounds[1][axis][lane] = upper[axis];
        }
        self.child[lane] = child.pack();
        match child {
            ChildRef::Node(_) => {}
            ChildRef::Triangles(_) => self.triangles |= 1 << lane,
            ChildRef::Sphere(_) | ChildRef::Square(_) => self.others |= 1 << lane,
        }
    }
}

/// What a child of a node is: a node or a leaf of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChildRef {
    /// Another node.
    Node(u32),
    /// A block of up to eight triangles.
    Triangles(u32),
    /// One sphere.
    Sphere(u32),
    /// One square.
    Square(u32),
}

impl ChildRef {
    const SHIFT: u32 = 30;
    /// The bits of a packed reference that are the index.
    pub const INDEX: u32 = (1 << Self::SHIFT) - 1;

    /// Two bits of kind, thirty of index.
    pub const fn pack(self) -> u32 {
        match self {
            Self::Node(i) => i,
            Self::Triangles(i) => i | 1 << Self::SHIFT,
            Self::Sphere(i) => i | 2 << Self::SHIFT,
            Self::Square(i) => i | 3 << Self::SHIFT,
        }
    }

    /// The inverse of [`ChildRef::pack`].
    pub const fn unpack(packed: u32) -> Self {
        let index = packed & Self::INDEX;
        match packed >> Self::SHIFT {
            0 => Self::Node(index),
            1 => Self::Triangles(index),
            2 => Self::Sphere(index),
            _ => Self::Square(index),
        }
    }
}

/// All that rays can hit, as flat slices.
#[derive(Debug, Clone, Copy)]
pub struct Geometry<'a> {
    /// Nodes; the first is the root. Empty if there is nothing to hit.
    pub nodes: &'a [BvhNode],
    /// Triangle leaves.
    pub triangles: &'a [TriangleBlock],
    /// What these hold.
    pub form: TriangleForm,
    /// Sphere leaves.
    pub spheres: &'a [Sphere],
    /// Square leaves.
    pub squares: &'a [Square],
}

/// The nearest hit between the ray's ends; of equal hits the first in file order.
pub fn closest_hit(geometry: &Geometry<'_>, ray: &Ray, rules: Rules) -> Hit {
    let mut best = Hit::none(ray.t_max);
    traverse(geometry, ray, |child, ray| {
        intersect_leaf(geometry, child, ray, rules, &mut |hit| best.take_nearer(hit));
        best.t
    });
    best
}

/// Whether anything lies between the ray's ends.
pub fn any_hit(geometry: &Geometry<'_>, ray: &Ray, rules: Rules) -> bool {
    let mut found = false;
    traverse(geometry, ray, |child, ray| {
        intersect_leaf(geometry, child, ray, rules, &mut |_| found = true);
        if found { f32::NEG_INFINITY } else { ray.t_max }
    });
    found
}

/// Reports every hit of a leaf between the ray's ends.
pub fn intersect_leaf(geometry: &Geometry<'_>, leaf: ChildRef, ray: &Ray, rules: Rules, report: &mut impl FnMut(Hit)) {
    match leaf {
        ChildRef::Node(_) => {}
        ChildRef::Triangles(i) => {
            let block = &geometry.triangles[i as usize];
            let (limit, shear) = (min_determinant(rules), Shear::new(ray.direction));
            let hit = |lane: usize| match geometry.form {
                TriangleForm::Edges => intersect_triangle(&block.triangle(lane), ray, limit),
                TriangleForm::Corners => intersect_watertight(&block.lane(lane), block.primitive[lane], ray, &shear),
            };
            (0..LANES).filter_map(hit).for_each(report);
        }
        ChildRef::Sphere(i) => intersect_sphere(&geometry.spheres[i as usize], ray, rules).into_iter().for_each(report),
        ChildRef::Square(i) => intersect_square(&geometry.squares[i as usize], ray).into_iter().for_each(report),
    }
}

/// Visits the leaves whose boxes the ray crosses before the parameter that `visit` returned last.
fn traverse(geometry: &Geometry<'_>, ray: &Ray, mut visit: impl FnMut(ChildRef, &Ray) -> f32) {
    if geometry.nodes.is_empty() {
        return;
    }
    let reciprocal = safe_reciprocal(ray.direction);
    let mut limit = ray.t_max;
    let mut stack = [(0_u32, 0.0_f32); STACK_SIZE];
    let mut size = 1;
    stack[0] = (ChildRef::Node(0).pack(), ray.t_min);
    while size > 0 {
        size -= 1;
        let (child, entry) = stack[size];
        if entry > limit * END_SLACK {
            continue;
        }
        let ChildRef::Node(index) = ChildRef::unpack(child) else {
            limit = visit(ChildRef::unpack(child), ray);
            continue;
        };
        let node = &geometry.nodes[index as usize];
        for lane in 0..LANES {
            if let Some(entry) = enter_box(node, lane, ray, reciprocal, limit) {
                stack[size] = (node.child[lane], entry);
                size += 1;
            }
        }
    }
}

/// The parameter at which the ray enters a child's box, if it crosses the box between `ray.t_min` and `limit`.
fn enter_box(node: &BvhNode, lane: usize, ray: &Ray, reciprocal: Vec3, limit: f32) -> Option<f32> {
    let (lower, upper) = node.child_box(lane);
    let (a, b) = ((lower - ray.origin) * reciprocal, (upper - ray.origin) * reciprocal);
    let entry = a.min(b).max_element().max(ray.t_min);
    let exit = a.max(b).min_element();
    // Inverted boxes of empty children come out with lower > upper on every axis, and so with their ends swapped;
    // they are told by their order.
    (lower.x <= upper.x && entry <= exit * SLAB_SLACK && entry <= limit * END_SLACK).then_some(entry)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn child_references_survive_packing() {
        for child in [ChildRef::Node(0), ChildRef::Triangles(7), ChildRef::Sphere(1), ChildRef::Square((1 << 30) - 1)] {
            assert_eq!(ChildRef::unpack(child.pack()), child);
        }
    }

    #[test]
    fn an_empty_geometry_is_never_hit() {
        let geometry = Geometry { nodes: &[], triangles: &[], form: TriangleForm::Edges, spheres: &[], squares: &[] };
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X, t_min: 0.0, t_max: 1.0, inside: false };
        assert!(!closest_hit(&geometry, &ray, Rules::Repaired).is_some());
        assert!(!any_hit(&geometry, &ray, Rules::Repaired));
    }
}
