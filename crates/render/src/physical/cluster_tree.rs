//! Station 4: the light tree of error-bounded cuts, split from the top in six dimensions: position and normal.

use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::cluster::{ClusterNode, LIGHT_CHILD, light_power};
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::virtual_light::VirtualLight;

/// Ranges of fewer lights are built by one thread.
const PARALLEL_LIGHTS: usize = 4096;

/// What a difference of normals counts for, relative to the diagonal of all lights.
const NORMAL_WEIGHT: f32 = 0.25;

/// Cosines of cones are lowered by so much: their lights' normals are rounded.
const CONE_MARGIN: f32 = 1e-5;

/// Virtual lights, in the order of the tree over them.
#[derive(Debug, Clone, Default)]
pub(crate) struct ClusterTree {
    pub(crate) lights: Vec<VirtualLight>,
    /// The first node is the root. One less than there are lights.
    pub(crate) nodes: Vec<ClusterNode>,
}

struct Builder<'a> {
    lights: &'a [VirtualLight],
    /// Factor on normals, in scene units.
    normal_scale: f32,
    stream: u32,
    is_over: &'a (dyn Fn() -> bool + Sync),
}

/// What a range of lights is told by.
#[derive(Debug, Clone, Copy)]
struct Summary {
    power: f32,
    /// Place of the representative in the tree's order.
    representative: u32,
}

impl ClusterTree {
    /// Builds the tree; `stream` decides which lights stand for their clusters. Once `is_over`, the tree is of no use.
    pub(crate) fn build(lights: &[VirtualLight], stream: u32, is_over: &(dyn Fn() -> bool + Sync)) -> Self {
        let (lower, upper) = lights.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), light| {
            (lower.min(light.position), upper.max(light.position))
        });
        let normal_scale = if lights.is_empty() { 0.0 } else { (upper - lower).length() * NORMAL_WEIGHT };
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        let mut nodes = vec![ClusterNode::zeroed(); lights.len().saturating_sub(1)];
        let builder = Builder { lights, normal_scale, stream, is_over };
        if !lights.is_empty() {
            builder.build(&mut nodes, &mut order, 0, 0);
        }
        Self { lights: order.iter().map(|&k| lights[k as usize]).collect(), nodes }
    }

    /// The root as a child reference; `None` without lights.
    pub(crate) fn root(&self) -> Option<u32> {
        match self.lights.len() {
            0 => None,
            1 => Some(LIGHT_CHILD),
            _ => Some(0),
        }
    }
}

