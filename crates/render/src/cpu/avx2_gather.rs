//! Gathering with AVX2, eight VPLs at a time. Twin of the plain functions in `gather`, same bits.

#![allow(unsafe_code)]

use super::avx2_bundle::ALL;
use super::avx2_shadows::{MOST, Shadow, Source, trace};
use super::avx2_trace::{Wide3, dot, load, load3, splat3, spread, store, sub};
use super::gather::{Blocks, Candidates, Decisions, Gathered, Receiver};
use super::half_spaces::Shared;
use super::stack::Stack;
use super::tracer::Tracer;
use crate::light_node::{LANES, LightNode};
use glam::Vec3;
use lightcuts_kernel::light_tree::BOUND_MARGIN;
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_blendv_ps,
    _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps,
    _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps, _mm256_xor_ps,
};

/// Decides for every cluster of a node; twin of `kernel::light_tree::decide`, same bits.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn decide_all(node: &LightNode, (lower, upper): (Vec3, Vec3), threshold: f32) -> Decisions {
    let zero = _mm256_setzero_ps();
    let sign_bit = _mm256_set1_ps(-0.0);
    let (from_upper, from_lower) = (sub(splat3(lower), load3(&node.upper)), sub(splat3(upper), load3(&node.lower)));
    let (mut near_sq, mut far_sq, mut least, mut greatest) = (zero, zero, zero, zero);
    for axis in 0..3 {
        let (u, l) = (from_upper[axis], from_lower[axis]);
        let outside = _mm256_max_ps(_mm256_max_ps(u, _mm256_xor_ps(sign_bit, l)), zero);
        let farthest = _mm256_max_ps(_mm256_andnot_ps(sign_bit, l), _mm256_andnot_ps(sign_bit, u));
        near_sq = _mm256_add_ps(near_sq, _mm256_mul_ps(outside, outside));
        far_sq = _mm256_add_ps(far_sq, _mm256_mul_ps(farthest, farthest));
        let direction = load(&node.axis[axis]);
        let (a, b) = (_mm256_mul_ps(direction, u), _mm256_mul_ps(direction, l));
        least = _mm256_add_ps(least, _mm256_min_ps(a, b));
        greatest = _mm256_add_ps(greatest, _mm256_max_ps(a, b));
    }
    let far = _mm256_sqrt_ps(far_sq);
    let near = _mm256_sqrt_ps(_mm256_blendv_ps(far_sq, near_sq, _mm256_cmp_ps::<_CMP_GT_OQ>(greatest, zero)));
    let (cos_spread, sin_spread) = (load(&node.cos_spread), load(&node.sin_spread));
    let faced = _mm256_cmp_ps::<_CMP_GE_OQ>(greatest, _mm256_mul_ps(near, cos_spread));
    let widened = _mm256_add_ps(_mm256_mul_ps(greatest, cos_spread), _mm256_mul_ps(near, sin_spread));
    let widened = _mm256_max_ps(_mm256_min_ps(widened, near), zero);
    let greatest_flux = _mm256_mul_ps(_mm256_blendv_ps(widened, near, faced), load(&node.max_intensity));
    let narrowed = _mm256_sub_ps(_mm256_mul_ps(least, cos_spread), _mm256_mul_ps(far, sin_spread));
    let least_flux = _mm256_mul_ps(narrowed, load(&node.min_intensity));
    let limit =
        |margin: f32, dist_sq, dist| _mm256_mul_ps(_mm256_set1_ps(threshold * margin), _mm256_mul_ps(dist_sq, dist));
    let reject = _mm256_cmp_ps::<_CMP_LT_OQ>(greatest_flux, limit(1.0 - BOUND_MARGIN, near_sq, near));
    let reaches = _mm256_cmp_ps::<_CMP_GE_OQ>(least_flux, limit(1.0 + BOUND_MARGIN, far_sq, far));
    let accept = _mm256_and_ps(reaches, _mm256_cmp_ps::<_CMP_GT_OQ>(least_flux, zero));
    let open = ((1 << node.count) - 1) & !(_mm256_movemask_ps(reject) as u32);
    let accept = open & _mm256_movemask_ps(accept) as u32;
    Decisions { accept, descend: open & !accept }
}

/// Lanes whose relevance reaches the threshold; twin of `kernel::light_tree::is_relevant`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn relevant(intensity: __m256, ways: &Ways, threshold: f32) -> u32 {
    let flux = _mm256_mul_ps(ways.cos_phi, intensity);
    let volume = _mm256_mul_ps(ways.dist_sq, _mm256_sqrt_ps(ways.dist_sq));
    let needed = _mm256_mul_ps(_mm256_set1_ps(threshold), volume);
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(flux, needed)) as u32
}

/// Ways from points to VPLs, eight of them.
#[derive(Clone, Copy)]
pub(super) struct Ways {
    to_light: Wide3,
    pub(super) dist_sq: __m256,
    /// Cosines at the VPLs times distances, 0 where they are negative.
    cos_phi: __m256,
    /// Products of the cosines at both ends, times the squared distances.
    pub(super) cosines: __m256,
}

