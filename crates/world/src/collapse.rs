//! The binary tree made 8 wide, with triangles gathered into blocks.

use crate::binary_tree::{self, BinaryNode, Content};
use crate::bvh::{BvhNode, ChildRef, LANES, TriangleBlock};
use crate::shapes::Builder;
use glam::Vec3;
use lightcuts_kernel::intersect::{SPHERE, TRIANGLE};

/// How far boxes are widened, relative to the largest coordinate in play: more than the rounding error of a hit found
/// from anywhere in the scene, so that a hit is never lost to its box.
pub(crate) const PADDING: f32 = 2e-6;

/// An empty child: a box that no ray enters.
const EMPTY_NODE: BvhNode =
    BvhNode { lower: [[f32::INFINITY; LANES]; 3], upper: [[f32::NEG_INFINITY; LANES]; 3], child: [u32::MAX; LANES] };

/// Builds the hierarchy over everything in the builder. `reach` is the camera's largest coordinate.
pub(crate) fn build(builder: &Builder, reach: f32) -> (Vec<BvhNode>, Vec<TriangleBlock>) {
    let extent = builder.boxes.iter().fold(reach, |m, (a, b)| m.max(a.abs().max_element()).max(b.abs().max_element()));
    let padding = Vec3::splat(extent * PADDING);
    let boxes: Vec<(Vec3, Vec3)> = builder.boxes.iter().map(|&(a, b)| (a - padding, b + padding)).collect();
    let binary = binary_tree::build(&boxes);
    if binary.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let sizes = triangle_counts(&binary, builder);
    let mut collapse = Collapse { binary: &binary, sizes: &sizes, builder, nodes: Vec::new(), blocks: Vec::new() };
    collapse.run();
    (collapse.nodes, collapse.blocks)
}

/// Number of triangles under each binary node, or `None` where other primitives lie under it too.
fn triangle_counts(binary: &[BinaryNode], builder: &Builder) -> Vec<Option<u32>> {
    let mut counts = vec![None; binary.len()];
    for (i, node) in binary.iter().enumerate().rev() {
        counts[i] = match node.content {
            Content::Primitive(p) => (builder.primitives[p as usize].kind == TRIANGLE).then_some(1),
            Content::Children(left, right) => {
                counts[left as usize].zip(counts[right as usize]).map(|(a, b): (u32, u32)| a + b)
            }
        };
    }
    counts
}

struct Collapse<'a> {
    binary: &'a [BinaryNode],
    sizes: &'a [Option<u32>],
    builder: &'a Builder,
    nodes: Vec<BvhNode>,
    blocks: Vec<TriangleBlock>,
}

impl Collapse<'_> {
    fn run(&mut self) {
        self.nodes.push(EMPTY_NODE);
        let mut open = vec![(0_u32, 0_usize)];
        while let Some((root, target)) = open.pop() {
            for (lane, child) in self.widen(root).into_iter().enumerate() {
                let node = &self.binary[child as usize];
                for axis in 0..3 {
                    self.nodes[target].lower[axis][lane] = node.lower[axis];
                    self.nodes[target].upper[axis][lane] = node.upper[axis];
                }
                let reference = self.leaf(child).unwrap_or_else(|| {
                    self.nodes.push(EMPTY_NODE);
                    open.push((child, self.nodes.len() - 1));
                    ChildRef::Node(self.nodes.len() as u32 - 1)
                });
                self.nodes[target].child[lane] = reference.pack();
            }
        }
    }

    /// Up to eight descendants that together cover a node: the one with the largest surface is opened next.
    fn widen(&self, root: u32) -> Vec<u32> {
        let mut wide = vec![root];
        while wide.len() < LANES {
            let largest = wide.iter().enumerate().filter(|&(_, &i)| !self.is_leaf(i)).max_by(|a, b| {
                self.binary[*a.1 as usize].half_area().total_cmp(&self.binary[*b.1 as usize].half_area())
            });
            let Some((place, &index)) = largest else { break };
            if let Content::Children(left, right) = self.binary[index as usize].content {
                wide[place] = left;
                wide.push(right);
            }
        }
        wide
    }

    fn is_leaf(&self, index: u32) -> bool {
        matches!(self.binary[index as usize].content, Content::Primitive(_))
            || self.sizes[index as usize].is_some_and(|n| n as usize <= LANES)
    }

    fn leaf(&mut self, index: u32) -> Option<ChildRef> {
        if self.sizes[index as usize].is_some_and(|n| n as usize <= LANES) {
            return Some(self.triangle_block(index));
        }
        let Content::Primitive(p) = self.binary[index as usize].content else { return None };
        let primitive = self.builder.primitives[p as usize];
        Some(if primitive.kind == SPHERE {
            ChildRef::Sphere(primitive.index)
        } else {
            ChildRef::Square(primitive.index)
        })
    }

    fn triangle_block(&mut self, root: u32) -> ChildRef {
        let mut block = TriangleBlock::EMPTY;
        let mut lane = 0;
        let mut open = vec![root];
        while let Some(index) = open.pop() {
            match self.binary[index as usize].content {
                Content::Children(left, right) => open.extend([right, left]),
                Content::Primitive(p) => {
                    let [a, b, c] = self.builder.points[self.builder.primitives[p as usize].index as usize];
                    for axis in 0..3 {
                        block.corner[axis][lane] = a[axis];
                        block.edge1[axis][lane] = (b - a)[axis];
                        block.edge2[axis][lane] = (c - a)[axis];
                    }
                    block.primitive[lane] = p;
                    lane += 1;
                }
            }
        }
        self.blocks.push(block);
        ChildRef::Triangles(self.blocks.len() as u32 - 1)
    }
}
