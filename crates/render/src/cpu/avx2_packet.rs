//! Eight shadow rays at a time, from one point or from neighbours. Twin of `lightcuts_world::bvh::any_hit` for each of them,
//! same answers.
//!
//! The thesis' rooms have few spheres and squares around a mesh. These are tested without their boxes, eight rays at once, with
//! what depends on where rays begin alone computed once for all rays from there; a square is mostly told by its plane. What is
//! left and meets the box of the mesh goes down the hierarchy as a bundle if all rays' directions have the same signs, as those of
//! neighbours to one light mostly do, else ray by ray.

#![allow(unsafe_code)]

use super::avx2_bundle::Bundle;
use super::avx2_trace::{Wide3, any_hit, dot, lanes, load, splat3, store, sub};
use super::tracer::{RayLanes, Tracer};
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::{Sphere, Square};
use lightcuts_kernel::ray::{ORIGINAL_EPSILON, Ray, SLAB_SLACK};
use lightcuts_world::bvh::{Geometry, LANES};
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NEQ_OQ, _mm256_add_ps, _mm256_and_ps,
    _mm256_andnot_ps, _mm256_blendv_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_mul_ps, _mm256_or_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps, _mm256_xor_ps,
};

/// Most spheres, and most squares, that are tested one after the other rather than found by the hierarchy.
const FEW: usize = 16;

/// Relative margin of comparisons that spare a division, far above its rounding error.
const MARGIN: f32 = 1e-6;

/// What of a few spheres and squares depends only on where rays begin: computed once for all packets from there.
pub(super) struct Source {
    /// Of each sphere the vector from its centre, and the square of its length less that of the radius.
    spheres: [(Wide3, __m256); FEW],
    /// Of each square how far its centre is along its normal.
    heights: [__m256; FEW],
}

impl Source {
    #[target_feature(enable = "avx2,fma,bmi1")]
    pub(super) fn new(geometry: &Geometry<'_>, origin: Wide3) -> Self {
        let zero = _mm256_setzero_ps();
        let mut source = Self { spheres: [([zero; 3], zero); FEW], heights: [zero; FEW] };
        for (of, sphere) in source.spheres.iter_mut().zip(geometry.spheres) {
            *of = sphere_from(sphere, origin);
        }
        for (height, square) in source.heights.iter_mut().zip(geometry.squares) {
            *height = height_of(square, origin);
        }
        source
    }
}

/// The vectors from a sphere's centre, and the squares of their lengths less that of the radius.
#[target_feature(enable = "avx2,fma,bmi1")]
#[inline]
fn sphere_from(sphere: &Sphere, origin: Wide3) -> (Wide3, __m256) {
    let offset = sub(origin, splat3(sphere.center));
    (offset, _mm256_sub_ps(dot(offset, offset), _mm256_set1_ps(sphere.radius * sphere.radius)))
}

/// How far a square's centre is along its normal.
#[target_feature(enable = "avx2,fma,bmi1")]
#[inline]
fn height_of(square: &Square, origin: Wide3) -> __m256 {
    dot(sub(splat3(square.center), origin), splat3(square.normal))
}

/// Eight rays that are not inside of anything.
pub(super) struct Packet {
    pub(super) origin: Wide3,
    pub(super) direction: Wide3,
    /// Not negative.
    pub(super) t_min: __m256,
    pub(super) t_max: __m256,
}

/// Which of the packet's rays in `asked` (a bit each) hit anything between their ends. `source` is given where several packets
/// begin at the same places.
#[target_feature(enable = "avx2,fma,bmi1")]
pub(super) fn any_hits(tracer: &Tracer<'_>, packet: &Packet, source: Option<&Source>, asked: u32) -> u32 {
    let Tracer { geometry, rules, .. } = tracer;
    if geometry.spheres.len() > FEW || geometry.squares.len() > FEW {
        return packet.singly::<true>(geometry, *rules, asked);
    }
    let mut open = asked;
    for (index, square) in geometry.squares.iter().enumerate() {
        let height = match source {
            Some(source) => source.heights[index % FEW],
            None => height_of(square, packet.origin),
        };
        open &= !packet.hits_square(square, height);
    }
    for (index, sphere) in geometry.spheres.iter().enumerate() {
        let (offset, c) = match source {
            Some(source) => source.spheres[index % FEW],
            None => sphere_from(sphere, packet.origin),
        };
        open &= !packet.hits_sphere(sphere, offset, c, *rules);
    }
    if open != 0 && !geometry.triangles.is_empty() {
        let near = packet.meet(tracer.mesh) & open;
        open &= !match Bundle::new(packet, near) {
            Some(bundle) => bundle.any_hits(geometry, *rules, near),
            None => packet.singly::<false>(geometry, *rules, near),
        };
    }
    asked & !open
}

/// Twin of `Tracer::occluded8` for rays that are not inside of anything and have no end behind their origin.
#[target_feature(enable = "avx2,fma,bmi1")]
pub(super) fn occluded(tracer: &Tracer<'_>, rays: &[Ray; LANES], asked: u32) -> u32 {
    any_hits(tracer, &Packet::new(rays), None, asked)
}

