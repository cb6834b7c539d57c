//! Directions towards an environment against their density.

use glam::Vec3;
use lightcuts_kernel::environment::{Environment, EnvironmentMap, environment_pdf, interval_of, sample_environment};
use lightcuts_kernel::rng::random4;
use lightcuts_testkit::chi_square::{ChiSquareTests, DirectionCells};

const WIDTH: usize = 16;
const HEIGHT: usize = 8;

/// Sums of weights from 0 to 1.
fn sums(weights: &[f64]) -> Vec<f32> {
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    let inner = weights.iter().map(|weight| {
        sum += weight / total;
        sum as f32
    });
    std::iter::once(0.0).chain(inner).collect()
}

/// A sky with a bright place, dark pixels and a black one.
fn weights() -> Vec<f64> {
    let weight = |k: usize| if k == 40 { 30.0 } else { (k * 7 % 5) as f64 };
    (0..WIDTH * HEIGHT).map(weight).collect()
}

#[test]
fn directions_towards_an_environment_have_their_density() {
    let weights = weights();
    let pixels: Vec<[f32; 3]> = weights.iter().map(|&weight| [weight as f32; 3]).collect();
    let rows = sums(&weights.chunks(WIDTH).map(|row| row.iter().sum()).collect::<Vec<_>>());
    let columns: Vec<f32> = weights.chunks(WIDTH).flat_map(sums).collect();
    let mut tests = ChiSquareTests::default();
    for (turn, axis) in [(0.0_f32, Vec3::Y), (0.7, Vec3::Y), (2.9, Vec3::new(0.36, 0.48, 0.8))] {
        let (sin, cos) = turn.sin_cos();
        let (width, height) = (WIDTH as u32, HEIGHT as u32);
        let record = Environment { radiance: Vec3::ONE, cos, sin, width, height, padding: 0 };
        let map = EnvironmentMap { record, pixels: &pixels, rows: &rows, columns: &columns };
        let n = 400_000;
        let directions = (0..n).map(|k| {
            let [a, b, ..] = random4(k, 0, 0, 31);
            sample_environment(&map, [a, b]).0
        });
        let cells = DirectionCells::new(axis, -1.0, 12, 24);
        let integrals = cells.integrals([80, 40], |direction| environment_pdf(&map, direction));
        let expected: Vec<f64> = integrals.iter().map(|of| of * f64::from(n)).collect();
        // Borders of pixels cut through cells, which the quadrature shows.
        tests.compare(format!("turned by {turn}"), &cells.count(directions), &expected, 0.01);
    }
    tests.check();
}

#[test]
fn intervals_are_drawn_by_their_length_and_evenly() {
    let weights = [0.0, 3.0, 1.0, 0.0, 0.5, 2.0, 0.0];
    let (sums, total) = (sums(&weights), weights.iter().sum::<f64>());
    let n = 100_000;
    let mut counts = vec![0.0; weights.len() * 4];
    for k in 0..n {
        let (interval, place) = interval_of(&sums, random4(k, 0, 0, 32)[0]);
        counts[interval as usize * 4 + (place * 4.0) as usize] += 1.0;
    }
    let expected: Vec<f64> = weights.iter().flat_map(|weight| [weight / total * f64::from(n) / 4.0; 4]).collect();
    let mut tests = ChiSquareTests::default();
    tests.compare("intervals", &counts, &expected, 0.0);
    tests.check();
}
