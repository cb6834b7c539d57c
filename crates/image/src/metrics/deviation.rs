//! Errors summed over every channel of every pixel.
//!
//! With the difference d = test - reference and a = reference, b = test. All sums are f64. Each function fails with
//! [`ImageError::SizeMismatch`], gives 0 for pictures without pixels and NaN where a value is NaN or infinite.

use rayon::prelude::*;

use crate::{Image, ImageError};

/// What keeps relative errors finite where the reference is black, in the unit of the light (pbrt, Rousselle et al.
/// 2011).
const DARK: f64 = 1e-2;

/// Mean of d^2, in the pictures' unit squared.
pub fn mse(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    mean(reference, test, |a, b| (b - a) * (b - a))
}

/// Root of the mean of d^2, in the pictures' unit.
pub fn rmse(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    Ok(mse(reference, test)?.sqrt())
}

/// Mean of |d|, in the pictures' unit.
pub fn mae(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    mean(reference, test, |a, b| (b - a).abs())
}

/// Relative mean squared error: mean of d^2 / (a^2 + 0.01), a ratio (Rousselle et al. 2011).
pub fn relmse(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    mean(reference, test, |a, b| (b - a) * (b - a) / (a * a + DARK))
}

/// Mean relative squared error: mean of (d / (a + 0.01))^2, a ratio: the other common meaning of relMSE, that of pbrt.
pub fn mrse(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    mean(reference, test, |a, b| ((b - a) / (a + DARK)).powi(2))
}

/// Symmetric mean absolute percentage error: mean of |d| / (|a| + |b| + 0.01), 0 to 1 (as in Vogels et al. 2018).
pub fn smape(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    mean(reference, test, |a, b| (b - a).abs() / (a.abs() + b.abs() + DARK))
}

/// How far the light of a whole picture is off: |mean of d| / mean of |a|, a ratio; 1 for twice the light, 0.5 for half of it,
/// whatever its level. Infinite where the reference is black and the test picture is not.
pub fn relative_bias(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    let difference = mean(reference, test, |a, b| b - a)?.abs();
    let light = mean(reference, test, |a, _| a.abs())?;
    Ok(if difference == 0.0 { 0.0 } else { difference / light })
}

/// Peak signal to noise ratio of code values in 0..=1: 10 log10 (1 / mse), in dB; infinite for equal pictures.
pub fn psnr(reference: &Image, test: &Image) -> Result<f64, ImageError> {
    Ok(10.0 * (1.0 / mse(reference, test)?).log10())
}

/// The mean over channels and pixels of `error(reference value, test value)`.
fn mean(reference: &Image, test: &Image, error: impl Fn(f64, f64) -> f64 + Sync) -> Result<f64, ImageError> {
    reference.expect_size_of(test, "the test picture")?;
    if reference.is_empty() {
        return Ok(0.0);
    }
    let width = reference.width();
    let rows = reference.pixels().par_chunks(width).zip(test.pixels().par_chunks(width));
    let sums: Vec<f64> = rows.map(|(a, b)| row_sum(a, b, &error)).collect();
    let mean = sums.iter().sum::<f64>() / (3.0 * reference.pixels().len() as f64);
    // Finite floats never overflow f64 here, but an infinity does give an infinite sum.
    Ok(if mean.is_finite() { mean } else { f64::NAN })
}

fn row_sum(reference: &[[f32; 3]], test: &[[f32; 3]], error: &impl Fn(f64, f64) -> f64) -> f64 {
    let pairs = reference.as_flattened().iter().zip(test.as_flattened());
    pairs.map(|(a, b)| error(f64::from(*a), f64::from(*b))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_bias_is_that_of_the_whole_light_at_any_level() {
        for level in [1e-30_f32, 1e-6, 1.0, 1e20] {
            let reference = Image::from_fn(9, 7, |x, y| [level * x as f32, level * y as f32, level * 0.5]);
            for (factor, expected) in [(1.0, 0.0), (2.0, 1.0), (0.5, 0.5), (4.0, 3.0)] {
                let test = reference.map(|pixel| pixel.map(|value| factor * value));
                assert!((relative_bias(&reference, &test).unwrap() - expected).abs() < 1e-6, "{level} {factor}");
            }
        }
        let (black, dim) = (Image::new(2, 2), Image::filled(2, 2, [1e-20; 3]));
        assert_eq!(relative_bias(&black, &black).unwrap(), 0.0);
        assert_eq!(relative_bias(&black, &dim).unwrap(), f64::INFINITY);
        assert!((relative_bias(&dim, &black).unwrap() - 1.0).abs() < 1e-9);
    }

    type Function = fn(&Image, &Image) -> Result<f64, ImageError>;
    const ALL: [Function; 6] = [mse, rmse, mae, relmse, mrse, smape];

    /// One pixel: d = (0.5, -0.5, 2), a = (0.5, 1, 0).
    fn pair() -> (Image, Image) {
        (Image::filled(1, 1, [0.5, 1.0, 0.0]), Image::filled(1, 1, [1.0, 0.5, 2.0]))
    }

    #[test]
    fn closed_forms() {
        let (a, b) = pair();
        let close = |value: Result<f64, ImageError>, expected: f64| {
            let value = value.unwrap();
            assert!((value - expected).abs() < 1e-12 * expected, "{value} {expected}");
        };
        close(mse(&a, &b), 4.5 / 3.0);
        close(rmse(&a, &b), 1.5_f64.sqrt());
        close(mae(&a, &b), 1.0);
        close(relmse(&a, &b), (0.25 / 0.26 + 0.25 / 1.01 + 4.0 / 0.01) / 3.0);
        close(mrse(&a, &b), (0.25 / 0.2601 + 0.25 / 1.0201 + 4.0 / 0.0001) / 3.0);
        close(smape(&a, &b), (0.5 / 1.51 + 0.5 / 1.51 + 2.0 / 2.01) / 3.0);
    }

    #[test]
    fn psnr_of_one_code_value() {
        let a = Image::filled(4, 3, [0.5; 3]);
        let b = a.map(|pixel| pixel.map(|value| value + 1.0 / 256.0));
        assert!((psnr(&a, &b).unwrap() - 20.0 * 256_f64.log10()).abs() < 1e-9);
        assert_eq!(psnr(&a, &a).unwrap(), f64::INFINITY);
    }

    #[test]
    fn equal_and_empty_pictures_do_not_deviate() {
        let empty = Image::new(0, 3);
        for function in ALL {
            assert_eq!(function(&pair().0, &pair().0).unwrap(), 0.0);
            assert_eq!(function(&empty, &empty).unwrap(), 0.0);
            assert!(function(&pair().0, &empty).is_err());
        }
    }

    #[test]
    fn a_value_that_is_no_number_gives_nan_from_either_side() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut image = Image::filled(3, 3, [0.5; 3]);
            image.set(1, 2, [0.0, value, 0.0]);
            for function in ALL {
                assert!(function(&image, &Image::new(3, 3)).unwrap().is_nan());
                assert!(function(&Image::new(3, 3), &image).unwrap().is_nan());
                assert!(function(&image, &image).unwrap().is_nan());
            }
        }
    }

    #[test]
    fn the_greatest_floats_do_not_overflow() {
        let (a, b) = (Image::filled(2, 2, [f32::MAX; 3]), Image::filled(2, 2, [f32::MIN; 3]));
        for function in ALL {
            assert!(function(&a, &b).unwrap().is_finite());
        }
    }
}
