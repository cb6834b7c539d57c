//! Gathering with AVX2: eight VPLs at a time, or one for eight points. Twin of the plain functions in `gather`, same bits.

#![allow(unsafe_code)]

use super::avx2_shadows::{MOST, Shadow, Source};
use super::avx2_trace::{Wide3, dot, load, load3, splat_lane, splat3, spread, store, sub};
use super::gather::{Blocks, Candidates, Decisions, Gathered, Receiver};
use super::stack::Stack;
use super::tracer::Tracer;
use crate::light_node::{LANES, LightNode, VplBlock};
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::light_tree::BOUND_MARGIN;
use lightcuts_kernel::ray::ORIGINAL_EPSILON;
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_blendv_ps,
    _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps,
    _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps, _mm256_xor_ps,
};

/// The ends of shadow rays; twin of `kernel::ray::shadow_ray`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
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

/// Decides for every cluster of a node; twin of `kernel::light_tree::decide`, same bits.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
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
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
fn relevant(intensity: __m256, cos_phi: __m256, dist_sq: __m256, threshold: f32) -> u32 {
    // With NaN in the first place the maximum is its second operand, as in the plain version.
    let flux = _mm256_mul_ps(_mm256_max_ps(cos_phi, _mm256_setzero_ps()), intensity);
    let needed = _mm256_mul_ps(_mm256_set1_ps(threshold), dist_sq);
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(flux, needed)) as u32
}

/// How VPLs would light points: eight of a block one point, or one of them eight points.
#[derive(Clone, Copy)]
struct Incidence {
    cos_theta: __m256,
    cos_phi: __m256,
    block: u32,
    /// Of the block, where it is one VPL.
    lane: usize,
    /// Lanes with shadow rays, a bit each.
    facing: u32,
}

impl Incidence {
    /// Adds the light of VPLs that are visible, as a mask; twin of `phong_vpl`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn add(&self, sums: &mut Wide3, colors: Wide3, attenuation: __m256, diffuse: Wide3, visible: __m256) {
        let emission = _mm256_mul_ps(attenuation, self.cos_phi);
        for channel in 0..3 {
            let reflected = _mm256_mul_ps(_mm256_mul_ps(colors[channel], diffuse[channel]), self.cos_theta);
            let color = _mm256_min_ps(_mm256_mul_ps(reflected, emission), _mm256_set1_ps(1.0));
            sums[channel] = _mm256_add_ps(sums[channel], _mm256_and_ps(color, visible));
        }
    }
}

/// Squared distances, and the cosines at the points and at the VPLs; twin of `vpl_incidence`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn cosines(to_light: Wide3, normal: Wide3, direction: Wide3) -> (__m256, [__m256; 2]) {
    let dist_sq = dot(to_light, to_light);
    let reciprocal = _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_sqrt_ps(dist_sq));
    let [x, y, z] = to_light;
    let unit = [_mm256_mul_ps(x, reciprocal), _mm256_mul_ps(y, reciprocal), _mm256_mul_ps(z, reciprocal)];
    (dist_sq, [dot(normal, unit), _mm256_sub_ps(_mm256_setzero_ps(), dot(direction, unit))])
}

/// What is still to be traced. First the cosines of many, then their shadow rays, then their light: while a processor waits for one
/// root and quotient it can begin with the next few, as long as little else lies between them.
struct Batch(Stack<Incidence, MOST>);

impl Batch {
    /// Takes an incidence if there are rays to trace; says whether there is no more room.
    #[inline]
    fn push(&mut self, incidence: Incidence) -> bool {
        self.0.push_if(incidence, incidence.facing != 0);
        self.0.size == MOST
    }

    /// Traces what was taken: `aim` makes the rays, without their sides and which are asked for; `light` is told which lanes see
    /// their VPL, as a mask.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn trace(
        &mut self,
        (tracer, source, blocks): (&Tracer<'_>, &Source, &Blocks<'_>),
        epsilon: __m256,
        aim: impl Fn(&Incidence) -> Wide3,
        mut light: impl FnMut(&Incidence, __m256),
    ) {
        let mut shadows = Stack::<Shadow, MOST>::new();
        for incidence in self.0.as_slice() {
            let direction = aim(incidence);
            let (t_min, t_max) = shadow_ends(tracer.rules, direction, epsilon);
            let ends = blocks.walls.of_block(incidence.block);
            shadows.push(Shadow { direction, t_min, t_max, ends, open: incidence.facing });
        }
        source.trace(tracer, shadows.as_mut_slice());
        for (incidence, shadow) in self.0.as_slice().iter().zip(shadows.as_slice()) {
            light(incidence, spread(shadow.open));
        }
        self.0.size = 0;
    }
}

