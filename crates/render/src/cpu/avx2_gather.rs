//! Gathering with AVX2: eight VPLs at a time, or one for eight points. Twin of the plain functions in `gather`, same bits.

#![allow(unsafe_code)]

use super::avx2_packet::{Packet, Source, any_hits};
use super::avx2_trace::{Wide3, dot, load, load3, splat3, store, sub};
use super::gather::{Candidates, Decisions, Gathered, Receiver};
use super::tracer::Tracer;
use crate::light_node::{LANES, LightNode, VplBlock};
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::light_tree::BOUND_MARGIN;
use lightcuts_kernel::ray::ORIGINAL_EPSILON;
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_and_si256, _mm256_andnot_ps,
    _mm256_blendv_ps, _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_div_ps, _mm256_max_ps,
    _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32,
    _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps, _mm256_xor_ps,
};

/// The ends of shadow rays; twin of `kernel::ray::shadow_ray`.
#[target_feature(enable = "avx2,fma,bmi1")]
fn shadow_ends(rules: Rules, to_light: Wide3, epsilon: __m256) -> (__m256, __m256) {
    let one = _mm256_set1_ps(1.0);
    match rules {
        Rules::Original => (_mm256_set1_ps(ORIGINAL_EPSILON), one),
        Rules::Repaired => {
            let length = _mm256_max_ps(_mm256_sqrt_ps(dot(to_light, to_light)), _mm256_set1_ps(f32::MIN_POSITIVE));
            let relative = _mm256_div_ps(epsilon, length);
            (relative, _mm256_sub_ps(one, relative))
        }
    }
}

/// All bits of the lanes that are set in a mask.
#[target_feature(enable = "avx2,fma,bmi1")]
fn spread(mask: u32) -> __m256 {
    let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    let chosen = _mm256_and_si256(_mm256_set1_epi32(mask as i32), bits);
    _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, bits))
}

/// Decides for every cluster of a node; twin of `kernel::light_tree::decide`, same bits.
#[target_feature(enable = "avx2,fma,bmi1")]
pub(super) fn decide_all(node: &LightNode, point: Vec3, threshold: f32) -> Decisions {
    let zero = _mm256_setzero_ps();
    let sign_bit = _mm256_set1_ps(-0.0);
    let point = splat3(point);
    let (from_upper, from_lower) = (sub(point, load3(&node.upper)), sub(point, load3(&node.lower)));
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
#[target_feature(enable = "avx2,fma,bmi1")]
fn relevant(intensity: __m256, cos_phi: __m256, dist_sq: __m256, threshold: f32) -> u32 {
    // With NaN in the first place the maximum is its second operand, as in the plain version.
    let flux = _mm256_mul_ps(_mm256_max_ps(cos_phi, _mm256_setzero_ps()), intensity);
    let needed = _mm256_mul_ps(_mm256_set1_ps(threshold), dist_sq);
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(flux, needed)) as u32
}

