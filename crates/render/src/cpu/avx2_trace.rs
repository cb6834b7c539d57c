//! Traversal with AVX2: eight boxes or eight triangles at a time. Twin of `lightcuts_world::bvh`, same hits.
//!
//! A ray visits few nodes and waits for each: what counts is the way from one node's boxes to the address of the next, and how
//! often the processor guesses wrong. So boxes are tested by fused operations without a multiplication behind them, the next
//! node is known before leaves are tested, and only what is left of a node is remembered.

#![allow(unsafe_code)]

use super::avx2_watertight::{WideShear, hit_watertight};
use super::stack::Stack;
use glam::{Vec3, Vec3A};
use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::{intersect_sphere, intersect_square, min_determinant};
use lightcuts_kernel::ray::{END_SLACK, Hit, Ray, SAFE_LEAST, SLAB_SLACK};
use lightcuts_kernel::rounding::UNIT;
use lightcuts_kernel::watertight::Shear;
use lightcuts_world::bvh::{BvhNode, ChildRef, Geometry, LANES, MAX_LEVELS, STACK_SIZE, TriangleBlock};
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NLT_UQ, _MM_HINT_T0, _mm_prefetch, _mm256_add_ps,
    _mm256_and_ps, _mm256_and_si256, _mm256_andnot_ps, _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32,
    _mm256_div_ps, _mm256_fmsub_ps, _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps,
    _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32, _mm256_setzero_ps, _mm256_storeu_ps, _mm256_sub_ps,
};

/// Eight lanes from memory.
#[target_feature(enable = "avx2")]
pub(super) fn load(lanes: &[f32; LANES]) -> __m256 {
    // SAFETY: an array of eight floats can be read for 32 bytes, and the load asks for no alignment.
    unsafe { _mm256_loadu_ps(lanes.as_ptr()) }
}

/// Eight lanes to memory.
#[target_feature(enable = "avx2")]
pub(super) fn store(value: __m256) -> [f32; LANES] {
    let mut lanes = [0.0; LANES];
    // SAFETY: an array of eight floats can be written for 32 bytes, and the store asks for no alignment.
    unsafe { _mm256_storeu_ps(lanes.as_mut_ptr(), value) };
    lanes
}

/// Three vectors of eight lanes.
pub(super) type Wide3 = [__m256; 3];

#[target_feature(enable = "avx2")]
pub(super) fn load3(lanes: &[[f32; LANES]; 3]) -> Wide3 {
    [load(&lanes[0]), load(&lanes[1]), load(&lanes[2])]
}

#[target_feature(enable = "avx2")]
pub(super) fn splat3(v: Vec3) -> Wide3 {
    [_mm256_set1_ps(v.x), _mm256_set1_ps(v.y), _mm256_set1_ps(v.z)]
}

/// The vector of one lane, in all lanes.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn splat_lane(of: &[[f32; LANES]; 3], lane: usize) -> Wide3 {
    let lane = lane % LANES;
    splat3(glam::Vec3::new(of[0][lane], of[1][lane], of[2][lane]))
}

/// All bits of the lanes that are set in a mask.
#[target_feature(enable = "avx2")]
#[inline]
pub(super) fn spread(mask: u32) -> __m256 {
    let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    let chosen = _mm256_and_si256(_mm256_set1_epi32(mask as i32), bits);
    _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, bits))
}

/// In the order of the plain dot product: (x x + y y) + z z.
#[target_feature(enable = "avx2")]
pub(super) fn dot(a: Wide3, b: Wide3) -> __m256 {
    let xy = _mm256_add_ps(_mm256_mul_ps(a[0], b[0]), _mm256_mul_ps(a[1], b[1]));
    _mm256_add_ps(xy, _mm256_mul_ps(a[2], b[2]))
}

#[target_feature(enable = "avx2")]
pub(super) fn sub(a: Wide3, b: Wide3) -> Wide3 {
    [_mm256_sub_ps(a[0], b[0]), _mm256_sub_ps(a[1], b[1]), _mm256_sub_ps(a[2], b[2])]
}

