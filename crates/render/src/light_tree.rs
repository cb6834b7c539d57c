//! Station 4: the light tree, built top-down over VPLs.

use glam::Vec3;
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::light_tree::{LANES, LightNode, VplBlock};
use lightcuts_kernel::ray::normalize;

/// Weight of directions against positions when VPLs are split, as a share of the diagonal of all positions: the 6-D
/// points (position, c/4 direction) of `docs/theory.md`.
const DIRECTION_WEIGHT: f32 = 0.25;

/// VPLs in blocks, in tree order, and the nodes over them.
///
/// The order does not depend on the gather strategy, so that strategies sum in the same order.
#[derive(Debug, Clone, Default)]
pub(crate) struct LightTree {
    /// Nodes in depth-first order, root first; leaves hold one block.
    pub(crate) nodes: Vec<LightNode>,
    /// VPLs, eight at a time.
    pub(crate) blocks: Vec<VplBlock>,
    vpl_count: usize,
}

impl LightTree {
    /// Builds the tree. The split axis is the longest of the 6-D box, the place the middle, rounded to whole blocks.
    pub(crate) fn build(vpls: &[Vpl]) -> Self {
        let (lower, upper) = vpls.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), vpl| {
            (lower.min(vpl.position), upper.max(vpl.position))
        });
        let weight = if vpls.is_empty() { 0.0 } else { DIRECTION_WEIGHT * (upper - lower).length() };
        let mut order: Vec<u32> = (0..vpls.len() as u32).collect();
        let mut tree = Self { nodes: Vec::new(), blocks: Vec::new(), vpl_count: vpls.len() };
        let mut open = if vpls.is_empty() { vec![] } else { vec![(0, vpls.len(), None)] };
        while let Some((start, end, parent)) = open.pop() {
            let here = tree.nodes.len();
            if let Some(parent) = parent {
                let parent: &mut LightNode = &mut tree.nodes[parent];
                parent.right = here as u32;
            }
            let range = &mut order[start..end];
            tree.nodes.push(node(vpls, range, (start / LANES) as u32));
            if range.len() <= LANES {
                // Within a block the order of placement: the tree then decides nothing by chance.
                range.sort_unstable();
                tree.push_block(vpls, range);
            } else {
                let middle = split(vpls, range, weight);
                open.push((start + middle, end, Some(here)));
                open.push((start, start + middle, None));
            }
        }
        tree
    }

    fn push_block(&mut self, vpls: &[Vpl], indices: &[u32]) {
        let mut block: VplBlock = bytemuck::Zeroable::zeroed();
        for (lane, &index) in indices.iter().enumerate() {
            block.set(lane, &vpls[index as usize]);
        }
        self.blocks.push(block);
    }

    /// The lanes of a block that hold VPLs, a bit each.
    pub(crate) fn lanes(&self, block: u32) -> u32 {
        let count = (self.vpl_count - block as usize * LANES).min(LANES);
        (1 << count) - 1
    }

    pub(crate) fn vpl_count(&self) -> usize {
        self.vpl_count
    }
}

/// Reorders a range by its longest 6-D axis and returns where to split it.
fn split(vpls: &[Vpl], range: &mut [u32], weight: f32) -> usize {
    let key = |index: u32, axis: usize| {
        let vpl = &vpls[index as usize];
        if axis < 3 { vpl.position[axis] } else { vpl.direction[axis - 3] * weight }
    };
    let extent = |axis: usize| {
        let keys = range.iter().map(|&i| key(i, axis));
        let (least, greatest) = keys.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), k| (a.min(k), b.max(k)));
        greatest - least
    };
    let axis = (0..6).max_by(|&a, &b| extent(a).total_cmp(&extent(b)).then(b.cmp(&a))).expect("six axes");
    let middle = range.len().div_ceil(2).next_multiple_of(LANES).min((range.len() - 1) / LANES * LANES);
    range.select_nth_unstable_by(middle, |&a, &b| key(a, axis).total_cmp(&key(b, axis)).then(a.cmp(&b)));
    middle
}

