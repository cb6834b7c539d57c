//! Eight shadow rays from one point at a time. Twin of `lightcuts_world::bvh::any_hit` for each of them, same answers.
//!
//! Shadow rays to the VPLs of one block start together and end near each other, so they cross much the same boxes; what
//! depends only on the origin is computed once for all eight.

#![allow(unsafe_code)]

use super::avx2_trace::{Wide3, WideRay, dot, lanes, splat3, store};
use super::gather::PacketStack;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::{Sphere, Square, min_determinant};
use lightcuts_kernel::ray::{ORIGINAL_EPSILON, Ray, SLAB_SLACK};
use lightcuts_world::bvh::{BvhNode, ChildRef, Geometry, LANES};
use std::arch::x86_64::{
    __m256, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_NEQ_OQ, _mm256_add_ps, _mm256_and_ps,
    _mm256_andnot_ps, _mm256_blendv_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_mul_ps, _mm256_or_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_sqrt_ps, _mm256_sub_ps, _mm256_xor_ps,
};

/// Rays from one point.
pub(super) struct Packet {
    pub(super) origin: Vec3,
    pub(super) directions: Wide3,
    pub(super) t_min: __m256,
    pub(super) t_max: __m256,
}

/// Which of the packet's rays in `asked` (a bit each) hit anything between their ends.
#[target_feature(enable = "avx2")]
pub(super) fn any_hits(
    geometry: &Geometry<'_>,
    packet: &Packet,
    asked: u32,
    rules: Rules,
    stack: &mut PacketStack,
) -> u32 {
    if geometry.nodes.is_empty() {
        return 0;
    }
    let reciprocal = packet.directions.map(|c| safe_reciprocal(c));
    let mut open = asked;
    stack.clear();
    stack.push((ChildRef::Node(0).pack(), asked));
    while let Some((child, entering)) = stack.pop() {
        let active = entering & open;
        if active == 0 {
            continue;
        }
        match ChildRef::unpack(child) {
            ChildRef::Node(index) => {
                packet.enter(&reciprocal, &geometry.nodes[index as usize], active, stack);
                continue;
            }
            ChildRef::Triangles(index) => {
                let [x, y, z] = packet.directions.map(|c| store(c));
                let (t_min, t_max) = (store(packet.t_min), store(packet.t_max));
                for lane in lanes(active) {
                    let direction = Vec3::new(x[lane], y[lane], z[lane]);
                    let ray =
                        Ray { origin: packet.origin, direction, t_min: t_min[lane], t_max: t_max[lane], inside: false };
                    let wide = WideRay::for_triangles(&ray);
                    if wide.intersect(&geometry.triangles[index as usize], min_determinant(rules)).0 != 0 {
                        open &= !(1 << lane);
                    }
                }
            }
            ChildRef::Sphere(index) => open &= !(packet.hits_sphere(&geometry.spheres[index as usize], rules) & active),
            ChildRef::Square(index) => open &= !(packet.hits_square(&geometry.squares[index as usize]) & active),
        }
        if open == 0 {
            break;
        }
    }
    asked & !open
}

/// Twin of `kernel::ray::safe_reciprocal`.
#[target_feature(enable = "avx2")]
fn safe_reciprocal(c: __m256) -> __m256 {
    let sign_bit = _mm256_set1_ps(-0.0);
    let tiny = _mm256_set1_ps(1e-20);
    let signed_tiny = _mm256_or_ps(tiny, _mm256_and_ps(sign_bit, c));
    let is_small = _mm256_cmp_ps::<_CMP_LT_OQ>(_mm256_andnot_ps(sign_bit, c), tiny);
    _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_blendv_ps(c, signed_tiny, is_small))
}

