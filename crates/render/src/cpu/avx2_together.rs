//! Neighbouring points that gather together, with AVX2: one VPL at a time for eight of them.
//!
//! What nothing can hide from eight neighbours is found out for all of them at once, and its light is added there and
//! then. The other shadow rays to a VPL go together.

#![allow(unsafe_code)]

use super::avx2_fan::PACKETS;
use super::avx2_gather::{Batch, Ways, add, relevant};
use super::avx2_packet::wide3;
use super::avx2_shadows::{Shadow, Source, trace};
use super::avx2_trace::{Wide3, lanes, load, splat_lane, spread, store, sub};
use super::gather::{Blocks, Candidates, Gathered, Receiver};
use super::half_spaces::{FacingId, HalfSpaces, Shared};
use super::stack::Stack;
use super::tracer::Tracer;
use crate::light_node::{LANES, VplBlock};
use glam::Vec3;
use std::arch::x86_64::{
    __m256, __m256i, _mm256_add_ps, _mm256_castps_si256, _mm256_castsi256_ps, _mm256_movemask_ps, _mm256_set1_ps,
    _mm256_setzero_ps, _mm256_setzero_si256, _mm256_sub_epi32,
};

/// Points that have the same candidates.
#[derive(Clone, Copy)]
struct Askers<'a> {
    /// What is still to come.
    candidates: &'a [Candidates],
    /// A bit for each point, and a byte of 1.
    points: u32,
    bytes: u64,
    /// Number of VPLs that are chosen without a test.
    chosen: u32,
}

impl<'a> Askers<'a> {
    /// Up to eight points, by their candidates.
    fn among(candidates: &[&'a [Candidates]]) -> Stack<Self, LANES> {
        let mut all = Stack::new();
        let (points, bytes) = ((1_u32 << candidates.len()) - 1, 0x0101_0101_0101_0101 >> (64 - 8 * candidates.len()));
        if candidates.iter().all(|&other| std::ptr::eq(other, candidates[0])) {
            all.push(Self { candidates: candidates[0], points, bytes, chosen: 0 });
        } else {
            for (k, &candidates) in candidates.iter().enumerate() {
                all.push(Self { candidates, points: 1 << k, bytes: 1 << (8 * k), chosen: 0 });
            }
        }
        all
    }
}

/// Up to eight points that gather together, component by component; the last one fills what is left of the eight.
struct Points<'a> {
    point: Wide3,
    normal: Wide3,
    diffuse: Wide3,
    facing: FacingId,
    askers: Stack<Askers<'a>, LANES>,
    /// Of the current block the points that have each VPL, and those whose VPLs are chosen without a test, a bit each.
    asked: [u32; LANES],
    certain: u32,
    /// Whether the points and the current block look the same way, and the planes that have both on one side.
    is_turned_away: bool,
    shared: Shared,
    /// VPLs of the current block that nothing can hide from the points, a bit each.
    seen: u32,
    /// By lane of the VPLs, as one point sums them.
    sums: [Wide3; LANES],
    /// Number of VPLs that are chosen by a test.
    chosen: __m256i,
    shadow_rays: __m256i,
}

impl<'a> Points<'a> {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn new(at: &[Receiver], candidates: &[&'a [Candidates]], half_spaces: &HalfSpaces) -> Self {
        let eight: [&Receiver; LANES] = std::array::from_fn(|lane| &at[lane.min(at.len() - 1)]);
        let normal = at[0].normal;
        let common = if at.iter().all(|at| at.normal == normal) { normal } else { Vec3::NAN };
        Self {
            point: wide3(eight.map(|at| at.point)),
            normal: wide3(eight.map(|at| at.normal)),
            diffuse: wide3(eight.map(|at| at.diffuse)),
            facing: half_spaces.facing(common),
            askers: Askers::among(candidates),
            asked: [0; LANES],
            certain: 0,
            is_turned_away: false,
            shared: Shared::default(),
            seen: 0,
            sums: [[_mm256_setzero_ps(); 3]; LANES],
            chosen: _mm256_setzero_si256(),
            shadow_rays: _mm256_setzero_si256(),
        }
    }

    /// The first block that is still to come.
    fn next_block(&self) -> Option<u32> {
        self.askers.as_slice().iter().filter_map(|askers| Some(askers.candidates.first()?.block)).min()
    }

    /// Goes on to a block.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn ask(&mut self, block: u32, is_tested: bool) {
        let mut rows = 0;
        self.certain = 0;
        for askers in self.askers.as_mut_slice() {
            let Some((ahead, later)) = askers.candidates.split_first().filter(|(ahead, _)| ahead.block == block) else {
                continue;
            };
            askers.candidates = later;
            rows |= u64::from(ahead.lanes) * askers.bytes;
            if ahead.certain || !is_tested {
                self.certain |= askers.points;
                askers.chosen += ahead.lanes.count_ones();
            }
        }
        self.asked = transposed(rows).map(u32::from);
    }

