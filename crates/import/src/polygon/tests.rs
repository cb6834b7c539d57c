use super::*;
use glam::Quat;

/// Numbers from 0 to 1, the same in every run: a linear congruential generator (Knuth's MMIX).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f32) as usize % count
    }
}

/// What becomes of a polygon, with twice its area and that of each triangle, along the normal.
fn cut(corners: &[Vec3], normal: Vec3) -> (Vec<[u32; 3]>, Outcome, f64, Vec<f64>) {
    let mut cutter = Cutter::new(Cut::Outlines);
    let (triangles, outcome) = cutter.cut(corners);
    let doubled = |points: &[Vec3]| {
        let point = |i: usize| points[i % points.len()].as_dvec3() - points[0].as_dvec3();
        (0..points.len()).map(|i| point(i).cross(point(i + 1)).dot(normal.as_dvec3())).sum::<f64>()
    };
    let areas = triangles.iter().map(|t| doubled(&t.map(|i| corners[i as usize]))).collect();
    (triangles.to_vec(), outcome, doubled(corners), areas)
}

/// A polygon in the plane z = 0, from its corners' x and y.
fn flat(corners: &[[f32; 2]]) -> Vec<Vec3> {
    corners.iter().map(|[x, y]| Vec3::new(*x, *y, 0.0)).collect()
}

/// Asserts that triangles cover a polygon of the plane z = 0 and nothing else: at drawn points, as the even-odd rule has it.
fn assert_covers(corners: &[Vec3], numbers: &mut Numbers, what: &str) {
    let (triangles, outcome, area, areas) = cut(corners, Vec3::Z);
    assert_eq!((triangles.len(), outcome), (corners.len() - 2, Outcome::Covered), "{what}");
    let sign = area.signum();
    assert!(areas.iter().all(|one| one * sign >= -1e-5 * area.abs()), "{what}: {areas:?}");
    assert!((areas.iter().sum::<f64>() - area).abs() < 1e-5 * area.abs(), "{what}");
    let (low, high) = corners.iter().fold((Vec3::MAX, Vec3::MIN), |(l, h), p| (l.min(*p), h.max(*p)));
    for _ in 0..40 {
        let at = low + (high - low) * Vec3::new(numbers.next(), numbers.next(), 0.0);
        let side = |a: Vec3, b: Vec3| (b - a).cross(at - a).z;
        let edges = || (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        if edges().any(|(a, b)| side(a, b).abs() < 1e-4 * (b - a).length()) {
            continue;
        }
        let crossed =
            edges().filter(|(a, b)| (a.y > at.y) != (b.y > at.y) && (side(*a, *b) > 0.0) == (b.y > a.y)).count();
        let holds = |t: &&[u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            let sides = [side(a, b), side(b, c), side(c, a)];
            sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
        };
        // Edges between triangles may pass through the point.
        assert!(triangles.iter().filter(holds).count() <= crossed % 2, "{what}: {at}");
    }
}

/// x-monotone polygons: two chains of random heights that do not meet.
fn mountains(numbers: &mut Numbers) -> Vec<Vec3> {
    let (above, below) = (1 + numbers.below(12), 1 + numbers.below(12));
    let mut chain = |count: usize, sign: f32| -> Vec<[f32; 2]> {
        (0..count).map(|i| [(i + 1) as f32 / (count + 1) as f32, sign * (0.02 + numbers.next())]).collect()
    };
    let (lower, mut upper) = (chain(below, -1.0), chain(above, 1.0));
    upper.reverse();
    flat(&[vec![[0.0, 0.0]], lower, vec![[1.0, 0.0]], upper].concat())
}

/// Two turns of a band.
fn spiral(steps: usize) -> Vec<Vec3> {
    let at = |i: usize, width: f32| {
        let turn = i as f32 / steps as f32;
        let (radius, angle) = (1.0 + turn * 2.0 + width, turn * 4.0 * std::f32::consts::PI);
        [radius * angle.cos(), radius * angle.sin()]
    };
    flat(
        &[(0..=steps).map(|i| at(i, 0.0)).rev().collect::<Vec<_>>(), (0..=steps).map(|i| at(i, 0.5)).collect()]
            .concat(),
    )
}

/// A comb with so many teeth.
fn comb(teeth: usize) -> Vec<Vec3> {
    let tooth = |i: usize| [[i as f32 + 0.3, 1.0], [i as f32 + 0.5, 9.0], [i as f32 + 0.7, 1.0]];
    let mut corners = vec![[0.0, 0.0], [teeth as f32, 0.0]];
    corners.extend((0..teeth).rev().flat_map(|i| tooth(i).into_iter().rev()));
    flat(&corners)
}

#[test]
fn simple_polygons_are_covered_whatever_their_first_corner_and_direction() {
    let mut numbers = Numbers(1);
    for i in 0..600 {
        let mut corners = match i % 3 {
            0 => mountains(&mut numbers),
            1 => comb(1 + numbers.below(6)),
            _ => spiral(14 + numbers.below(40)),
        };
        let count = corners.len();
        corners.rotate_left(numbers.below(count));
        if i % 2 == 1 {
            corners.reverse();
        }
        assert_covers(&corners, &mut numbers, &format!("{i}: {corners:?}"));
    }
}

#[test]
fn convex_polygons_keep_their_fan() {
    let mut numbers = Numbers(2);
    for i in 0..2000 {
        let count = 4 + numbers.below(9);
        let mut angles: Vec<f32> = (0..count).map(|_| numbers.next() * std::f32::consts::TAU).collect();
        angles.sort_by(f32::total_cmp);
        let turn =
            Quat::from_euler(glam::EulerRot::XYZ, numbers.next() * 7.0, numbers.next() * 7.0, numbers.next() * 7.0);
        let shift = Vec3::new(numbers.next(), numbers.next(), numbers.next()) * 100.0;
        // Not quite flat either, as quads of models are.
        let point = |angle: f32, lift: f32| turn * Vec3::new(angle.cos() * 3.0, angle.sin(), lift) + shift;
        let corners: Vec<Vec3> = angles.iter().map(|angle| point(*angle, 0.003 * (numbers.next() - 0.5))).collect();
        let (triangles, outcome, ..) = cut(&corners, Vec3::Z);
        assert_eq!((triangles, outcome), (fan(count).collect(), Outcome::Covered), "{i}: {corners:?}");
    }
    // Corners in a row are convex too.
    let square = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [0.0, 2.0], [0.0, 1.0]]);
    assert_eq!(cut(&square, Vec3::Z).0, fan(7).collect::<Vec<_>>());
}

