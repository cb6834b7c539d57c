//! Which clusters make up a cut.
//!
//! Where the light of all is known from earlier passes, whether a cluster is opened depends on nothing but its own
//! bound: the cut is found first, in the order of the tree, and then summed up. Elsewhere, and where a cut may not grow
//! as it would, the cluster with the greatest bound is opened first, and the light of all is what was gathered so far.

use super::vectors::{Vectors, Wide3, add, divided, loaded, scaled, stored, sub};
use super::{Bundle, gathered};
use crate::cpu::Lanes;
use crate::physical::cluster_tree::ClusterTree;
use crate::physical::gather::{Gathered, representative_of};
use crate::physical::sums::Counts;
use lightcuts_kernel::cluster::{LIGHT_CHILD, light_power};
use lightcuts_world::bvh::LANES;
use std::collections::BinaryHeap;

/// What a cut is to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fineness {
    /// Bound of a cluster's error, relative to the light of all.
    pub(crate) error: f32,
    pub(crate) max_cut: u32,
}

/// What is cut, and how.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cutting<'a> {
    pub(crate) tree: &'a ClusterTree,
    pub(crate) fineness: Fineness,
    /// The light of all, as a sum of channels, of each point; the last one's for what is left of the eight. `None`
    /// where it is not known.
    pub(crate) references: Option<[f32; LANES]>,
}

/// A cluster in a cut that grows from its worst one.
#[derive(Debug, Clone, Copy)]
struct Entry {
    node: u32,
    bound: [f32; LANES],
    /// Light that its representative would send with all of the cluster's power of 1.
    unit: Vectors,
}

/// Clusters of a cut; kept to save its memory.
#[derive(Debug, Default)]
pub(crate) struct Clusters {
    /// Clusters that are to be opened, and those and lights that make up the cut and may send something.
    open: Vec<u32>,
    found: Vec<u32>,
    entries: Vec<Entry>,
    /// Relative bounds, as bits, which order numbers of at least 0 as they do; with places of entries.
    order: BinaryHeap<(u32, u32)>,
}

impl Clusters {
    /// Orders the entries anew.
    #[inline(always)]
    fn reorder(&mut self, relative: impl Fn(&[f32; LANES]) -> f32) {
        let mut order = std::mem::take(&mut self.order).into_vec();
        for (key, place) in &mut order {
            *key = relative(&self.entries[*place as usize].bound).to_bits();
        }
        self.order = order.into();
    }
}

