//! Station 4: the light tree. Its wide layout is built here, top-down; the packed one in `packed_tree`.

pub use crate::packed_tree::{PackedTree, position_bounds};

use crate::cpu::Candidates;
use crate::light_node::{LANES, LightNode, Part, VplBlock};
use glam::Vec3;
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::light_tree::LightCluster;
use lightcuts_kernel::ray::normalize_or_zero;
use std::sync::atomic::{AtomicU64, Ordering};

/// Weight of directions against positions when VPLs are split, as a share of the diagonal of all positions: splits are
/// of 6-D points (position, weight x direction). Measured on the thesis' scenes: with 1/4 (Walter et al. 2005) bounds
/// decide for 60 % of the blocks of Simple, with 1 for 69 %; at its distances the cosine decides, not the distance.
const DIRECTION_WEIGHT: f32 = 1.0;

/// All lanes of a block.
const FULL: u8 = u8::MAX;

/// Number of the next tree.
static NEXT_ID: AtomicU64 = AtomicU64::new(0);

/// VPLs in blocks, in tree order, and the nodes over them.
///
/// The order depends on the layout but not on the gather strategy, so that strategies sum in the same order.
#[derive(Debug, Clone)]
pub struct LightTree {
    pub(crate) nodes: Nodes,
    /// VPLs, eight at a time.
    pub(crate) blocks: Vec<VplBlock>,
    vpl_count: usize,
    id: u64,
}

/// How the nodes of a light tree are laid out. Each device has one that it walks with the least work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TreeLayout {
    /// Nodes of up to eight clusters: eight lanes decide at once.
    Wide,
    /// A perfect binary tree of small nodes, walked without a stack: [`PackedTree`].
    Packed,
}

/// The nodes of a light tree.
#[derive(Debug, Clone)]
pub(crate) enum Nodes {
    /// Root first.
    Wide(Vec<LightNode>),
    Packed(PackedTree),
}

/// A range of the VPLs in tree order, with its halves unless it is a single block.
struct Half {
    part: Part,
    halves: Option<[u32; 2]>,
}

impl LightTree {
    /// Builds the tree over VPLs in order of placement.
    pub fn build(vpls: &[Vpl], layout: TreeLayout) -> Self {
        match layout {
            TreeLayout::Wide => Self::wide(vpls),
            TreeLayout::Packed => Self::from_packed(vpls, PackedTree::build(vpls)),
        }
    }

    /// The tree of nodes that another device has built over VPLs in order of placement. Panics if the tree's order
    /// names a VPL that is not there.
    pub fn from_packed(vpls: &[Vpl], packed: PackedTree) -> Self {
        let mut tree = Self::empty(packed.order.len());
        packed.order.chunks(LANES).for_each(|block| tree.push_block(vpls, block));
        Self { nodes: Nodes::Packed(packed), ..tree }
    }

    /// The VPLs are halved until a block holds them, then the halvings are gathered eight at a time.
    fn wide(vpls: &[Vpl]) -> Self {
        let mut tree = Self::empty(vpls.len());
        let halves = tree.halve(vpls);
        Self { nodes: Nodes::Wide(widen(&halves)), ..tree }
    }

    fn empty(vpl_count: usize) -> Self {
        let id = NEXT_ID.fetch_add(1, Ordering::Relaxed);
        Self { nodes: Nodes::Wide(Vec::new()), blocks: Vec::new(), vpl_count, id }
    }

