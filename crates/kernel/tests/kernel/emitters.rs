//! Directions towards lights, and lights drawn from a tree, against their densities.

use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::emitter::{Emitter, RECTANGLE_LIGHT, SPHERE_LIGHT, TRIANGLE_LIGHT, emitter_pdf, sample_emitter};
use lightcuts_kernel::emitter_tree::{EmitterNode, Lit, leaf_probability, sample_emitter_tree};
use lightcuts_kernel::ray::NONE;
use lightcuts_kernel::rng::random4;
use lightcuts_testkit::chi_square::{ChiSquareTests, DirectionCells};

fn flat(kind: u32, position: Vec3, edge1: Vec3, edge2: Vec3) -> Emitter {
    let cross = edge1.cross(edge2);
    let area = cross.length() * if kind == TRIANGLE_LIGHT { 0.5 } else { 1.0 };
    let direction = cross.normalize();
    Emitter { kind, position, edge1, edge2, area, direction, color: Vec3::ONE, two_sided: 1, ..Emitter::zeroed() }
}

/// Where a ray from `point` meets a light first, as a distance.
fn distance(emitter: &Emitter, point: Vec3, direction: Vec3) -> Option<f32> {
    if emitter.kind == SPHERE_LIGHT {
        let to_center = emitter.position - point;
        let (along, gap_sq) = (to_center.dot(direction), to_center.cross(direction).length_squared());
        let half_chord = (emitter.radius * emitter.radius - gap_sq).max(0.0).sqrt();
        if half_chord == 0.0 {
            return None;
        }
        return [along - half_chord, along + half_chord].into_iter().find(|&t| t > 0.0);
    }
    let distance = (emitter.position - point).dot(emitter.direction) / direction.dot(emitter.direction);
    let place = point + direction * distance - emitter.position;
    // Coordinates along the edges, by areas.
    let normal = emitter.edge1.cross(emitter.edge2);
    let scale = 1.0 / normal.length_squared();
    let (s, t) = (place.cross(emitter.edge2).dot(normal) * scale, emitter.edge1.cross(place).dot(normal) * scale);
    let is_within = s >= 0.0 && t >= 0.0 && if emitter.kind == TRIANGLE_LIGHT { s + t <= 1.0 } else { s.max(t) <= 1.0 };
    (distance > 0.0 && is_within).then_some(distance)
}

/// Lights with the points that they are seen from: near, far, at a grazing angle, and from within.
fn views() -> Vec<(&'static str, Emitter, Vec3)> {
    let corner = Vec3::new(-1.0, 3.0, -0.5);
    let (edge1, edge2) = (Vec3::new(2.0, 0.0, 0.5), Vec3::new(0.3, 0.4, 1.5));
    let triangle = flat(TRIANGLE_LIGHT, corner, edge1, edge2);
    let rectangle = flat(RECTANGLE_LIGHT, corner, edge1, Vec3::new(-0.5, 0.0, 2.0));
    let sphere = Emitter {
        kind: SPHERE_LIGHT,
        position: corner,
        radius: 0.8,
        color: Vec3::ONE,
        two_sided: 1,
        ..Emitter::zeroed()
    };
    vec![
        ("triangle", triangle, Vec3::ZERO),
        ("near triangle", triangle, Vec3::new(0.1, 2.6, 0.1)),
        ("grazing triangle", triangle, Vec3::new(2.2, 2.6, 1.4)),
        ("rectangle", rectangle, Vec3::new(0.3, 0.2, 0.1)),
        ("near rectangle", rectangle, Vec3::new(0.0, 3.4, 0.7)),
        ("grazing rectangle", rectangle, Vec3::new(3.2, 2.5, 1.0)),
        ("sphere", sphere, Vec3::ZERO),
        ("near sphere", sphere, corner + Vec3::new(0.0, 0.6, 0.6)),
        ("sphere from within", sphere, corner + Vec3::new(0.2, -0.3, 0.1)),
    ]
}

#[test]
fn directions_towards_lights_have_their_density() {
    let mut tests = ChiSquareTests::default();
    for (name, emitter, point) in views() {
        let n = 200_000;
        let directions: Vec<Vec3> = (0..n)
            .map(|k| {
                let [a, b, ..] = random4(k, 0, 0, 21);
                let sample = sample_emitter(&emitter, point, [a, b]);
                let met = distance(&emitter, point, sample.direction);
                // At the rim of a light rounding decides whether a ray meets it.
                let rim = met.is_none_or(|met| (met / sample.distance - 1.0).abs() < 2e-2);
                assert!(rim, "{name}: {met:?} {}", sample.distance);
                sample.direction
            })
            .collect();
        // A cap that holds the whole light, and little more, so that its cells are small.
        let axis = directions.iter().sum::<Vec3>().normalize_or(Vec3::Z);
        let least = directions.iter().map(|direction| axis.dot(*direction)).fold(1.0, f32::min);
        let cells = DirectionCells::new(axis, (least - 0.02 * (1.0 - least)).max(-1.0), 12, 16);
        let density = |direction: Vec3| {
            distance(&emitter, point, direction).map_or(0.0, |met| emitter_pdf(&emitter, point, direction, met))
        };
        let integrals = cells.integrals([100, 100], density);
        let whole: f64 = integrals.iter().sum();
        assert!((whole - 1.0).abs() < 5e-3, "{name}: {whole}");
        let expected: Vec<f64> = integrals.iter().map(|of| of * f64::from(n)).collect();
        // Cells at the rim are cut by it, which the quadrature shows.
        tests.compare(name, &cells.count(directions.into_iter()), &expected, 0.005);
    }
    tests.check();
}

