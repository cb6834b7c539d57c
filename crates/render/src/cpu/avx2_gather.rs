//! Gathering with AVX2: eight VPLs at a time, or one for eight points. Twin of the plain functions in `gather`, same bits.

#![allow(unsafe_code)]

use super::avx2_shadows::{MOST, Shadow, Source};
use super::avx2_trace::{Wide3, dot, load, load3, splat_lane, splat3, spread, store, sub};
use super::gather::{Blocks, Candidates, Decisions, Gathered, Receiver};
use super::stack::Stack;
use super::tracer::Tracer;
use super::walls::Shared;
use crate::light_node::{LANES, LightNode, VplBlock};
use glam::Vec3;
use lightcuts_kernel::light_tree::BOUND_MARGIN;
use std::arch::x86_64::{
    __m256, __m256i, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps,
    _mm256_blendv_ps, _mm256_castps_si256, _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps,
    _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_setzero_si256,
    _mm256_sqrt_ps, _mm256_sub_epi32, _mm256_sub_ps, _mm256_xor_ps,
};

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
#[inline]
fn relevant(intensity: __m256, cos_phi: __m256, dist_sq: __m256, threshold: f32) -> u32 {
    let flux = _mm256_mul_ps(cos_phi, intensity);
    let volume = _mm256_mul_ps(dist_sq, _mm256_sqrt_ps(dist_sq));
    let needed = _mm256_mul_ps(_mm256_set1_ps(threshold), volume);
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(flux, needed)) as u32
}

/// Cosines times distances, 0 where they are negative, at points and at VPLs; and squared distances.
struct Cosines {
    theta: __m256,
    phi: __m256,
    dist_sq: __m256,
}

impl Cosines {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn new(to_light: Wide3, normal: Wide3, direction: Wide3) -> Self {
        let zero = _mm256_setzero_ps();
        // With NaN in the first place the maximum is its second operand, as in the plain versions.
        let theta = _mm256_max_ps(dot(normal, to_light), zero);
        let phi = _mm256_max_ps(_mm256_sub_ps(zero, dot(direction, to_light)), zero);
        Self { theta, phi, dist_sq: dot(to_light, to_light) }
    }
}

/// How VPLs would light points: eight of a block one point, or one of them eight points. With the ray, twin of `VplIncidence`.
#[derive(Clone, Copy)]
struct Light {
    cosines: __m256,
    block: u32,
    /// Of the block, where it is one VPL.
    lane: u32,
}

/// Shadow rays of the lanes in `chosen` that face their VPL, or that their VPL faces; twin of `vpl_incidence`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn shadow(
    direction: Wide3,
    cosines: &Cosines,
    (block, lane): (u32, usize),
    chosen: u32,
    shared: Shared,
) -> Shadow<Light> {
    let product = _mm256_mul_ps(cosines.theta, cosines.phi);
    let facing = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(product, _mm256_setzero_ps())) as u32;
    let light = Light { cosines: product, block, lane: lane as u32 };
    Shadow { direction, length_sq: cosines.dist_sq, shared, open: facing & chosen, light }
}

impl Shadow<Light> {
    /// Adds the light of VPLs that are visible; twin of `phong_vpl`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn add(&self, sums: &mut Wide3, colors: Wide3, attenuation: __m256, diffuse: Wide3) {
        let factor = _mm256_mul_ps(attenuation, _mm256_div_ps(self.light.cosines, self.length_sq));
        let factor = _mm256_and_ps(factor, spread(self.open));
        for channel in 0..3 {
            let color = _mm256_mul_ps(_mm256_mul_ps(colors[channel], diffuse[channel]), factor);
            sums[channel] = _mm256_add_ps(sums[channel], _mm256_min_ps(color, _mm256_set1_ps(1.0)));
        }
    }
}

/// Shadow rays that are still to be traced. First those of many VPLs, then their ways, then their light: a processor can begin with
/// the next few while it waits for what the first ones need, as long as little else lies between them.
type Batch = Stack<Shadow<Light>, MOST>;