impl Bundle<'_> {
    #[inline(always)]
    pub(super) fn sum_of_cut<L: Lanes>(
        &self,
        cutting: &Cutting<'_>,
        clusters: &mut Clusters,
        counts: &mut Counts,
    ) -> [Gathered; LANES] {
        let Some(root) = cutting.tree.root() else { return [Gathered::default(); LANES] };
        counts.gathered += self.count as u64;
        let found = match &cutting.references {
            Some(references) => self.find::<L>(root, cutting, references, clusters, counts),
            None => None,
        };
        let (light, size, bound) = match found {
            Some((size, bound)) => (self.sum::<L>(cutting.tree, &clusters.found, counts), size, bound),
            None => self.grow(root, cutting, clusters, counts),
        };
        counts.cut += self.count as u64 * u64::from(size);
        gathered(light, size, bound)
    }

    /// Finds the cut where the light of all is known; returns its size and bound. `None` if it is larger than it may
    /// be.
    #[inline(always)]
    fn find<L: Lanes>(
        &self,
        root: u32,
        cutting: &Cutting<'_>,
        references: &[f32; LANES],
        clusters: &mut Clusters,
        counts: &mut Counts,
    ) -> Option<(u32, L)> {
        let (tree, Fineness { error, max_cut }) = (cutting.tree, cutting.fineness);
        let limit = L::load(references) * L::splat(error);
        clusters.open.clear();
        clusters.found.clear();
        let mut unlit = 0;
        let mut bound = L::splat(0.0);
        let mut children = [root, root];
        // The root alone, then both children of every cluster that is opened.
        let mut count = 1;
        loop {
            for &child in &children[..count] {
                if child & LIGHT_CHILD != 0 {
                    clusters.found.push(child);
                    continue;
                }
                counts.bounds += self.count as u64;
                let own = self.bound::<L>(&tree.nodes[child as usize]);
                if own.greater(limit).bits() != 0 {
                    clusters.open.push(child);
                    continue;
                }
                if own.greater(L::splat(0.0)).bits() != 0 {
                    clusters.found.push(child);
                } else {
                    unlit += 1;
                }
                bound = bound + own;
            }
            let size = clusters.found.len() as u32 + unlit;
            if size + clusters.open.len() as u32 > max_cut {
                return None;
            }
            let Some(node) = clusters.open.pop() else { return Some((size, bound)) };
            let node = &tree.nodes[node as usize];
            // The first child is next to its parent in memory, so it is the next one to be opened.
            (children, count) = ([node.right, node.left], 2);
        }
    }

    /// The light of clusters, each sent by its representative.
    #[inline(always)]
    fn sum<L: Lanes>(&self, tree: &ClusterTree, found: &[u32], counts: &mut Counts) -> Wide3<L> {
        let mut sum = [L::splat(0.0); 3];
        for &child in found {
            let light = &tree.lights[representative_of(tree, child) as usize];
            let mut sent: Wide3<L> = self.light(light, counts);
            if child & LIGHT_CHILD == 0 {
                let share = tree.nodes[child as usize].power / light_power(light.intensity);
                sent = scaled(sent, L::splat(share));
            }
            sum = add(sum, sent);
        }
        sum
    }

    /// Opens the worst cluster until all are fine enough or there are as many as there may be.
    #[inline(always)]
    fn grow<L: Lanes>(
        &self,
        root: u32,
        cutting: &Cutting<'_>,
        clusters: &mut Clusters,
        counts: &mut Counts,
    ) -> (Wide3<L>, u32, L) {
        let Cutting { tree, fineness, references } = cutting;
        clusters.entries.clear();
        clusters.order.clear();
        let zero = L::splat(0.0);
        let references = references.as_ref().map(|r| L::load(r));
        let mut cut = Cut { done: [zero; 3], open: [zero; 3], size: 0, references };
        let unit = self.representative(tree, root, counts);
        self.place(tree, root, unit, clusters, &mut cut, counts);
        // Whether the order is by the light of all as it is now: where it is what was gathered so far, it changes.
        let mut is_fresh = true;
        while let Some(&(_, worst)) = clusters.order.peek() {
            if cut.size + clusters.order.len() as u32 >= fineness.max_cut {
                break;
            }
            let entry = clusters.entries[worst as usize];
            if cut.relative(&entry.bound) <= fineness.error {
                if is_fresh || references.is_some() {
                    break;
                }
                clusters.reorder(|bound| cut.relative(bound));
                is_fresh = true;
                continue;
            }
            is_fresh = false;
            clusters.order.pop();
            let node = tree.nodes[entry.node as usize];
            let unit: Wide3<L> = loaded(&entry.unit);
            cut.open = sub(cut.open, scaled(unit, L::splat(node.power)));
            // One child shares its representative with the parent, and so the shadow rays.
            for child in [node.left, node.right] {
                let is_shared = representative_of(tree, child) == node.representative;
                let unit = if is_shared { unit } else { self.representative(tree, child, counts) };
                self.place(tree, child, unit, clusters, &mut cut, counts);
            }
        }
        let mut bound = zero;
        for &(_, place) in &clusters.order {
            let entry = &clusters.entries[place as usize];
            let power = L::splat(tree.nodes[entry.node as usize].power);
            cut.done = add(cut.done, scaled(loaded(&entry.unit), power));
            bound = bound + L::load(&entry.bound);
        }
        (cut.done, cut.size + clusters.order.len() as u32, bound)
    }

    /// Puts a child into the cut: a light is done, a cluster may be opened.
    #[inline(always)]
    fn place<L: Lanes>(
        &self,
        tree: &ClusterTree,
        child: u32,
        unit: Wide3<L>,
        clusters: &mut Clusters,
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
        counts.bounds += self.count as u64;
        let bound = self.bound::<L>(node).store();
        cut.open = add(cut.open, scaled(unit, L::splat(node.power)));
        clusters.order.push((cut.relative(&bound).to_bits(), clusters.entries.len() as u32));
        clusters.entries.push(Entry { node: child, bound, unit: stored(unit) });
    }

    /// Light of a child's representative, for a power of 1.
    #[inline(always)]
    fn representative<L: Lanes>(&self, tree: &ClusterTree, child: u32, counts: &mut Counts) -> Wide3<L> {
        let light = &tree.lights[representative_of(tree, child) as usize];
        let power = L::splat(light_power(light.intensity));
        divided(self.light(light, counts), power)
    }
}

/// A cut that grows.
struct Cut<L> {
    /// What lights sent that are in the cut.
    done: Wide3<L>,
    /// Light of the clusters among the entries.
    open: Wide3<L>,
    /// Lights in the cut.
    size: u32,
    /// The light of all, as a sum of channels; what was gathered so far where it is not known.
    references: Option<L>,
}

impl<L: Lanes> Cut<L> {
    /// The greatest share of the light of all that a bound is, at any of the points.
    #[inline(always)]
    fn relative(&self, bound: &[f32; LANES]) -> f32 {
        let total = if let Some(references) = self.references {
            references
        } else {
            let sum = add(self.done, self.open);
            sum[0] + sum[1] + sum[2]
        };
        let shares = L::load(bound) / total.max(L::splat(f32::MIN_POSITIVE));
        shares.store().into_iter().fold(0.0, f32::max)
    }
}
