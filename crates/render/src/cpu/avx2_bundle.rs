//! Eight rays that go much the same way, with AVX2. Twin of the plain traversal for each of them, same hits.
//!
//! The hierarchy is walked once for all: a node's eight boxes are tested against everything that lies between the rays,
//! by interval arithmetic (Boulos et al. 2007, "Packet-based Whitted and Distribution Ray Tracing"), and what remains
//! against each ray, eight at once, as are triangles. Rays that have come to be alone go on by themselves.

#![allow(unsafe_code)]

use super::avx2_packet::{Packet, meet, meet_any, sphere_from};
use super::avx2_trace::{
    Wide3, WideRay, any_hit, block, closest_hit, lanes, load, nearer_hit, other_hit, splat3, spread, store,
};
use super::avx2_watertight::{WideShear, hit_watertight};
use super::half_spaces::FEW;
use super::stack::Stack;
use super::tracer::Tracer;
use lightcuts_kernel::Rules;
use lightcuts_kernel::intersect::{Sphere, Square, min_determinant};
use lightcuts_kernel::ray::{END_SLACK, Hit, NONE, Ray};
use lightcuts_world::bvh::{BvhNode, ChildRef, Geometry, LANES, STACK_SIZE, TriangleBlock};
use std::arch::x86_64::{
    __m256, __m256i, _CMP_EQ_OQ, _CMP_LT_OQ, _mm256_and_ps, _mm256_blendv_ps, _mm256_castps_si256, _mm256_castsi256_ps,
    _mm256_cmp_ps, _mm256_cmpgt_epi32, _mm256_cvtss_f32, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_or_ps, _mm256_permute_ps, _mm256_permute2f128_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setzero_ps,
    _mm256_sub_ps,
};

/// So few rays are quicker alone.
pub(super) const ALONE: u32 = 2;

/// A bit for each ray of a packet.
pub(super) const ALL: u32 = 0xff;

/// Rays whose directions have the same signs, with the ranges of their numbers in all lanes.
/// `CORNERS` says that blocks hold these, else edges.
pub(super) struct Bundle<'a, const CORNERS: bool> {
    packet: &'a Packet,
    /// Of the rays that are asked for, and their origins and directions in the order of its axes.
    shear: WideShear,
    turned: [Wide3; 2],
    asked: u32,
    reciprocal: Wide3,
    /// Per axis 1 where the rays run towards smaller coordinates, else 0.
    backwards: [usize; 3],
    /// Of the origins, where boxes are entered and where they are left: what makes the interval widest.
    origin: [Wide3; 2],
    /// Least and greatest reciprocals.
    slope: [Wide3; 2],
    t_min: __m256,
}

/// The nearest hits so far.
struct Nearest {
    t: __m256,
    primitive: __m256i,
    u: __m256,
    v: __m256,
}

