//! Bloom: the glow that a lens adds around bright pixels.

use rayon::prelude::*;

use crate::Image;
use crate::plane::finite_or_zero;

/// Mixes each pixel with a blurred picture: `(1 - weight) * pixel + weight * blurred` (thesis section 7).
///
/// The kernel at distance r, in pixels, is `((radius - r) / radius)^4` for `r < radius`, the centre included, divided by
/// the sum of the weights inside the picture, so that a constant picture stays as it is up to its borders. The thesis
/// uses `radius` 12 and `weight` 0.7. A radius or a weight that is not positive returns the picture unchanged.
///
/// A NaN or an infinity stays in its pixel and counts as black for its neighbours. Cost: about `3 * radius^2` products
/// per pixel. Rows run in parallel; each sums in one fixed order, so that the result is the same on any number of
/// threads.
///
/// Differs from the original program, which worked IN PLACE row by row: there finished rows fed back into the rows
/// below them, so that a light smeared downwards. Here every pixel reads the original picture.
pub fn bloom(image: &Image, radius: f32, weight: f32) -> Image {
    if !(radius > 0.0 && weight > 0.0) || image.is_empty() {
        return image.clone();
    }
    let source: Vec<f32> = image.pixels().iter().flat_map(|pixel| finite_or_zero(*pixel)).collect();
    let mut result = image.clone();
    result.pixels_mut().par_chunks_mut(image.width()).enumerate().for_each(|(y, row)| {
        let blurred = blurred_row(&source, image.width(), image.height(), radius, y);
        for (pixel, blurred) in row.iter_mut().zip(blurred.chunks_exact(3)) {
            for (value, blurred) in pixel.iter_mut().zip(blurred) {
                *value = (1.0 - weight) * *value + weight * *blurred as f32;
            }
        }
    });
    result
}

/// Row `y` of the blurred picture, RGB interleaved; `source` is the whole picture, RGB interleaved.
fn blurred_row(source: &[f32], width: usize, height: usize, radius: f32, y: usize) -> Vec<f64> {
    let reach = reach(radius);
    let mut sums = vec![0.0; 3 * width];
    let mut weights = vec![0.0; width];
    for source_y in y.saturating_sub(reach)..=y.saturating_add(reach).min(height - 1) {
        let source_row = &source[3 * width * source_y..][..3 * width];
        let columns = reach.min(width - 1) as isize;
        for dx in -columns..=columns {
            let weight = kernel(radius, dx as f64, source_y.abs_diff(y) as f64);
            if weight > 0.0 {
                add_shifted(&mut sums, source_row, 3 * dx, weight);
                add_weight(&mut weights, dx, weight);
            }
        }
    }
    for (sum, weight) in sums.chunks_exact_mut(3).zip(&weights) {
        for sum in sum {
            *sum /= weight;
        }
    }
    sums
}

/// The greatest whole distance in pixels that is less than `radius`.
fn reach(radius: f32) -> usize {
    (radius.ceil() as usize).saturating_sub(1)
}

/// `((R - r) / R)^4` for `r < R`, else 0.
fn kernel(radius: f32, dx: f64, dy: f64) -> f64 {
    let radius = f64::from(radius);
    let falloff = ((radius - (dx * dx + dy * dy).sqrt()) / radius).max(0.0);
    falloff * falloff * falloff * falloff
}

/// `sums[i] += weight * source[i + shift]` wherever both exist.
fn add_shifted(sums: &mut [f64], source: &[f32], shift: isize, weight: f64) {
    let skip = shift.unsigned_abs().min(sums.len());
    let (sums, source) = if shift >= 0 { (&mut sums[..], &source[skip..]) } else { (&mut sums[skip..], source) };
    for (sum, value) in sums.iter_mut().zip(source) {
        *sum += weight * f64::from(*value);
    }
}

