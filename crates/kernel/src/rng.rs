//! Random numbers: the project's own, counter-based, and the original program's.

/// Largest value of the original's generator.
pub const ORIGINAL_MAX: u32 = 0x7fff;

/// Four well-mixed words from four (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering", pcg4d).
pub fn hash4(key: [u32; 4]) -> [u32; 4] {
    let [mut x, mut y, mut z, mut w] = key.map(|k| k.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for round in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        if round == 0 {
            (x, y, z, w) = (x ^ x >> 16, y ^ y >> 16, z ^ z >> 16, w ^ w >> 16);
        }
    }
    [x, y, z, w]
}

/// A float in [0, 1) from the upper 24 bits of a word.
pub fn unit_float(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Four independent floats in [0, 1) for a place in the run. `stream` tells passes and purposes apart and carries the
/// seed.
pub fn random4(pixel: u32, sample: u32, dimension: u32, stream: u32) -> [f32; 4] {
    hash4([pixel, sample, dimension, stream]).map(unit_float)
}

/// A stream for a purpose of a run.
pub fn stream(seed: u32, purpose: u32) -> u32 {
    hash4([seed, purpose, 0, 0])[0]
}

/// Factor of the original's generator.
pub const ORIGINAL_FACTOR: u32 = 214_013;

/// Summand of the original's generator.
pub const ORIGINAL_SUMMAND: u32 = 2_531_011;

/// The original generator's next state.
pub const fn original_next(state: u32) -> u32 {
    state.wrapping_mul(ORIGINAL_FACTOR).wrapping_add(ORIGINAL_SUMMAND)
}

/// The value that the original's generator gives in a state, 0 to [`ORIGINAL_MAX`].
pub const fn original_value(state: u32) -> u32 {
    (state >> 16) & ORIGINAL_MAX
}

/// The original generator's state after `count` draws; see [`OriginalGenerator::skip`].
pub const fn original_skip(state: u32, count: u32) -> u32 {
    let (mut factor, mut summand) = (ORIGINAL_FACTOR, ORIGINAL_SUMMAND);
    let (mut result, mut left) = (state, count);
    while left > 0 {
        if left & 1 == 1 {
            result = result.wrapping_mul(factor).wrapping_add(summand);
        }
        summand = summand.wrapping_mul(factor.wrapping_add(1));
        factor = factor.wrapping_mul(factor);
        left >>= 1;
    }
    result
}

/// The original's 15-bit linear congruential generator (that of its C run-time library).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OriginalGenerator {
    state: u32,
}

impl OriginalGenerator {
    /// The generator in its initial state.
    pub const fn new(seed: u32) -> Self {
        Self { state: seed }
    }

    /// Skips `count` draws in a number of steps that is the logarithm of it: x -> a x + c applied twice is
    /// x -> a^2 x + c (a + 1) (Brown 1994, "Random Number Generation with Arbitrary Strides").
    #[must_use]
    pub const fn skip(self, count: u32) -> Self {
        Self { state: original_skip(self.state, count) }
    }

    /// The next value, 0 to [`ORIGINAL_MAX`].
    pub const fn draw(&mut self) -> u32 {
        self.state = original_next(self.state);
        original_value(self.state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_original_sequence() {
        let mut generator = OriginalGenerator::new(1);
        let first: Vec<u32> = (0..5).map(|_| generator.draw()).collect();
        // Well-known first values of that library's rand() after srand(1).
        assert_eq!(first, [41, 18_467, 6_334, 26_500, 19_169]);
    }

    #[test]
    fn skipping_is_drawing() {
        let mut drawn = OriginalGenerator::new(1);
        for count in 0..200 {
            assert_eq!(OriginalGenerator::new(1).skip(count), drawn);
            drawn.draw();
        }
    }

    #[test]
    fn neighbouring_counters_are_uniform_and_independent() {
        let mut counts = [0_u32; 64];
        for pixel in 0..64_000 {
            let [a, b, ..] = random4(pixel, 0, 1, 42);
            counts[(a * 8.0) as usize * 8 + (b * 8.0) as usize] += 1;
        }
        // Chi-square with 63 degrees of freedom: mean 63, standard deviation 11.2.
        let chi_square: f64 = counts.iter().map(|&c| (f64::from(c) - 1000.0).powi(2) / 1000.0).sum();
        assert!((20.0..120.0).contains(&chi_square), "{chi_square}");
    }

    #[test]
    fn unit_floats_stay_below_one() {
        assert!(unit_float(u32::MAX) < 1.0);
        assert_eq!(unit_float(0), 0.0);
    }
}