/// A square hole is part of the outline by a bridge that is walked both ways, to any corner and from any start.
#[test]
fn holes_with_a_bridge_stay_open() {
    let mut numbers = Numbers(3);
    let outside = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let hole = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0]];
    for bridge in 0..4 {
        let ring: Vec<[f32; 2]> = (0..=4).map(|i| hole[(i + bridge) % 4]).collect();
        let from = [0, 3, 2, 1][bridge];
        let outline: Vec<[f32; 2]> = (0..=4).map(|i| outside[(i + from) % 4]).collect();
        let mut corners = flat(&[outline, ring].concat());
        for _ in 0..10 {
            assert_covers(&corners, &mut numbers, &format!("{corners:?}"));
            corners.rotate_left(1);
        }
    }
}

/// Parts that meet in one corner only, which the outline passes once for each of them.
#[test]
fn outlines_that_touch_themselves_in_a_corner_are_covered() {
    let mut numbers = Numbers(5);
    let wings = flat(&[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 2.0], [1.0, 1.0], [0.0, 2.0]]);
    let (triangles, outcome, area, areas) = cut(&wings, Vec3::Z);
    assert_eq!((triangles.len(), outcome, area, areas.iter().sum::<f64>()), (4, Outcome::Covered, 4.0, 4.0));
    assert!(areas.iter().all(|area| *area >= 0.0), "{areas:?}");
    for i in 0..300 {
        let petals = 2 + numbers.below(5);
        let at = |angle: f32, radius: f32| [radius * angle.cos(), radius * angle.sin()];
        let wedge = std::f32::consts::TAU / petals as f32;
        let mut corners = Vec::new();
        for petal in 0..petals {
            corners.push([0.0, 0.0]);
            let count = 2 + numbers.below(4);
            let angle = |k: usize| wedge * (petal as f32 + 0.1 + 0.7 * k as f32 / count as f32);
            corners.extend((0..count).map(|k| at(angle(k), 0.3 + numbers.next())));
        }
        let mut corners = flat(&corners);
        let count = corners.len();
        corners.rotate_left(numbers.below(count));
        if i % 2 == 1 {
            corners.reverse();
        }
        let turn = Quat::from_euler(glam::EulerRot::XYZ, numbers.next(), numbers.next(), numbers.next());
        assert_covers(&corners, &mut numbers, &format!("{i}: {corners:?}"));
        let turned: Vec<Vec3> = corners.iter().map(|corner| turn * *corner).collect();
        assert_eq!(cut(&turned, turn * Vec3::Z).1, Outcome::Covered, "{i}: {turned:?}");
    }
}

#[test]
fn polygons_in_space_are_cut_in_their_plane() {
    // A U of area 2.8, seen along each axis and across.
    let shape =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.4, 1.0], [0.4, -0.5], [-0.4, -0.5], [-0.4, 1.0], [-1.0, 1.0]];
    for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z, Vec3::new(1.0, 2.0, 3.0)] {
        let normal = axis.normalize();
        let turn = Quat::from_rotation_arc(Vec3::Z, normal);
        let corners: Vec<Vec3> = flat(&shape).iter().map(|corner| turn * *corner * 1000.0 + Vec3::splat(5e4)).collect();
        let (triangles, outcome, area, areas) = cut(&corners, normal);
        assert_eq!((triangles.len(), outcome), (6, Outcome::Covered));
        assert!((area / 2e6 - 2.8).abs() < 1e-3, "{area}");
        assert!(areas.iter().all(|area| *area > 0.0), "{axis}: {areas:?}");
    }
}

#[test]
fn broken_polygons_become_fans() {
    let bow = flat(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]]);
    let line = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]);
    let star = flat(&[[0.0, 3.0], [-2.0, -2.0], [3.0, 1.0], [-3.0, 1.0], [2.0, -2.0]]);
    for corners in [bow, line, star, vec![Vec3::ONE; 5]] {
        let (triangles, outcome, ..) = cut(&corners, Vec3::Z);
        assert_eq!((triangles, outcome), (fan(corners.len()).collect(), Outcome::Broken), "{corners:?}");
    }
}

#[test]
fn large_polygons_do_not_take_for_ever() {
    let start = std::time::Instant::now();
    for corners in [comb(20_000), spiral(3_000)] {
        let (triangles, outcome, _, areas) = cut(&corners, Vec3::Z);
        assert_eq!((triangles.len(), outcome), (corners.len() - 2, Outcome::Covered));
        assert!(areas.iter().all(|area| *area > -1e-3));
    }
    // What crosses itself everywhere is given up.
    let mut numbers = Numbers(4);
    let scribble: Vec<Vec3> = (0..20_000).map(|_| Vec3::new(numbers.next(), numbers.next(), 0.0)).collect();
    assert_eq!(cut(&scribble, Vec3::Z).1, Outcome::Broken);
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}
