//! Gathering with AVX2: eight VPLs at a time, or one for eight points. Twin of the plain functions in `gather`, same bits.

#![allow(unsafe_code)]

use super::avx2_shadows::{MOST, Shadow, Source, trace};
use super::avx2_trace::{Wide3, dot, load, load3, splat_lane, splat3, spread, store, sub};
use super::gather::{Blocks, Candidates, Decisions, Gathered, Receiver};
use super::stack::Stack;
use super::tracer::Tracer;
use super::walls::{Outlook, Shared, Walls};
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

/// Shadow rays of the lanes in `chosen` where point and VPL face each other; twin of `vpl_incidence`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn shadow(direction: Wide3, cosines: &Cosines, (block, lane): (u32, usize), chosen: u32, shared: Shared) -> Shadow {
    let product = _mm256_mul_ps(cosines.theta, cosines.phi);
    let facing = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(product, _mm256_setzero_ps())) as u32;
    let open = facing & chosen;
    Shadow {
        direction,
        length_sq: cosines.dist_sq,
        shared,
        open,
        cosines: product,
        block,
        lane: lane as u32,
        source: 0,
    }
}

impl Shadow {
    /// Adds the light of VPLs that are visible; twin of `phong_vpl`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn add(&self, sums: &mut Wide3, colors: Wide3, attenuation: __m256, diffuse: Wide3) {
        let factor = _mm256_mul_ps(attenuation, _mm256_div_ps(self.cosines, self.length_sq));
        let factor = _mm256_and_ps(factor, spread(self.open));
        for channel in 0..3 {
            let color = _mm256_mul_ps(_mm256_mul_ps(colors[channel], diffuse[channel]), factor);
            sums[channel] = _mm256_add_ps(sums[channel], _mm256_min_ps(color, _mm256_set1_ps(1.0)));
        }
    }
}

/// Shadow rays that are still to be traced. First those of many VPLs, then their ways, then their light: a processor can begin with
/// the next few while it waits for what the first ones need, as long as little else lies between them.
type Batch = Stack<Shadow, MOST>;

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
    let mut finish = |batch: &mut Batch, size: usize| {
        batch.size = size;
        trace(tracer, std::slice::from_ref(&source), batch.as_mut_slice(), false);
        let mut total = sums;
        for shadow in batch.as_slice() {
            let block = &vpls[shadow.block as usize];
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
            finish(&mut batch, size);
            size = 0;
        }
    }
    finish(&mut batch, size);
    let [r, g, b] = [store(sums[0]), store(sums[1]), store(sums[2])];
    let color = (0..LANES).fold(Vec3::ZERO, |total, lane| total + Vec3::new(r[lane], g[lane], b[lane]));
    Gathered { color, chosen: all_chosen, shadow_rays }
}

/// Up to eight points that gather together, component by component; the last one fills what is left of the eight.
struct Points<'a> {
    point: Wide3,
    normal: Wide3,
    diffuse: Wide3,
    outlook: Outlook,
    /// Of each point, what is still to come.
    candidates: &'a [&'a [Candidates]],
    next: [usize; LANES],
    /// Of the current block the points that have each VPL, and those whose VPLs are certain, a bit each.
    asked: [u32; LANES],
    certain: u32,
    /// Whether the points and the current block look the same way, and the planes that have both on one side.
    is_turned_away: bool,
    shared: Shared,
    /// By lane of the VPLs, as one point sums them.
    sums: [Wide3; LANES],
    chosen: __m256i,
    shadow_rays: __m256i,
}