/// What the chosen VPLs add; twin of the plain `evaluate`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn evaluate(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[Candidates],
    threshold: Option<f32>,
    at: &Receiver,
) -> Gathered {
    let Blocks { vpls, walls } = blocks;
    let (point, normal, diffuse) = (splat3(at.point), splat3(at.normal), splat3(at.diffuse));
    let outlook = walls.outlook(at.normal);
    let mut source = Source::new(point, _mm256_set1_ps(at.epsilon));
    source.look(&tracer.geometry, walls);
    let mut batch = Batch::new();
    let mut sums = [_mm256_setzero_ps(); 3];
    let mut trace = |batch: &mut Batch, size: usize| {
        batch.size = size;
        source.trace(tracer, batch.as_mut_slice());
        let mut total = sums;
        for shadow in batch.as_slice() {
            let block = &vpls[shadow.light.block as usize];
            shadow.add(&mut total, load3(&block.diffuse), load(&block.attenuation), diffuse);
        }
        sums = total;
    };
    let (mut all_chosen, mut shadow_rays, mut size) = (0, 0, 0);
    for &Candidates { block: number, lanes, certain } in candidates {
        let (lanes, tested) = (u32::from(lanes), threshold.filter(|_| !certain));
        if tested.is_none() && walls.is_turned_away(number, outlook) {
            all_chosen += lanes.count_ones();
            continue;
        }
        let block = &vpls[number as usize];
        let to_light = sub(load3(&block.position), point);
        let cosines = Cosines::new(to_light, normal, load3(&block.direction));
        let relevant = tested
            .map_or(u32::MAX, |threshold| relevant(load(&block.intensity), cosines.phi, cosines.dist_sq, threshold));
        let chosen = lanes & relevant;
        let shadow = shadow(to_light, &cosines, (number, 0), chosen, source.shared(walls.sides(number)));
        all_chosen += chosen.count_ones();
        shadow_rays += u64::from(shadow.open.count_ones());
        size = batch.put_if(size, shadow, shadow.open != 0);
        if size == MOST {
            trace(&mut batch, size);
            size = 0;
        }
    }
    trace(&mut batch, size);
    let [r, g, b] = [store(sums[0]), store(sums[1]), store(sums[2])];
    let color = (0..LANES).fold(Vec3::ZERO, |total, lane| total + Vec3::new(r[lane], g[lane], b[lane]));
    Gathered { color, chosen: all_chosen, shadow_rays }
}

/// Points that gather together, component by component; the last one fills what is left of the eight.
struct Points {
    count: usize,
    point: Wide3,
    normal: Wide3,
    /// The normal if it is the same for all, else no number.
    common_normal: Vec3,
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
        let normal = at[0].normal;
        Self {
            count: at.len(),
            common_normal: if at.iter().all(|at| at.normal == normal) { normal } else { Vec3::NAN },
            point: load3(&wide3(&|at| at.point)),
            normal: load3(&wide3(&|at| at.normal)),
            diffuse: load3(&wide3(&|at| at.diffuse)),
            epsilon: load(&epsilon),
        }
    }

    /// Which of the points in `asked` have a VPL, those of `tested` only where its relevance reaches the threshold or they are
    /// certain; and their shadow rays.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn shadow(
        &self,
        block: &VplBlock,
        (number, lane): (u32, usize),
        (asked, tested): (u32, Option<(f32, u32)>),
        shared: Shared,
    ) -> (u32, Shadow<Light>) {
        let to_light = sub(splat_lane(&block.position, lane), self.point);
        let cosines = Cosines::new(to_light, self.normal, splat_lane(&block.direction, lane));
        let chosen = match tested {
            Some((threshold, certain)) => {
                let intensity = _mm256_set1_ps(block.intensity[lane % LANES]);
                asked & (certain | relevant(intensity, cosines.phi, cosines.dist_sq, threshold))
            }
            None => asked,
        };
        (chosen, shadow(to_light, &cosines, (number, lane), chosen, shared))
    }
}

