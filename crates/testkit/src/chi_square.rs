//! Do samples have the density that is claimed of them? Pearson's chi-square tests over cells, many in one test.
//!
//! ```
//! use lightcuts_testkit::chi_square::ChiSquareTests;
//!
//! let mut tests = ChiSquareTests::default();
//! tests.compare("a fair coin", &[5010.0, 4990.0], &[5000.0, 5000.0], 0.0);
//! tests.check();
//! ```

use glam::Vec3;
use std::f64::consts::PI;

/// Chance that sound samplers fail a whole set of comparisons; seeds are fixed, so what passes once passes always.
const SIGNIFICANCE: f64 = 1e-3;

/// Fewest samples that a cell is to have: fewer are no normal deviates. Such cells are taken together.
const LEAST_EXPECTED: f64 = 50.0;

/// Factors on the densities of cells in the negative control, by turns.
const WRONG: [f64; 2] = [1.15, 0.85];

/// Comparisons that are judged together.
#[derive(Debug, Default)]
pub struct ChiSquareTests {
    cases: Vec<Case>,
}

#[derive(Debug)]
struct Case {
    name: String,
    /// Chance that a sound sampler is so far from its density.
    p: f64,
    /// The same of the negative control.
    p_of_wrong: f64,
}

impl ChiSquareTests {
    /// Compares counts of samples in cells with the numbers that a density makes expect. `quadrature` is the relative error that
    /// these may have.
    pub fn compare(&mut self, name: impl Into<String>, counts: &[f64], expected: &[f64], quadrature: f64) {
        assert_eq!(counts.len(), expected.len());
        let total = |of: &[f64]| of.iter().sum::<f64>();
        // By turns from the greatest cell on, so that it is wrong wherever most samples are.
        let mut order: Vec<usize> = (0..expected.len()).collect();
        order.sort_by(|&a, &b| expected[b].total_cmp(&expected[a]));
        let mut wrong = expected.to_vec();
        for (rank, &cell) in order.iter().enumerate() {
            wrong[cell] *= WRONG[rank % 2];
        }
        let factor = total(expected) / total(&wrong);
        for cell in &mut wrong {
            *cell *= factor;
        }
        let [p, p_of_wrong] = [expected, &wrong[..]].map(|expected| p_value(counts, expected, quadrature));
        self.cases.push(Case { name: name.into(), p, p_of_wrong });
    }

    /// Fails if a sampler has not its density, or if a density that is wrong by 15 % to both sides would have passed as well.
    pub fn check(&self) {
        // Sidak 1967: the limit for each of many comparisons.
        let limit = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / self.cases.len().max(1) as f64);
        let failed: Vec<String> = self.cases.iter().filter_map(|case| case.complaint(limit)).collect();
        assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), self.cases.len(), failed.join("\n"));
    }
}

impl Case {
    fn complaint(&self, limit: f64) -> Option<String> {
        let Self { name, p, p_of_wrong } = self;
        if *p < limit {
            return Some(format!("{name}: p = {p:.1e}, at least {limit:.1e}"));
        }
        (*p_of_wrong >= limit).then(|| format!("{name}: a wrong density passes with p = {p_of_wrong:.1e}"))
    }
}

/// Chance of a chi-square at least as great as that of these counts.
fn p_value(counts: &[f64], expected: &[f64], quadrature: f64) -> f64 {
    let (mut statistic, mut cells) = (0.0, 0.0);
    let mut add = |count: f64, expected: f64| {
        let excess = ((count - expected).abs() - quadrature * expected).max(0.0);
        statistic += excess * excess / expected;
        cells += 1.0;
    };
    let (mut few, mut few_expected) = (0.0, 0.0);
    for (&count, &expected) in counts.iter().zip(expected) {
        if expected < LEAST_EXPECTED {
            (few, few_expected) = (few + count, few_expected + expected);
        } else {
            add(count, expected);
        }
    }
    // Where nothing is expected a single sample is too many to be pooled with others.
    if few_expected == 0.0 && few > 0.0 {
        return 0.0;
    }
    if few_expected > 0.0 {
        add(few, few_expected.max(1.0));
    }
    // Wilson & Hilferty 1931: the cube root of a chi-square variable is nearly normal.
    let variance = 2.0 / (9.0 * f64::max(cells, 1.0));
    upper_tail(((statistic / f64::max(cells, 1.0)).cbrt() - (1.0 - variance)) / variance.sqrt())
}