/// What the chosen VPLs add; twin of the plain `evaluate`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn evaluate(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[Candidates],
    threshold: Option<f32>,
    at: &Receiver,
) -> Gathered {
    let zero = _mm256_setzero_ps();
    let (point, normal, diffuse) = (splat3(at.point), splat3(at.normal), splat3(at.diffuse));
    let source = Source::new(tracer, blocks.walls, point);
    let mut batch = Batch(Stack::new());
    let mut sums = [zero; 3];
    let mut gathered = Gathered { color: Vec3::ZERO, chosen: 0, shadow_rays: 0 };
    let mut trace = |batch: &mut Batch| {
        let aim = |incidence: &Incidence| sub(load3(&blocks.vpls[incidence.block as usize].position), point);
        batch.trace((tracer, &source, blocks), _mm256_set1_ps(at.epsilon), aim, |incidence, visible| {
            let block = &blocks.vpls[incidence.block as usize];
            let (colors, attenuation) = (load3(&block.diffuse), load(&block.attenuation));
            incidence.add(&mut sums, colors, attenuation, diffuse, visible);
        });
    };
    for candidates in candidates {
        let block = &blocks.vpls[candidates.block as usize];
        let to_light = sub(load3(&block.position), point);
        let (dist_sq, [cos_theta, cos_phi]) = cosines(to_light, normal, load3(&block.direction));
        let relevant = match threshold {
            Some(threshold) if !candidates.certain => relevant(load(&block.intensity), cos_phi, dist_sq, threshold),
            _ => u32::MAX,
        };
        let chosen = u32::from(candidates.lanes) & relevant;
        let facing = chosen & facing(cos_theta, cos_phi);
        gathered.chosen += chosen.count_ones();
        gathered.shadow_rays += u64::from(facing.count_ones());
        if batch.push(Incidence { cos_theta, cos_phi, block: candidates.block, lane: 0, facing }) {
            trace(&mut batch);
        }
    }
    trace(&mut batch);
    let [r, g, b] = [store(sums[0]), store(sums[1]), store(sums[2])];
    gathered.color = (0..LANES).fold(Vec3::ZERO, |total, lane| total + Vec3::new(r[lane], g[lane], b[lane]));
    gathered
}

/// Lanes where point and VPL face each other.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn facing(cos_theta: __m256, cos_phi: __m256) -> u32 {
    let zero = _mm256_setzero_ps();
    let is_positive = |cosine: __m256| _mm256_cmp_ps::<_CMP_GT_OQ>(cosine, zero);
    _mm256_movemask_ps(_mm256_and_ps(is_positive(cos_theta), is_positive(cos_phi))) as u32
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
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
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

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn to_light(&self, block: &VplBlock, lane: usize) -> Wide3 {
        sub(splat_lane(&block.position, lane), self.point)
    }

    /// Which of the points in `asked` have a VPL, those of `tested` only where its relevance reaches the threshold or they are
    /// certain; and how it would light them.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn incidence(
        &self,
        blocks: &Blocks<'_>,
        (number, lane): (u32, usize),
        asked: u32,
        tested: Option<(f32, u32)>,
    ) -> (u32, Incidence) {
        let block = &blocks.vpls[number as usize];
        let to_light = self.to_light(block, lane);
        let (dist_sq, [cos_theta, cos_phi]) = cosines(to_light, self.normal, splat_lane(&block.direction, lane));
        let chosen = match tested {
            Some((threshold, certain)) => {
                let intensity = _mm256_set1_ps(block.intensity[lane % LANES]);
                asked & (certain | relevant(intensity, cos_phi, dist_sq, threshold))
            }
            None => asked,
        };
        let facing = chosen & facing(cos_theta, cos_phi);
        (chosen, Incidence { cos_theta, cos_phi, block: number, lane, facing })
    }
}

/// Twin of [`evaluate`] for up to eight points, each with its candidates in the order of their blocks: one VPL at a time for all
/// points that have it, whose shadow rays go much the same way.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn evaluate_together(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[&[Candidates]],
    threshold: Option<f32>,
    at: &[Receiver],
) -> [Gathered; LANES] {
    let zero = _mm256_setzero_ps();
    let points = Points::new(at);
    let source = Source::new(tracer, blocks.walls, points.point);
    let mut batch = Batch(Stack::new());
    // By lane of the VPLs, as one point sums them.
    let mut sums = [[zero; 3]; LANES];
    let mut trace = |batch: &mut Batch| {
        let aim = |incidence: &Incidence| points.to_light(&blocks.vpls[incidence.block as usize], incidence.lane);
        batch.trace((tracer, &source, blocks), points.epsilon, aim, |incidence, visible| {
            let (block, lane) = (&blocks.vpls[incidence.block as usize], incidence.lane % LANES);
            let (colors, attenuation) = (splat_lane(&block.diffuse, lane), _mm256_set1_ps(block.attenuation[lane]));
            incidence.add(&mut sums[lane], colors, attenuation, points.diffuse, visible);
        });
    };
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
        for lane in (0..LANES).filter(|&lane| asked[lane] != 0) {
            let tested = threshold.filter(|_| asked[lane] & !certain != 0).map(|threshold| (threshold, certain));
            let (has, incidence) = points.incidence(blocks, (number, lane), asked[lane], tested);
            for k in 0..LANES {
                chosen[k] += has >> k & 1;
                shadow_rays[k] += incidence.facing >> k & 1;
            }
            if batch.push(incidence) {
                trace(&mut batch);
            }
        }
    }
    trace(&mut batch);
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
