//! A ray and eight triangles, or eight rays and a triangle, without gaps at edges, with AVX2. Twin of
//! `kernel::watertight`, same hits.
//!
//! Most triangles that are tested are missed, and are left after their edges: only for the others is it worked out where
//! their planes are.

#![allow(unsafe_code)]

use super::avx2_trace::{Wide3, cross, dot, load, sub};
use glam::Vec3;
use lightcuts_kernel::watertight::Shear;
use lightcuts_world::bvh::LANES;
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_LE_OQ, _CMP_NEQ_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_cmp_ps,
    _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_or_ps, _mm256_set1_ps,
    _mm256_setzero_ps, _mm256_sub_ps,
};

/// Eight of `kernel::watertight::Shear` that agree on the longest axis.
#[derive(Clone, Copy)]
pub(super) struct WideShear {
    /// 0, 1 and 2 in some order.
    axes: [usize; 3],
    slope: [__m256; 2],
    scale: __m256,
}

impl WideShear {
    /// That of one direction, in all lanes.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn of_one(direction: Vec3) -> Self {
        let Shear { axes, slope: [first, second], scale } = Shear::new(direction);
        let slope = [_mm256_set1_ps(first), _mm256_set1_ps(second)];
        Self { axes, slope, scale: _mm256_set1_ps(scale) }
    }

    /// Those of the directions in `asked`, a bit each; `None` if their longest axes differ. Other lanes mean nothing.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn of_some(direction: &Wide3, asked: u32) -> Option<Self> {
        let sign_bit = _mm256_set1_ps(-0.0);
        let [x, y, z] = [direction[0], direction[1], direction[2]];
        let (x, y, z) = (_mm256_andnot_ps(sign_bit, x), _mm256_andnot_ps(sign_bit, y), _mm256_andnot_ps(sign_bit, z));
        let at_least = |a: __m256, b: __m256| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(a, b)) as u32;
        let along_x = at_least(x, y) & at_least(x, z);
        let along_y = at_least(y, z) & !along_x;
        let last = [along_x, along_y, !(along_x | along_y)].iter().position(|lanes| asked & !lanes == 0)?;
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let scale = _mm256_div_ps(_mm256_set1_ps(1.0), direction[last]);
        let slope = [_mm256_mul_ps(direction[axes[0]], scale), _mm256_mul_ps(direction[axes[1]], scale)];
        Some(Self { axes, slope, scale })
    }

    /// For blocks of edges, which need none.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn none() -> Self {
        let zero = _mm256_setzero_ps();
        Self { axes: [0, 1, 2], slope: [zero; 2], scale: zero }
    }

    /// Components in turned order.
    pub(super) fn turned(&self, of: &Wide3) -> Wide3 {
        self.axes.map(|axis| of[axis])
    }

    /// Vectors of eight lanes from memory, in turned order.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn load3(&self, of: &[[f32; LANES]; 3]) -> Wide3 {
        // SAFETY: the axes are 0, 1 and 2 in some order.
        let lanes = |axis: usize| load(unsafe { of.get_unchecked(axis) });
        [lanes(self.axes[0]), lanes(self.axes[1]), lanes(self.axes[2])]
    }

    /// The vector of one lane, in all lanes, in turned order.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn splat_lane(&self, of: &[[f32; LANES]; 3], lane: usize) -> Wide3 {
        // SAFETY: the axes are 0, 1 and 2 in some order.
        let splat = |axis: usize| _mm256_set1_ps(unsafe { of.get_unchecked(axis) }[lane % LANES]);
        [splat(self.axes[0]), splat(self.axes[1]), splat(self.axes[2])]
    }
}

