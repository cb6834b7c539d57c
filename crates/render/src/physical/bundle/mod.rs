//! Station 5 for eight points at once: the light of all virtual lights, or of one cut that is fine enough for each of the points.
//!
//! Points of neighbouring pixels need much the same cut, and rays from them to one light go much the same way. So a cluster is
//! bounded for all of them at once, and opened where the bound is too much for any.

mod bound;
mod light;
mod vectors;

use super::cluster_tree::ClusterTree;
use super::gather::{Gathered, Receiver, representative_of};
use super::pass::Counts;
use super::scene::Interaction;
use crate::cpu::{Lanes, Plain, Simd};
use glam::Vec3;
use lightcuts_kernel::bsdf::LAMBERT;
use lightcuts_kernel::cluster::{LIGHT_CHILD, light_power};
use lightcuts_kernel::sampling::frame;
use lightcuts_world::bvh::LANES;
use std::collections::BinaryHeap;
use std::f32::consts::PI;
use vectors::{Wide3, add, divided, loaded, scaled, stored, sub};

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

impl BundleHeap {
    /// Orders the clusters anew.
    #[inline(always)]
    fn reorder(&mut self, relative: impl Fn(&[f32; LANES]) -> f32) {
        let mut order = std::mem::take(&mut self.order).into_vec();
        for (key, place) in &mut order {
            *key = relative(&self.entries[*place as usize].bound).to_bits();
        }
        self.order = order.into();
    }
}

impl<'a> Bundle<'a> {
    /// Whether a point can be computed with others at once.
    pub(crate) fn is_lambert(at: &Interaction) -> bool {
        at.bsdf.kind == LAMBERT
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
            is_lambert: receivers.iter().all(|receiver| Self::is_lambert(receiver.at)),
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
        gathered(sum, tree.lights.len() as u32, L::splat(0.0))
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
        // Whether the order is by the light of all as it is now: where it is what was gathered so far, it changes.
        let mut is_fresh = true;
        while let Some(&(_, worst)) = heap.order.peek() {
            if cut.size + heap.order.len() as u32 >= fineness.max_cut {
                break;
            }
            let entry = heap.entries[worst as usize];
            if cut.relative(&entry.bound, self.asked()) <= fineness.error {
                if is_fresh || references.is_some() {
                    break;
                }
                heap.reorder(|bound| cut.relative(bound, self.asked()));
                is_fresh = true;
                continue;
            }
            is_fresh = false;
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
        gathered(cut.done, size, bound)
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
}

/// What was gathered, point by point.
#[inline(always)]
fn gathered<L: Lanes>(light: Wide3<L>, size: u32, bound: L) -> [Gathered; LANES] {
    let (light, bound) = (stored(light), bound.store());
    std::array::from_fn(|lane| Gathered {
        light: Vec3::new(light[0][lane], light[1][lane], light[2][lane]),
        size,
        bound: bound[lane],
    })
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
        let total = if let Some(references) = self.references {
            references
        } else {
            let sum = add(self.done, self.open);
            sum[0] + sum[1] + sum[2]
        };
        let shares = (L::load(bound) / total.max(L::splat(f32::MIN_POSITIVE))).and(L::mask(asked));
        shares.store().into_iter().fold(0.0, f32::max)
    }
}
