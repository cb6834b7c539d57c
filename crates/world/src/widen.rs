//! Which nodes of a binary tree become the children of 8-wide ones, and which become leaves: the choice that costs rays least.
//!
//! The surface area heuristic over all ways to do it, by dynamic programming (Ylitie, Karras & Laine 2017, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.1). Differs: a leaf costs the same however many
//! triangles it has, for one block is tested at once.

use crate::binary_tree::{BinaryNode, Content};
use crate::bvh::LANES;

/// What testing a block of triangles costs, relative to the boxes of a node. Measured; between 0.3 and 1 it hardly matters.
const BLOCK_COST: f32 = 0.6;

/// Marks a number of parts that is better served by one part less.
const FEWER: u8 = u8::MAX;

/// How a binary node is best cut into parts, each of which becomes a child of a wide node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cut {
    /// Expected cost of a ray under this node if it is cut into at most so many parts; the first is one part.
    cost: [f32; LANES],
    /// Of these parts, how many come from the left child, less one; or [`FEWER`]. The first entry is for its own children,
    /// which are eight.
    left: [u8; LANES],
    /// Whether it is best made a leaf.
    pub(crate) is_leaf: bool,
}

/// The best cuts of all nodes. `sizes` has the number of triangles under a node, or `None` if other primitives lie there too.
pub(crate) fn cuts(binary: &[BinaryNode], sizes: &[Option<u32>]) -> Vec<Cut> {
    let mut cuts = vec![Cut { cost: [0.0; LANES], left: [FEWER; LANES], is_leaf: true }; binary.len()];
    for (index, node) in binary.iter().enumerate().rev() {
        let area = node.half_area();
        match node.content {
            Content::Primitive(_) => cuts[index].cost = [area * BLOCK_COST; LANES],
            Content::Children(left, right) => {
                let may_be_leaf = sizes[index].is_some_and(|n| n as usize <= LANES);
                let leaf_cost = if may_be_leaf { area * BLOCK_COST } else { f32::INFINITY };
                cuts[index] = cut(area, leaf_cost, &cuts[left as usize], &cuts[right as usize]);
            }
        }
    }
    cuts
}

/// The best cut of a node with two children.
fn cut(area: f32, leaf_cost: f32, left: &Cut, right: &Cut) -> Cut {
    let mut best = Cut { cost: [f32::INFINITY; LANES], left: [FEWER; LANES], is_leaf: false };
    for parts in 1..LANES {
        for from_left in 0..parts {
            let cost = left.cost[from_left] + right.cost[parts - 1 - from_left];
            if cost < best.cost[parts] {
                best.cost[parts] = cost;
                best.left[parts] = from_left as u8;
            }
        }
    }
    let node_cost = area + best.cost[LANES - 1];
    best.is_leaf = leaf_cost <= node_cost;
    best.cost[0] = leaf_cost.min(node_cost);
    best.left[0] = best.left[LANES - 1];
    for parts in 1..LANES {
        if best.cost[parts - 1] <= best.cost[parts] {
            best.cost[parts] = best.cost[parts - 1];
            best.left[parts] = FEWER;
        }
    }
    best
}

/// The children of the wide node that a binary node becomes; a leaf that is the whole tree is its own only child.
pub(crate) fn children(binary: &[BinaryNode], cuts: &[Cut], root: u32) -> Vec<u32> {
    let cut = &cuts[root as usize];
    let Content::Children(left, right) = binary[root as usize].content else { return vec![root] };
    if cut.is_leaf {
        return vec![root];
    }
    let mut found = Vec::with_capacity(LANES);
    collect(binary, cuts, left, cut.left[0], &mut found);
    collect(binary, cuts, right, LANES as u8 - 2 - cut.left[0], &mut found);
    found
}

/// Appends the parts of a node, at most `parts` + 1.
fn collect(binary: &[BinaryNode], cuts: &[Cut], index: u32, mut parts: u8, found: &mut Vec<u32>) {
    let cut = &cuts[index as usize];
    while parts > 0 && cut.left[parts as usize] == FEWER {
        parts -= 1;
    }
    match binary[index as usize].content {
        Content::Children(left, right) if parts > 0 => {
            let from_left = cut.left[parts as usize];
            collect(binary, cuts, left, from_left, found);
            collect(binary, cuts, right, parts - 1 - from_left, found);
        }
        _ => found.push(index),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::binary_tree;
    use glam::Vec3;

    fn count(binary: &[BinaryNode], index: u32) -> u32 {
        match binary[index as usize].content {
            Content::Primitive(_) => 1,
            Content::Children(left, right) => count(binary, left) + count(binary, right),
        }
    }

    #[test]
    fn every_node_is_parted_into_at_most_eight_that_cover_it() {
        let boxes: Vec<(Vec3, Vec3)> =
            (0..500).map(|i| Vec3::new((i % 7) as f32, (i % 31) as f32, i as f32)).map(|p| (p, p + 2.0)).collect();
        let binary = binary_tree::build(&boxes);
        let sizes: Vec<Option<u32>> = (0..binary.len() as u32).map(|index| Some(count(&binary, index))).collect();
        let cuts = cuts(&binary, &sizes);
        let (mut open, mut leaves, mut nodes) = (vec![0], 0, 0);
        while let Some(index) = open.pop() {
            if cuts[index as usize].is_leaf {
                assert!(count(&binary, index) as usize <= LANES);
                leaves += count(&binary, index);
                continue;
            }
            let children = children(&binary, &cuts, index);
            assert!((2..=LANES).contains(&children.len()));
            nodes += 1;
            open.extend(children);
        }
        assert_eq!(leaves, 500);
        assert!(nodes < 40, "{nodes}");
    }

    #[test]
    fn a_tree_of_one_leaf_is_its_own_child() {
        let binary = binary_tree::build(&[(Vec3::ZERO, Vec3::ONE)]);
        assert_eq!(children(&binary, &cuts(&binary, &[Some(1)]), 0), [0]);
    }
}
