//! What must hold of a world: every reference points at something and every box holds what is under it.

use crate::bvh::{ChildRef, LANES, MAX_LEVELS};
use crate::{Shapes, World};
use glam::Vec3;
use lightcuts_kernel::ray::NONE;

/// A broken rule of a [`World`]: a defect of this crate, never of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Defect {
    /// A primitive, material or texture number out of range.
    #[error("a number points at nothing")]
    DanglingNumber,
    /// A child reference out of range, or a node reached twice.
    #[error("the hierarchy is not a tree")]
    NotATree,
    /// A primitive in no leaf or in several.
    #[error("a primitive is not in exactly one leaf")]
    Leaves,
    /// A child that reaches out of its box.
    #[error("a box does not hold what is under it")]
    Box,
    /// A hierarchy too deep for the traversal's stack.
    #[error("the hierarchy is too deep")]
    TooDeep,
}

impl World {
    /// Checks the structure of the whole world.
    pub fn validate(&self) -> Result<(), Defect> {
        if !self.materials.iter().all(|m| m.texture == NONE || (m.texture as usize) < self.textures.len()) {
            return Err(Defect::DanglingNumber);
        }
        self.shapes.validate(self.materials.len())
    }
}

impl Shapes {
    /// Checks the structure of the hierarchy and the numbers of materials, of which there are so many.
    pub fn validate(&self, materials: usize) -> Result<(), Defect> {
        if !self.primitives.iter().all(|p| (p.material as usize) < materials) {
            return Err(Defect::DanglingNumber);
        }
        let mut seen = vec![0_u32; self.primitives.len()];
        let mut visits = 0;
        let mut open = if self.nodes.is_empty() { vec![] } else { vec![(0_usize, 1_usize, None)] };
        while let Some((index, depth, bounds)) = open.pop() {
            let node = self.nodes.get(index).ok_or(Defect::NotATree)?;
            visits += 1;
            if visits > self.nodes.len() {
                return Err(Defect::NotATree);
            }
            if depth > MAX_LEVELS {
                return Err(Defect::TooDeep);
            }
            for lane in 0..LANES {
                let child_box = node.child_box(lane);
                if child_box.0.x > child_box.1.x {
                    continue;
                }
                if bounds.is_some_and(|outer| !holds(outer, child_box)) {
                    return Err(Defect::Box);
                }
                match ChildRef::unpack(node.child[lane]) {
                    ChildRef::Node(child) => open.push((child as usize, depth + 1, Some(child_box))),
                    leaf => self.validate_leaf(leaf, child_box, &mut seen)?,
                }
            }
        }
        if seen.iter().all(|&n| n == 1) { Ok(()) } else { Err(Defect::Leaves) }
    }

    fn validate_leaf(&self, leaf: ChildRef, bounds: (Vec3, Vec3), seen: &mut [u32]) -> Result<(), Defect> {
        let mut check = |primitive: u32, lower: Vec3, upper: Vec3| {
            *seen.get_mut(primitive as usize).ok_or(Defect::DanglingNumber)? += 1;
            if holds(bounds, (lower, upper)) { Ok(()) } else { Err(Defect::Box) }
        };
        match leaf {
            ChildRef::Node(_) => Ok(()),
            ChildRef::Sphere(i) => {
                let s = self.spheres.get(i as usize).ok_or(Defect::DanglingNumber)?;
                check(s.primitive, s.center - s.radius, s.center + s.radius)
            }
            ChildRef::Square(i) => {
                let s = self.squares.get(i as usize).ok_or(Defect::DanglingNumber)?;
                check(s.primitive, s.center, s.center)
            }
            ChildRef::Triangles(i) => {
                let block = self.triangles.get(i as usize).ok_or(Defect::DanglingNumber)?;
                for lane in (0..LANES).filter(|&lane| block.primitive[lane] != NONE) {
                    let [corner, ..] = block.lane(lane);
                    check(block.primitive[lane], corner, corner)?;
                }
                Ok(())
            }
        }
    }
}

fn holds(outer: (Vec3, Vec3), inner: (Vec3, Vec3)) -> bool {
    outer.0.cmple(inner.0).all() && outer.1.cmpge(inner.1).all()
}
