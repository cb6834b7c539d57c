//! The packed layout of the light tree, built on the CPU: the twin of what GPUs build.

use glam::Vec3;
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::light_tree::LightCluster;
use lightcuts_kernel::packed_tree::{
    BLOCK_SIZE, PackedLightNode, empty_cluster, merge_clusters, morton_key, pack_cluster, unpack_cluster, vpl_cluster,
};

/// A perfect binary tree over blocks of VPLs in Morton order.
///
/// `leaves` is the number of blocks rounded up to a power of two, at least 1. Node 1 is the root, the children of node
/// i are 2i and 2i + 1, and leaf j, node `leaves` + j, holds the block of VPLs `order[8 j .. 8 j + 8]`. Leaves past the
/// last block are empty.
#[derive(Debug, Clone, PartialEq)]
pub struct PackedTree {
    /// 2 * `leaves` nodes; the first is unused and zero.
    pub nodes: Vec<PackedLightNode>,
    /// Index, in order of placement, of the VPL at each place of the tree.
    pub order: Vec<u32>,
}

impl PackedTree {
    /// Builds the tree level by level from below.
    pub(crate) fn build(vpls: &[Vpl]) -> Self {
        let order = morton_order(vpls);
        let block_size = BLOCK_SIZE as usize;
        let leaves = order.len().div_ceil(block_size).next_power_of_two();
        let mut nodes = vec![pack_cluster(&empty_cluster(), 0.0); 2 * leaves];
        nodes[0] = bytemuck::Zeroable::zeroed();
        for (leaf, block) in nodes[leaves..].iter_mut().zip(order.chunks(block_size)) {
            *leaf = leaf_node(vpls, block);
        }
        for index in (1..leaves).rev() {
            nodes[index] = inner_node(&nodes[2 * index], &nodes[2 * index + 1]);
        }
        Self { nodes, order }
    }

    /// Number of leaves: a power of two.
    pub fn leaves(&self) -> usize {
        self.nodes.len() / 2
    }
}

/// The lower corner and the extent of the box around all positions, which Morton keys divide; zeros without VPLs.
pub fn position_bounds(vpls: &[Vpl]) -> (Vec3, Vec3) {
    let positions = || vpls.iter().map(|vpl| vpl.position);
    let Some(lower) = positions().reduce(Vec3::min) else { return (Vec3::ZERO, Vec3::ZERO) };
    let upper = positions().fold(lower, Vec3::max);
    (lower, upper - lower)
}

/// The VPLs' indices by Morton key; equal keys keep the order of placement.
fn morton_order(vpls: &[Vpl]) -> Vec<u32> {
    let (lower, extent) = position_bounds(vpls);
    let mut keyed: Vec<(u32, u32)> =
        vpls.iter().zip(0..).map(|(vpl, index)| (morton_key(vpl, lower, extent), index)).collect();
    keyed.sort_by_key(|&(key, _)| key);
    keyed.into_iter().map(|(_, index)| index).collect()
}

/// The node of a block.
fn leaf_node(vpls: &[Vpl], block: &[u32]) -> PackedLightNode {
    let (mut cluster, mut intensity): (LightCluster, f32) = (empty_cluster(), 0.0);
    for vpl in block.iter().map(|&index| &vpls[index as usize]) {
        cluster = merge_clusters(&cluster, &vpl_cluster(vpl));
        intensity += vpl.intensity();
    }
    pack_cluster(&cluster, intensity)
}