    /// Halves all VPLs, parents before children; fills the blocks. The split axis is the longest of the 6-D box, the
    /// place the middle, rounded to whole units.
    fn halve(&mut self, vpls: &[Vpl]) -> Vec<Half> {
        let (lower, upper) = vpls.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), vpl| {
            (lower.min(vpl.position), upper.max(vpl.position))
        });
        let weight = if vpls.is_empty() { 0.0 } else { DIRECTION_WEIGHT * (upper - lower).length() };
        let mut order: Vec<u32> = (0..vpls.len() as u32).collect();
        let mut tree: Vec<Half> = Vec::new();
        let mut open = if vpls.is_empty() { vec![] } else { vec![(0, vpls.len(), None)] };
        while let Some((start, end, parent)) = open.pop() {
            let here = tree.len() as u32;
            if let Some((parent, side)) = parent {
                let parent: &mut Half = &mut tree[parent as usize];
                parent.halves.get_or_insert([0; 2])[side] = here;
            }
            let range = &mut order[start..end];
            tree.push(Half { part: part(vpls, range, (start / LANES) as u32), halves: None });
            if range.len() <= LANES {
                // Within a block the order of placement: the tree then decides nothing by chance.
                range.sort_unstable();
                self.push_block(vpls, range);
            } else {
                let middle = split(vpls, range, weight);
                // The left half is taken next, so that blocks come in order.
                open.push((start + middle, end, Some((here, 1))));
                open.push((start, start + middle, Some((here, 0))));
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
    pub(crate) fn lanes(&self, block: u32) -> u8 {
        // All but the last block are full.
        if block as usize + 1 < self.blocks.len() { FULL } else { FULL >> (self.blocks.len() * LANES - self.vpl_count) }
    }

    /// Every VPL, block by block.
    pub(crate) fn every_block(&self, certain: bool) -> impl Iterator<Item = Candidates> {
        (0..self.blocks.len() as u32).map(move |block| Candidates { block, lanes: self.lanes(block), certain })
    }

    /// Number of VPLs.
    pub fn vpl_count(&self) -> usize {
        self.vpl_count
    }

    /// The nodes in the packed layout, if the tree has that.
    pub fn packed(&self) -> Option<&PackedTree> {
        match &self.nodes {
            Nodes::Packed(packed) => Some(packed),
            Nodes::Wide(_) => None,
        }
    }

    /// All VPLs in tree order.
    pub fn ordered_vpls(&self) -> Vec<Vpl> {
        (0..self.vpl_count).map(|place| self.blocks[place / LANES].vpl(place % LANES)).collect()
    }

    /// A number that no other tree made in this process has, clones apart, so that devices can keep what they uploaded.
    pub fn id(&self) -> u64 {
        self.id
    }
}

/// Makes nodes of up to eight clusters: the ranges of one [`unit`] under each range that is larger than a block.
fn widen(halves: &[Half]) -> Vec<LightNode> {
    let mut nodes: Vec<LightNode> = Vec::new();
    if halves.is_empty() {
        return nodes;
    }
    nodes.push(bytemuck::Zeroable::zeroed());
    let mut open = vec![(0_u32, 0_usize)];
    while let Some((root, target)) = open.pop() {
        let unit = unit(halves[root as usize].part.vpl_count as usize);
        let mut ranges = vec![root];
        while let Some(index) = ranges.pop() {
            let Half { part, halves } = &halves[index as usize];
            if let Some([left, right]) = *halves
                && part.vpl_count as usize > unit
            {
                ranges.extend([right, left]);
                continue;
            }
            let mut node = 0;
            if halves.is_some() {
                nodes.push(bytemuck::Zeroable::zeroed());
                node = nodes.len() as u32 - 1;
                open.push((index, node as usize));
            }
            nodes[target].push(&Part { node, ..*part });
        }
    }
    nodes
}

/// Size of the ranges that a range of VPLs is made of: the largest power of eight below its length, at least a block.
/// So nodes are full, but for the last of each level.
fn unit(vpls: usize) -> usize {
    let mut unit = LANES;
    while unit * LANES < vpls {
        unit *= LANES;
    }
    unit
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
    // The middle, rounded to whole units; a range larger than a unit holds at least one.
    let unit = unit(range.len());
    let middle = ((range.len() + unit) / (2 * unit)).max(1) * unit;
    range.select_nth_unstable_by(middle, |&a, &b| key(a, axis).total_cmp(&key(b, axis)).then(a.cmp(&b)));
    middle
}

/// A range with what its VPLs have in common.
fn part(vpls: &[Vpl], range: &[u32], first_block: u32) -> Part {
    let [block_count, vpl_count] = [range.len().div_ceil(LANES) as u32, range.len() as u32];
    Part { cluster: cluster(vpls, range), first_block, block_count, vpl_count, node: 0 }
}

/// What the VPLs of a range have in common: box, cone and intensities.
fn cluster(vpls: &[Vpl], range: &[u32]) -> LightCluster {
    let of = || range.iter().map(|&i| &vpls[i as usize]);
    let axis = normalize_or_zero(of().map(|v| v.direction).sum());
    let least_cosine = of().map(|v| axis.dot(v.direction)).fold(1.0, f32::min);
    // Rounded outwards by more than the error of a dot product of unit vectors.
    let cos_spread = if axis == Vec3::ZERO { -1.0 } else { (least_cosine - 1e-6).max(-1.0) };
    LightCluster {
        lower: of().fold(Vec3::INFINITY, |m, v| m.min(v.position)),
        upper: of().fold(Vec3::NEG_INFINITY, |m, v| m.max(v.position)),
        axis,
        cos_spread,
        sin_spread: (1.0 - cos_spread * cos_spread).max(0.0).sqrt(),
        min_intensity: if cos_spread > 0.0 { of().map(Vpl::intensity).fold(f32::INFINITY, f32::min) } else { 0.0 },
        max_intensity: of().map(Vpl::intensity).fold(0.0, f32::max),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use lightcuts_kernel::rng::random4;

    /// VPLs on the walls of a box and on a sphere in it.
    pub(crate) fn scattered(count: u32) -> Vec<Vpl> {
        (0..count)
            .map(|i| {
                let [a, b, c, d] = random4(i, 0, 0, 99);
                let [e, f, ..] = random4(i, 1, 0, 99);
                let on_sphere = d < 0.4;
                let direction = if on_sphere {
                    normalize_or_zero(Vec3::new(a, b, c) - 0.5)
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
            let tree = LightTree::build(&vpls, TreeLayout::Wide);
            let mut expected: Vec<[u32; 3]> = vpls.iter().map(|v| v.position.to_array().map(f32::to_bits)).collect();
            expected.sort_unstable();
            assert_eq!(positions(&tree.blocks, &tree), expected, "{count}");
            assert_eq!(tree.blocks.len(), (count as usize).div_ceil(LANES));
        }
    }

    fn wide_nodes(tree: &LightTree) -> &[LightNode] {
        let Nodes::Wide(nodes) = &tree.nodes else { panic!("the wide layout") };
        nodes
    }

    /// Every cluster with its VPLs.
    fn clusters(tree: &LightTree) -> Vec<(Part, Vec<Vpl>)> {
        let all = wide_nodes(tree).iter().flat_map(|node| (0..node.count as usize).map(|lane| node.part(lane)));
        let vpls = |block: u32| {
            let lanes = (0..LANES).filter(move |lane| tree.lanes(block) >> lane & 1 == 1);
            lanes.map(move |lane| tree.blocks[block as usize].vpl(lane))
        };
        all.map(|c| (c, (c.first_block..c.first_block + c.block_count).flat_map(vpls).collect())).collect()
    }

    #[test]
    fn clusters_enclose_their_vpls_and_partition_their_parents() {
        let tree = LightTree::build(&scattered(700), TreeLayout::Wide);
        for (part, vpls) in clusters(&tree) {
            let cluster = &part.cluster;
            assert_eq!(vpls.len(), part.vpl_count as usize);
            for vpl in vpls {
                assert!(vpl.position.cmpge(cluster.lower).all() && vpl.position.cmple(cluster.upper).all());
                assert!(cluster.axis.dot(vpl.direction) >= cluster.cos_spread);
                assert!((cluster.min_intensity..=cluster.max_intensity).contains(&vpl.intensity()));
            }
            if part.node == 0 {
                assert_eq!(part.block_count, 1);
                continue;
            }
            let node = &wide_nodes(&tree)[part.node as usize];
            let mut next = part.first_block;
            for child in (0..node.count as usize).map(|lane| node.part(lane)) {
                assert_eq!(child.first_block, next);
                next += child.block_count;
            }
            assert_eq!(next, part.first_block + part.block_count);
        }
    }

    #[test]
    fn the_bounds_hold_for_ten_thousand_points_and_every_cluster() {
        use lightcuts_kernel::light_tree::{BOUND_MARGIN, relevance_bounds};
        let tree = LightTree::build(&scattered(300), TreeLayout::Wide);
        let clusters = clusters(&tree);
        let mut decided = 0;
        for sample in 0..10_000 {
            let [a, b, c, d] = random4(sample, 5, 0, 3);
            let point = (Vec3::new(a, b, c) - 0.5) * 420.0;
            // Every other time as one of a box.
            let reach = Vec3::new(c, a, b) * if sample % 2 == 0 { 0.0 } else { 100.0 * d * d * d };
            for (part, vpls) in &clusters {
                let bounds = relevance_bounds(&part.cluster, point - reach, point + reach * d);
                let least = (bounds.least_flux / bounds.greatest_volume).max(0.0);
                let greatest = bounds.greatest_flux / bounds.least_volume;
                decided += u32::from(least > 0.0 || greatest == 0.0);
                for vpl in vpls {
                    let to_point = point - vpl.position;
                    let cosine = vpl.direction.dot(normalize_or_zero(to_point)).max(0.0);
                    let exact = cosine * vpl.intensity() / to_point.length_squared();
                    // A bound that is NaN decides nothing.
                    assert!(exact <= greatest * (1.0 + BOUND_MARGIN) || greatest.is_nan(), "{exact} {greatest}");
                    assert!(exact >= least * (1.0 - BOUND_MARGIN) || least.is_nan(), "{exact} {least}");
                }
            }
        }
        // The bounds are worth something: many clusters face the point as a whole or face away as a whole.
        assert!(decided as usize > clusters.len() * 10_000 / 4, "{decided}");
    }
}
