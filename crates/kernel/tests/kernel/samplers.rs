//! Cones, microfacets and places on a lens against their densities.

use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::ggx::{sample_visible_normal, visible_normal_pdf};
use lightcuts_kernel::lens::{Lens, lens_ray};
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::sampling::sample_cosine_cone;
use lightcuts_testkit::chi_square::{ChiSquareTests, DirectionCells};
use std::f32::consts::PI;

fn random2(k: u32, purpose: u32) -> [f32; 2] {
    let [a, b, ..] = random4(k, purpose, 0, 41);
    [a, b]
}

#[test]
fn cones_are_sampled_by_cosine() {
    let mut tests = ChiSquareTests::default();
    for (normal, sin_max) in [(Vec3::Z, 1.0), (Vec3::new(0.6, 0.0, -0.8), 0.7), (Vec3::NEG_Z, 0.05_f32)] {
        let n = 200_000;
        let least = (1.0 - sin_max * sin_max).sqrt();
        let cells = DirectionCells::new(normal, least - 1e-5, 12, 24);
        let counts = cells.count((0..n).map(|k| sample_cosine_cone(normal, sin_max, random2(k, 0))));
        let density = |direction: Vec3| {
            let cos = normal.dot(direction);
            if cos < least { 0.0 } else { cos / (PI * sin_max * sin_max) }
        };
        let expected: Vec<f64> = cells.integrals([40, 10], density).iter().map(|of| of * f64::from(n)).collect();
        // The lowest ring reaches a little below the cone, so that rounding loses no direction.
        tests.compare(format!("{normal}, {sin_max}"), &counts, &expected, 0.01);
    }
    tests.check();
}

#[test]
fn visible_normals_have_their_density() {
    let mut tests = ChiSquareTests::default();
    for alpha in [0.15, 0.5, 1.0] {
        for cos in [1.0_f32, 0.6, 0.15] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let n = 200_000;
            let cells = DirectionCells::new(Vec3::Z, 0.0, 16, 16);
            let counts = cells.count((0..n).map(|k| sample_visible_normal(wo, alpha, random2(k, 1))));
            let integrals = cells.integrals([100, 16], |h| visible_normal_pdf(wo, h, alpha));
            let expected: Vec<f64> = integrals.iter().map(|of| of * f64::from(n)).collect();
            tests.compare(format!("width {alpha} from {cos}"), &counts, &expected, 0.005);
        }
    }
    tests.check();
}

#[test]
fn places_on_a_lens_are_uniform() {
    let lens = Lens {
        half_height: 0.5,
        forward: Vec3::NEG_Z,
        right: Vec3::X,
        up: Vec3::Y,
        radius: 0.3,
        focus: 4.0,
        width: 200,
        height: 100,
        ..Lens::zeroed()
    };
    let n = 100_000;
    let (rings, sectors) = (8, 16);
    let mut counts = vec![0.0; rings * sectors];
    for k in 0..n {
        let place = lens_ray(&lens, [37.0, 81.0], random2(k, 2)).origin / lens.radius;
        let part = |share: f32, of: usize| ((share * of as f32) as usize).min(of - 1);
        // Rings of equal area.
        let ring = part(place.x * place.x + place.y * place.y, rings);
        counts[ring * sectors + part(place.y.atan2(place.x) / (2.0 * PI) + 0.5, sectors)] += 1.0;
    }
    let mut tests = ChiSquareTests::default();
    tests.compare("lens", &counts, &vec![f64::from(n) / (rings * sectors) as f64; rings * sectors], 0.0);
    tests.check();
}
