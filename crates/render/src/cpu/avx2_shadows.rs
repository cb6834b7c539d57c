//! Shadow rays from the same places to many VPLs, with AVX2: packets of eight, some dozens of packets at once.
//!
//! What is hit cannot be guessed, and a wrong guess costs a processor more than testing a sphere does. So packets are
//! collected first; a loop without a branch finds those that meet a sphere at all, and only they are computed to the
//! end.

#![allow(unsafe_code)]

use super::avx2_bundle::ALL;
use super::avx2_fan::{PACKETS, miss_mesh};
use super::avx2_packet::{Packet, height_of, sphere_from};
use super::avx2_trace::{Wide3, dot, lanes, load3, splat3, store, sub};
use super::half_spaces::{FEW, HalfSpaces, RayStart, Shared, Sides};
use super::stack::Stack;
use super::tracer::Tracer;
use crate::light_node::VplBlock;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::ORIGINAL_EPSILON;
use lightcuts_world::bvh::{Geometry, LANES};
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _mm256_andnot_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps,
    _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps,
};

/// Packets that are collected, a bit each in masks: what is kept of them stays in the nearest cache.
pub(super) const MOST: usize = u32::BITS as usize;

// SAFETY: all bits 0 are eight numbers.
const ZERO: __m256 = unsafe { std::mem::zeroed() };

/// Where shadow rays begin, with what depends on that alone.
pub(super) struct Source {
    origin: Wide3,
    /// Distances from the surfaces below which hits do not count.
    epsilon: __m256,
    /// Of each of a few spheres the vector from its centre, and the square of its length less that of the radius.
    spheres: Stack<(Wide3, __m256), FEW>,
    /// Of each of a few squares how far its centre is along its normal.
    heights: Stack<__m256, FEW>,
    ray_start: RayStart,
    /// Somewhere in the middle of the origins; with each of a few spheres the vector from there to its centre, and the
    /// square of the distance that lines from there must keep from it if no ray from any of the origins is to hit it.
    /// Without spheres where the origins are not in the room.
    middle: Wide3,
    clearances: Stack<(Wide3, __m256), FEW>,
}

/// Eight shadow rays, and how the VPLs that they end at light the points if nothing is hit; with that, twin of
/// `VplIncidence`.
#[derive(Clone, Copy)]
pub(super) struct Shadow {
    /// To the VPLs, and its squared length.
    pub(super) direction: Wide3,
    pub(super) length_sq: __m256,
    /// Planes that have both ends of all rays on one side.
    pub(super) shared: Shared,
    /// Rays that are asked for and have hit nothing, a bit each.
    pub(super) open: u32,
    /// Products of the cosines at both ends, times the squared lengths.
    pub(super) cosines: __m256,
    /// Where the VPLs are: a block, and the lane of it where they are one.
    pub(super) block: u32,
    pub(super) lane: u32,
    /// Which of some sources they begin at.
    pub(super) source: u32,
}

