//! Packets of rays that end at one point, such as those of many neighbours to one VPL, with AVX2. Twin of the plain traversal for
//! each of the rays, same answers.
//!
//! The hierarchy is walked once for all packets, from the point X where they end: seen from there all rays begin at one place, and
//! their directions lie in a box. So a node's eight boxes are tested against all rays at once, a leaf's box against all packets at
//! once, and eight triangles against all rays: with a triangle's corner A and edges e1 and e2 the determinant and the numerators of
//! u, v and 1 - u - v (Moeller and Trumbore 1997) are linear in the ray's direction d: d.(e2 x e1), d.(e2 x (X - A)),
//! d.((X - A) x e1) and what these leave of the first. Over a box of directions their greatest values are those at its middle and
//! what its half extents add; where one of the last three has the other sign than the determinant for all directions, no ray hits.
//! The few triangles that are left meet each ray, eight at once.

#![allow(unsafe_code)]

use super::avx2_bundle::{ALL, ALONE};
use super::avx2_packet::{Packet, meet, meet_any, safe_reciprocal};
use super::avx2_trace::{Wide3, any_hit, block, cross, dot, lanes, load, load3, splat3, spread, sub};
use super::stack::Stack;
use super::tracer::Tracer;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::min_determinant;
use lightcuts_kernel::ray::{NONE, Ray};
use lightcuts_world::bvh::{Geometry, LANES, STACK_SIZE, TriangleBlock};
use std::arch::x86_64::{
    __m256, _CMP_GT_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_blendv_ps, _mm256_cmp_ps,
    _mm256_cvtss_f32, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_or_ps, _mm256_permute_ps,
    _mm256_permute2f128_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_shuffle_ps, _mm256_sub_ps, _mm256_unpackhi_ps,
    _mm256_unpacklo_ps, _mm256_xor_ps,
};

/// Packets that make up a fan at most, eight bits each in masks of its rays.
pub(super) const PACKETS: usize = u32::BITS as usize / LANES;

/// What a numerator may be off by in single precision, as a share of how large the products are that it is the difference of: with
/// u half an epsilon, less than 100 u in `intersect_triangle` and here together, the rounding of the rays' ends included.
const ROUNDING: f32 = 64.0 * f32::EPSILON;

/// A packet with the reciprocals of its directions.
type Asked = (Packet, Wide3);

/// Rays to one point whose directions have the same signs.
struct Fan<'a> {
    packets: &'a [Asked],
    end: Wide3,
    /// Per axis 1 where the rays come from smaller coordinates, and so boxes are entered, seen from the end, at their upper side;
    /// else 0.
    backwards: [usize; 3],
    /// Least and greatest component of the directions: of each packet in the lane of its number, and again four lanes further on.
    directions: [Wide3; 2],
    /// Least and greatest reciprocals of the directions seen from the end: of each packet, and of all rays in all lanes.
    slopes: [Wide3; 2],
    slope: [Wide3; 2],
    /// Greatest sum of a direction's components, and of those of it, an origin and a corner.
    length: f32,
    size: f32,
}

/// Of up to [`PACKETS`] packets, each with rays that are asked for, those that hit no triangle, eight bits each. All rays end, at
/// t = 1, at one point.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn miss_mesh(tracer: &Tracer<'_>, packets: &[(Packet, u32)]) -> u32 {
    let (mut open, mut near) = (0, 0);
    let (lower, upper) = (splat3(tracer.mesh.0), splat3(tracer.mesh.1));
    let mut all = Stack::<Asked, PACKETS>::new();
    for (number, (packet, asked)) in packets.iter().enumerate() {
        let reciprocal = packet.reciprocal();
        all.push((*packet, reciprocal));
        let met = meet(packet.origin, reciprocal, packet.t_min, packet.t_max, (lower, upper));
        open |= asked << (LANES * number);
        near |= (met & asked) << (LANES * number);
    }
    while near != 0 {
        let (fan, same) = Fan::new(all.as_slice(), near, tracer.mesh);
        open &= !fan.any_hits(&tracer.geometry, tracer.rules, same);
        near &= !same;
    }
    open
}

