//! Random numbers of one path: low-discrepancy points where they last, independent ones after that.

use lightcuts_kernel::rng::{hash4, random4};

/// Samples of a pixel after which the sequence of points is scrambled anew.
const SEQUENCE: u32 = 1 << 16;

/// Sets of four dimensions that the sequence has.
const SETS: u32 = sobol_burley::NUM_DIMENSION_SETS_4D;

/// The numbers of one sample of one pixel, in the order in which they are asked for.
#[derive(Debug, Clone)]
pub(crate) struct Randoms {
    pixel: u32,
    sample: u32,
    stream: u32,
    seed: u32,
    set: u32,
}

impl Randoms {
    pub(crate) fn new(pixel: u32, sample: u32, stream: u32) -> Self {
        let seed = hash4([pixel, stream, sample / SEQUENCE, 1])[0];
        Self { pixel, sample, stream, seed, set: 0 }
    }

    /// The next four numbers, each in 0..1.
    pub(crate) fn next(&mut self) -> [f32; 4] {
        let set = self.set;
        self.set += 1;
        if set < SETS {
            sobol_burley::sample_4d(self.sample % SEQUENCE, set, self.seed)
        } else {
            random4(self.pixel, self.sample, set, self.stream)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_pixel_cover_the_square_and_paths_are_told_apart() {
        let mut cells = [0_u32; 64];
        for sample in 0..64 {
            let [a, b, ..] = Randoms::new(7, sample, 3).next();
            cells[(a * 8.0) as usize * 8 + (b * 8.0) as usize] += 1;
        }
        assert!(cells.iter().all(|&count| count == 1), "{cells:?}");
        let mut long = Randoms::new(7, 0, 3);
        let numbers: Vec<[f32; 4]> = (0..200).map(|_| long.next()).collect();
        assert!(numbers.iter().flatten().all(|n| (0.0..1.0).contains(n)));
        assert_ne!(Randoms::new(8, 0, 3).next(), numbers[0]);
        assert_ne!(Randoms::new(7, SEQUENCE, 3).next(), numbers[0]);
    }
}
