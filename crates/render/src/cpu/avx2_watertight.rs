//! A ray and eight triangles, or eight rays and a triangle, without gaps at edges, with AVX2. Twin of
//! `kernel::watertight`, same hits.
//!
//! Most triangles that are tested are missed, and are left after their edges. Where a plane is crossed is worked out only
//! if the distances of the corners do not tell enough.

#![allow(unsafe_code)]

use super::avx2_trace::{Wide3, cross, dot, load, splat_lane, sub};
use lightcuts_kernel::watertight::Shear;
use lightcuts_world::bvh::LANES;
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NEQ_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps,
    _mm256_blendv_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps,
    _mm256_or_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_sub_ps,
};

/// Eight of `kernel::watertight::Shear`.
#[derive(Clone, Copy)]
pub(super) struct WideShear {
    /// 0, 1 and 2 in some order: what all lanes have, unless they differ.
    axes: [usize; 3],
    /// Where lanes differ: those whose longest axis is the first, and the second.
    longest: Option<[__m256; 2]>,
    slope: [__m256; 2],
    scale: __m256,
}

impl WideShear {
    /// One in all lanes.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn of_one(shear: &Shear) -> Self {
        let slope = [_mm256_set1_ps(shear.slope[0]), _mm256_set1_ps(shear.slope[1])];
        Self { axes: shear.axes, longest: None, slope, scale: _mm256_set1_ps(shear.scale) }
    }

    /// Those of the directions in `asked`, a bit each. Other lanes mean nothing.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn of_some(direction: &Wide3, asked: u32) -> Self {
        let sign_bit = _mm256_set1_ps(-0.0);
        let [x, y, z] = [direction[0], direction[1], direction[2]];
        let (x, y, z) = (_mm256_andnot_ps(sign_bit, x), _mm256_andnot_ps(sign_bit, y), _mm256_andnot_ps(sign_bit, z));
        let at_least = |a: __m256, b: __m256| _mm256_cmp_ps::<_CMP_GE_OQ>(a, b);
        let along_x = _mm256_and_ps(at_least(x, y), at_least(x, z));
        let along_y = _mm256_andnot_ps(along_x, at_least(y, z));
        let (of_x, of_y) = (_mm256_movemask_ps(along_x) as u32, _mm256_movemask_ps(along_y) as u32);
        let shared = [of_x, of_y, !(of_x | of_y)].iter().position(|lanes| asked & !lanes == 0);
        let last = shared.unwrap_or(2);
        let mut shear = Self { axes: [(last + 1) % 3, (last + 2) % 3, last], ..Self::none() };
        if shared.is_none() {
            shear.longest = Some([along_x, along_y]);
        }
        let turned = shear.turned(direction);
        shear.scale = _mm256_div_ps(_mm256_set1_ps(1.0), turned[2]);
        shear.slope = [_mm256_mul_ps(turned[0], shear.scale), _mm256_mul_ps(turned[1], shear.scale)];
        shear
    }

    /// For blocks of edges, which need none.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn none() -> Self {
        let zero = _mm256_setzero_ps();
        Self { axes: [0, 1, 2], longest: None, slope: [zero; 2], scale: zero }
    }

    /// Components in turned order.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn turned(&self, of: &Wide3) -> Wide3 {
        let Some([along_x, along_y]) = self.longest else { return self.axes.map(|axis| of[axis]) };
        let pick = |first: usize, second: usize, third: usize| {
            _mm256_blendv_ps(_mm256_blendv_ps(of[third], of[second], along_y), of[first], along_x)
        };
        [pick(1, 2, 0), pick(2, 0, 1), pick(0, 1, 2)]
    }

    /// Vectors of eight lanes from memory, in turned order; for lanes that agree on the longest axis.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn load3(&self, of: &[[f32; LANES]; 3]) -> Wide3 {
        // SAFETY: the axes are 0, 1 and 2 in some order.
        let lanes = |axis: usize| load(unsafe { of.get_unchecked(axis) });
        [lanes(self.axes[0]), lanes(self.axes[1]), lanes(self.axes[2])]
    }

    /// The vector of one lane of memory, in all lanes, in turned order.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn splat_lane(&self, of: &[[f32; LANES]; 3], lane: usize) -> Wide3 {
        if self.longest.is_some() {
            return self.turned(&splat_lane(of, lane));
        }
        // SAFETY: the axes are 0, 1 and 2 in some order.
        let splat = |axis: usize| _mm256_set1_ps(unsafe { of.get_unchecked(axis) }[lane % LANES]);
        [splat(self.axes[0]), splat(self.axes[1]), splat(self.axes[2])]
    }
}