impl<'a, const CORNERS: bool> Bundle<'a, CORNERS> {
    /// `None` if the rays in `asked`, a bit each, go different ways, or if there are none.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    pub(super) fn new(packet: &'a Packet, reciprocal: Wide3, asked: u32) -> Option<Self> {
        if asked == 0 {
            return None;
        }
        let mut backwards = [0; 3];
        for axis in 0..3 {
            let signs = _mm256_movemask_ps(reciprocal[axis]) as u32 & asked;
            if signs != 0 && signs != asked {
                return None;
            }
            backwards[axis] = usize::from(signs != 0);
        }
        let (shear, turned) = if CORNERS {
            let shear = WideShear::of_some(&packet.direction, asked);
            (shear, [shear.turned(&packet.origin), shear.turned(&packet.direction)])
        } else {
            (WideShear::none(), [packet.origin, packet.direction])
        };
        let zero = _mm256_setzero_ps();
        let (mut origin, mut slope) = ([[zero; 3]; 2], [[zero; 3]; 2]);
        for axis in 0..3 {
            let (least, greatest) = range(packet.origin[axis], asked);
            // A side is farthest behind where the origin is farthest ahead.
            let [entering, leaving] = if backwards[axis] == 1 { [least, greatest] } else { [greatest, least] };
            (origin[0][axis], origin[1][axis]) = (entering, leaving);
            (slope[0][axis], slope[1][axis]) = range(reciprocal[axis], asked);
        }
        let t_min = range(packet.t_min, asked).0;
        Some(Self { packet, shear, turned, asked, reciprocal, backwards, origin, slope, t_min })
    }

    /// The triangle of a lane: rays that hit it, with t, u and v; with corners only of those that were asked for. With `ANY`
    /// only the rays count: the other values may be missing.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn intersect<const ANY: bool>(&self, block: &TriangleBlock, lane: usize, least: f32) -> (__m256, [__m256; 3]) {
        if !CORNERS {
            return self.packet.intersect(block, lane, least);
        }
        let splat = |of: &[[f32; LANES]; 3]| self.shear.splat_lane(of, lane);
        let corners = [splat(&block.a), splat(&block.b), splat(&block.c)];
        let (rays, ends) = ((self.turned[0], self.turned[1]), (self.packet.t_min, self.packet.t_max));
        let (hit, values) = hit_watertight::<ANY>(rays, &self.shear, ends, &corners);
        (_mm256_and_ps(hit, spread(self.asked)), values)
    }

    /// Children that any of the rays may cross before `limit`, and the earliest that one may enter them.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn enter(&self, node: &BvhNode, limit: __m256) -> (u32, __m256) {
        let side = |far: usize, axis: usize| {
            _mm256_sub_ps(load(&node.bounds[(self.backwards[axis] & 1) ^ far][axis]), self.origin[far][axis])
        };
        let (near, far) = ([side(0, 0), side(0, 1), side(0, 2)], [side(1, 0), side(1, 1), side(1, 2)]);
        meet_any((near, far), self.slope, self.t_min, limit)
    }

    /// Rays that cross a child's box before `limit`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn meet(&self, node: &BvhNode, lane: usize, limit: __m256) -> u32 {
        let (lower, upper) = node.child_box(lane);
        meet(self.packet.origin, self.reciprocal, self.packet.t_min, limit, (splat3(lower), splat3(upper)))
    }

    /// Which of the rays in `asked` hit a triangle. Never inlined: rays that are no bundle would pay for its stack.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline(never)]
    pub(super) fn any_hits(&self, geometry: &Geometry<'_>, rules: Rules, asked: u32) -> u32 {
        let limit = range(self.packet.t_max, asked).1;
        let least = min_determinant(rules);
        // Nodes, each with the rays that enter it.
        let mut stack = Stack::<(u32, u32), STACK_SIZE>::new();
        let mut open = asked;
        let mut next = Some((0, asked));
        while let Some((index, entering)) = next {
            let active = entering & open;
            if active.count_ones() <= ALONE {
                let is_hit = |&lane: &usize| any_hit::<false, CORNERS>(geometry, &self.packet.ray(lane), rules, index);
                open &= !lanes(active).filter(is_hit).fold(0, |hits, lane| hits | 1 << lane);
            } else {
                let node = &geometry.nodes[index as usize];
                for lane in lanes(self.enter(node, limit).0 & !node.others) {
                    let mut active = self.meet(node, lane, self.packet.t_max) & active & open;
                    if node.triangles >> lane & 1 == 0 {
                        stack.push_if((node.child[lane], active), active != 0);
                        continue;
                    }
                    let block = block(geometry, node, lane);
                    // Each ray with all triangles or each triangle with all rays, whichever is less often.
                    let count = block.primitive.iter().filter(|&&primitive| primitive != NONE).count();
                    if (active.count_ones() as usize) < count {
                        let is_hit = |&lane: &usize| {
                            WideRay::<CORNERS>::new(&self.packet.ray(lane)).intersect::<true>(block, least).0 != 0
                        };
                        open &= !lanes(active).filter(is_hit).fold(0, |hits, lane| hits | 1 << lane);
                        continue;
                    }
                    for lane in 0..count {
                        if active == 0 {
                            break;
                        }
                        let hit = _mm256_movemask_ps(self.intersect::<true>(block, lane, least).0) as u32 & active;
                        active &= !hit;
                        open &= !hit;
                    }
                }
            }
            next = if open == 0 { None } else { stack.pop() };
        }
        asked & !open
    }

    /// The nearest of the best hits so far and those of the rays in `asked`; `rays` are all of them. `OTHERS` says
    /// whether spheres and squares count.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn closest_hits<const OTHERS: bool>(
        &self,
        (geometry, rules): (&Geometry<'_>, Rules),
        rays: &[Ray; LANES],
        asked: u32,
        mut best: Nearest,
    ) -> [Hit; LANES] {
        let mut limit = range(best.t, ALL).1;
        // Nodes, each with the rays that enter it and where the first does.
        let mut stack = Stack::<(u32, u32, f32), STACK_SIZE>::new();
        let mut next = (!geometry.nodes.is_empty()).then_some((0, asked, 0.0));
        while let Some((index, active, entry)) = next {
            if entry > _mm256_cvtss_f32(limit) * END_SLACK {
                // Everything that could be hit there lies behind.
            } else if active.count_ones() <= ALONE {
                let mut hits = best.hits();
                for lane in lanes(active) {
                    hits[lane] = nearer_hit::<CORNERS>(geometry, &rays[lane], rules, index, hits[lane]);
                }
                best = Nearest::new(&hits);
                limit = range(best.t, ALL).1;
            } else {
                let node = &geometry.nodes[index as usize];
                let (mask, entry) = self.enter(node, limit);
                let (leaves, entries, base) = (node.triangles | node.others, store(entry), stack.size);
                for lane in lanes(mask & if OTHERS { leaves } else { node.triangles }) {
                    if self.meet(node, lane, best.t) != 0 {
                        self.meet_leaf(geometry, rules, rays, node.child[lane], &mut best);
                    }
                }
                limit = range(best.t, ALL).1;
                for lane in lanes(mask & !leaves) {
                    let active = self.meet(node, lane, best.t) & active;
                    if active != 0 {
                        stack.insert(base, (node.child[lane], active, entries[lane]), |above| above.2 < entries[lane]);
                    }
                }
            }
            next = stack.pop();
        }
        best.hits()
    }

    /// Takes the hits of a leaf that are nearer.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn meet_leaf(&self, geometry: &Geometry<'_>, rules: Rules, rays: &[Ray; LANES], leaf: u32, best: &mut Nearest) {
        let zero = _mm256_setzero_ps();
        match ChildRef::unpack(leaf) {
            ChildRef::Node(_) => {}
            ChildRef::Triangles(index) => {
                let block = &geometry.triangles[index as usize];
                for lane in (0..LANES).take_while(|&lane| block.primitive[lane] != NONE) {
                    let (hit, values) = self.intersect::<false>(block, lane, min_determinant(rules));
                    best.take_nearer(hit, values, block.primitive[lane]);
                }
            }
            ChildRef::Square(index) => best.take_square(self.packet, &geometry.squares[index as usize]),
            ChildRef::Sphere(index) => {
                let hits = rays.map(|ray| other_hit(geometry, leaf, &ray, rules));
                let t = load(&hits.map(|hit| hit.map_or(f32::NAN, |hit| hit.t)));
                let hit = _mm256_cmp_ps::<_CMP_EQ_OQ>(t, t);
                best.take_nearer(hit, [t, zero, zero], geometry.spheres[index as usize].primitive);
            }
        }
    }
}