/// Chance that a normal deviate exceeds z (Abramowitz & Stegun 1964, 26.2.17 for |z| below 3, 26.2.14 as a finite continued
/// fraction above), within 1e-5 relative.
fn upper_tail(z: f64) -> f64 {
    if z < 0.0 {
        return 1.0 - upper_tail(-z);
    }
    let density = (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
    if z > 3.0 {
        let fraction = (1..=40).rev().fold(z, |rest, k| z + f64::from(k) / rest);
        return density / fraction;
    }
    let t = 1.0 / (1.0 + 0.231_641_9 * z);
    let polynomial = [1.330_274_429, -1.821_255_978, 1.781_477_937, -0.356_563_782, 0.319_381_530];
    density * polynomial.iter().fold(0.0, |sum, c| (sum + c) * t)
}

/// Cells of equal solid angle about an axis.
#[derive(Debug, Clone, Copy)]
pub struct DirectionCells {
    frame: [Vec3; 3],
    least_cos: f64,
    rings: usize,
    sectors: usize,
}

impl DirectionCells {
    /// Rings and sectors of all directions whose cosine to a unit axis is at least `least_cos`; one more cell has all others.
    pub fn new(axis: Vec3, least_cos: f32, rings: usize, sectors: usize) -> Self {
        let (tangent, bitangent) = axis.any_orthonormal_pair();
        Self { frame: [tangent, bitangent, axis], least_cos: f64::from(least_cos), rings, sectors }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.rings * self.sectors + 1
    }

    /// Never: there is always the cell of all others.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The cell of a unit direction.
    pub fn cell(&self, direction: Vec3) -> usize {
        let [x, y, z] = self.frame.map(|axis| f64::from(axis.dot(direction)));
        let height = (z - self.least_cos) / (1.0 - self.least_cos);
        if height < 0.0 {
            return self.rings * self.sectors;
        }
        let part = |share: f64, of: usize| ((share * of as f64) as usize).min(of - 1);
        part(height, self.rings) * self.sectors + part(y.atan2(x) / (2.0 * PI) + 0.5, self.sectors)
    }

    /// Counts of directions.
    pub fn count(&self, directions: impl Iterator<Item = Vec3>) -> Vec<f64> {
        let mut counts = vec![0.0; self.len()];
        for direction in directions {
            counts[self.cell(direction)] += 1.0;
        }
        counts
    }

    /// Integrals over the cells of a density per steradian, by so many midpoints across a ring and a sector.
    pub fn integrals(&self, [across, along]: [usize; 2], density: impl Fn(Vec3) -> f32) -> Vec<f64> {
        let (rows, columns) = (self.rings * across, self.sectors * along);
        let solid_angle = 2.0 * PI * (1.0 - self.least_cos) / (rows * columns) as f64;
        let turns: Vec<(f64, f64)> =
            (0..columns).map(|column| (((column as f64 + 0.5) / columns as f64 - 0.5) * 2.0 * PI).sin_cos()).collect();
        let mut integrals = vec![0.0; self.len()];
        for row in 0..rows {
            let z = self.least_cos + (1.0 - self.least_cos) * (row as f64 + 0.5) / rows as f64;
            let r = (1.0 - z * z).max(0.0).sqrt();
            for (column, (sin, cos)) in turns.iter().enumerate() {
                let [x, y, z] = [r * cos, r * sin, z].map(|c| c as f32);
                let direction = self.frame[0] * x + self.frame[1] * y + self.frame[2] * z;
                let cell = row / across * self.sectors + column / along;
                integrals[cell] += f64::from(density(direction)) * solid_angle;
            }
        }
        integrals
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_of_the_normal_distribution() {
        for (z, p) in [(0.0, 0.5), (1.0, 0.158_655), (-1.0, 0.841_345), (3.0, 1.349_9e-3), (5.0, 2.866_5e-7)] {
            assert!((upper_tail(z) / p - 1.0).abs() < 1e-4, "{z}: {}", upper_tail(z));
        }
    }

    #[test]
    fn chi_square_has_its_quantiles() {
        // 23.685 is exceeded by a chi-square variable of 14 degrees of freedom with a chance of 5 %.
        let shift = (23.685_f64 / 14.0 * 1000.0).sqrt();
        let counts: Vec<f64> = (0..14).map(|k| if k % 2 == 0 { 1000.0 + shift } else { 1000.0 - shift }).collect();
        assert!((p_value(&counts, &[1000.0; 14], 0.0) - 0.05).abs() < 1e-3);
    }

    #[test]
    fn cells_share_out_the_cap() {
        let cells = DirectionCells::new(Vec3::new(0.6, 0.0, -0.8), 0.3, 4, 6);
        let integrals = cells.integrals([8, 8], |_| 1.0);
        let each = 2.0 * PI * 0.7 / 24.0;
        assert!(integrals[..24].iter().all(|of| (of - each).abs() < 1e-6) && integrals[24] == 0.0);
        // Every direction that is integrated over lies in the cell that it is counted in.
        for cell in 0..24 {
            let alone = cells.integrals([8, 8], |direction| f32::from(u8::from(cells.cell(direction) == cell)));
            assert!((alone[cell] - each).abs() < 1e-6);
        }
        assert_eq!(cells.count([Vec3::NEG_X].into_iter())[24], 1.0);
    }

    #[test]
    #[should_panic(expected = "a wrong density passes")]
    fn too_few_samples_prove_nothing() {
        let mut tests = ChiSquareTests::default();
        tests.compare("a coin thrown too rarely", &[60.0, 60.0], &[60.0, 60.0], 0.0);
        tests.check();
    }

    #[test]
    #[should_panic(expected = "at least")]
    fn a_sample_where_none_can_be_fails() {
        let mut tests = ChiSquareTests::default();
        tests.compare("a coin that stands", &[5000.0, 5000.0, 1.0], &[5000.0, 5000.0, 0.0], 0.0);
        tests.check();
    }
}
