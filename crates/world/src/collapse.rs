//! The binary tree made 8 wide, with triangles gathered into blocks.

use crate::binary_tree::{self, BinaryNode, Content};
use crate::bvh::{BvhNode, ChildRef, TriangleBlock, TriangleForm};
use crate::shapes::Builder;
use crate::widen::{Cut, children, cuts};
use glam::Vec3;
use lightcuts_kernel::intersect::{SPHERE, TRIANGLE};

/// How far boxes are widened, relative to the largest coordinate in play: more than the rounding error of a hit found
/// from anywhere in the scene, so that a hit is never lost to its box.
pub(crate) const PADDING: f32 = 2e-6;

/// Builds the hierarchy over everything in the builder. `reach` is the camera's largest coordinate.
pub(crate) fn build(builder: &Builder, reach: f32, form: TriangleForm) -> (Vec<BvhNode>, Vec<TriangleBlock>) {
    let extent = builder.boxes.iter().fold(reach, |m, (a, b)| m.max(a.abs().max_element()).max(b.abs().max_element()));
    let padding = Vec3::splat(extent * PADDING);
    let widen = |&(lower, upper): &(Vec3, Vec3)| {
        let padding = match form {
            TriangleForm::Edges => padding,
            // What is flat stays flat: rays that begin next to a wall do not enter its box. Hits across it are as exact
            // as the box's test is.
            TriangleForm::Corners => padding.min(upper - lower),
        };
        (lower - padding, upper + padding)
    };
    let boxes: Vec<(Vec3, Vec3)> = builder.boxes.iter().map(widen).collect();
    let binary = binary_tree::build(&boxes);
    if binary.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let sizes = triangle_counts(&binary, builder);
    let cuts = cuts(&binary, &sizes);
    let (nodes, blocks) = (Vec::new(), Vec::new());
    let mut collapse = Collapse { binary: &binary, cuts: &cuts, builder, form, nodes, blocks };
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
    cuts: &'a [Cut],
    builder: &'a Builder,
    form: TriangleForm,
    nodes: Vec<BvhNode>,
    blocks: Vec<TriangleBlock>,
}

impl Collapse<'_> {
    fn run(&mut self) {
        self.nodes.push(BvhNode::EMPTY);
        let mut open = vec![(0_u32, 0_usize)];
        while let Some((root, target)) = open.pop() {
            let first = open.len();
            for (lane, child) in self.children(root).into_iter().enumerate() {
                let reference = self.leaf(child).unwrap_or_else(|| {
                    self.nodes.push(BvhNode::EMPTY);
                    open.push((child, self.nodes.len() - 1));
                    ChildRef::Node(self.nodes.len() as u32 - 1)
                });
                let node = &self.binary[child as usize];
                self.nodes[target].set_child(lane, (node.lower, node.upper), reference);
            }
            // What is beside the first child in memory is what rays visit after it.
            open[first..].reverse();
        }
    }

    /// The children of a node, the largest first: rays that want any hit begin with them.
    fn children(&self, root: u32) -> Vec<u32> {
        let mut children = children(self.binary, self.cuts, root);
        let area = |&index: &u32| self.binary[index as usize].half_area();
        children.sort_by(|a, b| area(b).total_cmp(&area(a)));
        children
    }

    fn leaf(&mut self, index: u32) -> Option<ChildRef> {
        if !self.cuts[index as usize].is_leaf {
            return None;
        }
        let primitive = match self.binary[index as usize].content {
            Content::Primitive(p) => self.builder.primitives[p as usize],
            Content::Children(..) => return Some(self.triangle_block(index)),
        };
        Some(match primitive.kind {
            TRIANGLE => self.triangle_block(index),
            SPHERE => ChildRef::Sphere(primitive.index),
            _ => ChildRef::Square(primitive.index),
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
                    let (b, c) = match self.form {
                        TriangleForm::Edges => (b - a, c - a),
                        TriangleForm::Corners => (b, c),
                    };
                    for axis in 0..3 {
                        block.a[axis][lane] = a[axis];
                        block.b[axis][lane] = b[axis];
                        block.c[axis][lane] = c[axis];
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
