//! Structural similarity.

use rayon::prelude::*;

use crate::{Image, ImageError};

/// Pixels from the window's centre to its border.
const REACH: usize = 5;
/// Pixels along a side of the window.
const WINDOW: usize = 2 * REACH + 1;
/// Standard deviation of the window's Gaussian in pixels.
const SIGMA: f64 = 1.5;
/// What keeps the comparison of dark means finite: (K1 * range)^2 with K1 = 0.01 and range 1.
const C1: f64 = 0.01 * 0.01;
/// What keeps the comparison of small variances finite: (K2 * range)^2 with K2 = 0.03 and range 1.
const C2: f64 = 0.03 * 0.03;

/// The mean structural similarity of two pictures of code values in 0..=1: 1 for equal ones, about 0 for unrelated
/// ones.
///
/// Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, "Image Quality Assessment: From Error Visibility to
/// Structural Similarity", IEEE Transactions on Image Processing 13(4), 2004, equation 13: an 11 x 11 Gaussian window
/// with a standard deviation of 1.5 pixels, K1 = 0.01, K2 = 0.03, variances of the population. Each channel by itself;
/// the mean is taken over the pixels whose window lies inside the picture and over channels. Sums are f64.
///
/// `None` where either side is shorter than the window. Fails with [`ImageError::SizeMismatch`].
pub fn ssim(reference: &Image, test: &Image) -> Result<Option<f64>, ImageError> {
    reference.expect_size_of(test, "the test picture")?;
    if reference.width() < WINDOW || reference.height() < WINDOW {
        return Ok(None);
    }
    let weights = weights();
    let rows = reference.height() - 2 * REACH;
    let sums: Vec<f64> = (0..rows).into_par_iter().map(|top| row_sum(reference, test, &weights, top)).collect();
    let values = 3 * rows * (reference.width() - 2 * REACH);
    Ok(Some(sums.iter().sum::<f64>() / values as f64))
}

/// The window along one side, with sum 1; the window is the product of both.
fn weights() -> [f64; WINDOW] {
    let gaussian: [f64; WINDOW] = std::array::from_fn(|i| {
        let distance = i as f64 - REACH as f64;
        (-0.5 * (distance / SIGMA).powi(2)).exp()
    });
    gaussian.map(|weight| weight / gaussian.iter().sum::<f64>())
}

/// What is averaged over a window: a = reference, b = test.
#[derive(Clone, Copy, Default)]
struct Moments {
    a: f64,
    b: f64,
    /// a * a + b * b; the formula needs their sum only.
    squares: f64,
    product: f64,
}

impl Moments {
    fn add(&mut self, weight: f64, other: Self) {
        self.a += weight * other.a;
        self.b += weight * other.b;
        self.squares += weight * other.squares;
        self.product += weight * other.product;
    }

    /// Equation 13 of Wang et al. 2004.
    fn similarity(self) -> f64 {
        let Self { a, b, squares, product } = self;
        let (means, mean_squares) = (a * b, a * a + b * b);
        let variances = squares - mean_squares;
        let covariance = product - means;
        (2.0 * means + C1) * (2.0 * covariance + C2) / ((mean_squares + C1) * (variances + C2))
    }
}

/// The sum over channels and columns of the similarity of the windows whose first row is `top`.
fn row_sum(reference: &Image, test: &Image, weights: &[f64; WINDOW], top: usize) -> f64 {
    let mut columns = vec![Moments::default(); 3 * reference.width()]; // channels stay interleaved
    for (dy, weight) in weights.iter().enumerate() {
        let values = reference.row(top + dy).as_flattened().iter().zip(test.row(top + dy).as_flattened());
        for (column, (a, b)) in columns.iter_mut().zip(values) {
            let (a, b) = (f64::from(*a), f64::from(*b));
            column.add(*weight, Moments { a, b, squares: a * a + b * b, product: a * b });
        }
    }
    let windows = columns.windows(3 * (WINDOW - 1) + 1);
    windows.map(|window| averaged(window, weights).similarity()).sum()
}

/// The average over every third of `columns`.
fn averaged(columns: &[Moments], weights: &[f64; WINDOW]) -> Moments {
    let mut average = Moments::default();
    for (dx, weight) in weights.iter().enumerate() {
        average.add(*weight, columns[3 * dx]);
    }
    average
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(a: &Image, b: &Image) -> f64 {
        ssim(a, b).unwrap().unwrap()
    }

    #[test]
    fn constant_pictures_have_the_closed_form_of_their_means() {
        for (a, b) in [(0.25_f32, 0.75_f32), (0.0, 1.0), (0.5, 0.5), (0.0, 0.0)] {
            let found = value(&Image::filled(15, 12, [a; 3]), &Image::filled(15, 12, [b; 3]));
            let (a, b) = (f64::from(a), f64::from(b));
            let expected = (2.0 * a * b + C1) / (a * a + b * b + C1);
            assert!((found - expected).abs() < 1e-9, "{a} {b}: {found} {expected}");
        }
    }

    #[test]
    fn a_negative_of_zero_mean_contrast_is_minus_one_times_the_means() {
        // Of a one-pixel stripe pattern every window has the mean 0.5 but for 1e-5, and variance 0.25.
        let stripes = Image::from_fn(30, 20, |x, _| [(x % 2) as f32; 3]);
        let negative = stripes.map(|pixel| pixel.map(|value| 1.0 - value));
        let expected = (C2 - 0.5) / (C2 + 0.5);
        assert!((value(&stripes, &negative) - expected).abs() < 1e-3);
        assert!((value(&stripes, &stripes) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn one_window_by_hand_and_channels_apart() {
        let (mut a, b) = (Image::new(11, 11), Image::new(11, 11));
        a.set(5, 5, [0.0, 1.0, 0.0]);
        let weight = weights()[5].powi(2);
        let green = C1 * C2 / ((weight * weight + C1) * (weight - weight * weight + C2));
        assert!((value(&a, &b) - (2.0 + green) / 3.0).abs() < 1e-12);
        assert_eq!(value(&a, &b), value(&b, &a));
    }

    #[test]
    fn pictures_smaller_than_the_window_have_no_value() {
        for (width, height) in [(10, 40), (40, 10), (0, 0)] {
            assert_eq!(ssim(&Image::new(width, height), &Image::new(width, height)).unwrap(), None);
        }
        assert!(ssim(&Image::new(12, 12), &Image::new(12, 13)).is_err());
    }
}