    /// The ways to a VPL of the current block, counted, and those on which there is light if nothing is between: of the
    /// points that have it, where they do not know it for certain only those where its relevance reaches the threshold.
    /// None, where neither lights the other.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn ways(&mut self, block: &VplBlock, lane: usize, threshold: Option<f32>) -> Option<(Ways, __m256)> {
        let asked = self.asked[lane];
        let tested = threshold.filter(|_| asked & !self.certain != 0);
        if asked == 0 || self.is_turned_away && tested.is_none() {
            return None;
        }
        let to_light = sub(splat_lane(&block.position, lane), self.point);
        let ways = Ways::new(to_light, self.normal, splat_lane(&block.direction, lane));
        let mut chosen = asked;
        if let Some(threshold) = tested {
            let intensity = _mm256_set1_ps(block.intensity[lane % LANES]);
            chosen &= self.certain | relevant(intensity, &ways, threshold);
            self.chosen = counted(self.chosen, spread(chosen & !self.certain));
        }
        let open = ways.facing(chosen);
        self.shadow_rays = counted(self.shadow_rays, open);
        Some((ways, open))
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
        let (mut chosen, shadow_rays) = (whole(self.chosen), whole(self.shadow_rays));
        for askers in self.askers.as_slice() {
            lanes(askers.points).for_each(|k| chosen[k] += askers.chosen);
        }
        std::array::from_fn(|k| Gathered {
            color: Vec3::new(r[k], g[k], b[k]),
            chosen: chosen[k],
            shadow_rays: u64::from(shadow_rays[k]),
        })
    }
}

/// One more in the lanes of a mask.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn counted(counts: __m256i, mask: __m256) -> __m256i {
    _mm256_sub_epi32(counts, _mm256_castps_si256(mask))
}

/// Twin of the plain `evaluate_together`, for up to 32 points whose candidates are in the order of their blocks: one
/// VPL at a time for all points that have it, whose shadow rays go much the same way.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[allow(clippy::large_stack_arrays)] // two dozen KiB, of which little is written
pub(super) fn evaluate_together(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[&[Candidates]],
    threshold: Option<f32>,
    at: &[Receiver],
) -> Vec<Gathered> {
    let Blocks { vpls, half_spaces } = blocks;
    let (mut points, mut sources) = (Vec::with_capacity(PACKETS), [const { Source::new() }; PACKETS]);
    for (at, candidates) in at.chunks(LANES).zip(candidates.chunks(LANES)) {
        let eight = Points::new(at, candidates, half_spaces);
        let epsilon = std::array::from_fn(|lane| at[lane.min(at.len() - 1)].epsilon);
        sources[points.len()].set(tracer, half_spaces, (eight.point, load(&epsilon)));
        points.push(eight);
    }
    let mut batch = Batch::new();
    while let Some(number) = points.iter().filter_map(Points::next_block).min() {
        let block = &vpls[number as usize];
        let light = |lane: usize| (splat_lane(&block.diffuse, lane), _mm256_set1_ps(block.attenuation[lane % LANES]));
        for (points, source) in points.iter_mut().zip(&sources) {
            points.ask(number, threshold.is_some());
            points.is_turned_away = half_spaces.is_turned_away(number, points.facing);
            points.shared = source.shared(half_spaces.sides(number));
            points.seen = source.sees(&tracer.geometry, half_spaces, number, block);
            for lane in lanes(points.seen) {
                let Some((ways, open)) = points.ways(block, lane, threshold) else { continue };
                add(&mut points.sums[lane], (ways.cosines, ways.dist_sq, open), light(lane), points.diffuse);
            }
        }
        batch.size = 0;
        for lane in 0..LANES {
            for (index, points) in points.iter_mut().enumerate().filter(|(_, points)| points.seen >> lane & 1 == 0) {
                let Some((ways, open)) = points.ways(block, lane, threshold) else { continue };
                let shadow = Shadow::new(&ways, _mm256_movemask_ps(open) as u32, points.shared);
                batch.push_if(
                    Shadow { block: number, lane: lane as u32, source: index as u32, ..shadow },
                    shadow.open != 0,
                );
            }
        }
        trace(tracer, &sources, batch.as_mut_slice(), true);
        for shadow in batch.as_slice() {
            let (points, lane) = (&mut points[shadow.source as usize], shadow.lane as usize % LANES);
            shadow.add(&mut points.sums[lane], light(lane), points.diffuse);
        }
    }
    points.iter().flat_map(|points| points.gathered()).take(at.len()).collect()
}

/// Rows and columns of eight times eight bits exchanged (Warren 2012, "Hacker's Delight", 7-3).
fn transposed(rows: u64) -> [u8; LANES] {
    let exchange = |bits: u64, shift: u32, mask: u64| {
        let differs = (bits ^ bits >> shift) & mask;
        bits ^ differs ^ differs << shift
    };
    let bits = exchange(rows, 7, 0x00aa_00aa_00aa_00aa);
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
                assert_eq!(transposed(u64::from_le_bytes(rows)), columns);
            }
        }
    }
}