impl Source {
    /// To be told where its origins are. Apart, for what is kept of them is not to be copied.
    pub(super) const fn new() -> Self {
        Self {
            origin: [ZERO; 3],
            epsilon: ZERO,
            spheres: Stack::new(),
            heights: Stack::new(),
            ray_start: RayStart::NOWHERE,
            middle: [ZERO; 3],
            clearances: Stack::new(),
        }
    }

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn set(&mut self, tracer: &Tracer<'_>, half_spaces: &HalfSpaces, (origin, epsilon): (Wide3, __m256)) {
        let Tracer { geometry, rules, .. } = tracer;
        (self.origin, self.epsilon) = (origin, epsilon);
        let zero = _mm256_setzero_ps();
        let all = |mask: __m256| u32::from(_mm256_movemask_ps(mask) as u32 == ALL);
        for sphere in geometry.spheres.iter().take(FEW) {
            self.spheres.push(sphere_from(sphere, origin));
        }
        let mut ray_start = RayStart::NOWHERE;
        let epsilon = store(self.epsilon).into_iter().fold(f32::INFINITY, f32::min);
        let plane_tolerance = _mm256_set1_ps(half_spaces.plane_tolerance(*rules, epsilon));
        for (index, square) in geometry.squares.iter().take(FEW).enumerate() {
            let height = height_of(square, origin);
            self.heights.push(height);
            // The centre is behind points in front.
            ray_start.sides.front |= u64::from(all(_mm256_cmp_ps::<_CMP_LE_OQ>(height, zero))) << index;
            ray_start.sides.back |= u64::from(all(_mm256_cmp_ps::<_CMP_GE_OQ>(height, zero))) << index;
            let distance = _mm256_andnot_ps(_mm256_set1_ps(-0.0), height);
            ray_start.on |= u64::from(all(_mm256_cmp_ps::<_CMP_LE_OQ>(distance, plane_tolerance))) << index;
        }
        // Of three planes across the axes those that all origins are above, and below.
        let above = |planes: Vec3| {
            let above = |axis: usize| all(_mm256_cmp_ps::<_CMP_GE_OQ>(origin[axis], _mm256_set1_ps(planes[axis])));
            above(0) | above(1) << 1 | above(2) << 2
        };
        let below = |planes: Vec3| {
            let below = |axis: usize| all(_mm256_cmp_ps::<_CMP_LE_OQ>(origin[axis], _mm256_set1_ps(planes[axis])));
            below(0) | below(1) << 1 | below(2) << 2
        };
        if above(half_spaces.enclosure.lower) & below(half_spaces.enclosure.upper) != 0b111 {
            return;
        }
        for (number, &(lower, upper)) in half_spaces.boxes.iter().enumerate() {
            ray_start.sides.add_faces(number, below(lower) | above(upper) << 3);
        }
        self.ray_start = ray_start;
        self.measure(geometry, half_spaces);
    }

    /// Finds how far from spheres ways that begin in the middle of the origins must keep.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn measure(&mut self, geometry: &Geometry<'_>, half_spaces: &HalfSpaces) {
        let [x, y, z] = [store(self.origin[0]), store(self.origin[1]), store(self.origin[2])];
        let origins: [Vec3; LANES] = std::array::from_fn(|lane| Vec3::new(x[lane], y[lane], z[lane]));
        let (lower, upper) = origins.iter().fold((origins[0], origins[0]), |(l, u), &p| (l.min(p), u.max(p)));
        let middle = lower.midpoint(upper);
        let spread_sq = origins.iter().map(|&origin| (origin - middle).length_squared()).fold(0.0, f32::max);
        let spread = f64::from(spread_sq).sqrt() * (1.0 + 4.0 * f64::from(f32::EPSILON));
        self.middle = splat3(middle);
        for (sphere, clearance) in geometry.spheres.iter().zip(&half_spaces.clearances) {
            let clearance_sq = _mm256_set1_ps((clearance + spread).powi(2) as f32);
            self.clearances.push((splat3(sphere.center - middle), clearance_sq));
        }
    }

    /// Of a block's VPLs those that nothing can hide from any of the origins, a bit each.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn sees(&self, geometry: &Geometry<'_>, half_spaces: &HalfSpaces, number: u32, block: &VplBlock) -> u32 {
        let shared = self.shared(half_spaces.sides(number));
        let is_hidden = !half_spaces.has_inside(number)
            || self.clearances.size < geometry.spheres.len()
            || geometry.squares.len() > FEW
            || shared.crossed(geometry.squares.len()) != 0
            || !geometry.triangles.is_empty() && shared.may_meet_mesh();
        if is_hidden {
            return 0;
        }
        let way = sub(load3(&block.position), self.middle);
        let length_sq = dot(way, way);
        let mut seen = ALL;
        for (sphere, &(center, clearance_sq)) in self.clearances.as_slice().iter().enumerate() {
            if !shared.may_meet_sphere(sphere) {
                continue;
            }
            // The point of the way that is nearest to the centre; a way of no length is the same everywhere.
            let along = _mm256_div_ps(dot(center, way), length_sq);
            let along = _mm256_max_ps(_mm256_min_ps(along, _mm256_set1_ps(1.0)), _mm256_setzero_ps());
            let offset_on = |axis: usize| _mm256_sub_ps(center[axis], _mm256_mul_ps(way[axis], along));
            let offset = [offset_on(0), offset_on(1), offset_on(2)];
            seen &= _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(dot(offset, offset), clearance_sq)) as u32;
        }
        seen
    }

    /// Of shadow rays to places on some sides.
    #[inline]
    pub(super) fn shared(&self, ends: Sides) -> Shared {
        self.ray_start.shared(ends)
    }

    /// A shadow ray as `kernel::ray::shadow_ray` makes it.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn packet(&self, rules: Rules, direction: Wide3, length_sq: __m256) -> Packet {
        let one = _mm256_set1_ps(1.0);
        let (t_min, t_max) = match rules {
            Rules::Original => (_mm256_set1_ps(ORIGINAL_EPSILON), one),
            Rules::Repaired => {
                let length = _mm256_max_ps(_mm256_sqrt_ps(length_sq), _mm256_set1_ps(f32::MIN_POSITIVE));
                let relative = _mm256_div_ps(self.epsilon, length);
                (relative, _mm256_sub_ps(one, relative))
            }
        };
        Packet { origin: self.origin, direction, t_min, t_max }
    }
}

