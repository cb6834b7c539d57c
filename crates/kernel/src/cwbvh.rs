//! The compressed eight-wide hierarchy that GPUs traverse (Ylitie et al. 2017, "Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs"), in the node format of the crate obvhs.
//!
//! Differs from the paper: boxes are built around padded primitives and their exits get [`SLAB_SLACK`], so that no hit is
//! lost to rounding; leaves of triangles, spheres and squares are mixed.

use crate::Rules;
use crate::intersect::{
    SPHERE, Sphere, Square, TRIANGLE, Triangle, intersect_sphere, intersect_square, intersect_triangle, min_determinant,
};
use crate::ray::{Hit, Ray, SLAB_SLACK, safe_reciprocal};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec3};

/// Most groups of siblings that a traversal can have to remember: one per level.
pub const COMPRESSED_STACK_SIZE: u32 = 32;

/// Eight children in 80 bytes: words 0-2 the origin of the grid; 3 its three exponents and the mask of inner children; 4
/// the first child node; 5 the first leaf item; 6-7 a byte per child (0 where empty; inner: 32 + 24 + slot; leaf: its
/// first item, and its number of items in unary in the upper three bits); 8-19 a byte per child each: lower and upper x,
/// lower and upper y, lower and upper z.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct CompressedNode {
    /// The words.
    pub words: [[u32; 4]; 5],
}

/// A primitive under a leaf. 48 bytes. Of a triangle `a` is a corner, `b` and `c` edges; of a sphere `a` is the centre and
/// `b.x` the radius; a square is looked up.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct LeafItem {
    /// Corner or centre.
    pub a: Vec3,
    /// Primitive in file order.
    pub primitive: u32,
    /// First edge, or the radius.
    pub b: Vec3,
    /// [`TRIANGLE`], [`SPHERE`] or [`crate::intersect::SQUARE`].
    pub kind: u32,
    /// Second edge.
    pub c: Vec3,
    /// Index of a square.
    pub index: u32,
}

/// All that rays can hit, as flat slices.
#[derive(Debug, Clone, Copy)]
pub struct CompressedGeometry<'a> {
    /// Nodes; the first is the root. Empty if there is nothing to hit.
    pub nodes: &'a [CompressedNode],
    /// Items in the order of the leaves.
    pub items: &'a [LeafItem],
    /// Squares in file order.
    pub squares: &'a [Square],
}

/// The nearest hit between the ray's ends; of equal hits the first in file order.
pub fn closest_hit(geometry: &CompressedGeometry<'_>, ray: &Ray, rules: Rules) -> Hit {
    traverse(geometry, ray, rules, false)
}

/// Whether anything lies between the ray's ends.
pub fn any_hit(geometry: &CompressedGeometry<'_>, ray: &Ray, rules: Rules) -> bool {
    traverse(geometry, ray, rules, true).is_some()
}

/// The hit of one item, or none.
pub fn intersect_item(item: &LeafItem, squares: &[Square], ray: &Ray, rules: Rules) -> Hit {
    let LeafItem { a, primitive, b, kind, c, index } = *item;
    let hit = match kind {
        TRIANGLE => {
            let triangle = Triangle { corner: a, primitive, edge1: b, padding0: 0, edge2: c, padding1: 0 };
            intersect_triangle(&triangle, ray, min_determinant(rules))
        }
        SPHERE => intersect_sphere(&Sphere { center: a, radius: b.x, primitive, padding: [0; 3] }, ray, rules),
        _ => intersect_square(&squares[index as usize], ray),
    };
    hit.unwrap_or(Hit::none(ray.t_max))
}

/// The order of children for a ray: of two siblings the one whose slot has more bits in common with this is nearer.
pub fn octant_order(direction: Vec3) -> u32 {
    let bit = |c: f32, bit: u32| if c < 0.0 { 0 } else { bit };
    bit(direction.x, 4) | bit(direction.y, 2) | bit(direction.z, 1)
}

