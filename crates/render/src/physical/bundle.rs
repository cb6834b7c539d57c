//! Station 5 for eight points at once: the light of all virtual lights, or of one cut that is fine enough for each of the points.
//!
//! Points of neighbouring pixels need much the same cut, and rays from them to one light go much the same way. So a cluster is
//! bounded for all of them at once, and opened where the bound is too much for any.

use super::cluster_tree::ClusterTree;
use super::gather::{Gathered, Receiver, representative_of};
use super::pass::Counts;
use crate::cpu::{Lanes, Plain, RayLanes, Simd};
use glam::Vec3;
use lightcuts_kernel::bsdf::LAMBERT;
use lightcuts_kernel::cluster::{BOUND_MARGIN, ClusterNode, LIGHT_CHILD, light_power, reach_bound};
use lightcuts_kernel::ray::{NONE, RELATIVE_EPSILON};
use lightcuts_kernel::sampling::frame;
use lightcuts_kernel::virtual_light::{VirtualLight, shading_normal, virtual_emission};
use lightcuts_world::bvh::LANES;
use std::collections::BinaryHeap;
use std::f32::consts::PI;

/// A vector for each point, by axes.
type Vectors = [[f32; LANES]; 3];

/// Points that are lit together.
pub(crate) struct Bundle<'a> {
    /// The last one fills what is left.
    receivers: [Receiver<'a>; LANES],
    /// How many there are.
    count: usize,
    /// Whether all of them are of Lambert's material: what is computed for all at once.
    is_lambert: bool,
    point: Vectors,
    face: Vectors,
    epsilon: [f32; LANES],
    normal: Vectors,
    tangents: [Vectors; 2],
    /// BSDF and factor on it, of Lambert's material.
    color: Vectors,
    /// The greatest channel of that.
    greatest: [f32; LANES],
}

/// What a cut is to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fineness {
    /// Bound of a cluster's error, relative to the light of all.
    pub(crate) error: f32,
    pub(crate) max_cut: u32,
}

/// A cluster in a cut.
#[derive(Debug, Clone, Copy)]
struct Entry {
    node: u32,
    bound: [f32; LANES],
    /// Light that its representative would send with all of the cluster's power of 1.
    unit: Vectors,
}

/// Clusters of a cut; kept to save its memory.
#[derive(Debug, Default)]
pub(crate) struct BundleHeap {
    entries: Vec<Entry>,
    /// Relative bounds, as bits, which order numbers of at least 0 as they do; with places of entries.
    order: BinaryHeap<(u32, u32)>,
}

/// Three lanes of numbers.
type Wide3<L> = [L; 3];

impl<'a> Bundle<'a> {
    /// Whether a point can be computed with others at once.
    pub(crate) fn is_lambert(receiver: &Receiver<'_>) -> bool {
        receiver.at.bsdf.kind == LAMBERT
    }