/// `weights[i] += weight` wherever `i + shift` lies in the row.
fn add_weight(weights: &mut [f64], shift: isize, weight: f64) {
    let width = weights.len();
    let skip = shift.unsigned_abs().min(width);
    let inside = if shift >= 0 { 0..width - skip } else { skip..width };
    weights[inside].iter_mut().for_each(|sum| *sum += weight);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::max_abs_difference;

    const RADIUS: f32 = 12.0;
    const WEIGHT: f32 = 0.7;

    /// The closed form, written as one double sum per pixel.
    fn reference(image: &Image, radius: f64, weight: f64) -> Image {
        Image::from_fn(image.width(), image.height(), |x, y| {
            let (mut sum, mut total) = ([0.0; 3], 0.0);
            for v in 0..image.height() {
                for u in 0..image.width() {
                    let r = (u as f64 - x as f64).hypot(v as f64 - y as f64);
                    let kernel = if r < radius { ((radius - r) / radius).powi(4) } else { 0.0 };
                    total += kernel;
                    (0..3).for_each(|c| sum[c] += kernel * f64::from(image.get(u, v)[c]));
                }
            }
            let own = image.get(x, y);
            std::array::from_fn(|c| ((1.0 - weight) * f64::from(own[c]) + weight * sum[c] / total) as f32)
        })
    }

    #[test]
    fn a_single_white_pixel_becomes_the_kernel_also_at_the_borders() {
        for (x, y) in [(20, 15), (0, 0), (39, 2), (5, 29)] {
            let mut image = Image::new(40, 30);
            image.set(x, y, [1.0, 2.0, 0.5]);
            let difference = max_abs_difference(&bloom(&image, RADIUS, WEIGHT), &reference(&image, 12.0, 0.7)).unwrap();
            assert!(difference < 1e-6, "{difference} at ({x}, {y})");
        }
    }

    #[test]
    fn a_constant_image_is_conserved() {
        let image = Image::filled(31, 17, [0.25, 1.0, 300.0]);
        let bloomed = bloom(&image, RADIUS, WEIGHT);
        assert!(
            bloomed.pixels().iter().all(|p| p.iter().zip([0.25, 1.0, 300.0]).all(|(a, b)| (a / b - 1.0).abs() < 1e-6))
        );
    }

    #[test]
    fn the_glow_is_symmetric_so_finished_rows_do_not_feed_back() {
        let mut image = Image::new(25, 25);
        image.set(12, 12, [1.0; 3]);
        let bloomed = bloom(&image, RADIUS, WEIGHT);
        for d in 1..12 {
            assert_eq!(bloomed.get(12, 12 - d), bloomed.get(12, 12 + d));
            assert_eq!(bloomed.get(12 - d, 12), bloomed.get(12 + d, 12));
        }
        assert_eq!(bloomed.get(12, 0), [0.0; 3], "the kernel is 0 at its radius");
    }

    #[test]
    fn small_pictures_and_odd_radii_agree_with_the_closed_form() {
        for (width, height, radius) in [(1, 1, 12.0), (2, 1, 0.5), (1, 7, 2.5), (5, 3, 100.0), (9, 9, 1.0)] {
            let image = Image::from_fn(width, height, |x, y| [x as f32, y as f32, 1.0]);
            let expected = reference(&image, f64::from(radius), 0.7);
            assert!(max_abs_difference(&bloom(&image, radius, WEIGHT), &expected).unwrap() < 1e-5);
        }
    }

    #[test]
    fn parameters_that_are_not_positive_change_nothing() {
        let image = Image::from_fn(4, 4, |x, y| [x as f32, y as f32, 1.0]);
        for (radius, weight) in [(0.0, 0.7), (-1.0, 0.7), (12.0, 0.0), (f32::NAN, 0.7)] {
            assert_eq!(bloom(&image, radius, weight), image);
        }
        assert!(bloom(&Image::new(0, 0), RADIUS, WEIGHT).is_empty());
    }

    #[test]
    fn a_nan_does_not_spread() {
        let mut image = Image::filled(5, 1, [1.0; 3]);
        image.set(2, 0, [f32::NAN, f32::INFINITY, 1.0]);
        let bloomed = bloom(&image, RADIUS, WEIGHT);
        assert!(bloomed.get(1, 0).iter().chain(&bloomed.get(3, 0)).all(|value| value.is_finite()));
        assert!(bloomed.get(2, 0)[0].is_nan());
    }
}
