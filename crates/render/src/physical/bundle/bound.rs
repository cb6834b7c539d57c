//! What a cluster may send to eight points at most.

use super::Bundle;
use super::vectors::{Wide3, absolute, dot, loaded, splat3, sub};
use crate::cpu::Lanes;
use crate::physical::cluster_tree::ClusterTree;
use crate::physical::pass::Counts;
use glam::Vec3;
use lightcuts_kernel::cluster::{BOUND_MARGIN, ClusterNode, reach_bound};
use lightcuts_kernel::sampling::frame;
use lightcuts_world::bvh::LANES;

impl Bundle<'_> {
    /// At most so much light, as a sum of channels, comes from a cluster to each point.
    #[inline(always)]
    pub(super) fn bound<L: Lanes>(&self, tree: &ClusterTree, node: u32, counts: &mut Counts) -> L {
        if self.is_lambert {
            counts.bounds += self.count as u64;
            return self.lambert_bound(&tree.nodes[node as usize]);
        }
        let mut bounds = [0.0; LANES];
        for (bound, receiver) in bounds.iter_mut().zip(&self.receivers[..self.count]) {
            *bound = reach_bound(&receiver.reach(tree, node, counts));
        }
        L::load(&bounds)
    }

    /// The same for points of Lambert's material; twin of `cluster_reach` and `reach_bound`.
    #[inline(always)]
    fn lambert_bound<L: Lanes>(&self, node: &ClusterNode) -> L {
        let zero = L::splat(0.0);
        let half = (node.upper - node.lower) * 0.5;
        let center: Wide3<L> = sub(splat3((node.upper + node.lower) * 0.5), loaded(&self.point));
        let wide_half: Wide3<L> = splat3(half);
        let mut nearest_sq = zero;
        for axis in 0..3 {
            let outside = (center[axis].abs() - wide_half[axis]).max(zero);
            nearest_sq = nearest_sq + outside * outside;
        }
        let nearest_sq = nearest_sq.max(L::splat(self.receivers[0].bound.clamp_sq.max(f32::MIN_POSITIVE)));
        let from_light = sub([zero; 3], center);
        let (tangent, bitangent) = frame(node.axis);
        let emitted = box_cosine(
            [dot(splat3(node.axis), from_light), dot(splat3(tangent), from_light), dot(splat3(bitangent), from_light)],
            splat3(Vec3::new(node.axis.abs().dot(half), tangent.abs().dot(half), bitangent.abs().dot(half))),
        );
        let emitted = widened_cosine(emitted, node.cos_cone);
        let (normal, tangents) = (loaded(&self.normal), [loaded(&self.tangents[0]), loaded(&self.tangents[1])]);
        let cos_normal = box_cosine(
            [dot(normal, center), dot(tangents[0], center), dot(tangents[1], center)],
            [
                dot(absolute(normal), wide_half),
                dot(absolute(tangents[0]), wide_half),
                dot(absolute(tangents[1]), wide_half),
            ],
        );
        let factor = L::load(&self.greatest) * cos_normal * emitted * L::splat(node.power);
        factor / nearest_sq * L::splat(BOUND_MARGIN)
    }
}

/// Twin of `cluster::box_cosine`: from where a box's middle is along three axes, and how far it reaches along them.
#[inline(always)]
fn box_cosine<L: Lanes>(middle: Wide3<L>, reach: Wide3<L>) -> L {
    let zero = L::splat(0.0);
    let z = middle[0] + reach[0];
    let x = (middle[1].abs() - reach[1]).max(zero);
    let y = (middle[2].abs() - reach[2]).max(zero);
    let cos = (z / (x * x + y * y + z * z).sqrt()).min(L::splat(1.0));
    cos.and(z.greater(zero))
}

/// Twin of `cluster::widened_cosine`.
#[inline(always)]
fn widened_cosine<L: Lanes>(cos: L, cos_cone: f32) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let sin_cone = (1.0 - cos_cone * cos_cone).max(0.0).sqrt();
    let sin = (one - cos * cos).max(zero).sqrt();
    let widened = (cos * L::splat(cos_cone) + sin * L::splat(sin_cone)).max(zero).min(one);
    L::select(L::splat(cos_cone).greater(cos), widened, one)
}