// Written out: with `map`, over arrays of registers, the compiler has been seen to misplace them on the stack.

/// Eight vectors by their coordinates.
#[target_feature(enable = "avx2,fma,bmi1")]
fn wide3(vectors: [Vec3; LANES]) -> Wide3 {
    [load(&vectors.map(|v| v.x)), load(&vectors.map(|v| v.y)), load(&vectors.map(|v| v.z))]
}

/// The coordinates of eight vectors.
#[target_feature(enable = "avx2,fma,bmi1")]
fn store3([x, y, z]: Wide3) -> [[f32; LANES]; 3] {
    [store(x), store(y), store(z)]
}

/// Twin of `Tracer::occluded_lanes`.
#[target_feature(enable = "avx2,fma,bmi1")]
pub(super) fn occluded_lanes(tracer: &Tracer<'_>, rays: &RayLanes, asked: u32) -> u32 {
    let load3 = |of: &[[f32; LANES]; 3]| [load(&of[0]), load(&of[1]), load(&of[2])];
    let (origin, direction) = (load3(&rays.origin), load3(&rays.direction));
    let packet = Packet { origin, direction, t_min: _mm256_setzero_ps(), t_max: load(&rays.t_max) };
    any_hits(tracer, &packet, None, asked)
}

/// Twin of `kernel::ray::safe_reciprocal`.
#[target_feature(enable = "avx2,fma,bmi1")]
pub(super) fn safe_reciprocal(c: __m256) -> __m256 {
    let sign_bit = _mm256_set1_ps(-0.0);
    let tiny = _mm256_set1_ps(1e-20);
    let signed_tiny = _mm256_or_ps(tiny, _mm256_and_ps(sign_bit, c));
    let is_small = _mm256_cmp_ps::<_CMP_LT_OQ>(_mm256_andnot_ps(sign_bit, c), tiny);
    _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_blendv_ps(c, signed_tiny, is_small))
}

/// Of eight rays those that meet a box before `limit`, as in `bvh::enter_box`.
#[target_feature(enable = "avx2,fma,bmi1")]
#[inline]
pub(super) fn meet(
    origin: Wide3,
    reciprocal: Wide3,
    t_min: __m256,
    limit: __m256,
    (lower, upper): (Wide3, Wide3),
) -> u32 {
    let (mut entry, mut exit) = (t_min, limit);
    for axis in 0..3 {
        let at = |side: __m256| _mm256_mul_ps(_mm256_sub_ps(side, origin[axis]), reciprocal[axis]);
        let (a, b) = (at(lower[axis]), at(upper[axis]));
        entry = _mm256_max_ps(entry, _mm256_min_ps(a, b));
        exit = _mm256_min_ps(exit, _mm256_mul_ps(_mm256_max_ps(a, b), _mm256_set1_ps(SLAB_SLACK)));
    }
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32
}

impl Packet {
    #[target_feature(enable = "avx2,fma,bmi1")]
    pub(super) fn new(rays: &[Ray; LANES]) -> Self {
        Self {
            origin: wide3(rays.map(|ray| ray.origin)),
            direction: wide3(rays.map(|ray| ray.direction)),
            t_min: load(&rays.map(|ray| ray.t_min)),
            t_max: load(&rays.map(|ray| ray.t_max)),
        }
    }

    /// Rays of `asked` that hit anything, one after the other; spheres and squares count where `OTHERS` says so.
    #[target_feature(enable = "avx2,fma,bmi1")]
    fn singly<const OTHERS: bool>(&self, geometry: &Geometry<'_>, rules: Rules, asked: u32) -> u32 {
        let rays = self.rays();
        let is_hit = |&lane: &usize| any_hit::<OTHERS>(geometry, &rays[lane], rules, 0);
        lanes(asked).filter(is_hit).fold(0, |hits, lane| hits | 1 << lane)
    }

    /// One by one.
    #[target_feature(enable = "avx2,fma,bmi1")]
    pub(super) fn rays(&self) -> [Ray; LANES] {
        let (origin, direction) = (store3(self.origin), store3(self.direction));
        let (t_min, t_max) = (store(self.t_min), store(self.t_max));
        std::array::from_fn(|lane| {
            let at = |of: &[[f32; LANES]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
            let (origin, direction) = (at(&origin), at(&direction));
            Ray { origin, direction, t_min: t_min[lane], t_max: t_max[lane], inside: false }
        })
    }

    /// Rays that meet a box, as in `bvh::enter_box`.
    #[target_feature(enable = "avx2,fma,bmi1")]
    fn meet(&self, (lower, upper): (Vec3, Vec3)) -> u32 {
        let [x, y, z] = self.direction;
        let reciprocal = [safe_reciprocal(x), safe_reciprocal(y), safe_reciprocal(z)];
        meet(self.origin, reciprocal, self.t_min, self.t_max, (splat3(lower), splat3(upper)))
    }

    /// Lanes with `t` between their ends.
    #[target_feature(enable = "avx2,fma,bmi1")]
    pub(super) fn between_ends(&self, t: __m256) -> __m256 {
        _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(t, self.t_min), _mm256_cmp_ps::<_CMP_LT_OQ>(t, self.t_max))
    }

