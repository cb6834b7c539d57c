//! Shadow rays from the same places to many VPLs, with AVX2: packets of eight, some dozens of packets at once.
//!
//! What is hit cannot be guessed, and a wrong guess costs a processor more than testing a sphere does. So packets are collected
//! first; a loop without a branch finds those that meet a sphere at all, and only they are computed to the end.

#![allow(unsafe_code)]

use super::avx2_packet::{Packet, height_of, sphere_from};
use super::avx2_trace::{Wide3, lanes, splat3};
use super::stack::Stack;
use super::tracer::Tracer;
use super::walls::{FEW, Sides, Walls};
use std::arch::x86_64::{__m256, _CMP_GE_OQ, _CMP_LE_OQ, _mm256_cmp_ps, _mm256_movemask_ps, _mm256_setzero_ps};

/// Packets that are collected: what is kept of them stays in the nearest cache.
pub(super) const MOST: usize = 32;

/// Where shadow rays begin, with what depends on that alone.
pub(super) struct Source {
    origin: Wide3,
    /// Of each of a few spheres the vector from its centre, and the square of its length less that of the radius.
    spheres: Stack<(Wide3, __m256), FEW>,
    /// Of each of a few squares how far its centre is along its normal.
    heights: Stack<__m256, FEW>,
    sides: Sides,
}

/// Eight shadow rays.
#[derive(Clone, Copy)]
pub(super) struct Shadow {
    pub(super) direction: Wide3,
    pub(super) t_min: __m256,
    pub(super) t_max: __m256,
    /// Where the VPLs lie that the rays end at.
    pub(super) ends: Sides,
    /// Rays that are asked for and have hit nothing, a bit each.
    pub(super) open: u32,
}

impl Source {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn new(tracer: &Tracer<'_>, walls: &Walls, origin: Wide3) -> Self {
        let Tracer { geometry, mesh: (lower, upper), .. } = tracer;
        let zero = _mm256_setzero_ps();
        let mut source = Self { origin, spheres: Stack::new(), heights: Stack::new(), sides: Sides::default() };
        for sphere in geometry.spheres.iter().take(FEW) {
            source.spheres.push(sphere_from(sphere, origin));
        }
        let all = |mask: __m256| _mm256_movemask_ps(mask) == 0xff;
        for (index, square) in geometry.squares.iter().take(FEW).enumerate() {
            let height = height_of(square, origin);
            source.heights.push(height);
            // The centre is behind points in front.
            source.sides.front |= u32::from(all(_mm256_cmp_ps::<_CMP_LE_OQ>(height, zero))) << index;
            source.sides.back |= u32::from(all(_mm256_cmp_ps::<_CMP_GE_OQ>(height, zero))) << index;
        }
        let is_above = |axis: usize, bound: Wide3| all(_mm256_cmp_ps::<_CMP_GE_OQ>(origin[axis], bound[axis]));
        let is_below = |axis: usize, bound: Wide3| all(_mm256_cmp_ps::<_CMP_LE_OQ>(origin[axis], bound[axis]));
        let (least, greatest) = (splat3(walls.lower), splat3(walls.upper));
        for axis in 0..3 {
            source.sides.front |= u32::from(is_below(axis, splat3(*lower))) << (FEW + axis);
            source.sides.front |= u32::from(is_above(axis, splat3(*upper))) << (FEW + 3 + axis);
        }
        if !(0..3).all(|axis| is_above(axis, least) && is_below(axis, greatest)) {
            source.sides = Sides::default();
        }
        source
    }

    /// Closes the rays that hit anything.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn trace(&self, tracer: &Tracer<'_>, shadows: &mut [Shadow]) {
        let Tracer { geometry, rules, .. } = tracer;
        let packet =
            |&Shadow { direction, t_min, t_max, .. }: &Shadow| Packet { origin: self.origin, direction, t_min, t_max };
        if geometry.spheres.len() > FEW || geometry.squares.len() > FEW {
            for shadow in shadows {
                shadow.open &= !packet(shadow).singly::<true>(geometry, *rules, shadow.open);
            }
            return;
        }
        for shadow in shadows.iter_mut() {
            for index in lanes(self.sides.crossed(shadow.ends, geometry.squares.len())) {
                let height = self.heights.as_slice()[index];
                shadow.open &= !packet(shadow).hits_square(&geometry.squares[index], height);
            }
        }
        for (sphere, &from) in geometry.spheres.iter().zip(self.spheres.as_slice()) {
            let mut met = Stack::<usize, MOST>::new();
            for (index, shadow) in shadows.iter().enumerate() {
                met.push_if(index, packet(shadow).line_meets_sphere(sphere, from, *rules) & shadow.open != 0);
            }
            for &index in met.as_slice() {
                let shadow = &mut shadows[index];
                shadow.open &= !packet(shadow).hits_sphere(sphere, from, *rules);
            }
        }
        if !geometry.triangles.is_empty() {
            for shadow in shadows {
                if self.sides.may_meet_mesh(shadow.ends) {
                    shadow.open = packet(shadow).miss_mesh(tracer, shadow.open);
                }
            }
        }
    }
}