#[target_feature(enable = "avx2")]
pub(super) fn cross(a: Wide3, b: Wide3) -> Wide3 {
    let minor = |i: usize, j: usize| _mm256_sub_ps(_mm256_mul_ps(a[i], b[j]), _mm256_mul_ps(b[i], a[j]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// Lanes whose line crosses their triangle (corner and two edges), with t, u and v; the arithmetic of `intersect_triangle`. The
/// ends of the rays are left to the caller.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn cross_triangles(
    origin: Wide3,
    direction: Wide3,
    [corner, edge1, edge2]: [Wide3; 3],
    min_determinant: f32,
) -> (__m256, [__m256; 3]) {
    let p = cross(direction, edge2);
    let determinant = dot(edge1, p);
    let magnitude = _mm256_andnot_ps(_mm256_set1_ps(-0.0), determinant);
    let mut hit = _mm256_cmp_ps::<_CMP_NLT_UQ>(magnitude, _mm256_set1_ps(min_determinant));
    let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), determinant);
    let to_origin = sub(origin, corner);
    let u = _mm256_mul_ps(dot(to_origin, p), inverse);
    let q = cross(to_origin, edge1);
    let v = _mm256_mul_ps(dot(direction, q), inverse);
    let t = _mm256_mul_ps(dot(edge2, q), inverse);
    let zero = _mm256_setzero_ps();
    for condition in [
        _mm256_cmp_ps::<_CMP_GE_OQ>(u, zero),
        _mm256_cmp_ps::<_CMP_GE_OQ>(v, zero),
        _mm256_cmp_ps::<_CMP_LE_OQ>(_mm256_add_ps(u, v), _mm256_set1_ps(1.0)),
    ] {
        hit = _mm256_and_ps(hit, condition);
    }
    (hit, [t, u, v])
}

/// By how much the product of origin and reciprocal may be wrong where boxes are entered or left, relative to it: it is
/// rounded four times, and not from the sides' distances as in the plain version.
const START_ERROR: f32 = 4.0 * UNIT;

/// `kernel::ray::safe_reciprocal`, of all components at once.
fn safe_reciprocal(direction: Vec3A) -> Vec3A {
    let tiny = Vec3A::splat(SAFE_LEAST);
    Vec3A::select(direction.abs().cmplt(tiny), tiny.copysign(direction), direction).recip()
}

/// A ray in all lanes, to meet boxes.
struct BoxRay {
    reciprocal: Wide3,
    /// Origin times reciprocal, made larger by as much as it may be wrong.
    start: Wide3,
    /// Both for the sides where boxes are left, made smaller by as much, with [`SLAB_SLACK`].
    far_reciprocal: Wide3,
    far_start: Wide3,
    /// Per axis 1 where the ray runs towards smaller coordinates, and so enters boxes at their upper side; else 0.
    backwards: [usize; 3],
    t_min: __m256,
}

impl BoxRay {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn new(ray: &Ray) -> Self {
        // As vectors of SSE: a third of the work.
        let reciprocal = safe_reciprocal(ray.direction.into());
        let start = Vec3A::from(ray.origin) * reciprocal;
        let error = start.abs() * START_ERROR;
        let signs = reciprocal.is_negative_bitmask() as usize;
        Self {
            reciprocal: splat3(reciprocal.into()),
            start: splat3((start + error).into()),
            far_reciprocal: splat3((reciprocal * SLAB_SLACK).into()),
            far_start: splat3(((start - error) * SLAB_SLACK).into()),
            backwards: [signs & 1, signs >> 1 & 1, signs >> 2 & 1],
            t_min: _mm256_set1_ps(ray.t_min),
        }
    }

    /// Children whose boxes the ray crosses before `limit`, and where it enters them.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn enter(&self, node: &BvhNode, limit: __m256) -> (u32, __m256) {
        let near = |axis: usize| {
            let side = load(&node.bounds[self.backwards[axis] & 1][axis]);
            _mm256_fmsub_ps(side, self.reciprocal[axis], self.start[axis])
        };
        let far = |axis: usize| {
            let side = load(&node.bounds[(self.backwards[axis] & 1) ^ 1][axis]);
            _mm256_fmsub_ps(side, self.far_reciprocal[axis], self.far_start[axis])
        };
        let entry = _mm256_max_ps(_mm256_max_ps(near(0), near(1)), _mm256_max_ps(near(2), self.t_min));
        let limit = _mm256_mul_ps(limit, _mm256_set1_ps(END_SLACK));
        let exit = _mm256_min_ps(_mm256_min_ps(far(0), far(1)), _mm256_min_ps(far(2), limit));
        (_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32, entry)
    }
}