impl Builder<'_> {
    /// Builds the subtree over a range: `nodes` are its own, one less than there are lights.
    fn build(&self, nodes: &mut [ClusterNode], order: &mut [u32], first_node: u32, first_light: u32) -> Summary {
        if let [only] = *order {
            return Summary { power: light_power(self.light(only).intensity), representative: first_light };
        }
        if order.len() > PARALLEL_LIGHTS && (self.is_over)() {
            return Summary { power: 0.0, representative: first_light };
        }
        let middle = self.split(order);
        let mut node = self.bounds(order);
        let (left_order, right_order) = order.split_at_mut(middle);
        let child = |count: usize, node: u32, light: u32| if count == 1 { LIGHT_CHILD | light } else { node };
        let second_light = first_light + middle as u32;
        node.left = child(left_order.len(), first_node + 1, first_light);
        node.right = child(right_order.len(), first_node + middle as u32, second_light);
        let Some((own, below)) = nodes.split_first_mut() else { unreachable!("a range of two lights has a node") };
        let (left_nodes, right_nodes) = below.split_at_mut(middle - 1);
        let left = |nodes, order| self.build(nodes, order, first_node + 1, first_light);
        let right = |nodes, order| self.build(nodes, order, first_node + middle as u32, second_light);
        let (a, b) = if left_order.len() + right_order.len() > PARALLEL_LIGHTS {
            rayon::join(|| left(left_nodes, left_order), || right(right_nodes, right_order))
        } else {
            (left(left_nodes, left_order), right(right_nodes, right_order))
        };
        node.power = a.power + b.power;
        // Drawn in proportion to power: always the stronger one would favour its light.
        let is_left = random4(first_node, first_light, 0, self.stream)[0] * node.power < a.power;
        node.representative = if is_left { a.representative } else { b.representative };
        *own = node;
        Summary { power: node.power, representative: node.representative }
    }

    fn light(&self, number: u32) -> &VirtualLight {
        &self.lights[number as usize]
    }

    /// A light as a point in six dimensions.
    fn point(&self, number: u32) -> [f32; 6] {
        let light = self.light(number);
        let (p, n) = (light.position, light.normal * self.normal_scale);
        [p.x, p.y, p.z, n.x, n.y, n.z]
    }

    /// Brings a range into two parts at the middle of its longest extent; returns the length of the first.
    fn split(&self, order: &mut [u32]) -> usize {
        let (mut lower, mut upper) = ([f32::INFINITY; 6], [f32::NEG_INFINITY; 6]);
        for &number in order.iter() {
            for (k, c) in self.point(number).into_iter().enumerate() {
                lower[k] = lower[k].min(c);
                upper[k] = upper[k].max(c);
            }
        }
        let extent = |k: usize| upper[k] - lower[k];
        let axis = (0..6).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
        let border = f32::midpoint(lower[axis], upper[axis]);
        let mut middle = 0;
        for k in 0..order.len() {
            if self.point(order[k])[axis] < border {
                order.swap(k, middle);
                middle += 1;
            }
        }
        // Lights in one place are halved by number.
        if middle == 0 || middle == order.len() { order.len() / 2 } else { middle }
    }

    /// Box and cone of a range.
    fn bounds(&self, order: &[u32]) -> ClusterNode {
        let (mut lower, mut upper, mut sum) = (Vec3::INFINITY, Vec3::NEG_INFINITY, Vec3::ZERO);
        for &number in order {
            let light = self.light(number);
            (lower, upper, sum) = (lower.min(light.position), upper.max(light.position), sum + light.normal);
        }
        let axis = sum.normalize_or(Vec3::Z);
        let cos = order.iter().map(|&number| axis.dot(self.light(number).normal)).fold(1.0, f32::min);
        ClusterNode { lower, upper, axis, cos_cone: (cos - CONE_MARGIN).max(-1.0), ..ClusterNode::zeroed() }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use lightcuts_kernel::ray::NONE;
    use lightcuts_kernel::virtual_light::pack_direction;

    pub(crate) fn scattered(count: u32) -> Vec<VirtualLight> {
        (0..count)
            .map(|k| {
                let [a, b, c, d] = random4(k, 0, 0, 9);
                let [e, f, g, _] = random4(k, 1, 0, 9);
                let normal = (Vec3::new(d, e, f) - 0.5).normalize_or(Vec3::X);
                VirtualLight {
                    position: Vec3::new(a, b, c) * 10.0,
                    table: NONE,
                    normal,
                    shading: pack_direction(normal),
                    intensity: Vec3::new(g, 0.5, b),
                    is_bent: 0,
                }
            })
            .collect()
    }

    /// Lights under a child, checked on the way.
    fn lights_under(tree: &ClusterTree, child: u32, seen: &mut [u32]) -> Vec<u32> {
        if child & LIGHT_CHILD != 0 {
            let light = child & !LIGHT_CHILD;
            seen[light as usize] += 1;
            return vec![light];
        }
        let node = &tree.nodes[child as usize];
        let mut lights = lights_under(tree, node.left, seen);
        lights.extend(lights_under(tree, node.right, seen));
        assert!(lights.contains(&node.representative));
        let power: f32 = lights.iter().map(|&k| light_power(tree.lights[k as usize].intensity)).sum();
        assert!((power - node.power).abs() <= 1e-4 * power);
        for &k in &lights {
            let light = &tree.lights[k as usize];
            assert!(node.lower.cmple(light.position).all() && node.upper.cmpge(light.position).all());
            assert!(node.axis.dot(light.normal) >= node.cos_cone);
        }
        lights
    }

    #[test]
    fn clusters_hold_their_lights_and_each_light_is_in_one_leaf() {
        for count in [0, 1, 2, 3, 1000, 9000] {
            let mut lights = scattered(count);
            for k in 0..lights.len() / 3 {
                lights[k] = lights[0];
            }
            let tree = ClusterTree::build(&lights, 5, &|| false);
            assert_eq!(tree.nodes.len(), lights.len().saturating_sub(1));
            let mut seen = vec![0; lights.len()];
            if let Some(root) = tree.root() {
                lights_under(&tree, root, &mut seen);
            }
            assert!(seen.iter().all(|&n| n == 1));
        }
    }

    #[test]
    fn lights_stand_for_clusters_by_power() {
        let mut lights = scattered(2);
        lights[0].intensity = Vec3::splat(3.0);
        lights[1].intensity = Vec3::splat(1.0);
        let trees = (0..4000).map(|stream| ClusterTree::build(&lights, stream, &|| false));
        let strong = trees.filter(|t| t.lights[t.nodes[0].representative as usize].intensity.x > 2.0).count();
        assert!((2880..3120).contains(&strong), "{strong}");
    }
}