impl Nearest {
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn none(packet: &Packet) -> Self {
        let zero = _mm256_setzero_ps();
        Self { t: packet.t_max, primitive: _mm256_set1_epi32(NONE as i32), u: zero, v: zero }
    }

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn take_square(&mut self, packet: &Packet, square: &Square) {
        let zero = _mm256_setzero_ps();
        let (hit, t) = packet.meet_square(square);
        self.take_nearer(hit, [t, zero, zero], square.primitive);
    }

    /// For rays outside.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn take_sphere(&mut self, packet: &Packet, sphere: &Sphere, rules: Rules) {
        let zero = _mm256_setzero_ps();
        let (hit, t) = packet.meet_sphere(sphere, sphere_from(sphere, packet.origin), rules);
        self.take_nearer(hit, [t, zero, zero], sphere.primitive);
    }

    /// Twin of `Hit::take_nearer` in the lanes of `hit`.
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    #[inline]
    fn take_nearer(&mut self, hit: __m256, [t, u, v]: [__m256; 3], primitive: u32) {
        // A hit lies before the ray's end, so that the number of no primitive, negative here, is never compared.
        let primitive = _mm256_set1_epi32(primitive as i32);
        let is_first = _mm256_castsi256_ps(_mm256_cmpgt_epi32(self.primitive, primitive));
        let is_equal = _mm256_and_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(t, self.t), is_first);
        let is_nearer = _mm256_or_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(t, self.t), is_equal);
        let taken = _mm256_and_ps(hit, is_nearer);
        let take = |old: __m256, new: __m256| _mm256_blendv_ps(old, new, taken);
        (self.t, self.u, self.v) = (take(self.t, t), take(self.u, u), take(self.v, v));
        let number = take(_mm256_castsi256_ps(self.primitive), _mm256_castsi256_ps(primitive));
        self.primitive = _mm256_castps_si256(number);
    }

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn new(hits: &[Hit; LANES]) -> Self {
        let primitive = load(&hits.map(|hit| f32::from_bits(hit.primitive)));
        let [t, u, v] = [load(&hits.map(|hit| hit.t)), load(&hits.map(|hit| hit.u)), load(&hits.map(|hit| hit.v))];
        Self { t, primitive: _mm256_castps_si256(primitive), u, v }
    }

    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn hits(&self) -> [Hit; LANES] {
        let (t, u, v) = (store(self.t), store(self.u), store(self.v));
        let primitive = store(_mm256_castsi256_ps(self.primitive)).map(f32::to_bits);
        std::array::from_fn(|lane| Hit { t: t[lane], primitive: primitive[lane], u: u[lane], v: v[lane] })
    }
}

