//! Gathering with AVX2: eight VPLs at a time. Twin of the plain functions in `gather`, same bits.

#![allow(unsafe_code)]

use super::avx2_packet::{Packet, any_hits};
use super::avx2_trace::{Wide3, dot, load, load3, splat3, store, sub};
use super::gather::{Chosen, PacketStack, Receiver};
use super::tracer::Tracer;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::light_tree::{LANES, VplBlock};
use lightcuts_kernel::ray::ORIGINAL_EPSILON;
use std::arch::x86_64::{
    __m256, _CMP_EQ_OQ, _CMP_GE_OQ, _CMP_GT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_and_si256, _mm256_andnot_ps,
    _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_div_ps, _mm256_max_ps, _mm256_min_ps,
    _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_setzero_ps,
    _mm256_sqrt_ps, _mm256_sub_ps,
};

/// Lanes whose relevance reaches the threshold; twin of `kernel::light_tree::relevance`.
#[target_feature(enable = "avx2")]
pub(super) fn relevant_lanes(block: &VplBlock, point: Vec3, threshold: f32) -> u32 {
    let from_light = sub(splat3(point), load3(&block.position));
    let dist_sq = dot(from_light, from_light);
    let reciprocal = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_sqrt_ps(dist_sq));
    let unit = from_light.map(|c| _mm256_mul_ps(c, reciprocal));
    let cosine = dot(load3(&block.direction), unit);
    let zero = _mm256_setzero_ps();
    // With NaN in the first place the maximum is its second operand, as in the plain version.
    let facing = _mm256_mul_ps(_mm256_max_ps(cosine, zero), load(&block.intensity));
    let coincident = _mm256_cmp_ps::<_CMP_EQ_OQ>(dist_sq, zero);
    let relevance = _mm256_andnot_ps(coincident, _mm256_div_ps(facing, dist_sq));
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(relevance, _mm256_set1_ps(threshold))) as u32
}

/// The ends of shadow rays; twin of `kernel::ray::shadow_ray`.
#[target_feature(enable = "avx2")]
fn shadow_ends(rules: Rules, to_light: Wide3, epsilon: f32) -> (__m256, __m256) {
    let one = _mm256_set1_ps(1.0);
    match rules {
        Rules::Original => (_mm256_set1_ps(ORIGINAL_EPSILON), one),
        Rules::Repaired => {
            let length = _mm256_max_ps(_mm256_sqrt_ps(dot(to_light, to_light)), _mm256_set1_ps(f32::MIN_POSITIVE));
            let relative = _mm256_div_ps(_mm256_set1_ps(epsilon), length);
            (relative, _mm256_sub_ps(one, relative))
        }
    }
}

/// All bits of the lanes that are set in a mask.
#[target_feature(enable = "avx2")]
fn spread(mask: u32) -> __m256 {
    let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    let chosen = _mm256_and_si256(_mm256_set1_epi32(mask as i32), bits);
    _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, bits))
}

/// What the chosen VPLs add; twin of `vpl_incidence` and `phong_vpl`.
#[target_feature(enable = "avx2")]
pub(super) fn evaluate(
    tracer: &Tracer<'_>,
    blocks: &[VplBlock],
    chosen: &[Chosen],
    at: &Receiver,
    stack: &mut PacketStack,
) -> (Vec3, u64) {
    let zero = _mm256_setzero_ps();
    let one = _mm256_set1_ps(1.0);
    let (point, normal, diffuse) = (splat3(at.point), splat3(at.normal), splat3(at.diffuse));
    let mut sums = [zero; 3];
    let mut shadow_rays = 0;
    for chosen in chosen {
        let block = &blocks[chosen.block as usize];
        let to_light = sub(load3(&block.position), point);
        let reciprocal = _mm256_div_ps(one, _mm256_sqrt_ps(dot(to_light, to_light)));
        let unit = to_light.map(|c| _mm256_mul_ps(c, reciprocal));
        let cos_theta = dot(normal, unit);
        let cos_phi = _mm256_sub_ps(zero, dot(load3(&block.direction), unit));
        let facing =
            _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(cos_theta, zero), _mm256_cmp_ps::<_CMP_GT_OQ>(cos_phi, zero));
        let candidates = _mm256_movemask_ps(facing) as u32 & chosen.lanes;
        if candidates == 0 {
            continue;
        }
        shadow_rays += u64::from(candidates.count_ones());
        let (t_min, t_max) = shadow_ends(tracer.rules, to_light, at.epsilon);
        let packet = Packet { origin: at.point, directions: to_light, t_min, t_max };
        let hidden = any_hits(&tracer.geometry, &packet, candidates, tracer.rules, stack);
        let visible = spread(candidates & !hidden);
        let emission = _mm256_mul_ps(load(&block.attenuation), cos_phi);
        let colors = load3(&block.diffuse);
        for channel in 0..3 {
            let reflected = _mm256_mul_ps(_mm256_mul_ps(colors[channel], diffuse[channel]), cos_theta);
            let color = _mm256_min_ps(_mm256_mul_ps(reflected, emission), one);
            sums[channel] = _mm256_add_ps(sums[channel], _mm256_and_ps(color, visible));
        }
    }
    let [r, g, b] = sums.map(|s| store(s));
    let total = (0..LANES).fold(Vec3::ZERO, |total, lane| total + Vec3::new(r[lane], g[lane], b[lane]));
    (total, shadow_rays)
}