/// A node over a range: box, cone and intensities.
fn node(vpls: &[Vpl], range: &[u32], first_block: u32) -> LightNode {
    let of = || range.iter().map(|&i| &vpls[i as usize]);
    let lower = of().fold(Vec3::INFINITY, |m, v| m.min(v.position));
    let upper = of().fold(Vec3::NEG_INFINITY, |m, v| m.max(v.position));
    let axis = normalize(of().map(|v| v.direction).sum());
    let least_cosine = of().map(|v| axis.dot(v.direction)).fold(1.0, f32::min);
    let center = (lower + upper) * 0.5;
    let reach = (upper - center).max(center - lower).length();
    LightNode {
        lower,
        max_intensity: of().map(Vpl::intensity).fold(0.0, f32::max),
        upper,
        min_intensity: of().map(Vpl::intensity).fold(f32::INFINITY, f32::min),
        axis,
        // Rounded outwards by more than the error of a dot product of unit vectors.
        cos_spread: if axis == Vec3::ZERO { -1.0 } else { (least_cosine - 1e-6).max(-1.0) },
        first_block,
        block_count: range.len().div_ceil(LANES) as u32,
        right: 0,
        vpl_count: range.len() as u32,
        center,
        radius: reach * (1.0 + 1e-6) + f32::MIN_POSITIVE,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::cpu::{select, select_exhaustively};
    use lightcuts_kernel::light_tree::relevance;
    use lightcuts_kernel::rng::random4;

    /// VPLs on the walls of a box and on a sphere in it.
    pub(crate) fn scattered(count: u32) -> Vec<Vpl> {
        (0..count)
            .map(|i| {
                let [a, b, c, d] = random4(i, 0, 0, 99);
                let [e, f, ..] = random4(i, 1, 0, 99);
                let on_sphere = d < 0.4;
                let direction = if on_sphere {
                    normalize(Vec3::new(a, b, c) - 0.5)
                } else {
                    [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z][(e * 5.0) as usize]
                };
                let wall = (Vec3::new(a, b, c) - 0.5) * 400.0 * (Vec3::ONE - direction.abs()) - direction * 200.0;
                Vpl {
                    position: if on_sphere { direction * 60.0 } else { wall },
                    direction,
                    diffuse: Vec3::new(f, 0.2, e),
                    attenuation: 0.1,
                    ..Vpl::default()
                }
            })
            .collect()
    }

    /// Sums of all VPLs' positions: equal sets have equal multisets of coordinates.
    fn positions(blocks: &[VplBlock], tree: &LightTree) -> Vec<[u32; 3]> {
        let mut all: Vec<[u32; 3]> = (0..blocks.len() as u32)
            .flat_map(|b| (0..LANES).filter(move |l| tree.lanes(b) >> l & 1 == 1).map(move |l| (b, l)))
            .map(|(b, l)| blocks[b as usize].vpl(l).position.to_array().map(f32::to_bits))
            .collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn every_vpl_is_in_exactly_one_leaf() {
        for count in [0, 1, 7, 8, 9, 16, 17, 290, 1000] {
            let vpls = scattered(count);
            let tree = LightTree::build(&vpls);
            let mut expected: Vec<[u32; 3]> = vpls.iter().map(|v| v.position.to_array().map(f32::to_bits)).collect();
            expected.sort_unstable();
            assert_eq!(positions(&tree.blocks, &tree), expected, "{count}");
            assert_eq!(tree.blocks.len(), (count as usize).div_ceil(LANES));
        }
    }

    #[test]
    fn nodes_enclose_their_vpls() {
        let vpls = scattered(700);
        let tree = LightTree::build(&vpls);
        for node in &tree.nodes {
            let mut count = 0;
            for block in node.first_block..node.first_block + node.block_count {
                for lane in (0..LANES).filter(|l| tree.lanes(block) >> l & 1 == 1) {
                    let vpl = tree.blocks[block as usize].vpl(lane);
                    count += 1;
                    assert!(vpl.position.cmpge(node.lower).all() && vpl.position.cmple(node.upper).all());
                    assert!((vpl.position - node.center).length() <= node.radius * 1.000_01);
                    assert!(node.axis.dot(vpl.direction) >= node.cos_spread);
                    assert!((node.min_intensity..=node.max_intensity).contains(&vpl.intensity()));
                }
            }
            assert_eq!(count, node.vpl_count);
        }
    }

    #[test]
    fn the_bounds_hold_for_ten_thousand_points_and_every_node() {
        use lightcuts_kernel::light_tree::{BOUND_MARGIN, relevance_bounds};
        let vpls = scattered(300);
        let tree = LightTree::build(&vpls);
        for sample in 0..10_000 {
            let [a, b, c, _] = random4(sample, 5, 0, 3);
            let point = (Vec3::new(a, b, c) - 0.5) * 420.0;
            for node in &tree.nodes {
                let (lower, upper) = relevance_bounds(node, point);
                for block in node.first_block..node.first_block + node.block_count {
                    for lane in (0..LANES).filter(|l| tree.lanes(block) >> l & 1 == 1) {
                        let vpl = tree.blocks[block as usize].vpl(lane);
                        let exact = relevance(vpl.position, vpl.direction, vpl.intensity(), point);
                        assert!(exact <= upper * (1.0 + BOUND_MARGIN) + f32::MIN_POSITIVE, "{exact} {upper} {node:?}");
                        assert!(exact >= lower * (1.0 - BOUND_MARGIN), "{exact} {lower} {node:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_tree_selects_what_testing_every_vpl_selects() {
        for count in [1, 9, 290, 3000] {
            let tree = LightTree::build(&scattered(count));
            let mut visited = 0;
            for sample in 0..500 {
                let [a, b, c, d] = random4(sample, 6, 0, 3);
                let point = (Vec3::new(a, b, c) - 0.5) * 400.0;
                let threshold = if sample % 10 == 0 { 0.0 } else { 10.0_f32.powf(-8.0 + 4.0 * d) };
                let mut exhaustive = Vec::new();
                select_exhaustively(&tree, point, threshold, &mut exhaustive);
                for avx2 in [false, crate::cpu::Simd::Auto.has_avx2()] {
                    let mut chosen = Vec::new();
                    let visits = select(&tree, avx2, point, threshold, &mut chosen);
                    assert_eq!(chosen, exhaustive, "{count} VPLs at {point}, threshold {threshold}");
                    visited += visits.nodes + visits.lights;
                }
            }
            println!("{count} VPLs: {:.1} visits per hit", visited as f64 / 1000.0);
        }
    }
}