impl Packet {
    /// Pushes the children that any active ray enters, with the rays that do.
    #[target_feature(enable = "avx2")]
    fn enter(&self, reciprocal: &Wide3, node: &BvhNode, active: u32, stack: &mut PacketStack) {
        for child in 0..LANES {
            // Children stand in front; the first empty one ends the node.
            if node.child[child] == u32::MAX {
                break;
            }
            let (mut entry, mut exit) = (self.t_min, self.t_max);
            for (axis, &reciprocal) in reciprocal.iter().enumerate() {
                let at = |side: f32| _mm256_mul_ps(_mm256_set1_ps(side - self.origin[axis]), reciprocal);
                let (a, b) = (at(node.lower[axis][child]), at(node.upper[axis][child]));
                entry = _mm256_max_ps(entry, _mm256_min_ps(a, b));
                exit = _mm256_min_ps(exit, _mm256_mul_ps(_mm256_max_ps(a, b), _mm256_set1_ps(SLAB_SLACK)));
            }
            let entering = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, exit)) as u32 & active;
            if entering != 0 {
                stack.push((node.child[child], entering));
            }
        }
    }

    /// Lanes with `t` between their ends.
    #[target_feature(enable = "avx2")]
    fn between_ends(&self, t: __m256) -> __m256 {
        _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(t, self.t_min), _mm256_cmp_ps::<_CMP_LT_OQ>(t, self.t_max))
    }

    /// Twin of `intersect_square`.
    #[target_feature(enable = "avx2")]
    fn hits_square(&self, square: &Square) -> u32 {
        let slope = dot(self.directions, splat3(square.normal));
        let height = _mm256_set1_ps((square.center - self.origin).dot(square.normal));
        let t = _mm256_div_ps(height, slope);
        let mut hit = _mm256_and_ps(self.between_ends(t), _mm256_cmp_ps::<_CMP_NEQ_OQ>(slope, _mm256_setzero_ps()));
        if _mm256_movemask_ps(hit) == 0 {
            return 0;
        }
        let (origin, center) = (splat3(self.origin), splat3(square.center));
        let offset_on = |axis: usize| {
            let point = _mm256_add_ps(origin[axis], _mm256_mul_ps(self.directions[axis], t));
            _mm256_sub_ps(point, center[axis])
        };
        let offset = [offset_on(0), offset_on(1), offset_on(2)];
        for (direction, half) in [(square.along, square.half_height), (square.across, square.half_width)] {
            let distance = _mm256_andnot_ps(_mm256_set1_ps(-0.0), dot(offset, splat3(direction)));
            hit = _mm256_and_ps(hit, _mm256_cmp_ps::<_CMP_LE_OQ>(distance, _mm256_set1_ps(half)));
        }
        _mm256_movemask_ps(hit) as u32
    }

    /// Twin of `intersect_sphere` for rays outside.
    #[target_feature(enable = "avx2")]
    fn hits_sphere(&self, sphere: &Sphere, rules: Rules) -> u32 {
        let offset = self.origin - sphere.center;
        let c = offset.dot(offset) - sphere.radius * sphere.radius;
        let hit = match rules {
            Rules::Original => self.sphere_original(offset, c),
            Rules::Repaired => self.sphere_repaired(offset, c, sphere.radius),
        };
        _mm256_movemask_ps(hit) as u32
    }

    #[target_feature(enable = "avx2")]
    fn sphere_original(&self, offset: Vec3, c: f32) -> __m256 {
        let zero = _mm256_setzero_ps();
        let two = _mm256_set1_ps(2.0);
        let a = dot(self.directions, self.directions);
        let b = _mm256_mul_ps(two, dot(self.directions, splat3(offset)));
        let product = _mm256_mul_ps(_mm256_mul_ps(_mm256_set1_ps(4.0), a), _mm256_set1_ps(c));
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

    #[target_feature(enable = "avx2")]
    fn sphere_repaired(&self, offset: Vec3, c: f32, radius: f32) -> __m256 {
        let zero = _mm256_setzero_ps();
        let sign_bit = _mm256_set1_ps(-0.0);
        let a = dot(self.directions, self.directions);
        // A negated dot product keeps its zero's sign in the plain version.
        let half_b = _mm256_xor_ps(sign_bit, dot(splat3(offset), self.directions));
        let along = _mm256_div_ps(half_b, a);
        let offsets = splat3(offset);
        let nearest_on = |axis: usize| _mm256_add_ps(offsets[axis], _mm256_mul_ps(self.directions[axis], along));
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
        let first = _mm256_and_ps(is_nonzero, _mm256_div_ps(_mm256_set1_ps(c), q));
        let second = _mm256_and_ps(is_nonzero, _mm256_div_ps(q, a));
        let (near, far) = (_mm256_min_ps(first, second), _mm256_max_ps(first, second));
        let t = _mm256_blendv_ps(far, near, _mm256_cmp_ps::<_CMP_GT_OQ>(near, self.t_min));
        _mm256_and_ps(real, self.between_ends(t))
    }
}
