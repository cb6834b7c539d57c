//! Builds the tree over lights that have a place: split where the orientation heuristic finds least cost (Conty Estevez & Kulla
//! 2018, section 4).

use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::emitter::{Emitter, POINT, SPHERE_LIGHT, SPOT, TRIANGLE_LIGHT, emitter_power};
use lightcuts_kernel::emitter_tree::EmitterNode;
use lightcuts_kernel::mip::mip_bilinear;
use lightcuts_kernel::ray::NONE;
use lightcuts_kernel::scatter::Images;

/// Places where a range may be split, per axis.
const BUCKETS: usize = 12;

/// The tree, root first, and each light's leaf.
pub(super) struct EmitterTree {
    pub(super) nodes: Vec<EmitterNode>,
    pub(super) leaves: Vec<u32>,
}

/// What holds some lights.
#[derive(Debug, Clone, Copy)]
struct Cluster {
    lower: Vec3,
    upper: Vec3,
    power: f32,
    axis: Vec3,
    /// Greatest angle between the axis and a light's own, in radians.
    spread: f32,
    /// Greatest angle from its own axis at which a light shines, in radians.
    reach: f32,
    two_sided: bool,
}

pub(super) fn build(emitters: &[Emitter], images: &Images<'_>) -> EmitterTree {
    let clusters: Vec<Cluster> = emitters.iter().map(|emitter| cluster(emitter, images)).collect();
    let mut order: Vec<u32> = (0..emitters.len() as u32).collect();
    let mut tree = EmitterTree { nodes: Vec::new(), leaves: vec![0; emitters.len()] };
    let mut open = if order.is_empty() { vec![] } else { vec![(0, order.len(), NONE)] };
    while let Some((first, end, parent)) = open.pop() {
        let index = tree.nodes.len() as u32;
        let part = &mut order[first..end];
        let all = part.iter().map(|&k| clusters[k as usize]).reduce(|a, b| a.with(&b)).expect("ranges are not empty");
        let mut node = all.node(parent);
        if let [only] = *part {
            (node.left, node.right) = (only, NONE);
            tree.leaves[only as usize] = index;
        } else {
            let middle = first + split(part, &clusters, &all);
            // Children learn their numbers when they are made: the first one next, the second one when its turn comes.
            open.push((middle, end, index));
            open.push((first, middle, index));
            (node.left, node.right) = (index + 1, 0);
        }
        tree.nodes.push(node);
        if let Some(above) = tree.nodes.get_mut(parent as usize).filter(|above| above.left != index) {
            above.right = index;
        }
    }
    tree
}

/// Brings a range into two parts; returns the length of the first.
fn split(part: &mut [u32], clusters: &[Cluster], all: &Cluster) -> usize {
    let center = |k: u32| clusters[k as usize].center();
    let (lower, upper) = part
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), &k| (lower.min(center(k)), upper.max(center(k))));
    let extent = upper - lower;
    let longest = (all.upper - all.lower).max_element();
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if extent[axis] <= 0.0 {
            continue;
        }
        let bucket = |k: u32| bucket_of(center(k)[axis], lower[axis], extent[axis]);
        let mut buckets: [Option<Cluster>; BUCKETS] = [None; BUCKETS];
        for &k in part.iter() {
            let slot = &mut buckets[bucket(k)];
            let own = clusters[k as usize];
            *slot = Some(slot.map_or(own, |held| held.with(&own)));
        }
        let join = |range: &[Option<Cluster>]| range.iter().flatten().copied().reduce(|a, b| a.with(&b));
        for border in 1..BUCKETS {
            let (Some(left), Some(right)) = (join(&buckets[..border]), join(&buckets[border..])) else { continue };
            let stretch = longest / (all.upper - all.lower)[axis].max(f32::MIN_POSITIVE);
            let cost = (left.cost() + right.cost()) * stretch;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, border));
            }
        }
    }
    let Some((_, axis, border)) = best else { return part.len() / 2 };
    let is_left = |k: u32| bucket_of(center(k)[axis], lower[axis], extent[axis]) < border;
    part.sort_by_key(|&k| !is_left(k));
    part.iter().filter(|&&k| is_left(k)).count()
}

