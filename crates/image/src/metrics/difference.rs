//! How far two pictures differ.

use crate::{Image, ImageError};

/// The greatest difference of any channel of any pixel, in the unit of the pictures; 0 for empty pictures.
///
/// Equal values differ by 0, infinities included, and two NaNs count as equal; a NaN against a number is infinite.
/// Fails with [`ImageError::SizeMismatch`].
pub fn max_abs_difference(a: &Image, b: &Image) -> Result<f32, ImageError> {
    a.expect_size_of(b, "the second picture")?;
    Ok(a.pixels().iter().zip(b.pixels()).map(|(a, b)| pixel_difference(*a, *b)).fold(0.0, f32::max))
}

/// The share of pixels, 0 to 1, whose three channels all differ by at most `tolerance`; 1 for empty pictures.
///
/// Differences are those of [`max_abs_difference`]. Fails with [`ImageError::SizeMismatch`].
pub fn fraction_within(a: &Image, b: &Image, tolerance: f32) -> Result<f64, ImageError> {
    a.expect_size_of(b, "the second picture")?;
    if a.is_empty() {
        return Ok(1.0);
    }
    let within = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| pixel_difference(**a, **b) <= tolerance).count();
    Ok(within as f64 / a.pixels().len() as f64)
}

fn pixel_difference(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|channel| channel_difference(a[channel], b[channel])).fold(0.0, f32::max)
}

fn channel_difference(a: f32, b: f32) -> f32 {
    if a == b || (a.is_nan() && b.is_nan()) {
        return 0.0; // also inf == inf, whose difference would be NaN
    }
    let difference = (a - b).abs();
    if difference.is_nan() { f32::INFINITY } else { difference }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greatest_difference_and_share() {
        let a = Image::filled(2, 2, [1.0; 3]);
        let mut b = a.clone();
        b.set(1, 1, [1.0, 1.5, 0.75]);
        assert_eq!(max_abs_difference(&a, &b).unwrap(), 0.5);
        assert_eq!(fraction_within(&a, &b, 0.4).unwrap(), 0.75);
        assert_eq!(fraction_within(&a, &b, 0.5).unwrap(), 1.0);
        assert!(max_abs_difference(&a, &Image::new(2, 1)).is_err());
    }

    #[test]
    fn non_finite_values_are_compared() {
        let with = |value| Image::filled(1, 1, [value, 0.0, 0.0]);
        let (nan, inf, zero) = (with(f32::NAN), with(f32::INFINITY), with(0.0));
        assert_eq!(max_abs_difference(&nan, &nan).unwrap(), 0.0);
        assert_eq!(max_abs_difference(&inf, &inf).unwrap(), 0.0);
        assert_eq!(max_abs_difference(&nan, &zero).unwrap(), f32::INFINITY);
        assert_eq!(max_abs_difference(&inf, &zero).unwrap(), f32::INFINITY);
        assert_eq!(fraction_within(&nan, &zero, 1e9).unwrap(), 0.0);
    }
}