/// Closes the rays that hit anything. At most [`MOST`] packets; `is_fan` says that all rays of each end at one VPL.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn trace(tracer: &Tracer<'_>, sources: &[Source], shadows: &mut [Shadow], is_fan: bool) {
    let Tracer { geometry, rules, .. } = tracer;
    let source = |shadow: &Shadow| &sources[shadow.source as usize];
    let packet = |shadow: &Shadow| source(shadow).packet(*rules, shadow.direction, shadow.length_sq);
    if geometry.spheres.len() > FEW || geometry.squares.len() > FEW {
        for shadow in shadows {
            shadow.open &= !packet(shadow).singly::<true, false>(geometry, *rules, shadow.open);
        }
        return;
    }
    for shadow in shadows.iter_mut() {
        for index in lanes(shadow.shared.crossed(geometry.squares.len())) {
            let height = source(shadow).heights.as_slice()[index];
            shadow.open &= !packet(shadow).hits_square(&geometry.squares[index], height);
        }
    }
    for (number, sphere) in geometry.spheres.iter().enumerate() {
        let mut near = 0_u32;
        for (index, shadow) in shadows.iter().enumerate() {
            near |= u32::from(shadow.shared.may_meet_sphere(number)) << index;
        }
        let mut met = 0_u32;
        for index in lanes(near) {
            let shadow = &shadows[index];
            let from = source(shadow).spheres.as_slice()[number];
            met |= u32::from(packet(shadow).line_meets_sphere(sphere, from, *rules) & shadow.open != 0) << index;
        }
        for index in lanes(met) {
            let shadow = &mut shadows[index];
            let from = source(shadow).spheres.as_slice()[number];
            shadow.open &= !packet(shadow).hits_sphere(sphere, from, *rules);
        }
    }
    if geometry.triangles.is_empty() {
        return;
    }
    if !is_fan {
        for shadow in shadows.iter_mut().filter(|shadow| shadow.shared.may_meet_mesh()) {
            shadow.open = packet(shadow).miss_mesh::<false>(tracer, shadow.open);
        }
        return;
    }
    let mut ahead = 0;
    while let Some(&Shadow { block, lane, .. }) = shadows.get(ahead) {
        // The packets to one VPL follow each other.
        let (mut fan, mut places) = (Stack::<(Packet, u32), PACKETS>::new(), [0; PACKETS]);
        while fan.size < PACKETS
            && let Some(shadow) = shadows.get(ahead).filter(|shadow| (shadow.block, shadow.lane) == (block, lane))
        {
            places[fan.size] = ahead;
            fan.push_if((packet(shadow), shadow.open), shadow.shared.may_meet_mesh() && shadow.open != 0);
            ahead += 1;
        }
        let open = miss_mesh(tracer, fan.as_slice());
        for (number, &place) in places[..fan.size].iter().enumerate() {
            shadows[place].open = open >> (LANES * number) & ALL;
        }
    }
}