/// What the chosen VPLs add; twin of `vpl_incidence` and `phong_vpl`.
#[target_feature(enable = "avx2,fma,bmi1")]
pub(super) fn evaluate(
    tracer: &Tracer<'_>,
    blocks: &[VplBlock],
    candidates: &[Candidates],
    threshold: Option<f32>,
    at: &Receiver,
) -> Gathered {
    let zero = _mm256_setzero_ps();
    let one = _mm256_set1_ps(1.0);
    let (point, normal, diffuse) = (splat3(at.point), splat3(at.normal), splat3(at.diffuse));
    let source = Source::new(&tracer.geometry, point);
    let mut sums = [zero; 3];
    let mut gathered = Gathered { color: Vec3::ZERO, chosen: 0, shadow_rays: 0 };
    for candidates in candidates {
        let block = &blocks[candidates.block as usize];
        let to_light = sub(load3(&block.position), point);
        let dist_sq = dot(to_light, to_light);
        let reciprocal = _mm256_div_ps(one, _mm256_sqrt_ps(dist_sq));
        let [x, y, z] = to_light;
        let unit = [_mm256_mul_ps(x, reciprocal), _mm256_mul_ps(y, reciprocal), _mm256_mul_ps(z, reciprocal)];
        let cos_theta = dot(normal, unit);
        let cos_phi = _mm256_sub_ps(zero, dot(load3(&block.direction), unit));
        let relevant = match threshold {
            Some(threshold) if !candidates.certain => relevant(load(&block.intensity), cos_phi, dist_sq, threshold),
            _ => u32::MAX,
        };
        let chosen = u32::from(candidates.lanes) & relevant;
        gathered.chosen += chosen.count_ones();
        let facing =
            _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(cos_theta, zero), _mm256_cmp_ps::<_CMP_GT_OQ>(cos_phi, zero));
        let facing = _mm256_movemask_ps(facing) as u32 & chosen;
        if facing == 0 {
            continue;
        }
        gathered.shadow_rays += u64::from(facing.count_ones());
        let (t_min, t_max) = shadow_ends(tracer.rules, to_light, _mm256_set1_ps(at.epsilon));
        let packet = Packet { origin: point, direction: to_light, t_min, t_max };
        let hidden = any_hits(tracer, &packet, Some(&source), facing);
        let visible = spread(facing & !hidden);
        let emission = _mm256_mul_ps(load(&block.attenuation), cos_phi);
        let colors = load3(&block.diffuse);
        for channel in 0..3 {
            let reflected = _mm256_mul_ps(_mm256_mul_ps(colors[channel], diffuse[channel]), cos_theta);
            let color = _mm256_min_ps(_mm256_mul_ps(reflected, emission), one);
            sums[channel] = _mm256_add_ps(sums[channel], _mm256_and_ps(color, visible));
        }
    }
    let [r, g, b] = [store(sums[0]), store(sums[1]), store(sums[2])];
    gathered.color = (0..LANES).fold(Vec3::ZERO, |total, lane| total + Vec3::new(r[lane], g[lane], b[lane]));
    gathered
}

/// Points that gather together, component by component; the last one fills what is left of the eight.
struct Points {
    count: usize,
    point: Wide3,
    normal: Wide3,
    diffuse: Wide3,
    epsilon: __m256,
}

impl Points {
    #[target_feature(enable = "avx2,fma,bmi1")]
    fn new(at: &[Receiver]) -> Self {
        let lane = |lane: usize| &at[lane.min(at.len() - 1)];
        let wide3 = |of: &dyn Fn(&Receiver) -> Vec3| -> [[f32; LANES]; 3] {
            std::array::from_fn(|axis| std::array::from_fn(|k| of(lane(k))[axis]))
        };
        let epsilon = std::array::from_fn(|k| lane(k).epsilon);
        Self {
            count: at.len(),
            point: load3(&wide3(&|at| at.point)),
            normal: load3(&wide3(&|at| at.normal)),
            diffuse: load3(&wide3(&|at| at.diffuse)),
            epsilon: load(&epsilon),
        }
    }
}