impl<'a> Points<'a> {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn new(at: &[Receiver], candidates: &'a [&'a [Candidates]], walls: &Walls) -> Self {
        let lane = |lane: usize| &at[lane.min(at.len() - 1)];
        let wide3 = |of: &dyn Fn(&Receiver) -> Vec3| -> [[f32; LANES]; 3] {
            std::array::from_fn(|axis| std::array::from_fn(|k| of(lane(k))[axis]))
        };
        let normal = at[0].normal;
        let common = if at.iter().all(|at| at.normal == normal) { normal } else { Vec3::NAN };
        Self {
            point: load3(&wide3(&|at| at.point)),
            normal: load3(&wide3(&|at| at.normal)),
            diffuse: load3(&wide3(&|at| at.diffuse)),
            outlook: walls.outlook(common),
            candidates,
            next: [0; LANES],
            asked: [0; LANES],
            certain: 0,
            is_turned_away: false,
            shared: Shared::default(),
            sums: [[_mm256_setzero_ps(); 3]; LANES],
            chosen: _mm256_setzero_si256(),
            shadow_rays: _mm256_setzero_si256(),
        }
    }

    /// The first block that is still to come.
    fn next_block(&self) -> Option<u32> {
        let ahead = self.candidates.iter().zip(self.next).filter_map(|(candidates, next)| candidates.get(next));
        ahead.map(|ahead| ahead.block).min()
    }

    /// Goes on to a block.
    fn ask(&mut self, block: u32, source: &Source, walls: &Walls) {
        self.is_turned_away = walls.is_turned_away(block, self.outlook);
        self.shared = source.shared(walls.sides(block));
        let mut lanes = [0_u8; LANES];
        self.certain = 0;
        for (k, candidates) in self.candidates.iter().enumerate() {
            let Some(ahead) = candidates.get(self.next[k]).filter(|ahead| ahead.block == block) else { continue };
            self.next[k] += 1;
            self.certain |= u32::from(ahead.certain) << k;
            lanes[k] = ahead.lanes;
        }
        self.asked = transposed(lanes).map(u32::from);
    }

    /// The shadow rays to a VPL of the current block, counted: of the points that have it, where they do not know it for certain
    /// only those where its relevance reaches the threshold. None, where neither lights the other.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn shadow(&mut self, block: &VplBlock, (number, lane): (u32, usize), threshold: Option<f32>) -> Option<Shadow> {
        let asked = self.asked[lane];
        let tested = threshold.filter(|_| asked & !self.certain != 0);
        if asked == 0 || self.is_turned_away && tested.is_none() {
            count(&mut self.chosen, asked);
            return None;
        }
        let to_light = sub(splat_lane(&block.position, lane), self.point);
        let cosines = Cosines::new(to_light, self.normal, splat_lane(&block.direction, lane));
        let chosen = tested.map_or(asked, |threshold| {
            let intensity = _mm256_set1_ps(block.intensity[lane % LANES]);
            asked & (self.certain | relevant(intensity, cosines.phi, cosines.dist_sq, threshold))
        });
        let shadow = shadow(to_light, &cosines, (number, lane), chosen, self.shared);
        count(&mut self.chosen, chosen);
        count(&mut self.shadow_rays, shadow.open);
        Some(shadow)
    }

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn gathered(&self) -> [Gathered; LANES] {
        let mut total = [_mm256_setzero_ps(); 3];
        for sum in self.sums {
            for channel in 0..3 {
                total[channel] = _mm256_add_ps(total[channel], sum[channel]);
            }
        }
        let [r, g, b] = [store(total[0]), store(total[1]), store(total[2])];
        let whole = |counts: __m256i| store(_mm256_castsi256_ps(counts)).map(f32::to_bits);
        let (chosen, shadow_rays) = (whole(self.chosen), whole(self.shadow_rays));
        std::array::from_fn(|k| Gathered {
            color: Vec3::new(r[k], g[k], b[k]),
            chosen: chosen[k],
            shadow_rays: u64::from(shadow_rays[k]),
        })
    }
}

/// Counts a mask's lanes, each in its own.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn count(counts: &mut __m256i, mask: u32) {
    *counts = _mm256_sub_epi32(*counts, _mm256_castps_si256(spread(mask)));
}

/// Twin of [`evaluate`] for some points, each with its candidates in the order of their blocks: one VPL at a time for all points
/// that have it, whose shadow rays go much the same way.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn evaluate_together(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[&[Candidates]],
    threshold: Option<f32>,
    at: &[Receiver],
) -> Vec<Gathered> {
    let Blocks { vpls, walls } = blocks;
    let (mut points, mut sources) = (Vec::new(), Vec::new());
    for (at, candidates) in at.chunks(LANES).zip(candidates.chunks(LANES)) {
        points.push(Points::new(at, candidates, walls));
        let epsilon = std::array::from_fn(|lane| at[lane.min(at.len() - 1)].epsilon);
        let mut source = Source::new(points[sources.len()].point, load(&epsilon));
        source.look(&tracer.geometry, walls);
        sources.push(source);
    }
    let finish = |points: &mut [Points<'_>], batch: &mut Batch, size: usize| {
        batch.size = size;
        trace(tracer, &sources, batch.as_mut_slice(), true);
        for shadow in batch.as_slice() {
            let (block, lane) = (&vpls[shadow.block as usize], shadow.lane as usize % LANES);
            let (colors, attenuation) = (splat_lane(&block.diffuse, lane), _mm256_set1_ps(block.attenuation[lane]));
            let points = &mut points[shadow.source as usize];
            shadow.add(&mut points.sums[lane], colors, attenuation, points.diffuse);
        }
    };
    let (mut batch, mut size) = (Batch::new(), 0);
    while let Some(number) = points.iter().filter_map(Points::next_block).min() {
        for (points, source) in points.iter_mut().zip(&sources) {
            points.ask(number, source, walls);
        }
        let block = &vpls[number as usize];
        for lane in 0..LANES {
            for index in 0..points.len() {
                let Some(shadow) = points[index].shadow(block, (number, lane), threshold) else { continue };
                size = batch.put_if(size, Shadow { source: index as u32, ..shadow }, shadow.open != 0);
                if size == MOST {
                    finish(&mut points, &mut batch, size);
                    size = 0;
                }
            }
        }
    }
    finish(&mut points, &mut batch, size);
    points.iter().flat_map(|points| points.gathered()).take(at.len()).collect()
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