/// A ray to meet triangles in blocks: `CORNERS` says that these hold corners, else edges.
pub(super) struct WideRay<const CORNERS: bool> {
    /// In the order of the shear's axes if there are corners, likewise the direction.
    origin: Vec3,
    direction: Vec3,
    shear: Shear,
    t_min: f32,
    t_max: f32,
}

impl<const CORNERS: bool> WideRay<CORNERS> {
    #[inline]
    pub(super) fn new(ray: &Ray) -> Self {
        let Ray { origin, direction, t_min, t_max, .. } = *ray;
        if !CORNERS {
            return Self {
                origin,
                direction,
                shear: Shear { axes: [0, 1, 2], slope: [0.0; 2], scale: 0.0 },
                t_min,
                t_max,
            };
        }
        let shear = Shear::new(direction);
        Self { origin: shear.turned(origin), direction: shear.turned(direction), shear, t_min, t_max }
    }

    /// Lanes of a block that the ray hits, with t, u and v; the arithmetic of `intersect_triangle` or, with corners, of
    /// `intersect_watertight`. With `ANY` only the lanes count: the other values may be missing.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    pub(super) fn intersect<const ANY: bool>(&self, block: &TriangleBlock, min_determinant: f32) -> (u32, [__m256; 3]) {
        let (origin, direction) = (splat3(self.origin), splat3(self.direction));
        let ends = (_mm256_set1_ps(self.t_min), _mm256_set1_ps(self.t_max));
        if CORNERS {
            let shear = WideShear::of_one(&self.shear);
            let triangles = [shear.load3(&block.a), shear.load3(&block.b), shear.load3(&block.c)];
            let (hit, values) = hit_watertight::<ANY>((origin, direction), &shear, ends, &triangles);
            return (_mm256_movemask_ps(hit) as u32, values);
        }
        let triangles = [load3(&block.a), load3(&block.b), load3(&block.c)];
        let (inside, [t, u, v]) = cross_triangles(origin, direction, triangles, min_determinant);
        let after = _mm256_cmp_ps::<_CMP_GT_OQ>(t, ends.0);
        let before = _mm256_cmp_ps::<_CMP_LT_OQ>(t, ends.1);
        let hit = _mm256_and_ps(inside, _mm256_and_ps(after, before));
        (_mm256_movemask_ps(hit) as u32, [t, u, v])
    }
}

/// Lanes set in a mask, lowest first.
#[inline]
pub(super) fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < 32).then_some(lane)
    })
}

/// Where the block of a child is that is one.
#[inline]
pub(super) fn block<'a>(geometry: &Geometry<'a>, node: &BvhNode, lane: usize) -> &'a TriangleBlock {
    &geometry.triangles[(node.child[lane % LANES] & ChildRef::INDEX) as usize]
}

/// Fetches a node that will be visited later: until then there is something else to do.
#[inline]
fn prefetch(geometry: &Geometry<'_>, index: u32) {
    let node = geometry.nodes.as_ptr().wrapping_add(index as usize).cast::<i8>();
    for line in 0..4 {
        // SAFETY: fetching changes nothing, wherever the address points.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(node.wrapping_add(64 * line)) };
    }
}

/// Whether anything lies between the ray's ends, under a node, 0 for everything. `OTHERS` says whether spheres and squares
/// count, `CORNERS` what blocks hold.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn any_hit<const OTHERS: bool, const CORNERS: bool>(
    geometry: &Geometry<'_>,
    ray: &Ray,
    rules: Rules,
    under: u32,
) -> bool {
    let Some(mut node) = geometry.nodes.get(under as usize) else { return false };
    let boxes = BoxRay::new(ray);
    // Many rays meet no triangle.
    let mut wide = None;
    let (limit, least) = (_mm256_set1_ps(ray.t_max), min_determinant(rules));
    // One entry per level: a node and those of its inner children that are still to be visited.
    let mut stack = Stack::<(u32, u32), MAX_LEVELS>::new();
    let mut index = under;
    loop {
        let here = node;
        let mask = boxes.enter(here, limit).0;
        let mut inner = mask & !(here.triangles | here.others);
        // The next node before the leaves of this one: the processor can fetch it meanwhile.
        let mut is_last = false;
        if inner == 0 {
            match stack.pop() {
                Some(rest) => {
                    (index, inner) = rest;
                    node = &geometry.nodes[index as usize];
                }
                None => is_last = true,
            }
        }
        if !is_last {
            let rest = inner & (inner - 1);
            stack.push_if((index, rest), rest != 0);
            for lane in lanes(rest) {
                prefetch(geometry, node.child[lane]);
            }
            index = node.child[inner.trailing_zeros() as usize % LANES];
            node = &geometry.nodes[index as usize];
        }
        for lane in lanes(mask & here.triangles) {
            let wide = wide.get_or_insert_with(|| WideRay::<CORNERS>::new(ray));
            if wide.intersect::<true>(block(geometry, here, lane), least).0 != 0 {
                return true;
            }
        }
        if OTHERS && lanes(mask & here.others).any(|lane| other_hit(geometry, here.child[lane], ray, rules).is_some()) {
            return true;
        }
        if is_last {
            return false;
        }
    }
}

