//! Eight shadow rays at a time, from one point or from neighbours. Twin of `lightcuts_world::bvh::any_hit` for each of
//! them, same answers.
//!
//! The thesis' rooms have few spheres and squares around a mesh. These are tested without their boxes, eight rays at
//! once; a square is mostly told by its plane. What is left and meets the box of the mesh goes down the hierarchy as a
//! bundle if all rays' directions have the same signs, as those of neighbours to one light mostly do, else ray by ray.
//! Many packets from the same places are for `avx2_shadows`.

#![allow(unsafe_code)]

use super::avx2_bundle::Bundle;
use super::avx2_trace::{Wide3, any_hit, cross_triangles, dot, lanes, load, splat_lane, splat3, sub};
use super::half_spaces::FEW;
use super::tracer::{RayLanes, Tracer};
use bytemuck::cast_ref;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::{Sphere, Square};
use lightcuts_kernel::ray::{END_SLACK, ORIGINAL_EPSILON, Ray, SAFE_LEAST, SLAB_SLACK};
use lightcuts_world::bvh::{Geometry, LANES, TriangleBlock};
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NEQ_OQ, _mm256_add_ps, _mm256_and_ps,
    _mm256_andnot_ps, _mm256_blendv_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_mul_ps, _mm256_or_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps, _mm256_xor_ps,
};

/// Relative margin of comparisons that spare a division, far above its rounding error.
const MARGIN: f32 = 1e-6;

/// The vectors from a sphere's centre, and the squares of their lengths less that of the radius.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn sphere_from(sphere: &Sphere, origin: Wide3) -> (Wide3, __m256) {
    let offset = sub(origin, splat3(sphere.center));
    (offset, _mm256_sub_ps(dot(offset, offset), _mm256_set1_ps(sphere.radius * sphere.radius)))
}

/// How far a square's centre is along its normal.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn height_of(square: &Square, origin: Wide3) -> __m256 {
    dot(sub(splat3(square.center), origin), splat3(square.normal))
}

/// Eight rays that are not inside of anything.
#[derive(Clone, Copy)]
pub(super) struct Packet {
    pub(super) origin: Wide3,
    pub(super) direction: Wide3,
    /// Not negative.
    pub(super) t_min: __m256,
    pub(super) t_max: __m256,
}

/// Which of the packet's rays in `asked` (a bit each) hit anything between their ends.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn any_hits<const CORNERS: bool>(tracer: &Tracer<'_>, packet: &Packet, asked: u32) -> u32 {
    let Tracer { geometry, rules, .. } = tracer;
    if geometry.spheres.len() > FEW || geometry.squares.len() > FEW {
        return packet.singly::<true, CORNERS>(geometry, *rules, asked);
    }
    let mut open = asked;
    for square in geometry.squares {
        open &= !packet.hits_square(square, height_of(square, packet.origin));
    }
    for sphere in geometry.spheres {
        open &= !packet.hits_sphere(sphere, sphere_from(sphere, packet.origin), *rules);
    }
    asked & !packet.miss_mesh::<CORNERS>(tracer, open)
}

/// Twin of `Tracer::occluded8` for rays that are not inside of anything and have no end behind their origin.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn occluded(tracer: &Tracer<'_>, rays: &[Ray; LANES], asked: u32) -> u32 {
    by_form!(tracer.geometry.form, CORNERS => any_hits::<CORNERS>(tracer, &Packet::new(rays), asked))
}

// Written out: with `map`, over arrays of registers, the compiler has been seen to misplace them on the stack.

/// Eight vectors by their coordinates.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn wide3(vectors: [Vec3; LANES]) -> Wide3 {
    [load(&vectors.map(|v| v.x)), load(&vectors.map(|v| v.y)), load(&vectors.map(|v| v.z))]
}

/// Twin of `Tracer::occluded_lanes`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn occluded_lanes(tracer: &Tracer<'_>, rays: &RayLanes, asked: u32) -> u32 {
    let load3 = |of: &[[f32; LANES]; 3]| [load(&of[0]), load(&of[1]), load(&of[2])];
    let (origin, direction) = (load3(&rays.origin), load3(&rays.direction));
    let packet = Packet { origin, direction, t_min: _mm256_setzero_ps(), t_max: load(&rays.t_max) };
    by_form!(tracer.geometry.form, CORNERS => any_hits::<CORNERS>(tracer, &packet, asked))
}