    /// One to eight points.
    pub(crate) fn new(receivers: &[Receiver<'a>]) -> Self {
        let count = receivers.len();
        let receivers = std::array::from_fn(|lane| receivers[lane.min(count - 1)]);
        let each = |of: &dyn Fn(&Receiver<'_>) -> f32| std::array::from_fn(|lane| of(&receivers[lane]));
        let vectors = |of: &dyn Fn(&Receiver<'_>) -> Vec3| -> Vectors {
            std::array::from_fn(|axis| each(&|receiver| of(receiver)[axis]))
        };
        // Towards the viewer.
        let side = |receiver: &Receiver<'_>| 1.0_f32.copysign(receiver.at.wo.z);
        let color = |receiver: &Receiver<'_>| receiver.at.bsdf.diffuse * (1.0 / PI) * receiver.matt;
        Self {
            receivers,
            count,
            is_lambert: receivers.iter().all(Self::is_lambert),
            point: vectors(&|receiver| receiver.at.point),
            face: vectors(&|receiver| receiver.at.face * side(receiver)),
            epsilon: each(&|receiver| receiver.at.epsilon),
            normal: vectors(&|receiver| receiver.bound.normal),
            tangents: [
                vectors(&|receiver| frame(receiver.bound.normal).0),
                vectors(&|receiver| frame(receiver.bound.normal).1),
            ],
            color: vectors(&color),
            greatest: each(&|receiver| receiver.weights[0] * receiver.at.bsdf.diffuse.max_element() * (1.0 / PI)),
        }
    }

    fn asked(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// The sum over all lights, at each point.
    pub(crate) fn all(&self, tree: &ClusterTree, simd: Simd, counts: &mut Counts) -> [Gathered; LANES] {
        #[cfg(target_arch = "x86_64")]
        if simd.has_avx2() {
            // SAFETY: the machine has the features.
            #[allow(unsafe_code)]
            return unsafe { self.all_avx2(tree, counts) };
        }
        self.sum_of_all::<Plain>(tree, counts)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1")]
    fn all_avx2(&self, tree: &ClusterTree, counts: &mut Counts) -> [Gathered; LANES] {
        self.sum_of_all::<crate::cpu::Wide>(tree, counts)
    }

    /// The sum over a cut, at each point (Walter et al. 2005): as [`Receiver::cut`], but that a cluster is opened where its bound
    /// is too much for any of the points.
    pub(crate) fn cut(
        &self,
        tree: &ClusterTree,
        fineness: Fineness,
        references: Option<&[f32; LANES]>,
        heap: &mut BundleHeap,
        simd: Simd,
        counts: &mut Counts,
    ) -> [Gathered; LANES] {
        #[cfg(target_arch = "x86_64")]
        if simd.has_avx2() {
            // SAFETY: the machine has the features.
            #[allow(unsafe_code)]
            return unsafe { self.cut_avx2(tree, fineness, references, heap, counts) };
        }
        self.sum_of_cut::<Plain>(tree, fineness, references, heap, counts)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1")]
    fn cut_avx2(
        &self,
        tree: &ClusterTree,
        fineness: Fineness,
        references: Option<&[f32; LANES]>,
        heap: &mut BundleHeap,
        counts: &mut Counts,
    ) -> [Gathered; LANES] {
        self.sum_of_cut::<crate::cpu::Wide>(tree, fineness, references, heap, counts)
    }

    #[inline(always)]
    fn sum_of_all<L: Lanes>(&self, tree: &ClusterTree, counts: &mut Counts) -> [Gathered; LANES] {
        counts.gathered += self.count as u64;
        counts.cut += (self.count * tree.lights.len()) as u64;
        let mut sum = [L::splat(0.0); 3];
        for light in &tree.lights {
            sum = add(sum, self.light(light, counts));
        }
        self.gathered(sum, tree.lights.len() as u32, L::splat(0.0))
    }

    #[inline(always)]
    fn sum_of_cut<L: Lanes>(
        &self,
        tree: &ClusterTree,
        fineness: Fineness,
        references: Option<&[f32; LANES]>,
        heap: &mut BundleHeap,
        counts: &mut Counts,
    ) -> [Gathered; LANES] {
        let Some(root) = tree.root() else { return [Gathered::default(); LANES] };
        counts.gathered += self.count as u64;
        heap.entries.clear();
        heap.order.clear();
        let zero = L::splat(0.0);
        let mut cut = Cut { done: [zero; 3], open: [zero; 3], size: 0, references: references.map(|r| L::load(r)) };
        let unit = self.representative(tree, root, counts);
        self.place(tree, root, unit, heap, &mut cut, counts);
        while let Some(&(_, worst)) = heap.order.peek() {
            let entry = heap.entries[worst as usize];
            let is_fine = cut.relative(&entry.bound, self.asked()) <= fineness.error;
            if is_fine || cut.size + heap.order.len() as u32 >= fineness.max_cut {
                break;
            }
            heap.order.pop();
            let node = tree.nodes[entry.node as usize];
            let unit: Wide3<L> = loaded(&entry.unit);
            let power = L::splat(node.power);
            cut.open = sub(cut.open, scaled(unit, power));
            // One child shares its representative with the parent, and so the shadow rays.
            for child in [node.left, node.right] {
                let is_shared = representative_of(tree, child) == node.representative;
                let unit = if is_shared { unit } else { self.representative(tree, child, counts) };
                self.place(tree, child, unit, heap, &mut cut, counts);
            }
        }
        let mut bound = zero;
        for &(_, place) in &heap.order {
            let entry = &heap.entries[place as usize];
            let power = L::splat(tree.nodes[entry.node as usize].power);
            cut.done = add(cut.done, scaled(loaded(&entry.unit), power));
            bound = bound + L::load(&entry.bound);
        }
        let size = cut.size + heap.order.len() as u32;
        counts.cut += self.count as u64 * u64::from(size);
        self.gathered(cut.done, size, bound)
    }

    /// Puts a child into the cut: a light is done, a cluster may be opened.
    #[inline(always)]
    fn place<L: Lanes>(
        &self,
        tree: &ClusterTree,
        child: u32,
        unit: Wide3<L>,
        heap: &mut BundleHeap,
        cut: &mut Cut<L>,
        counts: &mut Counts,
    ) {
        if child & LIGHT_CHILD != 0 {
            let power = L::splat(light_power(tree.lights[(child & !LIGHT_CHILD) as usize].intensity));
            cut.done = add(cut.done, scaled(unit, power));
            cut.size += 1;
            return;
        }
        let node = &tree.nodes[child as usize];
        let bound = self.bound::<L>(tree, child, counts).store();
        let power = L::splat(node.power);
        cut.open = add(cut.open, scaled(unit, power));
        let relative = cut.relative(&bound, self.asked());
        heap.order.push((relative.to_bits(), heap.entries.len() as u32));
        heap.entries.push(Entry { node: child, bound, unit: stored(unit) });
    }

    /// Light of a child's representative, for a power of 1.
    #[inline(always)]
    fn representative<L: Lanes>(&self, tree: &ClusterTree, child: u32, counts: &mut Counts) -> Wide3<L> {
        let light = &tree.lights[representative_of(tree, child) as usize];
        let power = L::splat(light_power(light.intensity));
        divided(self.light(light, counts), power)
    }

    /// What a light sends to each point.
    #[inline(always)]
    fn light<L: Lanes>(&self, light: &VirtualLight, counts: &mut Counts) -> Wide3<L> {
        let zero = L::splat(0.0);
        let sent: Wide3<L> = if self.is_lambert { self.unshadowed(light) } else { self.unshadowed_each(light) };
        let asked = sent[0].max(sent[1]).max(sent[2]).greater(zero).bits() & self.asked();
        if asked == 0 {
            return [zero; 3];
        }
        counts.shadow += u64::from(asked.count_ones());
        let visible = L::mask(self.visible::<L>(light.position, asked));
        [sent[0].and(visible), sent[1].and(visible), sent[2].and(visible)]
    }

    /// What a light sends if nothing is between, to points of Lambert's material; twin of [`Receiver::unshadowed`].
    #[inline(always)]
    fn unshadowed<L: Lanes>(&self, light: &VirtualLight) -> Wide3<L> {
        let zero = L::splat(0.0);
        let to_light: Wide3<L> = sub(splat3(light.position), loaded(&self.point));
        let distance_sq = dot(to_light, to_light);
        let distance = distance_sq.sqrt();
        let direction = divided(to_light, distance);
        let cos_light = zero - dot(splat3(light.normal), direction);
        let cos = dot(loaded(&self.normal), direction);
        let cos_face = dot(loaded(&self.face), direction);
        let mut facing = cos_light.min(cos).min(cos_face);
        if light.is_bent != 0 {
            facing = facing.min(zero - dot(splat3(shading_normal(light)), direction));
        }
        let emitted = if light.table == NONE {
            cos_light
        } else {
            let direction = stored(direction);
            let tables = &self.receivers[0].scene.world.tables[..];
            let each = |lane: usize| -Vec3::new(direction[0][lane], direction[1][lane], direction[2][lane]);
            L::load(&std::array::from_fn(|lane| virtual_emission(light, tables, each(lane))))
        };
        let clamped = distance_sq.max(L::splat(self.receivers[0].bound.clamp_sq));
        let geometry = (emitted / clamped).and(facing.greater(zero));
        let color: Wide3<L> = loaded(&self.color);
        scaled(product(scaled(color, cos), splat3(light.intensity)), geometry)
    }

    /// The same one by one, for points of any material.
    #[inline(always)]
    fn unshadowed_each<L: Lanes>(&self, light: &VirtualLight) -> Wide3<L> {
        let mut sent = [[0.0; LANES]; 3];
        for (lane, receiver) in self.receivers[..self.count].iter().enumerate() {
            let light = receiver.unshadowed(light);
            (0..3).for_each(|axis| sent[axis][lane] = light[axis]);
        }
        loaded(&sent)
    }

    /// Which of the points in `asked`, a bit each, see a place; twin of `Interaction::ray_to`.
    #[inline(always)]
    fn visible<L: Lanes>(&self, target: Vec3, asked: u32) -> u32 {
        // Lights are off their surface already.
        let target_epsilon = RELATIVE_EPSILON * target.abs().max_element();
        let scene = self.receivers[0].scene;
        if scene.world.has_masks {
            let is_free = |lane: &usize| {
                asked >> lane & 1 == 1 && scene.is_free(&self.receivers[*lane].at.ray_to(target, target_epsilon))
            };
            return (0..self.count).filter(is_free).fold(0, |bits, lane| bits | 1 << lane);
        }
        let (point, face, epsilon) = (loaded(&self.point), loaded(&self.face), L::load(&self.epsilon));
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let is_behind = zero.greater(dot(face, sub(splat3(target), point)));
        let side = L::select(is_behind, zero - epsilon, epsilon);
        let origin = add(point, scaled(face, side));
        let direction = sub(splat3(target), origin);
        let length = dot(direction, direction).sqrt().max(L::splat(f32::MIN_POSITIVE));
        let end = one - L::splat(2.0) * (epsilon + L::splat(target_epsilon)) / length;
        let rays = RayLanes { origin: stored(origin), direction: stored(direction), t_max: end.max(zero).store() };
        asked & !scene.occluded_lanes(&rays, asked)
    }

    /// At most so much light, as a sum of channels, comes from a cluster to each point.
    #[inline(always)]
    fn bound<L: Lanes>(&self, tree: &ClusterTree, node: u32, counts: &mut Counts) -> L {
        if self.is_lambert {
            counts.bounds += self.count as u64;
            return self.lambert_bound(&tree.nodes[node as usize]);
        }
        let mut bounds = [0.0; LANES];
        for (bound, receiver) in bounds.iter_mut().zip(&self.receivers[..self.count]) {
            *bound = reach_bound(&receiver.reach(tree, node, counts));
        }
        L::load(&bounds)
    }

    /// The same for points of Lambert's material; twin of `cluster_reach` and `reach_bound`.
    #[inline(always)]
    fn lambert_bound<L: Lanes>(&self, node: &ClusterNode) -> L {
        let zero = L::splat(0.0);
        let half = (node.upper - node.lower) * 0.5;
        let center: Wide3<L> = sub(splat3((node.upper + node.lower) * 0.5), loaded(&self.point));
        let wide_half: Wide3<L> = splat3(half);
        let mut nearest_sq = zero;
        for axis in 0..3 {
            let outside = (center[axis].abs() - wide_half[axis]).max(zero);
            nearest_sq = nearest_sq + outside * outside;
        }
        let nearest_sq = nearest_sq.max(L::splat(self.receivers[0].bound.clamp_sq.max(f32::MIN_POSITIVE)));
        let from_light = sub([zero; 3], center);
        let (tangent, bitangent) = frame(node.axis);
        let emitted = box_cosine(
            [dot(splat3(node.axis), from_light), dot(splat3(tangent), from_light), dot(splat3(bitangent), from_light)],
            splat3(Vec3::new(node.axis.abs().dot(half), tangent.abs().dot(half), bitangent.abs().dot(half))),
        );
        let emitted = widened_cosine(emitted, node.cos_cone);
        let (normal, tangents) = (loaded(&self.normal), [loaded(&self.tangents[0]), loaded(&self.tangents[1])]);
        let cos_normal = box_cosine(
            [dot(normal, center), dot(tangents[0], center), dot(tangents[1], center)],
            [
                dot(absolute(normal), wide_half),
                dot(absolute(tangents[0]), wide_half),
                dot(absolute(tangents[1]), wide_half),
            ],
        );
        let factor = L::load(&self.greatest) * cos_normal * emitted * L::splat(node.power);
        factor / nearest_sq * L::splat(BOUND_MARGIN)
    }

    #[inline(always)]
    fn gathered<L: Lanes>(&self, light: Wide3<L>, size: u32, bound: L) -> [Gathered; LANES] {
        let (light, bound) = (stored(light), bound.store());
        std::array::from_fn(|lane| Gathered {
            light: Vec3::new(light[0][lane], light[1][lane], light[2][lane]),
            size,
            bound: bound[lane],
        })
    }
}

/// A cut on its way.
struct Cut<L> {
    /// What lights sent that are in the cut.
    done: Wide3<L>,
    /// Light of the clusters in the heap.
    open: Wide3<L>,
    /// Lights in the cut.
    size: u32,
    /// The light of all, as a sum of channels; what was gathered so far where it is not known.
    references: Option<L>,
}

impl<L: Lanes> Cut<L> {
    /// The greatest share of the light of all that a bound is, among the points in `asked`.
    #[inline(always)]
    fn relative(&self, bound: &[f32; LANES], asked: u32) -> f32 {
        let total = match self.references {
            Some(references) => references,
            None => {
                let sum = add(self.done, self.open);
                sum[0] + sum[1] + sum[2]
            }
        };
        let shares = (L::load(bound) / total.max(L::splat(f32::MIN_POSITIVE))).and(L::mask(asked));
        shares.store().into_iter().fold(0.0, f32::max)
    }
}

/// Twin of `cluster::box_cosine`: from where a box's middle is along three axes, and how far it reaches along them.
#[inline(always)]
fn box_cosine<L: Lanes>(middle: Wide3<L>, reach: Wide3<L>) -> L {
    let zero = L::splat(0.0);
    let z = middle[0] + reach[0];
    let x = (middle[1].abs() - reach[1]).max(zero);
    let y = (middle[2].abs() - reach[2]).max(zero);
    let cos = (z / (x * x + y * y + z * z).sqrt()).min(L::splat(1.0));
    cos.and(z.greater(zero))
}

/// Twin of `cluster::widened_cosine`.
#[inline(always)]
fn widened_cosine<L: Lanes>(cos: L, cos_cone: f32) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let sin_cone = (1.0 - cos_cone * cos_cone).max(0.0).sqrt();
    let sin = (one - cos * cos).max(zero).sqrt();
    let widened = (cos * L::splat(cos_cone) + sin * L::splat(sin_cone)).max(zero).min(one);
    L::select(L::splat(cos_cone).greater(cos), widened, one)
}

// Written out: a closure would be a function of its own, without the features of the one around it.

#[inline(always)]
fn splat3<L: Lanes>(v: Vec3) -> Wide3<L> {
    [L::splat(v.x), L::splat(v.y), L::splat(v.z)]
}

#[inline(always)]
fn loaded<L: Lanes>(vectors: &Vectors) -> Wide3<L> {
    [L::load(&vectors[0]), L::load(&vectors[1]), L::load(&vectors[2])]
}

#[inline(always)]
fn stored<L: Lanes>(v: Wide3<L>) -> Vectors {
    [v[0].store(), v[1].store(), v[2].store()]
}

#[inline(always)]
fn dot<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn add<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> Wide3<L> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn sub<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> Wide3<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn product<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> Wide3<L> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[inline(always)]
fn scaled<L: Lanes>(v: Wide3<L>, factor: L) -> Wide3<L> {
    [v[0] * factor, v[1] * factor, v[2] * factor]
}

#[inline(always)]
fn divided<L: Lanes>(v: Wide3<L>, divisor: L) -> Wide3<L> {
    [v[0] / divisor, v[1] / divisor, v[2] / divisor]
}

#[inline(always)]
fn absolute<L: Lanes>(v: Wide3<L>) -> Wide3<L> {
    [v[0].abs(), v[1].abs(), v[2].abs()]
}
