//! The ray tree of a camera ray, in an array: slot k's mirrored ray is in slot 2k + 1, its refracted ray in 2k + 2
//! (thesis, section 4.4). Traced layer by layer, summed from the leaves; no recursion.

use crate::shade::{Found, Shader};
use glam::Vec3;
use lightcuts_kernel::optics::{reflect_at, refract_at};
use lightcuts_kernel::ray::Ray;
use lightcuts_kernel::surface::Surface;

/// A ray and what it found.
#[derive(Debug, Clone, Copy)]
struct Slot {
    ray: Ray,
    color: Vec3,
    /// What it hit, if anything.
    found: Option<Found>,
    /// Factors on the children's colours; 0 where there is no child.
    reflection: f32,
    refraction: f32,
}

/// A hit of a ray tree: a place where a VPL may be put.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TreeHit {
    /// Slot of the ray in its tree.
    pub slot: u32,
    /// What it hit.
    pub surface: Surface,
    /// The ray's final colour.
    pub color: Vec3,
    /// Distance that separates rays and VPLs from this surface.
    pub epsilon: f32,
}

/// The array, reused from ray to ray.
#[derive(Debug)]
pub(crate) struct RayTree {
    max_depth: u32,
    slots: Vec<Slot>,
    /// Slots in use, parents before children.
    active: Vec<u32>,
    /// Place of each slot when subtrees come before their root, mirrored before refracted.
    rank: Vec<u32>,
}

impl RayTree {
    pub(crate) fn new(max_depth: u32) -> Self {
        let size = (1_usize << max_depth) - 1;
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::ZERO, t_min: 0.0, t_max: 0.0, inside: false };
        let unused = Slot { ray, color: Vec3::ZERO, found: None, reflection: 0.0, refraction: 0.0 };
        Self { max_depth, slots: vec![unused; size], active: Vec::new(), rank: post_order(size) }
    }

    /// Traces a camera ray with everything that follows from it and returns its colour.
    pub(crate) fn trace(&mut self, shader: &mut Shader<'_>, camera_ray: Ray) -> Vec3 {
        self.active.clear();
        self.visit(shader, 0, camera_ray);
        let mut next = 0;
        while let Some(&k) = self.active.get(next) {
            next += 1;
            self.spawn(shader, k);
        }
        self.sum();
        self.slots[0].color
    }

    /// Finds what a ray hits and its local colour.
    fn visit(&mut self, shader: &mut Shader<'_>, k: u32, ray: Ray) {
        self.active.push(k);
        // In its place: a slot is too large to be passed around.
        let slot = &mut self.slots[k as usize];
        slot.ray = ray;
        slot.found = shader.find(&ray, k > 0);
        (slot.reflection, slot.refraction) = (0.0, 0.0);
        let Some(found) = &slot.found else {
            slot.color = shader.background();
            return;
        };
        slot.color = shader.local(k, &ray, found);
        // A slot of the deepest layer has no children.
        if k < (1 << (self.max_depth - 1)) - 1 {
            let material = shader.material(found);
            (slot.reflection, slot.refraction) = (material.reflection, material.refraction);
        }
    }

    /// Traces the children of a slot.
    fn spawn(&mut self, shader: &mut Shader<'_>, k: u32) {
        let Slot { ray, found, reflection, refraction, .. } = self.slots[k as usize];
        let Some(found) = found.filter(|_| reflection > 0.0 || refraction > 0.0) else { return };
        let Found { surface, epsilon, .. } = found;
        let material = shader.material(&found);
        let child = |direction: Vec3, inside: bool| Ray {
            origin: surface.point,
            direction,
            t_min: epsilon,
            t_max: f32::INFINITY,
            inside,
        };
        if reflection > 0.0 {
            let mirrored = child(reflect_at(ray.direction, surface.normal), ray.inside);
            self.visit(shader, 2 * k + 1, mirrored);
        }
        let bent = (refraction > 0.0)
            .then(|| refract_at(ray.direction, surface.normal, material.refraction_ratio, shader.rules()))
            .flatten();
        if let Some(direction) = bent {
            let refracted = child(direction, !ray.inside);
            self.visit(shader, 2 * k + 2, refracted);
        } else {
            self.slots[k as usize].refraction = 0.0;
        }
    }

    /// Adds the children's colours to their parents', from the deepest up; each ray's colour is at most 1.
    fn sum(&mut self) {
        for &k in self.active.iter().rev() {
            let slot = &self.slots[k as usize];
            let (mut color, is_hit) = (slot.color, slot.found.is_some());
            for (factor, child) in [(slot.reflection, 2 * k + 1), (slot.refraction, 2 * k + 2)] {
                if factor > 0.0 {
                    color += self.slots[child as usize].color * factor;
                }
            }
            self.slots[k as usize].color = if is_hit { color.min(Vec3::ONE) } else { color };
        }
    }

    /// The hits of the last tree in the original's order: a node's mirrored subtree, its refracted subtree, itself.
    pub(crate) fn hits(&mut self, hits: &mut Vec<TreeHit>) {
        hits.clear();
        self.active.sort_unstable_by_key(|&k| self.rank[k as usize]);
        for &k in &self.active {
            if let Slot { found: Some(Found { surface, epsilon, .. }), color, .. } = &self.slots[k as usize] {
                hits.push(TreeHit { slot: k, surface: *surface, color: *color, epsilon: *epsilon });
            }
        }
    }

    /// Number of hits in the tree of a camera ray.
    pub(crate) fn hit_count(&mut self, shader: &mut Shader<'_>, camera_ray: Ray) -> usize {
        shader.trace_primary(&[camera_ray], &[0]);
        shader.make_current(0, (0, 0));
        self.trace(shader, camera_ray);
        self.active.iter().filter(|&&k| self.slots[k as usize].found.is_some()).count()
    }

    /// What the camera ray of the last tree hit, at which distance.
    pub(crate) fn first_found(&self) -> Option<&Found> {
        self.slots[0].found.as_ref()
    }
}

/// Place of each slot of a full tree in post-order.
fn post_order(size: usize) -> Vec<u32> {
    let mut rank = vec![0; size];
    let mut reverse = Vec::with_capacity(size);
    // Root, right, left is post-order backwards.
    let mut open = vec![0];
    while let Some(k) = open.pop() {
        reverse.push(k);
        if 2 * k + 2 < size {
            open.extend([2 * k + 1, 2 * k + 2]);
        }
    }
    for (place, &k) in reverse.iter().rev().enumerate() {
        rank[k] = place as u32;
    }
    rank
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subtrees_come_before_their_roots() {
        // Slots in post-order: 3 4 1 5 6 2 0.
        assert_eq!(post_order(7), [6, 2, 5, 0, 1, 3, 4]);
        assert_eq!(post_order(1), [0]);
    }
}
