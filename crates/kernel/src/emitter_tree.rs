//! A tree over lights that have a place, from which one is drawn by how much it may matter (Conty Estevez & Kulla 2018,
//! "Importance Sampling of Many Lights with Adaptive Tree Splitting").

use crate::ray::NONE;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A node: lights in a box, that shine about an axis. 80 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct EmitterNode {
    /// Lower corner of the box.
    pub lower: Vec3,
    /// Sum of the lights' powers.
    pub power: f32,
    /// Upper corner.
    pub upper: Vec3,
    /// Cosine of the greatest angle between the axis and a light's own.
    pub cos_axes: f32,
    /// Unit axis.
    pub axis: Vec3,
    /// Cosine of the greatest angle from its own axis at which a light shines.
    pub cos_reach: f32,
    /// First child; of a leaf the light.
    pub left: u32,
    /// Second child; [`NONE`] of a leaf.
    pub right: u32,
    /// The node above; [`NONE`] of the root.
    pub parent: u32,
    /// Whether a light shines to both sides of its axis.
    pub two_sided: u32,
    /// Unused.
    pub padding: [u32; 4],
}

/// Who is to be lit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lit {
    /// Position.
    pub point: Vec3,
    /// Unit normal, on the side from which light matters.
    pub normal: Vec3,
    /// Whether light from both sides matters.
    pub both_sides: bool,
}

/// Cosine of the difference of two angles, or 1 where the first is the smaller.
pub fn cos_of_difference(cos_a: f32, cos_b: f32) -> f32 {
    if cos_a >= cos_b {
        return 1.0;
    }
    let sin = |cos: f32| (1.0 - cos * cos).max(0.0).sqrt();
    cos_a * cos_b + sin(cos_a) * sin(cos_b)
}

/// How much a node's lights may matter. 0 only if none of them can shine on the point.
pub fn emitter_importance(node: &EmitterNode, lit: &Lit) -> f32 {
    let center = (node.lower + node.upper) * 0.5;
    let radius_sq = (node.upper - node.lower).length_squared() * 0.25;
    let to_point = lit.point - center;
    let distance_sq = to_point.length_squared();
    let floor = distance_sq.max(radius_sq).max(f32::MIN_POSITIVE);
    if distance_sq <= radius_sq * 1.001 || distance_sq == 0.0 {
        // Somewhere among the lights.
        return node.power / floor;
    }
    let direction = to_point / distance_sq.sqrt();
    // Half angle of a cone that holds the box.
    let cos_box = (1.0 - radius_sq / distance_sq).max(0.0).sqrt();
    let along = node.axis.dot(direction);
    let cos_axis = if node.two_sided != 0 { along.abs() } else { along };
    let cos_emitted = cos_of_difference(cos_of_difference(cos_axis, node.cos_axes), cos_box);
    if cos_emitted < node.cos_reach - 1e-5 {
        return 0.0;
    }
    let facing = -lit.normal.dot(direction);
    let cos_received = cos_of_difference(if lit.both_sides { facing.abs() } else { facing }, cos_box);
    if cos_received < -1e-5 {
        return 0.0;
    }
    // At the edges of both hemispheres rounding must not lose a light that shines.
    node.power * cos_emitted.max(1e-4) * cos_received.max(1e-4) / floor
}

/// A light for each random number, drawn by importance, with its probability; `None` where it is found that none can shine on the
/// point. Lights that are drawn together share the way down the tree as far as it is the same.
pub fn sample_emitter_tree<const N: usize>(
    nodes: &[EmitterNode],
    lit: &Lit,
    randoms: [f32; N],
) -> [Option<(u32, f32)>; N] {
    let mut found = [None; N];
    let mut numbers = randoms;
    // Those on the same way are neighbours in the order.
    let mut order: [usize; N] = std::array::from_fn(|k| k);
    // Ways that are still to be gone: a node, its probability, and the first and the end of those that go there.
    let mut open = [(0_usize, 1.0_f32, 0, N); N];
    let mut size = N.min(1);
    while size > 0 {
        size -= 1;
        let (mut index, mut probability, first, mut end) = open[size];
        while let Some(node) = nodes.get(index) {
            if node.right == NONE {
                if index != 0 || emitter_importance(node, lit) > 0.0 {
                    order[first..end].iter().for_each(|&k| found[k] = Some((node.left, probability)));
                }
                break;
            }
            let Some(left) = left_probability(nodes, node, lit) else { break };
            let mut middle = first;
            for place in first..end {
                let k = order[place];
                if numbers[k] < left {
                    numbers[k] /= left;
                    order.swap(place, middle);
                    middle += 1;
                } else {
                    numbers[k] = ((numbers[k] - left) / (1.0 - left)).min(1.0 - f32::EPSILON);
                }
            }
            let right = (node.right as usize, probability * (1.0 - left), middle, end);
            if middle == first {
                (index, probability, ..) = right;
                continue;
            }
            if middle < end {
                open[size] = right;
                size += 1;
            }
            (index, probability, end) = (node.left as usize, probability * left, middle);
        }
    }
    found
}

/// The probability with which [`sample_emitter_tree`] comes to a leaf.
pub fn leaf_probability(nodes: &[EmitterNode], leaf: u32, lit: &Lit) -> f32 {
    let (mut index, mut probability) = (leaf, 1.0);
    if nodes[leaf as usize].parent == NONE {
        return if emitter_importance(&nodes[leaf as usize], lit) > 0.0 { 1.0 } else { 0.0 };
    }
    loop {
        let above = nodes[index as usize].parent;
        if above == NONE {
            return probability;
        }
        let node = &nodes[above as usize];
        let Some(left) = left_probability(nodes, node, lit) else { return 0.0 };
        probability *= if node.left == index { left } else { 1.0 - left };
        index = above;
    }
}