/// Twin of `kernel::ray::safe_reciprocal`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn safe_reciprocal(c: __m256) -> __m256 {
    let sign_bit = _mm256_set1_ps(-0.0);
    let tiny = _mm256_set1_ps(SAFE_LEAST);
    let signed_tiny = _mm256_or_ps(tiny, _mm256_and_ps(sign_bit, c));
    let is_small = _mm256_cmp_ps::<_CMP_LT_OQ>(_mm256_andnot_ps(sign_bit, c), tiny);
    _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_blendv_ps(c, signed_tiny, is_small))
}

/// Of eight rays those that meet a box before `limit`, as in `bvh::enter_box`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn meet(
    origin: Wide3,
    reciprocal: Wide3,
    t_min: __m256,
    limit: __m256,
    (lower, upper): (Wide3, Wide3),
) -> u32 {
    let (mut entry, mut exit) = (t_min, _mm256_mul_ps(limit, _mm256_set1_ps(END_SLACK)));
    for axis in 0..3 {
        let at = |side: __m256| _mm256_mul_ps(_mm256_sub_ps(side, origin[axis]), reciprocal[axis]);
        let (a, b) = (at(lower[axis]), at(upper[axis]));
        entry = _mm256_max_ps(entry, _mm256_min_ps(a, b));
        exit = _mm256_min_ps(exit, _mm256_mul_ps(_mm256_max_ps(a, b), _mm256_set1_ps(SLAB_SLACK)));
    }
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32
}

/// Boxes that any of some rays may cross, and the earliest that one may enter them, by interval arithmetic: from where
/// the rays begin to the boxes' near and far sides, with the least and the greatest reciprocals of their directions.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn meet_any(
    (near, far): (Wide3, Wide3),
    [least, greatest]: [Wide3; 2],
    t_min: __m256,
    limit: __m256,
) -> (u32, __m256) {
    let (mut entry, mut exit) = (t_min, _mm256_mul_ps(limit, _mm256_set1_ps(END_SLACK)));
    for axis in 0..3 {
        let by = |side: __m256| (_mm256_mul_ps(side, least[axis]), _mm256_mul_ps(side, greatest[axis]));
        let ((a, b), (c, d)) = (by(near[axis]), by(far[axis]));
        entry = _mm256_max_ps(entry, _mm256_min_ps(a, b));
        exit = _mm256_min_ps(exit, _mm256_max_ps(c, d));
    }
    let exit = _mm256_mul_ps(exit, _mm256_set1_ps(SLAB_SLACK));
    (_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32, entry)
}

impl Packet {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn new(rays: &[Ray; LANES]) -> Self {
        Self {
            origin: wide3(rays.map(|ray| ray.origin)),
            direction: wide3(rays.map(|ray| ray.direction)),
            t_min: load(&rays.map(|ray| ray.t_min)),
            t_max: load(&rays.map(|ray| ray.t_max)),
        }
    }