/// Twin of [`evaluate`] for up to eight points, each with its candidates in the order of their blocks: one VPL at a time for all
/// points that have it, whose shadow rays go much the same way.
#[target_feature(enable = "avx2,fma,bmi1")]
pub(super) fn evaluate_together(
    tracer: &Tracer<'_>,
    blocks: &[VplBlock],
    candidates: &[&[Candidates]],
    threshold: Option<f32>,
    at: &[Receiver],
) -> [Gathered; LANES] {
    let zero = _mm256_setzero_ps();
    let points = Points::new(at);
    let source = Source::new(&tracer.geometry, points.point);
    // By lane of the VPLs, as one point sums them.
    let mut sums = [[zero; 3]; LANES];
    let (mut chosen, mut shadow_rays) = ([0_u32; LANES], [0_u32; LANES]);
    let mut next = [0_usize; LANES];
    loop {
        let blocks_ahead = (0..points.count).filter_map(|k| candidates[k].get(next[k])).map(|ahead| ahead.block);
        let Some(number) = blocks_ahead.min() else { break };
        // Of each VPL which points have it; and which points have tested theirs.
        let (mut asked, mut certain) = ([0_u32; LANES], 0);
        for k in 0..points.count {
            let Some(ahead) = candidates[k].get(next[k]).filter(|ahead| ahead.block == number) else { continue };
            next[k] += 1;
            certain |= u32::from(ahead.certain || threshold.is_none()) << k;
            for (lane, asked) in asked.iter_mut().enumerate() {
                *asked |= u32::from(ahead.lanes >> lane & 1) << k;
            }
        }
        let block = &blocks[number as usize];
        for lane in (0..LANES).filter(|&lane| asked[lane] != 0) {
            let tested = threshold.filter(|_| asked[lane] & !certain != 0).map(|threshold| (threshold, certain));
            let lit = light(tracer, &source, &points, (block, lane), asked[lane], tested, &mut sums[lane]);
            for k in 0..LANES {
                chosen[k] += lit[0] >> k & 1;
                shadow_rays[k] += lit[1] >> k & 1;
            }
        }
    }
    let mut total = [zero; 3];
    for sum in sums {
        for channel in 0..3 {
            total[channel] = _mm256_add_ps(total[channel], sum[channel]);
        }
    }
    let [r, g, b] = [store(total[0]), store(total[1]), store(total[2])];
    std::array::from_fn(|k| Gathered {
        color: Vec3::new(r[k], g[k], b[k]),
        chosen: chosen[k],
        shadow_rays: u64::from(shadow_rays[k]),
    })
}

/// Adds what one VPL sends to the points in `asked`, those of `tested` only where its relevance reaches the threshold or they are
/// certain; returns which of them have it, and which of these asked for shadow rays.
#[target_feature(enable = "avx2,fma,bmi1")]
#[inline]
fn light(
    tracer: &Tracer<'_>,
    source: &Source,
    points: &Points,
    (block, lane): (&VplBlock, usize),
    asked: u32,
    tested: Option<(f32, u32)>,
    sum: &mut Wide3,
) -> [u32; 2] {
    let zero = _mm256_setzero_ps();
    let one = _mm256_set1_ps(1.0);
    let splat = |of: &[[f32; LANES]; 3]| splat3(Vec3::new(of[0][lane], of[1][lane], of[2][lane]));
    let to_light = sub(splat(&block.position), points.point);
    let dist_sq = dot(to_light, to_light);
    let reciprocal = _mm256_div_ps(one, _mm256_sqrt_ps(dist_sq));
    let [x, y, z] = to_light;
    let unit = [_mm256_mul_ps(x, reciprocal), _mm256_mul_ps(y, reciprocal), _mm256_mul_ps(z, reciprocal)];
    let cos_theta = dot(points.normal, unit);
    let cos_phi = _mm256_sub_ps(zero, dot(splat(&block.direction), unit));
    let chosen = match tested {
        Some((threshold, certain)) => {
            let intensity = _mm256_set1_ps(block.intensity[lane]);
            asked & (certain | relevant(intensity, cos_phi, dist_sq, threshold))
        }
        None => asked,
    };
    let facing =
        _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(cos_theta, zero), _mm256_cmp_ps::<_CMP_GT_OQ>(cos_phi, zero));
    let facing = _mm256_movemask_ps(facing) as u32 & chosen;
    if facing == 0 {
        return [chosen, 0];
    }
    let (t_min, t_max) = shadow_ends(tracer.rules, to_light, points.epsilon);
    let packet = Packet { origin: points.point, direction: to_light, t_min, t_max };
    let hidden = any_hits(tracer, &packet, Some(source), facing);
    let visible = spread(facing & !hidden);
    let emission = _mm256_mul_ps(_mm256_set1_ps(block.attenuation[lane]), cos_phi);
    for (channel, sum) in sum.iter_mut().enumerate() {
        let color = _mm256_set1_ps(block.diffuse[channel][lane]);
        let reflected = _mm256_mul_ps(_mm256_mul_ps(color, points.diffuse[channel]), cos_theta);
        let color = _mm256_min_ps(_mm256_mul_ps(reflected, emission), one);
        *sum = _mm256_add_ps(*sum, _mm256_and_ps(color, visible));
    }
    [chosen, facing]
}