/// Counts a mask's lanes, each in its own.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn count(counts: &mut __m256i, mask: u32) {
    *counts = _mm256_sub_epi32(*counts, _mm256_castps_si256(spread(mask)));
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
    let Blocks { vpls, walls } = blocks;
    let zero = _mm256_setzero_ps();
    let points = Points::new(at);
    let outlook = walls.outlook(points.common_normal);
    let mut source = Source::new(points.point, points.epsilon);
    source.look(&tracer.geometry, walls);
    let mut batch = Batch::new();
    // By lane of the VPLs, as one point sums them.
    let mut sums = [[zero; 3]; LANES];
    let mut trace = |batch: &mut Batch, size: usize| {
        batch.size = size;
        source.trace(tracer, batch.as_mut_slice());
        for shadow in batch.as_slice() {
            let (block, lane) = (&vpls[shadow.light.block as usize], shadow.light.lane as usize % LANES);
            let (colors, attenuation) = (splat_lane(&block.diffuse, lane), _mm256_set1_ps(block.attenuation[lane]));
            shadow.add(&mut sums[lane], colors, attenuation, points.diffuse);
        }
    };
    let (mut all_chosen, mut shadow_rays) = (_mm256_setzero_si256(), _mm256_setzero_si256());
    let mut next = [0_usize; LANES];
    let mut size = 0;
    loop {
        let blocks_ahead = (0..points.count).filter_map(|k| candidates[k].get(next[k])).map(|ahead| ahead.block);
        let Some(number) = blocks_ahead.min() else { break };
        // Of each point the VPLs that it has; and which points have tested theirs.
        let (mut lanes, mut certain) = ([0_u8; LANES], 0);
        for k in 0..points.count {
            let Some(ahead) = candidates[k].get(next[k]).filter(|ahead| ahead.block == number) else { continue };
            next[k] += 1;
            certain |= u32::from(ahead.certain || threshold.is_none()) << k;
            lanes[k] = ahead.lanes;
        }
        let asked = transposed(lanes).map(u32::from);
        let (block, shared) = (&vpls[number as usize], source.shared(walls.sides(number)));
        let is_turned_away = walls.is_turned_away(number, outlook);
        for lane in (0..LANES).filter(|&lane| asked[lane] != 0) {
            let tested = threshold.filter(|_| asked[lane] & !certain != 0).map(|threshold| (threshold, certain));
            if is_turned_away && tested.is_none() {
                count(&mut all_chosen, asked[lane]);
                continue;
            }
            let (chosen, shadow) = points.shadow(block, (number, lane), (asked[lane], tested), shared);
            count(&mut all_chosen, chosen);
            count(&mut shadow_rays, shadow.open);
            size = batch.put_if(size, shadow, shadow.open != 0);
            if size == MOST {
                trace(&mut batch, size);
                size = 0;
            }
        }
    }
    trace(&mut batch, size);
    let mut total = [zero; 3];
    for sum in sums {
        for channel in 0..3 {
            total[channel] = _mm256_add_ps(total[channel], sum[channel]);
        }
    }
    let [r, g, b] = [store(total[0]), store(total[1]), store(total[2])];
    let whole = |counts: __m256i| store(_mm256_castsi256_ps(counts)).map(f32::to_bits);
    let (all_chosen, shadow_rays) = (whole(all_chosen), whole(shadow_rays));
    std::array::from_fn(|k| Gathered {
        color: Vec3::new(r[k], g[k], b[k]),
        chosen: all_chosen[k],
        shadow_rays: u64::from(shadow_rays[k]),
    })
}

/// Rows and columns of eight times eight bits exchanged (Warren 2012, "Hacker's Delight", 7-3).
fn transposed(rows: [u8; LANES]) -> [u8; LANES] {
    let exchange = |bits: u64, shift: u32, mask: u64| {
        let differs = (bits ^ bits >> shift) & mask;
        bits ^ differs ^ differs << shift
    };
    let bits = exchange(u64::from_le_bytes(rows), 7, 0x00aa_00aa_00aa_00aa);
    let bits = exchange(bits, 14, 0x0000_cccc_0000_cccc);
    exchange(bits, 28, 0x0000_0000_f0f0_f0f0).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_transposed() {
        for row in 0..LANES {
            for column in 0..LANES {
                let (mut rows, mut columns) = ([0; LANES], [0; LANES]);
                rows[row] = 1 << column;
                columns[column] = 1 << row;
                assert_eq!(transposed(rows), columns);
            }
        }
    }
}