/// Lanes whose line crosses their triangle, with t, u and v; the arithmetic of `intersect_watertight`, all vectors in turned
/// order. The ends of the rays are left to the caller.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn cross_watertight(
    origin: Wide3,
    direction: Wide3,
    shear: &WideShear,
    corners: &[Wide3; 3],
) -> (__m256, [__m256; 3]) {
    let zero = _mm256_setzero_ps();
    let (a, b, c) = (sub(corners[0], origin), sub(corners[1], origin), sub(corners[2], origin));
    let flat = |p: Wide3| {
        let moved = |axis: usize| _mm256_sub_ps(p[axis], _mm256_mul_ps(shear.slope[axis], p[2]));
        [moved(0), moved(1)]
    };
    let edge = |p: [__m256; 2], q: [__m256; 2]| _mm256_sub_ps(_mm256_mul_ps(p[0], q[1]), _mm256_mul_ps(p[1], q[0]));
    let (flat_a, flat_b, flat_c) = (flat(a), flat(b), flat(c));
    let (of_a, of_b, of_c) = (edge(flat_b, flat_c), edge(flat_c, flat_a), edge(flat_a, flat_b));
    let sum = _mm256_add_ps(_mm256_add_ps(of_a, of_b), of_c);
    let least = _mm256_min_ps(_mm256_min_ps(of_a, of_b), of_c);
    let greatest = _mm256_max_ps(_mm256_max_ps(of_a, of_b), of_c);
    let on_one_side =
        _mm256_or_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(least, zero), _mm256_cmp_ps::<_CMP_LE_OQ>(greatest, zero));
    let inside = _mm256_and_ps(on_one_side, _mm256_cmp_ps::<_CMP_NEQ_OQ>(sum, zero));
    if _mm256_movemask_ps(inside) == 0 {
        return (inside, [zero; 3]);
    }
    let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), sum);
    let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
    let of_plane = _mm256_div_ps(dot(normal, a), dot(normal, direction));
    let at = |z: __m256| _mm256_mul_ps(z, shear.scale);
    let (at_a, at_b, at_c) = (at(a[2]), at(b[2]), at(c[2]));
    // What is no number gives way to the second of both operands.
    let t = _mm256_max_ps(of_plane, _mm256_min_ps(_mm256_min_ps(at_a, at_b), at_c));
    let t = _mm256_min_ps(t, _mm256_max_ps(_mm256_max_ps(at_a, at_b), at_c));
    (inside, [t, _mm256_mul_ps(of_b, inverse), _mm256_mul_ps(of_c, inverse)])
}

#[cfg(test)]
mod tests {
    use super::super::Simd;
    use super::super::avx2_packet::wide3;
    use super::*;
    use lightcuts_kernel::rng::random4;
    use lightcuts_kernel::watertight::longest_axis;

    /// Eight directions agree on an axis if and only if each by itself has it.
    #[test]
    #[allow(unsafe_code)]
    fn directions_agree_on_what_each_has() {
        if !Simd::Auto.has_avx2() {
            println!("skipped: no AVX2");
            return;
        }
        let mut agreed = 0;
        for k in 0..20_000 {
            let directions: [Vec3; 8] = std::array::from_fn(|lane| {
                let [x, y, z, w] = random4(k, lane as u32 * (k % 2), 0, 94);
                let v = Vec3::new(x, y, z) - 0.5;
                if w < 0.2 { (v * 4.0).round() } else { v }
            });
            let asked = random4(k, 9, 0, 94)[0] * 255.0;
            let asked = asked as u32 | 1;
            let axes: Vec<usize> =
                (0..8).filter(|lane| asked >> lane & 1 == 1).map(|lane| longest_axis(directions[lane])).collect();
            // SAFETY: the machine has AVX2.
            let shear = unsafe { WideShear::of_some(&wide3(directions), asked) };
            let expected = axes.iter().all(|&axis| axis == axes[0]).then_some(axes[0]);
            assert_eq!(shear.map(|shear| shear.axes[2]), expected, "{k}");
            agreed += u32::from(expected.is_some());
        }
        assert!((8_000..18_000).contains(&agreed), "{agreed}");
    }
}
