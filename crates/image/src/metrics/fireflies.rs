//! Fireflies: isolated pixels that are far too bright.

use rayon::prelude::*;

use crate::plane::{finite_or_zero, luminance_f64};
use crate::{Image, ImageError, Plane};

/// How many times brighter than everything that it is compared with a firefly is.
const FACTOR: f64 = 5.0;

/// The number of pixels of `test` that are fireflies: samples of high value and low probability that the mean of a
/// pixel has not outgrown.
///
/// A pixel counts whose luminance is more than 5 times each of these:
/// * the greatest luminance of the reference within one pixel of it: a highlight or a light's edge is no firefly, even
///   where it has moved by a pixel;
/// * the mean luminance of the reference: a speck in the dark that no one sees is none;
/// * the median of the test picture within one pixel of it, itself included (of an even number the lower of both middle
///   ones): a surface that is too bright as a whole is an error of another kind. Up to 4 of 9 pixels may glow together.
///
/// Non-finite pixels are counted by [`NonFinite`](super::NonFinite); here they are black. Fails with
/// [`ImageError::SizeMismatch`].
pub fn count_fireflies(reference: &Image, test: &Image) -> Result<usize, ImageError> {
    reference.expect_size_of(test, "the test picture")?;
    if reference.is_empty() {
        return Ok(0);
    }
    let (reference, test) = (brightness(reference), brightness(test));
    let mean = mean(&reference);
    let rows = (0..test.height()).into_par_iter();
    Ok(rows.map(|y| (0..test.width()).filter(|&x| is_firefly(&reference, &test, mean, x, y)).count()).sum())
}

fn brightness(image: &Image) -> Plane<f64> {
    let values = image.pixels().par_iter().map(|pixel| luminance_f64(finite_or_zero(*pixel)));
    Plane::from_pixels(image.width(), image.height(), values.collect()).expect("one luminance per pixel")
}

fn mean(plane: &Plane<f64>) -> f64 {
    let sums: Vec<f64> = plane.pixels().par_chunks(plane.width()).map(|row| row.iter().sum()).collect();
    sums.iter().sum::<f64>() / plane.pixels().len() as f64
}

fn is_firefly(reference: &Plane<f64>, test: &Plane<f64>, mean: f64, x: usize, y: usize) -> bool {
    let bound = test.get(x, y) / FACTOR;
    // The cheap tests come first: nearly every pixel fails one of them.
    bound > 0.0
        && bound > mean
        && bound > reference.get(x, y)
        && neighbourhood(reference, x, y).all(|other| bound > other)
        && bound > median(neighbourhood(test, x, y))
}

/// The values within one pixel, the pixel itself included: 9 inside a picture, fewer at its borders.
fn neighbourhood(plane: &Plane<f64>, x: usize, y: usize) -> impl Iterator<Item = f64> {
    let columns = x.saturating_sub(1)..(x + 2).min(plane.width());
    let rows = y.saturating_sub(1)..(y + 2).min(plane.height());
    rows.flat_map(move |row| plane.row(row)[columns.clone()].iter().copied())
}

/// The median of up to nine values, at least one; of an even number the lower of both middle ones.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted = [f64::INFINITY; 9];
    let mut count = 0;
    for (slot, value) in sorted.iter_mut().zip(values) {
        *slot = value;
        count += 1;
    }
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[(count - 1) / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREY: [f32; 3] = [0.5; 3];

    fn count(reference: &Image, test: &Image) -> usize {
        count_fireflies(reference, test).unwrap()
    }

    #[test]
    fn bright_specks_count_inside_and_at_the_borders() {
        let reference = Image::filled(20, 10, GREY);
        let mut test = reference.clone();
        for (x, y) in [(0, 0), (19, 0), (7, 0), (0, 5), (19, 9), (9, 4), (10, 4), (9, 5)] {
            test.set(x, y, [3.0; 3]);
        }
        assert_eq!(count(&reference, &test), 8);
        assert_eq!(count(&test, &reference), 0, "too dark is no firefly");
    }

    #[test]
    fn five_times_is_not_enough() {
        let reference = Image::filled(5, 5, GREY);
        let with = |value| {
            let mut test = reference.clone();
            test.set(2, 2, [value; 3]);
            count(&reference, &test)
        };
        assert_eq!((with(2.499), with(2.501)), (0, 1));
    }

    #[test]
    fn highlights_that_moved_by_a_pixel_are_none() {
        let mut reference = Image::filled(9, 9, GREY);
        reference.set(4, 4, [50.0; 3]);
        let moved = |x, y| {
            let mut test = Image::filled(9, 9, GREY);
            test.set(x, y, [50.0; 3]);
            count(&reference, &test)
        };
        assert_eq!((moved(4, 4), moved(5, 5), moved(3, 4)), (0, 0, 0));
        assert_eq!(moved(6, 4), 1);
    }

    #[test]
    fn bright_surfaces_and_specks_in_the_dark_are_none() {
        let black = Image::new(6, 6);
        assert_eq!(count(&black, &Image::filled(6, 6, [1.0; 3])), 0);
        let mut lit = Image::filled(6, 6, [1.0; 3]);
        (0..6).for_each(|y| (0..3).for_each(|x| lit.set(x, y, [0.0; 3])));
        let mut speck = lit.clone();
        speck.set(0, 3, [0.4; 3]); // the reference's mean is 0.5
        assert_eq!(count(&lit, &speck), 0);
        speck.set(0, 3, [2.6; 3]);
        assert_eq!(count(&lit, &speck), 1);
    }

    #[test]
    fn a_black_reference_is_an_answer() {
        let black = Image::new(6, 6);
        let mut test = black.clone();
        test.set(3, 3, [1e-6; 3]);
        assert_eq!((count(&black, &test), count(&black, &black)), (1, 0));
        assert_eq!(count(&Image::new(0, 4), &Image::new(0, 4)), 0);
        assert!(count_fireflies(&black, &Image::new(5, 6)).is_err());
    }

    #[test]
    fn pixels_that_are_no_numbers_are_not_counted_here() {
        let reference = Image::filled(5, 5, GREY);
        let mut test = reference.clone();
        test.set(1, 1, [f32::INFINITY; 3]);
        test.set(3, 3, [f32::NAN; 3]);
        assert_eq!(count(&reference, &test), 0);
        assert_eq!(count(&test, &reference), 0);
    }
}