/// Children of a node whose boxes the ray crosses before `limit`: x a bit per inner child at its place in the order, y a
/// bit per leaf item.
pub fn enter_children(node: &CompressedNode, ray: &Ray, reciprocal: Vec3, order: u32, limit: f32) -> UVec2 {
    let [w0, w1, w2, w3, w4] = node.words;
    let scale = |shift: u32| f32::from_bits(((w0[3] >> shift) & 0xff) << 23);
    let adjusted = Vec3::new(scale(0), scale(8), scale(16)) * reciprocal;
    let origin = Vec3::new(f32::from_bits(w0[0]), f32::from_bits(w0[1]), f32::from_bits(w0[2]));
    let offset = (origin - ray.origin) * reciprocal;
    let planes = [[w2[0], w2[1], w2[2], w2[3]], [w3[0], w3[1], w3[2], w3[3]], [w4[0], w4[1], w4[2], w4[3]]];
    let mut entered = UVec2::ZERO;
    for slot in 0..8 {
        let (half, shift) = ((slot / 4) as usize, slot % 4 * 8);
        let meta = (w1[2 + half] >> shift) & 0xff;
        if meta == 0 {
            continue;
        }
        let plane = |axis: usize, upper: usize| ((planes[axis][2 * upper + half] >> shift) & 0xff) as f32;
        let near = |axis: usize| plane(axis, usize::from(reciprocal[axis] < 0.0)) * adjusted[axis] + offset[axis];
        let far = |axis: usize| plane(axis, usize::from(reciprocal[axis] >= 0.0)) * adjusted[axis] + offset[axis];
        let entry = near(0).max(near(1)).max(near(2).max(ray.t_min));
        let exit = far(0).min(far(1)).min(far(2));
        if entry <= exit * SLAB_SLACK && entry <= limit {
            if meta & 0x18 == 0x18 {
                entered.x |= 1 << (slot ^ order);
            } else {
                entered.y |= (meta >> 5) << (meta & 0x1f);
            }
        }
    }
    entered
}

/// Walks the hierarchy for the nearest hit, or for any where `first` is set.
pub fn traverse(geometry: &CompressedGeometry<'_>, ray: &Ray, rules: Rules, first: bool) -> Hit {
    let mut best = Hit::none(ray.t_max);
    if geometry.nodes.is_empty() {
        return best;
    }
    let reciprocal = safe_reciprocal(ray.direction);
    let order = octant_order(reciprocal);
    // Siblings still to be visited: x their first node, y a bit for each in bits 8-15 and which siblings are inner in
    // bits 0-7.
    let mut stack = [UVec2::ZERO; COMPRESSED_STACK_SIZE as usize];
    let mut size = 0;
    let mut index = 0;
    loop {
        let node = &geometry.nodes[index as usize];
        let entered = enter_children(node, ray, reciprocal, order, best.t);
        let mut leaves = entered.y;
        while leaves != 0 {
            let item = node.words[1][1] + leaves.trailing_zeros();
            leaves &= leaves - 1;
            best.take_nearer(intersect_item(&geometry.items[item as usize], geometry.squares, ray, rules));
            if first && best.is_some() {
                return best;
            }
        }
        let mut group = UVec2::new(node.words[1][0], entered.x << 8 | node.words[0][3] >> 24);
        if entered.x == 0 {
            if size == 0 {
                return best;
            }
            size -= 1;
            group = stack[size];
        }
        let place = group.y.ilog2();
        group.y &= !(1 << place);
        if group.y >> 8 != 0 {
            stack[size] = group;
            size += 1;
        }
        let slot = (place - 8) ^ order;
        index = group.x + (group.y & 0xff & ((1 << slot) - 1)).count_ones();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::Rules;

    #[test]
    fn an_empty_geometry_is_never_hit() {
        let geometry = CompressedGeometry { nodes: &[], items: &[], squares: &[] };
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X, t_min: 0.0, t_max: 1.0, inside: false };
        assert!(!closest_hit(&geometry, &ray, Rules::Repaired).is_some());
        assert!(!any_hit(&geometry, &ray, Rules::Repaired));
    }
}