    /// Twin of `intersect_square`.
    #[target_feature(enable = "avx2,fma,bmi1")]
    #[inline]
    fn hits_square(&self, square: &Square, height: __m256) -> u32 {
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
    #[target_feature(enable = "avx2,fma,bmi1")]
    pub(super) fn meet_square(&self, square: &Square) -> (__m256, __m256) {
        let slope = dot(self.direction, splat3(square.normal));
        let t = _mm256_div_ps(dot(sub(splat3(square.center), self.origin), splat3(square.normal)), slope);
        let hit = _mm256_and_ps(self.between_ends(t), _mm256_cmp_ps::<_CMP_NEQ_OQ>(slope, _mm256_setzero_ps()));
        (_mm256_and_ps(hit, self.within(square, t)), t)
    }

    /// Rays that are within a square's edges at a point of its plane.
    #[target_feature(enable = "avx2,fma,bmi1")]
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

    /// Twin of `intersect_sphere` for rays outside.
    #[target_feature(enable = "avx2,fma,bmi1")]
    #[inline]
    fn hits_sphere(&self, sphere: &Sphere, offset: Wide3, c: __m256, rules: Rules) -> u32 {
        let hit = match rules {
            Rules::Original => self.sphere_original(offset, c),
            Rules::Repaired => self.sphere_repaired(offset, c, sphere.radius),
        };
        _mm256_movemask_ps(hit) as u32
    }

    #[target_feature(enable = "avx2,fma,bmi1")]
    fn sphere_original(&self, offset: Wide3, c: __m256) -> __m256 {
        let zero = _mm256_setzero_ps();
        let two = _mm256_set1_ps(2.0);
        let a = dot(self.direction, self.direction);
        let b = _mm256_mul_ps(two, dot(self.direction, offset));
        let product = _mm256_mul_ps(_mm256_mul_ps(_mm256_set1_ps(4.0), a), c);
        let discriminant = _mm256_sub_ps(_mm256_mul_ps(b, b), product);
        let real = _mm256_cmp_ps::<_CMP_GE_OQ>(discriminant, zero);
        if _mm256_movemask_ps(real) == 0 {
            return zero;
        }
        let root = _mm256_sqrt_ps(discriminant);
        let (minus_b, two_a) = (_mm256_sub_ps(zero, b), _mm256_mul_ps(two, a));
        let near = _mm256_div_ps(_mm256_sub_ps(minus_b, root), two_a);
        let far = _mm256_div_ps(_mm256_add_ps(minus_b, root), two_a);
        let t = _mm256_blendv_ps(far, near, _mm256_cmp_ps::<_CMP_GT_OQ>(near, zero));
        let counts = _mm256_cmp_ps::<_CMP_GT_OQ>(t, _mm256_set1_ps(ORIGINAL_EPSILON));
        _mm256_and_ps(_mm256_and_ps(real, counts), self.between_ends(t))
    }

    #[target_feature(enable = "avx2,fma,bmi1")]
    fn sphere_repaired(&self, offset: Wide3, c: __m256, radius: f32) -> __m256 {
        let zero = _mm256_setzero_ps();
        let sign_bit = _mm256_set1_ps(-0.0);
        let a = dot(self.direction, self.direction);
        // A negated dot product keeps its zero's sign in the plain version.
        let half_b = _mm256_xor_ps(sign_bit, dot(offset, self.direction));
        let along = _mm256_div_ps(half_b, a);
        let nearest_on = |axis: usize| _mm256_add_ps(offset[axis], _mm256_mul_ps(self.direction[axis], along));
        let nearest = [nearest_on(0), nearest_on(1), nearest_on(2)];
        let depth = _mm256_sub_ps(_mm256_set1_ps(radius * radius), dot(nearest, nearest));
        let discriminant = _mm256_mul_ps(a, depth);
        let real = _mm256_cmp_ps::<_CMP_GE_OQ>(discriminant, zero);
        if _mm256_movemask_ps(real) == 0 {
            return zero;
        }
        let signed_root = _mm256_or_ps(_mm256_sqrt_ps(discriminant), _mm256_and_ps(sign_bit, half_b));
        let q = _mm256_add_ps(half_b, signed_root);
        let is_nonzero = _mm256_cmp_ps::<_CMP_NEQ_OQ>(q, zero);
        let first = _mm256_and_ps(is_nonzero, _mm256_div_ps(c, q));
        let second = _mm256_and_ps(is_nonzero, _mm256_div_ps(q, a));
        let (near, far) = (_mm256_min_ps(first, second), _mm256_max_ps(first, second));
        let t = _mm256_blendv_ps(far, near, _mm256_cmp_ps::<_CMP_GT_OQ>(near, self.t_min));
        _mm256_and_ps(real, self.between_ends(t))
    }
}