/// The node over two.
fn inner_node(left: &PackedLightNode, right: &PackedLightNode) -> PackedLightNode {
    let cluster = merge_clusters(&unpack_cluster(left), &unpack_cluster(right));
    pack_cluster(&cluster, left.intensity + right.intensity)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{Simd, chosen, select, select_exhaustively};
    use crate::light_tree::tests::scattered;
    use crate::light_tree::{LightTree, TreeLayout};
    use lightcuts_kernel::rng::random4;

    const COUNTS: [u32; 8] = [0, 1, 2, 3, 8, 9, 1000, 5000];

    /// VPLs in a room, all in one place, on a line, and without light.
    fn sets(count: u32) -> [(&'static str, Vec<Vpl>); 4] {
        let changed = |change: fn(usize, &mut Vpl)| {
            let mut vpls = scattered(count);
            vpls.iter_mut().enumerate().for_each(|(k, vpl)| change(k, vpl));
            vpls
        };
        [
            ("scattered", scattered(count)),
            ("coincident", changed(|_, vpl| vpl.position = Vec3::new(3.0, -20.0, 0.1))),
            ("collinear", changed(|k, vpl| vpl.position = Vec3::X * (k as f32 * 0.3 - 100.0))),
            ("mostly black", changed(|k, vpl| vpl.diffuse *= if k.is_multiple_of(7) { 1.0 } else { 0.0 })),
        ]
    }

    fn assert_holds(node: &PackedLightNode, vpl: &Vpl) {
        let cluster = unpack_cluster(node);
        assert!(
            cluster.lower.cmple(vpl.position).all() && cluster.upper.cmpge(vpl.position).all(),
            "{cluster:?} {vpl:?}"
        );
        assert!(cluster.axis.dot(vpl.direction) >= cluster.cos_spread, "{cluster:?} {vpl:?}");
        assert!((cluster.min_intensity..=cluster.max_intensity).contains(&vpl.intensity()), "{cluster:?} {vpl:?}");
    }

    #[test]
    fn packed_nodes_hold_every_vpl_below_them_once_and_all_the_light() {
        for count in COUNTS {
            for (name, vpls) in sets(count) {
                let tree = LightTree::build(&vpls, TreeLayout::Packed);
                let packed = tree.packed().expect("the packed layout");
                let leaves = packed.leaves();
                assert!(leaves.is_power_of_two() && (leaves == 1 || leaves < 2 * count.div_ceil(BLOCK_SIZE) as usize));
                for (place, vpl) in tree.ordered_vpls().iter().enumerate() {
                    assert_eq!(*vpl, vpls[packed.order[place] as usize], "{name} {count}");
                    let mut index = leaves + place / BLOCK_SIZE as usize;
                    while index > 0 {
                        assert_holds(&packed.nodes[index], vpl);
                        index /= 2;
                    }
                }
                let mut order = packed.order.clone();
                order.sort_unstable();
                assert!(order.into_iter().eq(0..count), "{name} {count}");
                let light: f64 = vpls.iter().map(|vpl| f64::from(vpl.intensity())).sum();
                assert!((f64::from(packed.nodes[1].intensity) - light).abs() <= 1e-5 * light, "{name} {count}");
                let used = count.div_ceil(BLOCK_SIZE) as usize;
                let empty = pack_cluster(&empty_cluster(), 0.0);
                assert!(packed.nodes[leaves + used..].iter().all(|node| *node == empty), "{name} {count}");
            }
        }
    }

    #[test]
    fn the_packed_tree_selects_what_testing_every_vpl_selects() {
        for count in COUNTS {
            for (name, vpls) in sets(count) {
                let trees = [TreeLayout::Wide, TreeLayout::Packed].map(|layout| LightTree::build(&vpls, layout));
                let mut visited = [0; 2];
                for sample in 0..200_u32 {
                    let [a, b, c, d] = random4(sample, 6, 0, 3);
                    // Some points coincide with a VPL.
                    let at_vpl = vpls.get(sample as usize).filter(|_| sample.is_multiple_of(8));
                    let point = at_vpl.map_or((Vec3::new(a, b, c) - 0.5) * 400.0, |vpl| vpl.position);
                    let threshold = if sample.is_multiple_of(10) { 0.0 } else { 10.0_f32.powf(-8.0 + 4.0 * d) };
                    for (tree, visited) in trees.iter().zip(&mut visited) {
                        let (mut found, mut expected) = (Vec::new(), Vec::new());
                        let visits = select(tree, Simd::Auto.has_avx2(), (point, point), threshold, &mut found);
                        select_exhaustively(tree, &mut expected);
                        let sets = [found, expected].map(|some| chosen(tree, &some, point, threshold));
                        assert_eq!(sets[0], sets[1], "{count} {name} at {point}, threshold {threshold}");
                        *visited += visits.nodes + visits.lights;
                    }
                }
                let [wide, packed] = visited.map(|visits| visits as f64 / 200.0);
                println!("{count} {name}: visits per hit: wide {wide:.1}, packed {packed:.1}");
            }
        }
    }
}