impl<'a> Fan<'a> {
    /// Of the rays in `asked`, a bit each, those that go the way of the first one; and which these are. `asked` is not 0. The box is
    /// around all triangles.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn new(packets: &'a [Asked], asked: u32, (lower, upper): (Vec3, Vec3)) -> (Self, u32) {
        let first = asked.trailing_zeros() as usize;
        let (mut same, mut backwards) = (asked, [0; 3]);
        for (axis, backwards) in backwards.iter_mut().enumerate() {
            let mut signs = 0;
            for (number, (packet, _)) in packets.iter().enumerate() {
                signs |= (_mm256_movemask_ps(packet.direction[axis]) as u32) << (LANES * number);
            }
            let is_negative = signs >> first & 1 == 1;
            *backwards = usize::from(!is_negative);
            same &= if is_negative { signs } else { !signs };
        }
        let any = packets[first / LANES].0.ray(first % LANES);
        let end = any.origin + any.direction;
        let zero = [_mm256_setzero_ps(); 3];
        let mut fan = Self {
            packets,
            end: splat3(end),
            backwards,
            directions: [zero; 2],
            slopes: [zero; 2],
            slope: [zero; 2],
            length: 0.0,
            size: 0.0,
        };
        let mut longest = Vec3::ZERO;
        for axis in 0..3 {
            let (mut least, mut greatest) =
                ([_mm256_set1_ps(f32::INFINITY); PACKETS], [_mm256_set1_ps(f32::NEG_INFINITY); PACKETS]);
            for (number, (packet, _)) in packets.iter().enumerate() {
                let counts = spread(same >> (LANES * number) & ALL);
                least[number] = _mm256_blendv_ps(least[number], packet.direction[axis], counts);
                greatest[number] = _mm256_blendv_ps(greatest[number], packet.direction[axis], counts);
            }
            let (least, greatest) = (least_of_each(least), greatest_of_each(greatest));
            (fan.directions[0][axis], fan.directions[1][axis]) = (least, greatest);
            (fan.slopes[0][axis], fan.slopes[1][axis]) = slopes(least, greatest);
            let (least, greatest) = (least_of_four(least), greatest_of_four(greatest));
            (fan.slope[0][axis], fan.slope[1][axis]) = slopes(least, greatest);
            longest[axis] = _mm256_cvtss_f32(least).abs().max(_mm256_cvtss_f32(greatest).abs());
        }
        fan.length = longest.element_sum();
        // Every origin is the end less a direction.
        fan.size = 3.0 * fan.length + (end.abs() + lower.abs().max(upper.abs())).element_sum();
        (fan, same)
    }

    /// Which of the rays in `asked`, which are those of the fan, hit a triangle.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn any_hits(&self, geometry: &Geometry<'_>, rules: Rules, asked: u32) -> u32 {
        let least = min_determinant(rules);
        let mut stack = Stack::<u32, STACK_SIZE>::new();
        let mut open = asked;
        let mut next = Some(0);
        while let Some(index) = next {
            if open.count_ones() <= ALONE {
                let is_hit = |&bit: &usize| any_hit::<false, false>(geometry, &self.ray(bit), rules, index);
                open &= !lanes(open).filter(is_hit).fold(0, |hits, bit| hits | 1 << bit);
            } else {
                let node = &geometry.nodes[index as usize];
                let side = |far: usize, axis: usize| load(&node.bounds[(self.backwards[axis] & 1) ^ far][axis]);
                let entered = self.met(self.slope, side) & !node.others;
                for lane in lanes(entered & !node.triangles) {
                    stack.push(node.child[lane]);
                }
                for lane in lanes(entered & node.triangles) {
                    open &= !self.hits_leaf(block(geometry, node, lane), node.child_box(lane), least, open);
                }
            }
            next = if open == 0 { None } else { stack.pop() };
        }
        asked & !open
    }

    /// Which of the rays in `open` hit a triangle of a leaf.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn hits_leaf(&self, block: &TriangleBlock, (lower, upper): (Vec3, Vec3), least: f32, open: u32) -> u32 {
        let sides = [lower, upper];
        let side = |far: usize, axis: usize| _mm256_set1_ps(sides[(self.backwards[axis] & 1) ^ far][axis]);
        let near = self.met(self.slopes, side) & ((1 << self.packets.len()) - 1);
        if near == 0 {
            return 0;
        }
        let triangles = self.may_hit(near, block, (upper - lower).element_sum());
        let mut hits = 0;
        for number in lanes(near) {
            let (packet, reciprocal) = &self.packets[number];
            let mut left = open >> (LANES * number) & ALL;
            left &= meet(packet.origin, *reciprocal, packet.t_min, packet.t_max, (splat3(lower), splat3(upper)));
            for lane in lanes(triangles) {
                if left == 0 {
                    break;
                }
                let hit = _mm256_movemask_ps(packet.intersect(block, lane, least).0) as u32 & left;
                left &= !hit;
                hits |= hit << (LANES * number);
            }
        }
        hits
    }

    /// Lanes whose box, the near side of an axis or the far one, is met by rays whose reciprocals, seen from the end, are in a range.
    /// The rounding of the end and of what is computed from it moves a side by less than 12 u of the largest coordinate; boxes are
    /// padded by more (`PADDING` in `lightcuts_world`).
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn met(&self, slopes: [Wide3; 2], side: impl Fn(usize, usize) -> __m256) -> u32 {
        let side = |far: usize, axis: usize| _mm256_sub_ps(side(far, axis), self.end[axis]);
        let (near, far) = ([side(0, 0), side(0, 1), side(0, 2)], [side(1, 0), side(1, 1), side(1, 2)]);
        meet_any((near, far), slopes, _mm256_setzero_ps(), _mm256_set1_ps(1.0)).0
    }

    /// Triangles of a block that rays of some packets, a bit each, may hit. `extent` is the sum of the extents of a box around them.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn may_hit(&self, packets: u32, block: &TriangleBlock, extent: f32) -> u32 {
        let (zero, sign_bit) = (_mm256_setzero_ps(), _mm256_set1_ps(-0.0));
        let counts = spread(packets | packets << PACKETS);
        let (mut middle, mut half) = ([zero; 3], [zero; 3]);
        for axis in 0..3 {
            let [least, greatest] = [self.directions[0][axis], self.directions[1][axis]];
            let least = least_of_four(_mm256_blendv_ps(_mm256_set1_ps(f32::INFINITY), least, counts));
            let greatest = greatest_of_four(_mm256_blendv_ps(_mm256_set1_ps(f32::NEG_INFINITY), greatest, counts));
            middle[axis] = _mm256_mul_ps(_mm256_add_ps(least, greatest), _mm256_set1_ps(0.5));
            half[axis] = _mm256_mul_ps(_mm256_sub_ps(greatest, least), _mm256_set1_ps(0.5));
        }
        // By how much a product with a direction may differ from that with the middle one.
        let spread = |[x, y, z]: Wide3| {
            let magnitude = |c: __m256| _mm256_andnot_ps(sign_bit, c);
            dot(half, [magnitude(x), magnitude(y), magnitude(z)])
        };
        let (edge1, edge2) = (load3(&block.b), load3(&block.c));
        let to_end = sub(self.end, load3(&block.a));
        let (determinant, u, v) = (cross(edge2, edge1), cross(edge2, to_end), cross(to_end, edge1));
        let w = sub(sub(determinant, u), v);
        let margin = ROUNDING * self.length * extent;
        let at_middle = dot(middle, determinant);
        let away = _mm256_add_ps(spread(determinant), _mm256_set1_ps(margin * extent));
        let has_sign = _mm256_cmp_ps::<_CMP_GT_OQ>(_mm256_andnot_ps(sign_bit, at_middle), away);
        let sign = _mm256_and_ps(sign_bit, at_middle);
        let margin = _mm256_set1_ps(margin * self.size);
        let is_beyond = |of: Wide3| {
            let greatest = _mm256_add_ps(_mm256_xor_ps(dot(middle, of), sign), spread(of));
            _mm256_cmp_ps::<_CMP_LT_OQ>(_mm256_add_ps(greatest, margin), zero)
        };
        let missed = _mm256_or_ps(is_beyond(u), _mm256_or_ps(is_beyond(v), is_beyond(w)));
        let missed = _mm256_movemask_ps(_mm256_and_ps(missed, has_sign)) as u32;
        let count = block.primitive.iter().filter(|&&primitive| primitive != NONE).count();
        ((1 << count) - 1) & !missed
    }

    /// A ray by its bit.
    fn ray(&self, bit: usize) -> Ray {
        self.packets[bit / LANES].0.ray(bit % LANES)
    }
}

