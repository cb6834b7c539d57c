//! The compressed hierarchy for GPUs, built by obvhs.

use crate::World;
use crate::binary_tree::{self, BinaryNode, Content};
use crate::bvh::LANES;
use crate::collapse::PADDING;
use glam::Vec3;
use lightcuts_kernel::cwbvh::{COMPRESSED_STACK_SIZE, CompressedGeometry, CompressedNode, LeafItem};
use lightcuts_kernel::intersect::{SPHERE, SQUARE, Square, TRIANGLE};
use lightcuts_kernel::ray::NONE;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;

/// Primitives of a leaf at most; the node format has room for three.
const LEAF_SIZE: u32 = 3;

/// Eight-wide nodes of 80 bytes over a world's primitives, and these in the order of the leaves.
#[derive(Debug, Clone, Default)]
pub struct CompressedHierarchy {
    /// Nodes; the first is the root. Empty if there is nothing to hit.
    pub nodes: Vec<CompressedNode>,
    /// Primitives in the order of the leaves.
    pub items: Vec<LeafItem>,
}

impl CompressedHierarchy {
    /// Builds the hierarchy over everything that rays can hit.
    pub fn new(world: &World) -> Self {
        let items = items(world);
        let corners = |item: &LeafItem| bounds(item, &world.shapes.squares);
        let reach = world.view.center.abs().max_element();
        let extent = items.iter().map(corners).fold(reach, |m, (a, b)| m.max(a.abs().max(b.abs()).max_element()));
        let padding = Vec3::splat(extent * PADDING);
        let boxes: Vec<(Vec3, Vec3)> = items.iter().map(corners).map(|(a, b)| (a - padding, b + padding)).collect();
        let built = build(&boxes);
        Self {
            nodes: bytemuck::cast_slice(&built.nodes).to_vec(),
            items: built.primitive_indices.iter().map(|&i| items[i as usize]).collect(),
        }
    }

    /// What rays can hit; `squares` are those of the world.
    pub fn geometry<'a>(&'a self, squares: &'a [Square]) -> CompressedGeometry<'a> {
        CompressedGeometry { nodes: &self.nodes, items: &self.items, squares }
    }
}

fn items(world: &World) -> Vec<LeafItem> {
    let lanes = world.shapes.triangles.iter().flat_map(|block| (0..LANES).map(move |lane| block.triangle(lane)));
    let triangles = lanes.filter(|triangle| triangle.primitive != NONE).map(|triangle| LeafItem {
        a: triangle.corner,
        primitive: triangle.primitive,
        b: triangle.edge1,
        kind: TRIANGLE,
        c: triangle.edge2,
        index: 0,
    });
    let spheres = world.shapes.spheres.iter().map(|sphere| LeafItem {
        a: sphere.center,
        primitive: sphere.primitive,
        b: Vec3::X * sphere.radius,
        kind: SPHERE,
        c: Vec3::ZERO,
        index: 0,
    });
    let squares = world.shapes.squares.iter().zip(0..).map(|(square, index)| LeafItem {
        a: square.center,
        primitive: square.primitive,
        b: Vec3::ZERO,
        kind: SQUARE,
        c: Vec3::ZERO,
        index,
    });
    triangles.chain(spheres).chain(squares).collect()
}

/// The box of an item.
fn bounds(item: &LeafItem, squares: &[Square]) -> (Vec3, Vec3) {
    match item.kind {
        TRIANGLE => {
            let (b, c) = (item.a + item.b, item.a + item.c);
            (item.a.min(b).min(c), item.a.max(b).max(c))
        }
        SPHERE => (item.a - item.b.x, item.a + item.b.x),
        _ => {
            let square = &squares[item.index as usize];
            let reach = (square.across * square.half_width).abs() + (square.along * square.half_height).abs();
            (square.center - reach, square.center + reach)
        }
    }
}

/// The tree of obvhs, compressed; a balanced one where that comes out too deep for the traversal's stack.
fn build(boxes: &[(Vec3, Vec3)]) -> CwBvh {
    if boxes.is_empty() {
        return CwBvh::default();
    }
    let compress = |tree: &[BinaryNode]| bvh2_to_cwbvh(&binary(tree), LEAF_SIZE, true, false);
    let built = compress(&binary_tree::build(boxes));
    if depth(&built) <= COMPRESSED_STACK_SIZE { built } else { compress(&binary_tree::balanced(boxes)) }
}