/// The probability of a node's first child; `None` if no child matters.
fn left_probability(nodes: &[EmitterNode], node: &EmitterNode, lit: &Lit) -> Option<f32> {
    let left = emitter_importance(&nodes[node.left as usize], lit);
    let right = emitter_importance(&nodes[node.right as usize], lit);
    (left + right > 0.0).then(|| left / (left + right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;

    /// Sixteen lights in a row under a complete tree, each shining down.
    fn tree() -> Vec<EmitterNode> {
        let leaf = |k: u32| EmitterNode {
            lower: Vec3::new(k as f32, 1.0, 0.0),
            upper: Vec3::new(k as f32 + 0.5, 1.0, 0.3),
            power: 1.0 + (k % 3) as f32,
            axis: Vec3::NEG_Y,
            cos_axes: 1.0,
            cos_reach: 0.0,
            left: k,
            right: NONE,
            ..EmitterNode::zeroed()
        };
        let mut nodes = vec![EmitterNode::zeroed(); 31];
        for k in 0..16 {
            nodes[15 + k as usize] = leaf(k);
        }
        for k in (0..15).rev() {
            let (a, b) = (nodes[2 * k + 1], nodes[2 * k + 2]);
            nodes[k] = EmitterNode {
                lower: a.lower.min(b.lower),
                upper: a.upper.max(b.upper),
                power: a.power + b.power,
                left: 2 * k as u32 + 1,
                right: 2 * k as u32 + 2,
                ..a
            };
        }
        for (k, node) in nodes.iter_mut().enumerate() {
            node.parent = if k == 0 { NONE } else { (k as u32 - 1) / 2 };
        }
        nodes
    }

    #[test]
    fn lights_are_drawn_with_their_probability() {
        let nodes = tree();
        let lit = Lit { point: Vec3::new(3.0, 0.0, 0.1), normal: Vec3::Y, both_sides: false };
        let mut counts = [0_u32; 16];
        let n = 100_000;
        for k in 0..n {
            let (light, probability) = sample_emitter_tree(&nodes, &lit, [random4(k, 0, 0, 1)[0]])[0].unwrap();
            counts[light as usize] += 1;
            let again = leaf_probability(&nodes, 15 + light, &lit);
            assert!((again / probability - 1.0).abs() < 1e-4);
        }
        let total: f32 = (0..16).map(|k| leaf_probability(&nodes, 15 + k, &lit)).sum();
        assert!((total - 1.0).abs() < 1e-4, "{total}");
        for (k, &count) in counts.iter().enumerate() {
            let wanted = leaf_probability(&nodes, 15 + k as u32, &lit) * n as f32;
            assert!((count as f32 - wanted).abs() < 6.0 * wanted.max(1.0).sqrt(), "{k}: {count} {wanted}");
        }
        assert!(counts[3] > counts[12]);
    }

    #[test]
    fn lights_that_are_drawn_together_are_those_that_are_drawn_alone() {
        let nodes = tree();
        for k in 0..2_000 {
            let [a, b, c, d] = random4(k, 0, 0, 2);
            let lit = Lit { point: Vec3::new(a, b, c) * 3.0, normal: Vec3::Y, both_sides: d < 0.5 };
            let numbers: [f32; 8] = std::array::from_fn(|place| random4(k, place as u32, 0, 3)[0]);
            let alone = numbers.map(|number| sample_emitter_tree(&nodes, &lit, [number])[0]);
            assert_eq!(sample_emitter_tree(&nodes, &lit, numbers), alone);
        }
    }

    #[test]
    fn what_cannot_shine_is_not_drawn() {
        let nodes = tree();
        let above = Lit { point: Vec3::new(3.0, 5.0, 0.1), normal: Vec3::NEG_Y, both_sides: false };
        assert_eq!(sample_emitter_tree(&nodes, &above, [0.5])[0], None);
        let away = Lit { point: Vec3::new(3.0, -50.0, 0.1), normal: Vec3::NEG_Y, both_sides: false };
        assert_eq!(sample_emitter_tree(&nodes, &away, [0.5])[0], None);
        assert!(sample_emitter_tree(&nodes, &Lit { both_sides: true, ..away }, [0.5])[0].is_some());
        assert_eq!(sample_emitter_tree(&[], &away, [0.5])[0], None);
    }

    /// Any point of a box from which an emitter of the cone shines on the receiver has importance.
    #[test]
    fn no_light_that_shines_is_without_importance() {
        for k in 0..20_000 {
            let [a, b, c, d] = random4(k, 1, 0, 1);
            let [e, f, g, h] = random4(k, 2, 0, 1);
            let axis = (Vec3::new(e, f, g) - 0.5).normalize();
            let node = EmitterNode {
                lower: Vec3::ZERO,
                upper: Vec3::new(a, b, c),
                power: 1.0,
                axis,
                cos_axes: 1.0,
                cos_reach: 0.0,
                right: NONE,
                ..EmitterNode::zeroed()
            };
            let [i, j, l, m] = random4(k, 3, 0, 1);
            let lit = Lit {
                point: (Vec3::new(d, h, i) - 0.5) * 4.0,
                normal: (Vec3::new(j, l, m) - 0.5).normalize(),
                both_sides: false,
            };
            let [p, q, r, _] = random4(k, 4, 0, 1);
            let place = node.upper * Vec3::new(p, q, r);
            let to_light = (place - lit.point).normalize();
            if lit.normal.dot(to_light) > 0.0 && axis.dot(-to_light) > 0.0 {
                assert!(emitter_importance(&node, &lit) > 0.0, "{node:?} {lit:?}");
            }
        }
    }
}