/// Twin of `Tracer::closest8`.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn closest_hits<const CORNERS: bool>(tracer: &Tracer<'_>, rays: &[Ray; LANES]) -> [Hit; LANES] {
    let Tracer { geometry, rules, .. } = tracer;
    let packet = Packet::new(rays);
    let mut best = Nearest::none(&packet);
    let reciprocal = packet.reciprocal();
    if geometry.spheres.len() > FEW || geometry.squares.len() > FEW || rays.iter().any(|ray| ray.inside) {
        return match Bundle::<CORNERS>::new(&packet, reciprocal, ALL) {
            Some(bundle) => bundle.closest_hits::<true>((geometry, *rules), rays, ALL, best),
            None => rays.map(|ray| closest_hit::<CORNERS>(geometry, &ray, *rules)),
        };
    }
    geometry.squares.iter().for_each(|square| best.take_square(&packet, square));
    geometry.spheres.iter().for_each(|sphere| best.take_sphere(&packet, sphere, *rules));
    let (lower, upper) = tracer.mesh;
    let near = meet(packet.origin, reciprocal, packet.t_min, best.t, (splat3(lower), splat3(upper)));
    if geometry.triangles.is_empty() || near == 0 {
        return best.hits();
    }
    if let Some(bundle) = Bundle::<CORNERS>::new(&packet, reciprocal, near) {
        return bundle.closest_hits::<false>((geometry, *rules), rays, near, best);
    }
    let mut hits = best.hits();
    for lane in lanes(near) {
        hits[lane] = nearer_hit::<CORNERS>(geometry, &rays[lane], *rules, 0, hits[lane]);
    }
    hits
}

/// Least and greatest value of some lanes, each in all lanes; `asked` has a bit for each. What is no number does not
/// count.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
#[inline]
fn range(values: __m256, asked: u32) -> (__m256, __m256) {
    let counts = spread(asked);
    let of_asked = |none: f32| _mm256_blendv_ps(_mm256_set1_ps(none), values, counts);
    // The second one of both operands is the result where either is no number.
    let least = _mm256_min_ps(of_asked(f32::INFINITY), _mm256_set1_ps(f32::INFINITY));
    let greatest = _mm256_max_ps(of_asked(f32::NEG_INFINITY), _mm256_set1_ps(f32::NEG_INFINITY));
    let least = _mm256_min_ps(least, _mm256_permute2f128_ps::<1>(least, least));
    let least = _mm256_min_ps(least, _mm256_permute_ps::<0b0100_1110>(least));
    let least = _mm256_min_ps(least, _mm256_permute_ps::<0b1011_0001>(least));
    let greatest = _mm256_max_ps(greatest, _mm256_permute2f128_ps::<1>(greatest, greatest));
    let greatest = _mm256_max_ps(greatest, _mm256_permute_ps::<0b0100_1110>(greatest));
    let greatest = _mm256_max_ps(greatest, _mm256_permute_ps::<0b1011_0001>(greatest));
    (least, greatest)
}
