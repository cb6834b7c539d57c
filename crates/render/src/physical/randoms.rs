//! Random numbers of one path: low-discrepancy points where they last, independent ones after that.

use lightcuts_kernel::rng::{hash4, random4};
use sobol_burley::parts::{Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev};

/// Samples of a pixel after which the sequence of points is scrambled anew.
const SEQUENCE: u32 = 1 << 16;

/// Sets of four dimensions that the sequence has.
const SETS: u32 = sobol_burley::NUM_DIMENSION_SETS_4D;

/// Constants of `sobol_burley::sample_4d`: what tells the shuffling of samples from the scrambling of dimensions, and these apart.
const SHUFFLE: u32 = 0x79c6_8e4a;
const SCRAMBLE: u32 = 0x9c8f_2d3b;
const DIMENSIONS: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];

/// The numbers of one sample of one pixel, in the order in which they are asked for.
#[derive(Debug, Clone)]
pub(crate) struct Randoms {
    pixel: u32,
    sample: u32,
    stream: u32,
    /// The sample's shuffled place in the sequence, bits reversed: the same for all dimensions.
    place: u32,
    /// What dimensions are scrambled by.
    scramble: u32,
    set: u32,
}

impl Randoms {
    pub(crate) fn new(pixel: u32, sample: u32, stream: u32) -> Self {
        let seed = hash4([pixel, stream, sample / SEQUENCE, 1])[0];
        let place = owen_scramble_rev((sample % SEQUENCE).reverse_bits(), hash(seed ^ SHUFFLE));
        Self { pixel, sample, stream, place, scramble: seed.wrapping_mul(SCRAMBLE), set: 0 }
    }

    /// The next four numbers, each in 0..1.
    pub(crate) fn next(&mut self) -> [f32; 4] {
        let set = self.set;
        self.set += 1;
        if set < SETS { self.point(set) } else { random4(self.pixel, self.sample, set, self.stream) }
    }
}

impl Randoms {
    /// Four dimensions of the sample: `sobol_burley::sample_4d`, which would shuffle it anew each time.
    fn point(&self, set: u32) -> [f32; 4] {
        let scramble: Int4 = DIMENSIONS.map(|dimension| dimension ^ self.scramble ^ set).into();
        owen_scramble_int4_rev(sobol_int4_rev(self.place, set), hash_int4(scramble)).reverse_bits().to_f32_norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_library() {
        for k in 0..2000 {
            let [pixel, sample, stream, set] = hash4([k, 0, 0, 9]);
            let (sample, set) = (sample >> (k % 24), set % SETS);
            let seed = hash4([pixel, stream, sample / SEQUENCE, 1])[0];
            let expected = sobol_burley::sample_4d(sample % SEQUENCE, set, seed);
            assert_eq!(Randoms::new(pixel, sample, stream).point(set), expected, "{pixel} {sample} {stream} {set}");
        }
    }

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