fn bucket_of(place: f32, lower: f32, extent: f32) -> usize {
    (((place - lower) / extent * BUCKETS as f32) as usize).min(BUCKETS - 1)
}

fn cluster(emitter: &Emitter, images: &Images<'_>) -> Cluster {
    let pi = std::f32::consts::PI;
    let corners = match emitter.kind {
        POINT | SPOT => vec![emitter.position],
        SPHERE_LIGHT => vec![emitter.position - emitter.radius, emitter.position + emitter.radius],
        kind => {
            let (a, b, c) = (emitter.position, emitter.position + emitter.edge1, emitter.position + emitter.edge2);
            if kind == TRIANGLE_LIGHT { vec![a, b, c] } else { vec![a, b, c, b + emitter.edge2] }
        }
    };
    let (lower, upper) = corners.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, u), &p| (l.min(p), u.max(p)));
    let of_image = |image: u32| {
        let image = &images.images[image as usize];
        mip_bilinear(images.words, image, image.levels - 1, [0.5; 2]).truncate()
    };
    let mean = if emitter.image == NONE { Vec3::ONE } else { of_image(emitter.image) };
    let power = emitter_power(emitter) * mean;
    let (axis, spread, reach) = match emitter.kind {
        POINT | SPHERE_LIGHT => (Vec3::Z, pi, pi / 2.0),
        SPOT => (emitter.direction, 0.0, emitter.cos_outer.clamp(-1.0, 1.0).acos()),
        _ => (emitter.direction, 0.0, pi / 2.0),
    };
    Cluster {
        lower,
        upper,
        power: power.x + power.y + power.z,
        axis,
        spread,
        reach,
        two_sided: emitter.two_sided != 0 && emitter.kind != SPHERE_LIGHT,
    }
}

impl Cluster {
    fn center(&self) -> Vec3 {
        (self.lower + self.upper) * 0.5
    }

    fn with(&self, other: &Self) -> Self {
        let (axis, spread) = joined_cones((self.axis, self.spread), (other.axis, other.spread));
        Self {
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
            power: self.power + other.power,
            axis,
            spread,
            reach: self.reach.max(other.reach),
            two_sided: self.two_sided || other.two_sided,
        }
    }

    /// Power times area times a measure of the directions that it shines to.
    fn cost(&self) -> f32 {
        let d = self.upper - self.lower;
        let area = d.x * d.y + d.y * d.z + d.z * d.x;
        // Lights in one plane or line have no area; their extent keeps the cost above 0.
        let extent = area + 1e-3 * d.max_element() * d.max_element();
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        self.power * extent * directions(self.spread, self.reach) * sides
    }

    fn node(&self, parent: u32) -> EmitterNode {
        // Rounded outwards: angles a little wider.
        let cos = |angle: f32| (angle + 1e-4).min(std::f32::consts::PI).cos();
        EmitterNode {
            lower: self.lower,
            power: self.power,
            upper: self.upper,
            cos_axes: cos(self.spread),
            axis: self.axis,
            cos_reach: cos(self.reach),
            parent,
            two_sided: u32::from(self.two_sided),
            ..EmitterNode::zeroed()
        }
    }
}

/// The integral of the light over directions about a cone of axes (the paper's equation 1).
fn directions(spread: f32, reach: f32) -> f32 {
    let pi = std::f32::consts::PI;
    let end = (spread + reach).min(pi);
    2.0 * pi * (1.0 - spread.cos())
        + pi / 2.0
            * (2.0 * end * spread.sin() - (spread - 2.0 * end).cos() - 2.0 * spread * spread.sin() + spread.cos())
}

