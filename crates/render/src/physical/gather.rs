//! Station 5: the light of virtual lights at a point: of all, of a cut, or of a few that are drawn.

use super::bundle::Fineness;
use super::cluster_tree::ClusterTree;
use super::scene::{Interaction, Scene};
use super::sums::Counts;
use glam::Vec3;
use lightcuts_kernel::bsdf::{DIFFUSE, GLOSSY, Transport};
use lightcuts_kernel::cluster::{
    BoundReceiver, ClusterReach, LIGHT_CHILD, bsdf_bound, cluster_reach, first_probability, light_power, reach_bound,
};
use lightcuts_kernel::virtual_light::{VirtualLight, virtual_emission};

/// A point that is lit, and what of its light counts.
#[derive(Clone, Copy)]
pub(crate) struct Receiver<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) at: &'a Interaction,
    /// Factors on what diffuse lobes send on, and on what glossy ones do.
    pub(super) diffuse: Vec3,
    glossy: Vec3,
    pub(super) bound: BoundReceiver,
}

/// What was gathered.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Gathered {
    pub(crate) light: Vec3,
    /// Clusters and lights that it is the sum of.
    pub(crate) size: u32,
    /// How far the sum over all lights may be away, as a sum of channels.
    pub(crate) bound: f32,
}

/// A cluster in a cut.
#[derive(Debug, Clone, Copy)]
struct Entry {
    bound: f32,
    node: u32,
    /// Light that its representative would send with all of the cluster's power of 1.
    unit: Vec3,
}

impl<'a> Receiver<'a> {
    pub(crate) fn new(scene: &'a Scene<'a>, at: &'a Interaction, diffuse: Vec3, glossy: Vec3, clamp_sq: f32) -> Self {
        let normal = if at.wo.z < 0.0 { -at.normal } else { at.normal };
        let cos_o = at.wo.z.abs();
        let toward = at.toward();
        let weights = [diffuse.max_element(), glossy.max_element()];
        let bsdf = bsdf_bound(&at.bsdf, &scene.world.tables, weights, cos_o);
        let bound = BoundReceiver { point: at.point, normal, mirror: normal * (2.0 * cos_o) - toward, clamp_sq, bsdf };
        Self { scene, at, diffuse, glossy, bound }
    }

    /// What a light sends if nothing is between.
    pub(super) fn unshadowed(&self, light: &VirtualLight) -> Vec3 {
        let to_light = light.position - self.at.point;
        let distance_sq = to_light.length_squared();
        if distance_sq == 0.0 {
            return Vec3::ZERO;
        }
        let direction = to_light / distance_sq.sqrt();
        let tables = &self.scene.world.tables[..];
        let emitted = virtual_emission(light, tables, -direction);
        if emitted == 0.0 {
            return Vec3::ZERO;
        }
        let of = |lobes, factor: Vec3| {
            if factor == Vec3::ZERO {
                Vec3::ZERO
            } else {
                self.at.scattered(tables, lobes, direction, Transport::Radiance) * factor
            }
        };
        let value = of(DIFFUSE, self.diffuse) + of(GLOSSY, self.glossy);
        value * light.intensity * (emitted / distance_sq.max(self.bound.clamp_sq))
    }

    /// What a light sends.
    pub(crate) fn light(&self, light: &VirtualLight, counts: &mut Counts) -> Vec3 {
        let sent = self.unshadowed(light);
        if sent == Vec3::ZERO {
            return sent;
        }
        counts.shadow += 1;
        if self.scene.is_free(&self.at.ray_to(light.position, light.normal)) { sent } else { Vec3::ZERO }
    }

    pub(super) fn reach(&self, tree: &ClusterTree, node: u32, counts: &mut Counts) -> ClusterReach {
        counts.bounds += 1;
        cluster_reach(&tree.nodes[node as usize], &self.bound)
    }

    /// The sum over all lights.
    pub(crate) fn all(&self, tree: &ClusterTree, counts: &mut Counts) -> Gathered {
        counts.gathered += 1;
        counts.cut += tree.lights.len() as u64;
        let light = tree.lights.iter().map(|light| self.light(light, counts)).sum();
        Gathered { light, size: tree.lights.len() as u32, bound: 0.0 }
    }

    /// The sum over a cut (Walter et al. 2005): clusters are opened until the error bound of each is at most `error`
    /// times the light of all, or there are `max_cut` of them. That light is `reference`, a sum of channels; where
    /// there is none it is what was gathered so far, which depends on the lights that stand for clusters and so is
    /// biased a little where that is averaged.
    pub(crate) fn cut(
        &self,
        tree: &ClusterTree,
        fineness: Fineness,
        reference: Option<f32>,
        heap: &mut CutHeap,
        counts: &mut Counts,
    ) -> Gathered {
        let Some(root) = tree.root() else { return Gathered::default() };
        counts.gathered += 1;
        heap.entries.clear();
        let mut done = Gathered::default();
        // Light of the clusters in the heap.
        let mut open = Vec3::ZERO;
        let root_unit = self.representative(tree, root, counts);
        self.place(tree, root, root_unit, heap, &mut open, &mut done, counts);
        while let Some(&worst) = heap.entries.first() {
            let total = reference.unwrap_or_else(|| light_power(done.light + open));
            if worst.bound <= fineness.error * total || done.size + heap.entries.len() as u32 >= fineness.max_cut {
                break;
            }
            heap.pop();
            let node = tree.nodes[worst.node as usize];
            open -= worst.unit * node.power;
            // One child shares its representative with the parent, and so the shadow ray.
            for child in [node.left, node.right] {
                let is_shared = representative_of(tree, child) == node.representative;
                let unit = if is_shared { worst.unit } else { self.representative(tree, child, counts) };
                self.place(tree, child, unit, heap, &mut open, &mut done, counts);
            }
        }
        for entry in &heap.entries {
            done.light += entry.unit * tree.nodes[entry.node as usize].power;
            done.bound += entry.bound;
            done.size += 1;
        }
        counts.cut += u64::from(done.size);
        done
    }

