//! Traversal with AVX2: eight boxes or eight triangles at a time. Twin of `lightcuts_world::bvh`, same hits.

#![allow(unsafe_code)]

use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::{intersect_sphere, intersect_square, min_determinant};
use lightcuts_kernel::ray::{Hit, Ray, SLAB_SLACK, safe_reciprocal};
use lightcuts_world::bvh::{BvhNode, ChildRef, Geometry, LANES, STACK_SIZE, TriangleBlock};
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NLT_UQ, _mm256_add_ps, _mm256_and_ps,
    _mm256_andnot_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_mul_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_storeu_ps, _mm256_sub_ps,
};
use std::mem::MaybeUninit;

/// Levels that the any-hit stack can hold; a world's hierarchy is never deeper (`World::validate`).
const MAX_LEVELS: usize = STACK_SIZE / (LANES - 1);

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
pub(super) fn splat3(v: glam::Vec3) -> Wide3 {
    [_mm256_set1_ps(v.x), _mm256_set1_ps(v.y), _mm256_set1_ps(v.z)]
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
fn cross(a: Wide3, b: Wide3) -> Wide3 {
    let minor = |i: usize, j: usize| _mm256_sub_ps(_mm256_mul_ps(a[i], b[j]), _mm256_mul_ps(b[i], a[j]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// A ray in all lanes.
pub(super) struct WideRay {
    origin: Wide3,
    direction: Wide3,
    reciprocal: Wide3,
    /// Per axis: whether the ray runs towards smaller coordinates, and so enters boxes at their upper side.
    backwards: [bool; 3],
    t_min: __m256,
    t_max: __m256,
}

impl WideRay {
    #[target_feature(enable = "avx2")]
    fn new(ray: &Ray) -> Self {
        let reciprocal = safe_reciprocal(ray.direction);
        Self {
            reciprocal: splat3(reciprocal),
            backwards: [reciprocal.x < 0.0, reciprocal.y < 0.0, reciprocal.z < 0.0],
            ..Self::for_triangles(ray)
        }
    }

    /// A ray that is not to meet boxes.
    #[target_feature(enable = "avx2")]
    pub(super) fn for_triangles(ray: &Ray) -> Self {
        Self {
            origin: splat3(ray.origin),
            direction: splat3(ray.direction),
            reciprocal: [_mm256_setzero_ps(); 3],
            backwards: [false; 3],
            t_min: _mm256_set1_ps(ray.t_min),
            t_max: _mm256_set1_ps(ray.t_max),
        }
    }

    /// Children whose boxes the ray crosses before `limit`, and where it enters them.
    #[target_feature(enable = "avx2")]
    fn enter(&self, node: &BvhNode, limit: __m256) -> (u32, __m256) {
        let mut entry = self.t_min;
        let mut exit = limit;
        for axis in 0..3 {
            let (first, second) = if self.backwards[axis] {
                (&node.upper[axis], &node.lower[axis])
            } else {
                (&node.lower[axis], &node.upper[axis])
            };
            let at = |side| _mm256_mul_ps(_mm256_sub_ps(load(side), self.origin[axis]), self.reciprocal[axis]);
            entry = _mm256_max_ps(entry, at(first));
            exit = _mm256_min_ps(exit, _mm256_mul_ps(at(second), _mm256_set1_ps(SLAB_SLACK)));
        }
        (_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32, entry)
    }

    /// Lanes of a block that the ray hits, with t, u and v; the arithmetic of `intersect_triangle`.
    #[target_feature(enable = "avx2")]
    pub(super) fn intersect(&self, block: &TriangleBlock, min_determinant: f32) -> (u32, [__m256; 3]) {
        let (edge1, edge2) = (load3(&block.edge1), load3(&block.edge2));
        let p = cross(self.direction, edge2);
        let determinant = dot(edge1, p);
        let magnitude = _mm256_andnot_ps(_mm256_set1_ps(-0.0), determinant);
        let mut hit = _mm256_cmp_ps::<_CMP_NLT_UQ>(magnitude, _mm256_set1_ps(min_determinant));
        let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), determinant);
        let to_origin = sub(self.origin, load3(&block.corner));
        let u = _mm256_mul_ps(dot(to_origin, p), inverse);
        let q = cross(to_origin, edge1);
        let v = _mm256_mul_ps(dot(self.direction, q), inverse);
        let t = _mm256_mul_ps(dot(edge2, q), inverse);
        let zero = _mm256_setzero_ps();
        for condition in [
            _mm256_cmp_ps::<_CMP_GE_OQ>(u, zero),
            _mm256_cmp_ps::<_CMP_GE_OQ>(v, zero),
            _mm256_cmp_ps::<_CMP_LE_OQ>(_mm256_add_ps(u, v), _mm256_set1_ps(1.0)),
            _mm256_cmp_ps::<_CMP_GT_OQ>(t, self.t_min),
            _mm256_cmp_ps::<_CMP_LT_OQ>(t, self.t_max),
        ] {
            hit = _mm256_and_ps(hit, condition);
        }
        (_mm256_movemask_ps(hit) as u32, [t, u, v])
    }
}

/// A stack of fixed size that costs nothing to make: clearing its memory would take longer than most traversals.
struct Stack<T: Copy, const SIZE: usize> {
    entries: [MaybeUninit<T>; SIZE],
    size: usize,
}

impl<T: Copy, const SIZE: usize> Stack<T, SIZE> {
    const fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; SIZE], size: 0 }
    }

    #[inline]
    fn push(&mut self, value: T) {
        self.entries[self.size] = MaybeUninit::new(value);
        self.size += 1;
    }

    #[inline]
    fn pop(&mut self) -> Option<T> {
        self.size = self.size.checked_sub(1)?;
        // SAFETY: every entry below the size was written by `push`.
        Some(unsafe { self.entries[self.size].assume_init() })
    }
}