/// The least cone around two.
fn joined_cones((a, of_a): (Vec3, f32), (b, of_b): (Vec3, f32)) -> (Vec3, f32) {
    let pi = std::f32::consts::PI;
    let ((a, of_a), (b, of_b)) = if of_a >= of_b { ((a, of_a), (b, of_b)) } else { ((b, of_b), (a, of_a)) };
    let between = a.dot(b).clamp(-1.0, 1.0).acos();
    if (between + of_b).min(pi) <= of_a {
        return (a, of_a);
    }
    let half = f32::midpoint(of_a, between + of_b);
    let across = (b - a * a.dot(b)).normalize_or_zero();
    if half >= pi || across == Vec3::ZERO {
        return (a, pi);
    }
    let turn = half - of_a;
    ((a * turn.cos() + across * turn.sin()).normalize_or_zero(), half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::emitter::RECTANGLE_LIGHT;
    use lightcuts_kernel::rng::random4;

    fn emitters(count: u32) -> Vec<Emitter> {
        (0..count)
            .map(|k| {
                let [a, b, c, d] = random4(k, 0, 0, 1);
                let [e, f, ..] = random4(k, 1, 0, 1);
                let direction = (Vec3::new(d, e, f) - 0.5).normalize();
                let edge1 = direction.any_orthonormal_vector() * 0.1;
                Emitter {
                    kind: RECTANGLE_LIGHT,
                    position: Vec3::new(a, b, c) * 10.0,
                    edge1,
                    edge2: direction.cross(edge1),
                    area: 0.01,
                    direction,
                    color: Vec3::splat(1.0 + a),
                    image: NONE,
                    ..Emitter::zeroed()
                }
            })
            .collect()
    }

    #[test]
    fn every_light_has_its_leaf_and_every_node_holds_what_is_below() {
        for count in [0, 1, 2, 3, 500] {
            let mut emitters = emitters(count);
            // Some in one place.
            for k in 0..emitters.len() / 4 {
                emitters[k] = emitters[0];
            }
            let tree = build(&emitters, &Images { images: &[], words: &[] });
            assert_eq!(tree.nodes.len(), (2 * emitters.len()).saturating_sub(1));
            for (k, &leaf) in tree.leaves.iter().enumerate() {
                let node = &tree.nodes[leaf as usize];
                assert_eq!((node.left, node.right), (k as u32, NONE));
                let mut above = leaf;
                while above != NONE {
                    let node = &tree.nodes[above as usize];
                    let emitter = &emitters[k];
                    assert!(node.lower.cmple(emitter.position).all() && node.upper.cmpge(emitter.position).all());
                    assert!(node.axis.dot(emitter.direction) >= node.cos_axes - 1e-4);
                    let parent = node.parent;
                    if parent != NONE {
                        let parent = &tree.nodes[parent as usize];
                        assert!((parent.left == above) != (parent.right == above));
                    }
                    above = parent;
                }
            }
            if let Some(root) = tree.nodes.first() {
                let power: f32 = emitters.iter().map(|e| emitter_power(e).x * 3.0).sum();
                assert!((root.power / power - 1.0).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn cones_are_joined_tightly() {
        let (axis, half) = joined_cones((Vec3::X, 0.1), (Vec3::Y, 0.2));
        assert!((half - f32::midpoint(std::f32::consts::FRAC_PI_2, 0.3)).abs() < 1e-5);
        for (other, own) in [(Vec3::X, 0.1_f32), (Vec3::Y, 0.2)] {
            assert!(axis.dot(other).acos() + own <= half + 1e-4);
        }
        assert_eq!(joined_cones((Vec3::X, 1.0), (Vec3::X, 0.5)), (Vec3::X, 1.0));
        assert_eq!(joined_cones((Vec3::X, 0.0), (Vec3::NEG_X, 0.0)).1, std::f32::consts::PI);
    }
}