/// The range of the reciprocals of directions in a range, turned round. All have the same sign.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn slopes(least: __m256, greatest: __m256) -> (__m256, __m256) {
    let turned = |c: __m256| _mm256_xor_ps(safe_reciprocal(c), _mm256_set1_ps(-0.0));
    (turned(least), turned(greatest))
}

/// What a function of two makes of the lanes of each of four: in the lane of its number, and again four lanes further on.
macro_rules! of_each {
    ($name:ident, $four:ident, $of_two:ident, $what:literal) => {
        #[doc = concat!("The ", $what, " lane of each of four vectors: in the lane of its number, and again four lanes further on.")]
        #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
        #[inline]
        fn $name([a, b, c, d]: [__m256; PACKETS]) -> __m256 {
            let ab = $of_two(_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let cd = $of_two(_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            let halves = $of_two(
                _mm256_shuffle_ps::<0b01_00_01_00>(ab, cd),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab, cd),
            );
            $of_two(halves, _mm256_permute2f128_ps::<1>(halves, halves))
        }

        #[doc = concat!("The ", $what, " of the first four lanes, which the others repeat, in all lanes.")]
        #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
        #[inline]
        fn $four(values: __m256) -> __m256 {
            let values = $of_two(values, _mm256_permute_ps::<0b01_00_11_10>(values));
            $of_two(values, _mm256_permute_ps::<0b10_11_00_01>(values))
        }
    };
}

of_each!(least_of_each, least_of_four, _mm256_min_ps, "least");
of_each!(greatest_of_each, greatest_of_four, _mm256_max_ps, "greatest");
