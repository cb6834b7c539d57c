//! Dodging and burning: the local operator of Reinhard et al. 2002.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{expect_positive, positive_luminance, scaled};
use crate::plane::finite_or_zero;
use crate::{Image, ImageError, Plane};

/// Width of the smallest centre: `1 / (2 sqrt 2)`, which puts two standard deviations at one pixel (Reinhard 2002).
const CENTRE_WIDTH: f64 = 0.353_553_390_593_273_8;
/// Added before the logarithm, so that pixels which are almost black do not drive the average to 0 (Reinhard 2002,
/// equation 1).
const LOG_DELTA: f64 = 1e-6;
/// A Gaussian `exp(-(d / w)^2)` is cut off at this many widths, where it is 1e-4.
const GAUSSIAN_REACH: f64 = 3.0;
/// More scales would blur over more than any picture's size.
const MAX_SCALES: u32 = 24;

/// Local tone reproduction (Reinhard, Stark, Shirley, Ferwerda, "Photographic Tone Reproduction for Digital Images",
/// SIGGRAPH 2002, sections 3.1 and 3.2, without the white point of equation 4).
///
/// Luminance is scaled so that its log-average becomes `key`. Each pixel finds the largest neighbourhood of even
/// luminance V1 around it, and becomes `L / (1 + V1)`: a dark pixel in a bright surrounding is darkened ("burned"), a
/// bright one in a dark surrounding is held back, so that local contrast survives. Colours keep their ratios.
///
/// Differs: black pixels are left out of the average, for an empty background would make everything else white; and the
/// Gaussians are cut off at three widths and divided by their weights inside the picture: the paper uses an FFT, which
/// wraps around.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct LocalToneMapping {
    /// The grey that the log-average becomes, before compression; 0.18 is a photographer's middle grey.
    pub key: f32,
    /// Sharpening: how much a small neighbourhood is preferred to a large one (paper: 8).
    pub phi: f32,
    /// Number of neighbourhood sizes; size i has the width `ratio^i` pixels (paper: 8).
    pub scales: u32,
    /// Ratio of one size to the one before, and of surround to centre (paper: 1.6).
    pub ratio: f32,
    /// Greatest difference between centre and surround that still counts as even (paper: 0.05).
    pub epsilon: f32,
}

impl Default for LocalToneMapping {
    fn default() -> Self {
        Self { key: 0.18, phi: 8.0, scales: 8, ratio: 1.6, epsilon: 0.05 }
    }
}

impl LocalToneMapping {
    pub(super) fn validate(&self) -> Result<(), ImageError> {
        expect_positive("key", self.key)?;
        expect_positive("phi", self.phi)?;
        expect_positive("epsilon", self.epsilon)?;
        if !(self.ratio > 1.0 && self.ratio <= 4.0) {
            let (parameter, range) = ("ratio", "above 1 and at most 4");
            return Err(ImageError::Parameter { parameter, range, value: f64::from(self.ratio) });
        }
        if !(1..=MAX_SCALES).contains(&self.scales) {
            let (parameter, range) = ("scales", "1 to 24");
            return Err(ImageError::Parameter { parameter, range, value: f64::from(self.scales) });
        }
        Ok(())
    }

    /// The picture after the operator; NaN and infinity count as 0, negative luminance as none.
    pub(super) fn apply(&self, image: &Image) -> Image {
        let mut result = image.map(finite_or_zero);
        if result.is_empty() {
            return result;
        }
        let world = result.map(positive_luminance);
        let exposure = f64::from(self.key) / log_average(&world);
        let luminance = world.map(|value| value * exposure);
        let adaptation = self.adaptation(&luminance);
        result.pixels_mut().par_iter_mut().zip(adaptation.pixels()).for_each(|(rgb, adaptation)| {
            // Ld / Lw = (exposure * Lw / (1 + V1)) / Lw; no division by the pixel's own luminance is left.
            *rgb = scaled(*rgb, exposure / (1.0 + adaptation));
        });
        result
    }

    /// V1 at the largest scale of each pixel up to which every scale is even (equations 5 to 8).
    fn adaptation(&self, luminance: &Plane<f64>) -> Plane<f64> {
        let ratio = f64::from(self.ratio);
        let mut centre = blurred(luminance, CENTRE_WIDTH);
        let mut chosen = centre.clone();
        let mut is_open = Plane::filled(luminance.width(), luminance.height(), true);
        for scale in 0..self.scales {
            let size = ratio.powi(scale as i32);
            // The surround of one scale is the centre of the next: both grow by the same ratio.
            let surround = blurred(luminance, CENTRE_WIDTH * size * ratio);
            let floor = f64::from(self.phi).exp2() * f64::from(self.key) / (size * size);
            let epsilon = f64::from(self.epsilon);
            let pixels = chosen.pixels_mut().par_iter_mut().zip(is_open.pixels_mut());
            pixels.zip(centre.pixels()).zip(surround.pixels()).for_each(|(((chosen, is_open), v1), v2)| {
                *is_open = *is_open && ((v1 - v2) / (floor + v1)).abs() < epsilon;
                if *is_open {
                    *chosen = *v1;
                }
            });
            centre = surround;
        }
        chosen
    }
}