/// The hit of a child that is a sphere or a square.
#[inline]
pub(super) fn other_hit(geometry: &Geometry<'_>, child: u32, ray: &Ray, rules: Rules) -> Option<Hit> {
    match ChildRef::unpack(child) {
        ChildRef::Node(_) | ChildRef::Triangles(_) => None,
        ChildRef::Sphere(i) => intersect_sphere(&geometry.spheres[i as usize], ray, rules),
        ChildRef::Square(i) => intersect_square(&geometry.squares[i as usize], ray),
    }
}

/// The nearest hit between the ray's ends; of equal hits the first in file order.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn closest_hit<const CORNERS: bool>(geometry: &Geometry<'_>, ray: &Ray, rules: Rules) -> Hit {
    nearer_hit::<CORNERS>(geometry, ray, rules, 0, Hit::none(ray.t_max))
}

/// The nearest of the hits under a node and of the best one so far.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
pub(super) fn nearer_hit<const CORNERS: bool>(
    geometry: &Geometry<'_>,
    ray: &Ray,
    rules: Rules,
    under: u32,
    mut best: Hit,
) -> Hit {
    let Some(mut node) = geometry.nodes.get(under as usize) else { return best };
    let (boxes, wide) = (BoxRay::new(ray), WideRay::<CORNERS>::new(ray));
    let least = min_determinant(rules);
    let mut stack = Stack::<(u32, f32), STACK_SIZE>::new();
    loop {
        let (mask, entry) = boxes.enter(node, _mm256_set1_ps(best.t));
        for lane in lanes(mask & node.triangles) {
            let block = block(geometry, node, lane);
            let (mask, values) = wide.intersect::<false>(block, least);
            if mask != 0 {
                let [t, u, v] = [store(values[0]), store(values[1]), store(values[2])];
                for lane in lanes(mask) {
                    best.take_nearer(Hit { t: t[lane], primitive: block.primitive[lane], u: u[lane], v: v[lane] });
                }
            }
        }
        for lane in lanes(mask & node.others) {
            if let Some(hit) = other_hit(geometry, node.child[lane], ray, rules) {
                best.take_nearer(hit);
            }
        }
        let inner = mask & !(node.triangles | node.others);
        let next = if inner == 0 { nearer(&mut stack, best.t) } else { Some(nearest(&mut stack, node, inner, entry)) };
        let Some(index) = next else { return best };
        node = &geometry.nodes[index as usize];
    }
}

/// The nearest of some children; the others go to the stack, the farthest lowest.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn nearest(stack: &mut Stack<(u32, f32), STACK_SIZE>, node: &BvhNode, inner: u32, entry: __m256) -> u32 {
    let first = inner.trailing_zeros() as usize % LANES;
    let rest = inner & (inner - 1);
    if rest == 0 {
        return node.child[first];
    }
    let entries = store(entry);
    let base = stack.size;
    let mut near = (node.child[first], entries[first]);
    for lane in lanes(rest) {
        let mut other = (node.child[lane], entries[lane]);
        if other.1 < near.1 {
            std::mem::swap(&mut near, &mut other);
        }
        stack.insert(base, other, |above| above.1 < other.1);
    }
    near.0
}

/// The next node of the stack that the ray enters before `limit`.
#[inline]
fn nearer(stack: &mut Stack<(u32, f32), STACK_SIZE>, limit: f32) -> Option<u32> {
    loop {
        let (index, entry) = stack.pop()?;
        if entry <= limit * END_SLACK {
            return Some(index);
        }
    }
}