    /// Puts a child into the cut: a light is done, a cluster may be opened.
    #[allow(clippy::too_many_arguments)] // the state of one loop
    fn place(
        &self,
        tree: &ClusterTree,
        child: u32,
        unit: Vec3,
        heap: &mut CutHeap,
        open: &mut Vec3,
        done: &mut Gathered,
        counts: &mut Counts,
    ) {
        if child & LIGHT_CHILD != 0 {
            done.light += unit * light_power(tree.lights[(child & !LIGHT_CHILD) as usize].intensity);
            done.size += 1;
            return;
        }
        let bound = reach_bound(&self.reach(tree, child, counts));
        *open += unit * tree.nodes[child as usize].power;
        heap.push(Entry { bound, node: child, unit });
    }

    /// Light of a child's representative, for a power of 1.
    fn representative(&self, tree: &ClusterTree, child: u32, counts: &mut Counts) -> Vec3 {
        let light = &tree.lights[representative_of(tree, child) as usize];
        self.light(light, counts) / light_power(light.intensity)
    }

    /// An estimate by some lights, each drawn down the tree by what it may send (after Yuksel 2019, "Stochastic
    /// Lightcuts").
    pub(crate) fn drawn(
        &self,
        tree: &ClusterTree,
        samples: u32,
        mut random: impl FnMut() -> f32,
        counts: &mut Counts,
    ) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for k in 0..samples {
            // One number per stretch, so that the lights are spread over the tree.
            let number = (k as f32 + random()) / samples as f32;
            if let Some((light, probability)) = self.draw(tree, number, counts) {
                sum += self.light(&tree.lights[light as usize], counts) / probability;
            }
        }
        counts.gathered += 1;
        counts.cut += u64::from(samples);
        sum / samples as f32
    }

    fn draw(&self, tree: &ClusterTree, random: f32, counts: &mut Counts) -> Option<(u32, f32)> {
        let (mut child, mut probability, mut random) = (tree.root()?, 1.0, random);
        while child & LIGHT_CHILD == 0 {
            let node = &tree.nodes[child as usize];
            let mut reach = |child: u32| {
                if child & LIGHT_CHILD == 0 {
                    return self.reach(tree, child, counts);
                }
                let light = &tree.lights[(child & !LIGHT_CHILD) as usize];
                let distance_sq = (light.position - self.at.point).length_squared().max(self.bound.clamp_sq);
                let factor = light_power(self.unshadowed(light)) * distance_sq;
                ClusterReach { factor, nearest_sq: distance_sq, farthest_sq: distance_sq }
            };
            let share = first_probability(&reach(node.left), &reach(node.right))?;
            if random < share {
                (child, probability, random) = (node.left, probability * share, random / share);
            } else {
                (child, probability) = (node.right, probability * (1.0 - share));
                random = ((random - share) / (1.0 - share)).min(1.0 - f32::EPSILON);
            }
        }
        Some((child & !LIGHT_CHILD, probability))
    }
}

pub(super) fn representative_of(tree: &ClusterTree, child: u32) -> u32 {
    if child & LIGHT_CHILD != 0 { child & !LIGHT_CHILD } else { tree.nodes[child as usize].representative }
}

/// Clusters of a cut, the one with the greatest bound first; kept to save its memory.
#[derive(Debug, Default)]
pub(crate) struct CutHeap {
    entries: Vec<Entry>,
}

impl CutHeap {
    fn push(&mut self, entry: Entry) {
        self.entries.push(entry);
        let mut k = self.entries.len() - 1;
        while k > 0 {
            let above = (k - 1) / 2;
            if self.entries[above].bound >= self.entries[k].bound {
                break;
            }
            self.entries.swap(k, above);
            k = above;
        }
    }

    /// Removes the first.
    fn pop(&mut self) {
        if self.entries.is_empty() {
            return;
        }
        self.entries.swap_remove(0);
        let mut k = 0;
        loop {
            let (left, right) = (2 * k + 1, 2 * k + 2);
            let bound = |i: usize| self.entries.get(i).map_or(f32::NEG_INFINITY, |entry| entry.bound);
            let greatest = if bound(right) > bound(left) { right } else { left };
            if bound(greatest) <= bound(k) {
                return;
            }
            self.entries.swap(k, greatest);
            k = greatest;
        }
    }
}