/// Lanes set in a mask, lowest first.
pub(super) fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < 32).then_some(lane)
    })
}

/// Whether anything lies between the ray's ends.
#[target_feature(enable = "avx2")]
pub(super) fn any_hit(geometry: &Geometry<'_>, ray: &Ray, rules: Rules) -> bool {
    if geometry.nodes.is_empty() {
        return false;
    }
    let wide = WideRay::new(ray);
    // One entry per level: a node and those of its inner children that are still to be visited.
    let mut stack = Stack::<(u32, u32), MAX_LEVELS>::new();
    let mut index = 0_u32;
    loop {
        let node = &geometry.nodes[index as usize];
        let mut inner = 0;
        for lane in lanes(wide.enter(node, wide.t_max).0) {
            match ChildRef::unpack(node.child[lane]) {
                ChildRef::Node(_) => inner |= 1 << lane,
                leaf => {
                    if leaf_is_hit(geometry, leaf, &wide, ray, rules) {
                        return true;
                    }
                }
            }
        }
        if inner != 0 {
            stack.push((index, inner));
        }
        let Some((parent, pending)) = stack.pop() else { return false };
        let rest = pending & (pending - 1);
        if rest != 0 {
            stack.push((parent, rest));
        }
        index = geometry.nodes[parent as usize].child[pending.trailing_zeros() as usize];
    }
}

#[target_feature(enable = "avx2")]
fn leaf_is_hit(geometry: &Geometry<'_>, leaf: ChildRef, wide: &WideRay, ray: &Ray, rules: Rules) -> bool {
    match leaf {
        ChildRef::Node(_) => false,
        ChildRef::Triangles(i) => wide.intersect(&geometry.triangles[i as usize], min_determinant(rules)).0 != 0,
        ChildRef::Sphere(i) => intersect_sphere(&geometry.spheres[i as usize], ray, rules).is_some(),
        ChildRef::Square(i) => intersect_square(&geometry.squares[i as usize], ray).is_some(),
    }
}

/// The nearest hit between the ray's ends; of equal hits the first in file order.
#[target_feature(enable = "avx2")]
pub(super) fn closest_hit(geometry: &Geometry<'_>, ray: &Ray, rules: Rules) -> Hit {
    let mut best = Hit::none(ray.t_max);
    if geometry.nodes.is_empty() {
        return best;
    }
    let wide = WideRay::new(ray);
    let mut stack = Stack::<(u32, f32), STACK_SIZE>::new();
    stack.push((ChildRef::Node(0).pack(), ray.t_min));
    while let Some((child, entry)) = stack.pop() {
        if entry > best.t {
            continue;
        }
        match ChildRef::unpack(child) {
            ChildRef::Node(index) => {
                let node = &geometry.nodes[index as usize];
                let (mask, entries) = wide.enter(node, _mm256_set1_ps(best.t));
                let entries = store(entries);
                // Sorted, so that the nearest child ends on top of the stack.
                let mut sorted = [(0, 0.0); LANES];
                let mut count = 0;
                for lane in lanes(mask) {
                    let mut place = count;
                    while place > 0 && sorted[place - 1].1 < entries[lane] {
                        sorted[place] = sorted[place - 1];
                        place -= 1;
                    }
                    sorted[place] = (node.child[lane], entries[lane]);
                    count += 1;
                }
                sorted[..count].iter().for_each(|&child| stack.push(child));
            }
            ChildRef::Triangles(index) => {
                let block = &geometry.triangles[index as usize];
                let (mask, values) = wide.intersect(block, min_determinant(rules));
                if mask != 0 {
                    let [t, u, v] = [store(values[0]), store(values[1]), store(values[2])];
                    for lane in lanes(mask) {
                        best.take_nearer(Hit { t: t[lane], primitive: block.primitive[lane], u: u[lane], v: v[lane] });
                    }
                }
            }
            ChildRef::Sphere(i) => {
                if let Some(hit) = intersect_sphere(&geometry.spheres[i as usize], ray, rules) {
                    best.take_nearer(hit);
                }
            }
            ChildRef::Square(i) => {
                if let Some(hit) = intersect_square(&geometry.squares[i as usize], ray) {
                    best.take_nearer(hit);
                }
            }
        }
    }
    best
}
