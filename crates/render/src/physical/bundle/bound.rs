//! What a cluster may send to eight points at most.

use super::Bundle;
use super::vectors::{Frames, Wide3, absolute, dot, loaded, splat3, sub};
use crate::cpu::Lanes;
use glam::Vec3;
use lightcuts_kernel::cluster::{BOUND_MARGIN, ClusterNode};
use lightcuts_kernel::power::power;
use lightcuts_kernel::sampling::frame;
use lightcuts_world::bvh::LANES;
use std::f32::consts::PI;

impl Bundle<'_> {
    /// At most so much light, as a sum of channels, comes from a cluster to each point; twin of `cluster_reach` and
    /// `reach_bound`.
    #[inline(always)]
    pub(super) fn bound<L: Lanes>(&self, node: &ClusterNode) -> L {
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
        let factor = self.greatest_bsdf(center, wide_half) * emitted * L::splat(node.power);
        factor / nearest_sq * L::splat(BOUND_MARGIN)
    }

    /// The greatest channel of the points' BSDFs times the cosine, for light from a box; twin of `cluster::greatest_bsdf`.
    #[inline(always)]
    fn greatest_bsdf<L: Lanes>(&self, center: Wide3<L>, half: Wide3<L>) -> L {
        let cos_normal = axis_cosine(&self.normals, center, half);
        let even = L::load(&self.even) * cos_normal;
        if !self.is_shiny {
            return even;
        }
        let (one, a_half) = (L::splat(1.0), L::splat(0.5));
        let cos_mirror = axis_cosine(&self.mirrors, center, half);
        let cos_half = (a_half + a_half * cos_mirror).sqrt();
        let alpha = L::load(&self.alpha);
        let width = (one - cos_half) * (one + cos_half) + alpha * alpha * cos_half * cos_half;
        let facets = L::load(&self.facets) * (alpha * alpha / (L::splat(PI) * width * width));
        let lobes = L::load(&self.lobes(cos_mirror.store())) * cos_normal;
        (even + facets + lobes).and(cos_normal.greater(L::splat(0.0)))
    }

    /// Phong's lobes where they are cut by these cosines.
    fn lobes(&self, cos_mirror: [f32; LANES]) -> [f32; LANES] {
        let mut lobes = [0.0; LANES];
        for (lane, receiver) in self.receivers[..self.count].iter().enumerate() {
            let bound = &receiver.bound.bsdf;
            if bound.lobe > 0.0 {
                lobes[lane] = bound.lobe * power(cos_mirror[lane], bound.exponent);
            }
        }
        lobes
    }
}

/// The greatest cosines between each point's axis, the first of its frame, and its box.
#[inline(always)]
fn axis_cosine<L: Lanes>(frames: &Frames, center: Wide3<L>, half: Wide3<L>) -> L {
    let [axis, tangent, bitangent]: [Wide3<L>; 3] = [loaded(&frames[0]), loaded(&frames[1]), loaded(&frames[2])];
    box_cosine(
        [dot(axis, center), dot(tangent, center), dot(bitangent, center)],
        [dot(absolute(axis), half), dot(absolute(tangent), half), dot(absolute(bitangent), half)],
    )
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
