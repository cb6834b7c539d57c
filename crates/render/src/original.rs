//! The original program's random numbers, for exact reproduction.

use lightcuts_kernel::rng::{ORIGINAL_MAX, OriginalGenerator};

/// How far the original moves samples: this share of half the view plane's width in units, per tenth drawn.
const SHIFT_SCALE: f32 = 0.3;

/// Half the view plane's width in scene units.
const HALF_WIDTH: f32 = 2.56;

/// Initial state of the original's generator.
const SEED: u32 = 1;

/// The sequence of draws.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OriginalDraws {
    generator: OriginalGenerator,
}

impl OriginalDraws {
    pub(crate) const fn new() -> Self {
        Self { generator: OriginalGenerator::new(SEED) }
    }

    /// The shifts of a row's samples from their pixels' centres, in pixels: drawn before anything of the row is traced.
    pub(crate) fn row(&mut self, width: u32) -> Vec<[f32; 2]> {
        (0..width).map(|_| [self.shift(), self.shift()]).collect()
    }

    fn shift(&mut self) -> f32 {
        original_shift(self.generator.draw())
    }

    /// Passes over draws: each hit takes one.
    pub(crate) fn skip(&mut self, draws: usize) {
        for _ in 0..draws {
            self.generator.draw();
        }
    }

    /// One draw: whether a hit may become a VPL.
    pub(crate) fn accepts(&mut self, probability: f32) -> bool {
        self.generator.draw() <= acceptance_limit(probability)
    }

    /// The draws of the original's tree build: one per parent, layers made even by repeating their last node.
    pub(crate) fn skip_light_tree(&mut self, vpls: usize) {
        let mut layer = vpls;
        while layer > 1 {
            layer = layer.div_ceil(2);
            self.skip(layer);
        }
    }
}

/// The shift of a sample along one axis, in pixels, that a draw gives: one of ten.
pub fn original_shift(draw: u32) -> f32 {
    let tenths = draw as i32 % 10 - 5;
    tenths as f32 / 10.0 * SHIFT_SCALE * HALF_WIDTH
}

/// Greatest draw that makes a hit a VPL: floor(p 10^6), from the original's `draw % 1000000 / 1000000 < p`.
fn acceptance_limit(probability: f32) -> u32 {
    // The float nearest to a decimal p can lie just below it; a thousandth of a step makes up for that.
    (f64::from(probability) * 1e6 + 1e-3) as u32
}

/// The probability that a nominal one comes to with the original's 15-bit generator: (floor(p 10^6) + 1) / 32768.
pub(crate) fn effective_probability(nominal: f32) -> f32 {
    let values = ORIGINAL_MAX + 1;
    if nominal <= 0.0 { 0.0 } else { (acceptance_limit(nominal) + 1).min(values) as f32 / values as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effective_probabilities_of_the_three_scenes() {
        for (nominal, numerator) in [(0.0001, 101.0), (0.00003, 31.0), (0.000_035, 36.0)] {
            assert_eq!(effective_probability(nominal), numerator / 32768.0);
        }
        assert_eq!(effective_probability(1.0), 1.0);
        assert_eq!(effective_probability(0.0), 0.0);
    }

    #[test]
    fn the_tree_of_290_lights_takes_295_draws() {
        let mut draws = OriginalDraws::new();
        draws.skip_light_tree(290);
        let mut expected = OriginalGenerator::new(1);
        let draw_count: u32 = [145, 73, 37, 19, 10, 5, 3, 2, 1].iter().sum();
        for _ in 0..draw_count {
            expected.draw();
        }
        assert_eq!(draws.generator, expected);
    }

    #[test]
    fn shifts_are_tenths_of_the_original_range() {
        let row = OriginalDraws::new().row(1);
        // The first two values are 41 and 18467: -0.4 and 0.2.
        assert!((row[0][0] + 0.4 * 0.768).abs() < 1e-6 && (row[0][1] - 0.2 * 0.768).abs() < 1e-6);
    }
}