    /// Rays of `open` that hit no triangle.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn miss_mesh<const CORNERS: bool>(&self, tracer: &Tracer<'_>, open: u32) -> u32 {
        let Tracer { geometry, rules, .. } = tracer;
        if open == 0 || geometry.triangles.is_empty() {
            return open;
        }
        let (reciprocal, (lower, upper)) = (self.reciprocal(), tracer.mesh);
        let near = meet(self.origin, reciprocal, self.t_min, self.t_max, (splat3(lower), splat3(upper))) & open;
        open & !match Bundle::<CORNERS>::new(self, reciprocal, near) {
            Some(bundle) => bundle.any_hits(geometry, *rules, near),
            None => self.singly::<false, CORNERS>(geometry, *rules, near),
        }
    }

    /// The triangle of a lane, of a block of edges: rays that hit it, with t, u and v; the arithmetic of `intersect_triangle`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn intersect(&self, block: &TriangleBlock, lane: usize, least: f32) -> (__m256, [__m256; 3]) {
        let triangle = [splat_lane(&block.a, lane), splat_lane(&block.b, lane), splat_lane(&block.c, lane)];
        let (inside, [t, u, v]) = cross_triangles(self.origin, self.direction, triangle, least);
        (_mm256_and_ps(inside, self.between_ends(t)), [t, u, v])
    }

    /// Rays of `asked` that hit anything, one after the other; spheres and squares count where `OTHERS` says so.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn singly<const OTHERS: bool, const CORNERS: bool>(
        &self,
        geometry: &Geometry<'_>,
        rules: Rules,
        asked: u32,
    ) -> u32 {
        let is_hit = |&lane: &usize| any_hit::<OTHERS, CORNERS>(geometry, &self.ray(lane), rules, 0);
        lanes(asked).filter(is_hit).fold(0, |hits, lane| hits | 1 << lane)
    }

    /// The ray of one lane.
    pub(super) fn ray(&self, lane: usize) -> Ray {
        let at = |of: &__m256| cast_ref::<__m256, [f32; LANES]>(of)[lane % LANES];
        let vector = |[x, y, z]: &Wide3| Vec3::new(at(x), at(y), at(z));
        let (origin, direction) = (vector(&self.origin), vector(&self.direction));
        Ray { origin, direction, t_min: at(&self.t_min), t_max: at(&self.t_max), inside: false }
    }

    /// Of the directions, safe in slab tests.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn reciprocal(&self) -> Wide3 {
        let [x, y, z] = self.direction;
        [safe_reciprocal(x), safe_reciprocal(y), safe_reciprocal(z)]
    }

    /// Lanes with `t` between their ends.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn between_ends(&self, t: __m256) -> __m256 {
        _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(t, self.t_min), _mm256_cmp_ps::<_CMP_LT_OQ>(t, self.t_max))
    }

    /// Twin of `intersect_square`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn hits_square(&self, square: &Square, height: __m256) -> u32 {
        let slope = dot(self.direction, splat3(square.normal));
        // t = height / slope lies between the ends only if this does; rays between the walls of a room are done here.
        let sign_bit = _mm256_set1_ps(-0.0);
        let (rise, reach) = (_mm256_andnot_ps(sign_bit, slope), _mm256_andnot_ps(sign_bit, height));
        let scaled = |t: __m256, margin: f32| _mm256_mul_ps(rise, _mm256_mul_ps(t, _mm256_set1_ps(margin)));
        let before = _mm256_cmp_ps::<_CMP_LE_OQ>(reach, scaled(self.t_max, 1.0 + MARGIN));
        let beyond = _mm256_cmp_ps::<_CMP_GE_OQ>(reach, scaled(self.t_min, 1.0 - MARGIN));
        let may = _mm256_andnot_ps(_mm256_xor_ps(slope, height), _mm256_and_ps(before, beyond));
        if _mm256_movemask_ps(may) == 0 {
            return 0;
        }
        let t = _mm256_div_ps(height, slope);
        let hit = _mm256_and_ps(self.between_ends(t), _mm256_cmp_ps::<_CMP_NEQ_OQ>(slope, _mm256_setzero_ps()));
        _mm256_movemask_ps(_mm256_and_ps(hit, self.within(square, t))) as u32
    }

    /// Hits of a square, and where: twin of `intersect_square`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn meet_square(&self, square: &Square) -> (__m256, __m256) {
        let slope = dot(self.direction, splat3(square.normal));
        let t = _mm256_div_ps(dot(sub(splat3(square.center), self.origin), splat3(square.normal)), slope);
        let hit = _mm256_and_ps(self.between_ends(t), _mm256_cmp_ps::<_CMP_NEQ_OQ>(slope, _mm256_setzero_ps()));
        (_mm256_and_ps(hit, self.within(square, t)), t)
    }

    /// Rays that are within a square's edges at a point of its plane.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn within(&self, square: &Square, t: __m256) -> __m256 {
        let center = splat3(square.center);
        let offset_on = |axis: usize| {
            let point = _mm256_add_ps(self.origin[axis], _mm256_mul_ps(self.direction[axis], t));
            _mm256_sub_ps(point, center[axis])
        };
        let offset = [offset_on(0), offset_on(1), offset_on(2)];
        let inside = |direction: Vec3, half: f32| {
            let distance = _mm256_andnot_ps(_mm256_set1_ps(-0.0), dot(offset, splat3(direction)));
            _mm256_cmp_ps::<_CMP_LE_OQ>(distance, _mm256_set1_ps(half))
        };
        _mm256_and_ps(inside(square.along, square.half_height), inside(square.across, square.half_width))
    }

    /// Rays whose whole lines meet a sphere, as [`Packet::hits_sphere`] finds first.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn line_meets_sphere(&self, sphere: &Sphere, (offset, c): (Wide3, __m256), rules: Rules) -> u32 {
        let discriminant = match rules {
            Rules::Original => self.discriminant_original(offset, c)[2],
            Rules::Repaired => self.discriminant_repaired(offset, sphere.radius)[2],
        };
        _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(discriminant, _mm256_setzero_ps())) as u32
    }

    /// Which rays hit a sphere: twin of `intersect_sphere` for rays outside.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn hits_sphere(&self, sphere: &Sphere, from: (Wide3, __m256), rules: Rules) -> u32 {
        _mm256_movemask_ps(self.meet_sphere(sphere, from, rules).0) as u32
    }

    /// Hits of a sphere, and where: twin of `intersect_sphere` for rays outside.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn meet_sphere(&self, sphere: &Sphere, (offset, c): (Wide3, __m256), rules: Rules) -> (__m256, __m256) {
        match rules {
            Rules::Original => self.sphere_original(offset, c),
            Rules::Repaired => self.sphere_repaired(offset, c, sphere.radius),
        }
    }

    /// The a, b and discriminant of the original's equation.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn discriminant_original(&self, offset: Wide3, c: __m256) -> [__m256; 3] {
        let a = dot(self.direction, self.direction);
        let b = _mm256_mul_ps(_mm256_set1_ps(2.0), dot(self.direction, offset));
        let product = _mm256_mul_ps(_mm256_mul_ps(_mm256_set1_ps(4.0), a), c);
        [a, b, _mm256_sub_ps(_mm256_mul_ps(b, b), product)]
    }

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn sphere_original(&self, offset: Wide3, c: __m256) -> (__m256, __m256) {
        let zero = _mm256_setzero_ps();
        let two = _mm256_set1_ps(2.0);
        let [a, b, discriminant] = self.discriminant_original(offset, c);
        let real = _mm256_cmp_ps::<_CMP_GE_OQ>(discriminant, zero);
        if _mm256_movemask_ps(real) == 0 {
            return (zero, zero);
        }
        let root = _mm256_sqrt_ps(discriminant);
        let (minus_b, two_a) = (_mm256_sub_ps(zero, b), _mm256_mul_ps(two, a));
        let near = _mm256_div_ps(_mm256_sub_ps(minus_b, root), two_a);
        let far = _mm256_div_ps(_mm256_add_ps(minus_b, root), two_a);
        let t = _mm256_blendv_ps(far, near, _mm256_cmp_ps::<_CMP_GT_OQ>(near, zero));
        let counts = _mm256_cmp_ps::<_CMP_GT_OQ>(t, _mm256_set1_ps(ORIGINAL_EPSILON));
        (_mm256_and_ps(_mm256_and_ps(real, counts), self.between_ends(t)), t)
    }

    /// The a, half b and discriminant of the repaired equation.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn discriminant_repaired(&self, offset: Wide3, radius: f32) -> [__m256; 3] {
        let sign_bit = _mm256_set1_ps(-0.0);
        let a = dot(self.direction, self.direction);
        // A negated dot product keeps its zero's sign in the plain version.
        let half_b = _mm256_xor_ps(sign_bit, dot(offset, self.direction));
        let along = _mm256_div_ps(half_b, a);
        let nearest_on = |axis: usize| _mm256_add_ps(offset[axis], _mm256_mul_ps(self.direction[axis], along));
        let nearest = [nearest_on(0), nearest_on(1), nearest_on(2)];
        let depth = _mm256_sub_ps(_mm256_set1_ps(radius * radius), dot(nearest, nearest));
        [a, half_b, _mm256_mul_ps(a, depth)]
    }

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn sphere_repaired(&self, offset: Wide3, c: __m256, radius: f32) -> (__m256, __m256) {
        let zero = _mm256_setzero_ps();
        let sign_bit = _mm256_set1_ps(-0.0);
        let [a, half_b, discriminant] = self.discriminant_repaired(offset, radius);
        let real = _mm256_cmp_ps::<_CMP_GE_OQ>(discriminant, zero);
        if _mm256_movemask_ps(real) == 0 {
            return (zero, zero);
        }
        let signed_root = _mm256_or_ps(_mm256_sqrt_ps(discriminant), _mm256_and_ps(sign_bit, half_b));
        let q = _mm256_add_ps(half_b, signed_root);
        let is_nonzero = _mm256_cmp_ps::<_CMP_NEQ_OQ>(q, zero);
        let first = _mm256_and_ps(is_nonzero, _mm256_div_ps(c, q));
        let second = _mm256_and_ps(is_nonzero, _mm256_div_ps(q, a));
        let (near, far) = (_mm256_min_ps(first, second), _mm256_max_ps(first, second));
        let t = _mm256_blendv_ps(far, near, _mm256_cmp_ps::<_CMP_GT_OQ>(near, self.t_min));
        (_mm256_and_ps(real, self.between_ends(t)), t)
    }
}