impl Ways {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn new(to_light: Wide3, normal: Wide3, direction: Wide3) -> Self {
        let zero = _mm256_setzero_ps();
        // With NaN in the first place the maximum is its second operand, as in the plain versions.
        let cos_theta = _mm256_max_ps(dot(normal, to_light), zero);
        let cos_phi = _mm256_max_ps(_mm256_sub_ps(zero, dot(direction, to_light)), zero);
        Self { to_light, dist_sq: dot(to_light, to_light), cos_phi, cosines: _mm256_mul_ps(cos_theta, cos_phi) }
    }

    /// Those in `chosen` whose points and VPLs face each other; with the rest, twin of `vpl_incidence`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn facing(&self, chosen: u32) -> __m256 {
        let facing = _mm256_cmp_ps::<_CMP_GT_OQ>(self.cosines, _mm256_setzero_ps());
        if chosen == ALL { facing } else { _mm256_and_ps(facing, spread(chosen)) }
    }
}

/// Adds the light of VPLs that are visible; twin of `phong_vpl`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn add(
    sums: &mut Wide3,
    (cosines, dist_sq, visible): (__m256, __m256, __m256),
    (colors, attenuation): (Wide3, __m256),
    diffuse: Wide3,
) {
    let factor = _mm256_mul_ps(attenuation, _mm256_div_ps(cosines, dist_sq));
    let factor = _mm256_and_ps(factor, visible);
    for channel in 0..3 {
        let color = _mm256_mul_ps(_mm256_mul_ps(colors[channel], diffuse[channel]), factor);
        sums[channel] = _mm256_add_ps(sums[channel], _mm256_min_ps(color, _mm256_set1_ps(1.0)));
    }
}

impl Shadow {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn new(ways: &Ways, open: u32, shared: Shared) -> Self {
        let Ways { to_light: direction, dist_sq: length_sq, cosines, .. } = *ways;
        Self { direction, length_sq, shared, open, cosines, block: 0, lane: 0, source: 0 }
    }

    /// Adds the light of VPLs that are visible.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn add(&self, sums: &mut Wide3, light: (Wide3, __m256), diffuse: Wide3) {
        add(sums, (self.cosines, self.length_sq, spread(self.open)), light, diffuse);
    }
}

/// Shadow rays that are still to be traced. First those of many VPLs, then their ways, then their light: a processor
/// can begin with the next few while it waits for what the first ones need, as long as little else lies between them.
pub(super) type Batch = Stack<Shadow, MOST>;

/// What the chosen VPLs add; twin of the plain `evaluate`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn evaluate(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[Candidates],
    threshold: Option<f32>,
    at: &Receiver,
) -> Gathered {
    let Blocks { vpls, half_spaces } = blocks;
    let (point, normal, diffuse) = (splat3(at.point), splat3(at.normal), splat3(at.diffuse));
    let facing = half_spaces.facing(at.normal);
    let mut source = Source::new();
    source.set(tracer, half_spaces, (point, _mm256_set1_ps(at.epsilon)));
    let mut batch = Batch::new();
    let mut sums = [_mm256_setzero_ps(); 3];
    let mut finish = |batch: &mut Batch, size: usize| {
        batch.size = size;
        trace(tracer, std::slice::from_ref(&source), batch.as_mut_slice(), false);
        let mut total = sums;
        for shadow in batch.as_slice() {
            let block = &vpls[shadow.block as usize];
            shadow.add(&mut total, (load3(&block.diffuse), load(&block.attenuation)), diffuse);
        }
        sums = total;
    };
    let (mut all_chosen, mut shadow_rays, mut size) = (0, 0, 0);
    for &Candidates { block: number, lanes, certain } in candidates {
        let (lanes, tested) = (u32::from(lanes), threshold.filter(|_| !certain));
        if tested.is_none() && half_spaces.is_turned_away(number, facing) {
            all_chosen += lanes.count_ones();
            continue;
        }
        let block = &vpls[number as usize];
        let ways = Ways::new(sub(load3(&block.position), point), normal, load3(&block.direction));
        let chosen = lanes & tested.map_or(ALL, |threshold| relevant(load(&block.intensity), &ways, threshold));
        let open = _mm256_movemask_ps(ways.facing(ALL)) as u32 & chosen;
        let shadow = Shadow { block: number, ..Shadow::new(&ways, open, source.shared(half_spaces.sides(number))) };
        all_chosen += chosen.count_ones();
        shadow_rays += u64::from(open.count_ones());
        size = batch.put_if(size, shadow, open != 0);
        if size == MOST {
            finish(&mut batch, size);
            size = 0;
        }
    }
    finish(&mut batch, size);
    let [r, g, b] = [store(sums[0]), store(sums[1]), store(sums[2])];
    let color = (0..LANES).fold(Vec3::ZERO, |total, lane| total + Vec3::new(r[lane], g[lane], b[lane]));
    Gathered { color, chosen: all_chosen, shadow_rays }
}