/// `exp(mean(log(delta + L)))` of all pixels that are not black; 1 if all are. Rows are summed in parallel, the row sums in
/// order: the same on any number of threads.
fn log_average(luminance: &Plane<f64>) -> f64 {
    let row_sum = |row: &[f64]| {
        let lit = row.iter().filter(|value| **value > 0.0);
        lit.fold((0.0, 0_usize), |(sum, count), value| (sum + (LOG_DELTA + value).ln(), count + 1))
    };
    let sums: Vec<(f64, usize)> = luminance.pixels().par_chunks(luminance.width()).map(row_sum).collect();
    let (sum, count) = sums.into_iter().fold((0.0, 0), |(sum, count), row| (sum + row.0, count + row.1));
    if count == 0 { 1.0 } else { (sum / count as f64).exp() }
}

/// The picture under a Gaussian `exp(-(d / width)^2)`, `width` in pixels, normalised inside the picture.
fn blurred(plane: &Plane<f64>, width: f64) -> Plane<f64> {
    let weights = gaussian(width, plane.width().max(plane.height()));
    // A transposed picture turns columns into rows, which are read in order.
    transposed(&blurred_rows(&transposed(&blurred_rows(plane, &weights)), &weights))
}

/// Weights at the distances 0, 1, ... pixels, at most `limit` of them.
fn gaussian(width: f64, limit: usize) -> Vec<f64> {
    let reach = ((GAUSSIAN_REACH * width).ceil() as usize).min(limit.saturating_sub(1));
    (0..=reach).map(|distance| (-(distance as f64 / width).powi(2)).exp()).collect()
}

fn blurred_rows(plane: &Plane<f64>, weights: &[f64]) -> Plane<f64> {
    let mut result = plane.clone();
    let rows = plane.pixels().par_chunks(plane.width());
    result.pixels_mut().par_chunks_mut(plane.width()).zip(rows).for_each(|(result, row)| {
        for (x, result) in result.iter_mut().enumerate() {
            let (mut sum, mut total) = (weights[0] * row[x], weights[0]);
            for (distance, weight) in weights.iter().enumerate().skip(1) {
                let left = x.checked_sub(distance).map(|x| row[x]);
                for value in left.iter().chain(row.get(x + distance)) {
                    sum += weight * value;
                    total += weight;
                }
            }
            *result = sum / total;
        }
    });
    result
}

fn transposed(plane: &Plane<f64>) -> Plane<f64> {
    Plane::from_fn(plane.height(), plane.width(), |x, y| plane.get(y, x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GlobalToneMapping;

    #[test]
    fn a_constant_image_becomes_key_over_one_plus_key() {
        for value in [1e-3_f32, 1.0, 5e4] {
            let result = LocalToneMapping::default().apply(&Image::filled(33, 21, [value; 3]));
            let expected = 0.18 / 1.18;
            let tolerance = if value < 1.0 { 1e-3 } else { 1e-5 }; // the delta of the logarithm counts in the dark
            assert!(result.pixels().iter().flatten().all(|v| (v / expected - 1.0).abs() < tolerance), "{value}");
        }
    }

    #[test]
    fn a_black_background_changes_nothing_else() {
        let of_width = |lit: usize| {
            let pixels = (0..64 * 64).map(|k| if k % 64 < lit { [0.3; 3] } else { [0.0; 3] });
            let operator = LocalToneMapping { scales: 1, ..LocalToneMapping::default() };
            operator.apply(&Image::from_pixels(64, 64, pixels.collect()).unwrap())
        };
        let (whole, partial) = (of_width(64), of_width(20));
        assert!((whole.get(3, 30)[0] / partial.get(3, 30)[0] - 1.0).abs() < 1e-5);
        assert_eq!(partial.get(60, 30), [0.0; 3]);
        assert!(of_width(0).pixels().iter().all(|pixel| *pixel == [0.0; 3]));
    }

    #[test]
    fn gaussians_conserve_a_constant_and_the_sum_of_a_point_inside() {
        let constant = blurred(&Plane::filled(17, 9, 3.0), 5.0);
        assert!(constant.pixels().iter().all(|value| (value - 3.0).abs() < 1e-12));
        let mut point = Plane::new(61, 61);
        point.set(30, 30, 1.0);
        let point = blurred(&point, 4.0);
        assert!((point.pixels().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let expected = (-25.0_f64 / 16.0).exp(); // distance (3, 4), width 4
        assert!((point.get(33, 34) / point.get(30, 30) - expected).abs() < 1e-12);
    }

    /// Ratio of the greatest to the least green of fine stripes in the right, bright half.
    fn bright_contrast(image: &Image) -> f32 {
        let values: Vec<f32> = (44..60).map(|x| image.get(x, 16)[1]).collect();
        values.iter().copied().fold(0.0, f32::max) / values.iter().copied().fold(f32::MAX, f32::min)
    }

    #[test]
    fn detail_in_the_bright_half_survives_better_than_with_the_global_operator() {
        let image = Image::from_fn(64, 32, |x, _| {
            let level = if x < 32 { 0.05 } else { 50.0 };
            [level * if (x / 2) % 2 == 0 { 1.3 } else { 1.0 }; 3]
        });
        let local = bright_contrast(&LocalToneMapping::default().apply(&image));
        let global = bright_contrast(&GlobalToneMapping::default().apply(&image));
        assert!(local > 1.05 * global, "local {local}, global {global}");
        assert!((bright_contrast(&image) - 1.3).abs() < 1e-4);
    }
}