/// Levels of a hierarchy.
fn depth(built: &CwBvh) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0_u32, 1_u32)];
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        let node = &built.nodes[index as usize];
        let inner = (0..8).filter(|&child| !node.is_child_empty(child) && !node.is_leaf(child));
        open.extend(inner.map(|child| (node.child_node_index(child), level + 1)));
    }
    deepest
}

/// A balanced tree in the form that obvhs compresses: the two children of a node follow each other.
fn binary(tree: &[BinaryNode]) -> Bvh2 {
    let mut binary = Bvh2::default();
    let leaf = |node: &BinaryNode, first: u32, count: u32| {
        Bvh2Node::new(Aabb::new(node.lower.to_array().into(), node.upper.to_array().into()), count, first)
    };
    binary.nodes.push(leaf(&tree[0], 0, 0));
    let mut open = vec![(0_u32, 0_usize)];
    while let Some((index, place)) = open.pop() {
        match tree[index as usize].content {
            Content::Primitive(primitive) => {
                binary.nodes[place] = leaf(&tree[index as usize], binary.primitive_indices.len() as u32, 1);
                binary.primitive_indices.push(primitive);
            }
            Content::Children(left, right) => {
                let first = binary.nodes.len();
                binary.nodes.push(leaf(&tree[left as usize], 0, 0));
                binary.nodes.push(leaf(&tree[right as usize], 0, 0));
                binary.nodes[place] = leaf(&tree[index as usize], first as u32, 0);
                open.extend([(right, first + 1), (left, first)]);
            }
        }
    }
    binary
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh;
    use lightcuts_import::{ImportOptions, load};
    use lightcuts_kernel::Rules;
    use lightcuts_kernel::cwbvh::{any_hit, closest_hit};
    use lightcuts_kernel::ray::Ray;
    use lightcuts_kernel::rng::random4;
    use lightcuts_testkit::project_root;

    #[test]
    fn the_compressed_hierarchy_finds_the_hits_of_the_other() {
        for scene in ["thesis/simple.txt", "thesis/statue.txt", "thesis/ship.txt", "gallery/cubes.txt"] {
            let path = project_root().join("scenes").join(scene);
            let imported = load(&path, &ImportOptions::default()).expect("the project's own scene loads");
            let world = World::new(&imported.scene).expect("the scene is sound");
            let hierarchy = CompressedHierarchy::new(&world);
            let (compressed, plain) = (hierarchy.geometry(&world.shapes.squares), world.shapes.geometry());
            let mut hits = 0;
            for k in 0..10_000 {
                let [a, b, c, d] = random4(k, 0, 0, 17);
                let [e, f, g, _] = random4(k, 1, 0, 17);
                let origin = (Vec3::new(a, b, c) - 0.5) * 450.0;
                let direction = match k % 8 {
                    0 => Vec3::X,
                    1 => Vec3::NEG_Y,
                    2 => Vec3::new(0.0, 1.0, -1.0),
                    _ => (Vec3::new(e, f, g) - 0.5) * 450.0 - origin,
                };
                let t_max = if d < 0.5 { 1.0 } else { f32::INFINITY };
                let ray = Ray { origin, direction, t_min: 0.001, t_max, inside: k % 5 == 0 };
                let rules = [Rules::Original, Rules::Repaired][(k / 8 % 2) as usize];
                let expected = bvh::closest_hit(&plain, &ray, rules);
                hits += u32::from(expected.is_some());
                assert_eq!(closest_hit(&compressed, &ray, rules), expected, "{scene}, ray {k}");
                assert_eq!(any_hit(&compressed, &ray, rules), expected.is_some(), "{scene}, ray {k}");
            }
            assert!(hits > 2_000, "{hits}");
        }
    }

    #[test]
    fn every_primitive_is_in_one_leaf_even_where_all_coincide() {
        for boxes in [vec![(Vec3::ZERO, Vec3::ONE); 3000], vec![(Vec3::ZERO, Vec3::ONE)]] {
            let built = build(&boxes);
            assert!(depth(&built) <= COMPRESSED_STACK_SIZE);
            let mut indices = built.primitive_indices.clone();
            indices.sort_unstable();
            assert_eq!(indices, (0..boxes.len() as u32).collect::<Vec<_>>());
        }
    }
}