/// Lanes whose ray hits its triangle between its ends, with t, u and v; the arithmetic of `intersect_watertight`, all vectors
/// in turned order. With `ANY` only the lanes count: the other values may be missing.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn hit_watertight<const ANY: bool>(
    (origin, direction): (Wide3, Wide3),
    shear: &WideShear,
    (t_min, t_max): (__m256, __m256),
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
    let at = |z: __m256| _mm256_mul_ps(z, shear.scale);
    let (at_a, at_b, at_c) = (at(a[2]), at(b[2]), at(c[2]));
    let nearest = _mm256_min_ps(_mm256_min_ps(at_a, at_b), at_c);
    let farthest = _mm256_max_ps(_mm256_max_ps(at_a, at_b), at_c);
    let before = |a: __m256, b: __m256| _mm256_cmp_ps::<_CMP_LT_OQ>(a, b);
    let may = _mm256_and_ps(inside, _mm256_and_ps(before(t_min, farthest), before(nearest, t_max)));
    // Those of which some corner lies beyond an end of the ray.
    let unsure = _mm256_andnot_ps(_mm256_and_ps(before(t_min, nearest), before(farthest, t_max)), may);
    if _mm256_movemask_ps(if ANY { unsure } else { may }) == 0 {
        return (may, [zero; 3]);
    }
    let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), sum);
    let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
    let of_plane = _mm256_div_ps(dot(normal, a), dot(normal, direction));
    // What is no number gives way to the second of both operands.
    let t = _mm256_min_ps(_mm256_max_ps(of_plane, nearest), farthest);
    let hit = _mm256_and_ps(inside, _mm256_and_ps(before(t_min, t), before(t, t_max)));
    (hit, [t, _mm256_mul_ps(of_b, inverse), _mm256_mul_ps(of_c, inverse)])
}

#[cfg(test)]
mod tests {
    use super::super::Simd;
    use super::super::avx2_packet::wide3;
    use super::super::avx2_trace::store;
    use super::*;
    use glam::Vec3;
    use lightcuts_kernel::rng::random4;

    /// Eight directions together, whether they agree on the longest axis or not, are what each is by itself.
    #[test]
    #[allow(unsafe_code)]
    fn shears_are_those_of_each_direction() {
        if !Simd::Auto.has_avx2() {
            println!("skipped: no AVX2");
            return;
        }
        let mut agreed = 0;
        for k in 0..20_000 {
            let vector = |lane: usize, what: u32| {
                let [x, y, z, w] = random4(k, lane as u32 * (k % 2), what, 94);
                let v = Vec3::new(x, y, z) - 0.5;
                if w < 0.2 { (v * 4.0).round() } else { v }
            };
            let (directions, points): ([Vec3; 8], [Vec3; 8]) =
                (std::array::from_fn(|lane| vector(lane, 0)), std::array::from_fn(|lane| vector(lane, 1)));
            let asked = (random4(k, 9, 0, 94)[0] * 255.0) as u32 | 1;
            // SAFETY: the machine has AVX2.
            let (shear, turned, values) = unsafe {
                let shear = WideShear::of_some(&wide3(directions), asked);
                let turned = shear.turned(&wide3(points)).map(|of| store(of));
                (shear, turned, [shear.slope[0], shear.slope[1], shear.scale].map(|of| store(of)))
            };
            agreed += u32::from(shear.longest.is_none());
            for lane in (0..8).filter(|lane| asked >> lane & 1 == 1) {
                let alone = Shear::new(directions[lane]);
                assert_eq!(Vec3::from(turned.map(|of| of[lane])), alone.turned(points[lane]), "{k}, {lane}");
                let expected = [alone.slope[0], alone.slope[1], alone.scale];
                assert_eq!(values.map(|of| of[lane].to_bits()), expected.map(f32::to_bits), "{k}, {lane}");
            }
        }
        assert!((8_000..18_000).contains(&agreed), "{agreed}");
    }
}
