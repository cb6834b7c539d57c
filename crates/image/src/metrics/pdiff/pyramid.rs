//! A picture and ever smoother versions of it, all of one size.

use std::ops::Range;

/// Levels of a pyramid; level 0 is the picture.
pub(super) const LEVELS: usize = 8;

/// Weights of the filter along one side, nearly a Gaussian (Burt and Adelson 1983, a = 0.4).
const WEIGHTS: [f32; 5] = [0.05, 0.25, 0.4, 0.25, 0.05];
/// Pixels that the filter reaches to each side.
const REACH: usize = 2;

/// The low-pass levels of a Laplacian pyramid, not shrunk: each is the one below it, smoothed by 5 x 5 weights.
pub(super) struct Pyramid {
    levels: Vec<Level>,
}

impl Pyramid {
    /// The levels over the rows `band` of a picture, whose row `y` is what `base(y, row)` writes.
    ///
    /// A band holds what the whole picture's levels would hold: it starts from as many rows around it as the levels
    /// reach. Everything is f32 in one order of sums, because the verdict on flat pictures hangs on the rounding:
    /// contrast there is nothing but the difference of roundings between levels.
    pub(super) fn new(width: usize, height: usize, band: Range<usize>, base: impl Fn(usize, &mut [f32])) -> Self {
        let reach = REACH * (LEVELS - 1);
        let rows = band.start.saturating_sub(reach)..(band.end + reach).min(height);
        let mut levels = vec![Level::from_rows(width, height, rows, base)];
        while levels.len() < LEVELS {
            levels.extend(levels.last().map(Level::smoothed));
        }
        Self { levels }
    }

    /// Row `y` of each level; the band has it.
    pub(super) fn rows(&self, y: usize) -> [&[f32]; LEVELS] {
        std::array::from_fn(|level| &self.levels[level].padded_row(y)[REACH..][..self.levels[level].width])
    }
}

/// Some rows of a picture; each has [`REACH`] mirrored pixels on both sides, so that filtering needs no case for
/// borders.
struct Level {
    width: usize,
    /// Height of the whole picture.
    height: usize,
    rows: Range<usize>,
    padded: Vec<f32>,
}

impl Level {
    fn from_rows(width: usize, height: usize, rows: Range<usize>, fill: impl Fn(usize, &mut [f32])) -> Self {
        let stride = width + 2 * REACH;
        let mut padded = vec![0.0; stride * rows.len()];
        for (y, row) in rows.clone().zip(padded.chunks_exact_mut(stride)) {
            fill(y, &mut row[REACH..][..width]);
            for x in (0..REACH).chain(width + REACH..stride) {
                row[x] = row[REACH + mirrored(x, width)];
            }
        }
        Self { width, height, rows, padded }
    }

    /// The rows that this level determines: all of them at the picture's borders, [`REACH`] fewer elsewhere.
    fn smoothed(&self) -> Self {
        let Range { start, end } = self.rows;
        let start = if start == 0 { 0 } else { start + REACH };
        let end = if end == self.height { end } else { end - REACH };
        Self::from_rows(self.width, self.height, start..end, |y, row| {
            for (dx, column_weight) in WEIGHTS.into_iter().enumerate() {
                for (dy, row_weight) in WEIGHTS.into_iter().enumerate() {
                    let weight = column_weight * row_weight;
                    let source = &self.padded_row(mirrored(y + dy, self.height))[dx..];
                    row.iter_mut().zip(source).for_each(|(sum, value)| *sum += weight * value);
                }
            }
        })
    }

    fn padded_row(&self, y: usize) -> &[f32] {
        let stride = self.width + 2 * REACH;
        &self.padded[stride * (y - self.rows.start)..][..stride]
    }
}

/// The place inside 0..length that stands for `padded - REACH`, itself where it is inside.
///
/// Mirrored at the first pixel's centre and at the last pixel's outer edge: -1 is 1, but `length` is `length - 1`. Yee
/// 2004 leaves borders open; published figures come from these.
fn mirrored(padded: usize, length: usize) -> usize {
    let place = padded.abs_diff(REACH);
    if place < length { place } else { (2 * length - 1).saturating_sub(place) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Plane;

    fn pyramid(plane: &Plane<f32>, band: Range<usize>) -> Pyramid {
        Pyramid::new(plane.width(), plane.height(), band, |y, row| row.copy_from_slice(plane.row(y)))
    }

    #[test]
    fn bands_hold_what_the_whole_picture_holds() {
        for height in [1, 2, 9, 70] {
            let plane = Plane::from_fn(13, height, |x, y| ((x * 7919 + y * 104_729) % 1009) as f32);
            let whole = pyramid(&plane, 0..height);
            for start in 0..height {
                let end = (start + 3).min(height);
                let band = pyramid(&plane, start..end);
                (start..end).for_each(|y| assert_eq!(band.rows(y), whole.rows(y), "{height} {start} {y}"));
            }
        }
    }

    #[test]
    fn borders_are_mirrored() {
        let places = |length| (0..length + 4).map(|x| mirrored(x, length)).collect::<Vec<_>>();
        assert_eq!(places(5), [2, 1, 0, 1, 2, 3, 4, 4, 3]);
        assert_eq!(places(3), [2, 1, 0, 1, 2, 2, 1]);
        assert_eq!(places(2), [1, 1, 0, 1, 1, 0]);
        assert_eq!(places(1), [0, 0, 0, 0, 0]);
    }

    #[test]
    fn a_point_becomes_the_product_of_the_weights() {
        let mut plane = Plane::new(9, 9);
        plane.set(4, 4, 1.0_f32);
        let levels = pyramid(&plane, 0..9);
        for y in 0..9_usize {
            for (x, value) in levels.rows(y)[1].iter().copied().enumerate() {
                let weight = |at: usize| (at + 2).checked_sub(4).and_then(|i| WEIGHTS.get(i)).copied().unwrap_or(0.0);
                assert_eq!(value, weight(x) * weight(y), "{x} {y}");
            }
        }
    }

    #[test]
    fn constant_pictures_stay_but_for_rounding() {
        for (width, height) in [(1, 1), (2, 3), (40, 1), (17, 9)] {
            let plane = Plane::filled(width, height, 21.952_f32);
            for value in pyramid(&plane, 0..height).rows(height - 1).into_iter().flatten() {
                assert!((value - 21.952).abs() < 2e-5, "{value}");
            }
        }
    }
}