/// The test would notice a density by area that forgets the cosine at the light.
#[test]
#[should_panic(expected = "grazing rectangle")]
fn a_density_without_its_cosine_fails() {
    let (name, emitter, point) = views().swap_remove(5);
    let n = 200_000;
    let directions: Vec<Vec3> = (0..n)
        .map(|k| {
            let [a, b, ..] = random4(k, 0, 0, 22);
            sample_emitter(&emitter, point, [a, b]).direction
        })
        .collect();
    let axis = directions.iter().sum::<Vec3>().normalize();
    let cells = DirectionCells::new(axis, 0.8, 12, 16);
    let integrals =
        cells.integrals([60, 60], |direction| distance(&emitter, point, direction).map_or(0.0, |met| met * met));
    let whole: f64 = integrals.iter().sum();
    let expected: Vec<f64> = integrals.iter().map(|of| of / whole * f64::from(n)).collect();
    let mut tests = ChiSquareTests::default();
    tests.compare(name, &cells.count(directions.into_iter()), &expected, 0.005);
    tests.check();
}

/// Lights strewn through a room under a tree that halves them by number: boxes overlap, powers and axes differ.
fn tree(lights: u32) -> Vec<EmitterNode> {
    let leaf = |k: u32| {
        let [a, b, c, power] = random4(k, 0, 0, 23);
        let [d, e, f, reach] = random4(k, 1, 0, 23);
        let lower = Vec3::new(a, b, c) * 4.0;
        EmitterNode {
            lower,
            upper: lower + Vec3::new(0.3, 0.0, 0.2),
            power: 0.1 + power,
            axis: (Vec3::new(d, e, f) - 0.5).normalize(),
            cos_axes: 1.0,
            cos_reach: if reach < 0.5 { 0.0 } else { -1.0 },
            left: k,
            right: NONE,
            parent: NONE,
            ..EmitterNode::zeroed()
        }
    };
    let mut nodes = Vec::new();
    build(&mut nodes, &(0..lights).map(leaf).collect::<Vec<_>>(), NONE);
    nodes
}

fn build(nodes: &mut Vec<EmitterNode>, leaves: &[EmitterNode], parent: u32) -> u32 {
    let index = nodes.len() as u32;
    if let [only] = *leaves {
        nodes.push(EmitterNode { parent, ..only });
        return index;
    }
    nodes.push(EmitterNode::zeroed());
    let (first, second) = leaves.split_at(leaves.len() / 2);
    let (left, right) = (build(nodes, first, index), build(nodes, second, index));
    let (a, b) = (nodes[left as usize], nodes[right as usize]);
    // Axes of all directions: a cone of both would narrow the choice, which is not what is tested.
    nodes[index as usize] = EmitterNode {
        lower: a.lower.min(b.lower),
        upper: a.upper.max(b.upper),
        power: a.power + b.power,
        axis: Vec3::Y,
        cos_axes: -1.0,
        cos_reach: a.cos_reach.min(b.cos_reach),
        left,
        right,
        parent,
        ..EmitterNode::zeroed()
    };
    index
}

#[test]
fn lights_are_drawn_from_the_tree_with_their_probability() {
    let nodes = tree(200);
    let mut tests = ChiSquareTests::default();
    for view in 0..12 {
        let [a, b, c, d] = random4(view, 2, 0, 23);
        let [e, f, both, _] = random4(view, 3, 0, 23);
        let lit = Lit {
            point: Vec3::new(a, b, c) * 3.0 + 0.5,
            normal: (Vec3::new(d, e, f) - 0.5).normalize(),
            both_sides: both < 0.25,
        };
        let n = 200_000;
        // One cell for each light, and one for draws that find none.
        let (mut counts, mut expected) = (vec![0.0; 201], vec![0.0; 201]);
        for k in 0..n {
            let drawn = sample_emitter_tree(&nodes, &lit, [random4(k, view, 0, 24)[0]])[0];
            counts[drawn.map_or(200, |(light, _)| light as usize)] += 1.0;
        }
        for (index, node) in nodes.iter().enumerate().filter(|(_, node)| node.right == NONE) {
            expected[node.left as usize] = f64::from(leaf_probability(&nodes, index as u32, &lit)) * f64::from(n);
        }
        expected[200] = (f64::from(n) - expected.iter().sum::<f64>()).max(0.0);
        if expected[200] < 1e-4 * f64::from(n) {
            expected[200] = 0.0;
        }
        tests.compare(format!("view {view}"), &counts, &expected, 0.0);
    }
    tests.check();
}
