//! The judgement of each pixel.

use rayon::prelude::*;

use super::color::Decoder;
use super::pyramid::{LEVELS, Pyramid};
use super::vision::{ContrastSensitivity, masking, threshold_versus_intensity};
use super::{PdiffOutcome, PerceptualDiff};
use crate::{Image, Plane};

/// Bands of spatial frequency: each lies between two levels and is measured against a third.
const BANDS: usize = LEVELS - 2;
/// Below this luminance in cd/m2 colour is not compared: cones see little there.
const COLOR_VISION: f32 = 10.0;
/// Luminances in cd/m2 and contrasts are at least this where something is divided by them.
const TINY: f32 = 1e-5;
/// Contrast raises the tolerance at most by this (Yee 2004).
const GREATEST_FACTOR: f32 = 10.0;
/// The frequency in cycles per degree at which an eye adapted to `BRIGHT` is most sensitive.
const PEAK_FREQUENCY: f32 = 3.248;
/// The luminance in cd/m2 for which bands are weighted.
const BRIGHT: f32 = 100.0;

/// Rows that are judged together. Around them 2 x 14 more are smoothed; all levels of both pictures are held for these
/// rows only, not for the whole picture.
const BAND: usize = 64;

/// Both pictures before a viewer's eye.
pub(super) struct Field<'a> {
    settings: &'a PerceptualDiff,
    pictures: [&'a Image; 2],
    decoder: Decoder,
    adaptation_level: usize,
    /// Centre of each band of frequency in cycles per degree.
    frequencies: [f32; BANDS],
    /// Inverse of each band's share in what an eye adapted to [`BRIGHT`] sees, 1 at the peak.
    weights: [f32; BANDS],
}

impl<'a> Field<'a> {
    /// Of two pictures of one size with at least one pixel.
    pub(super) fn new(settings: &'a PerceptualDiff, reference: &'a Image, test: &'a Image) -> Self {
        let highest = 0.5 * reference.width() as f64 / settings.degrees(); // a cycle takes two pixels
        let frequencies = std::array::from_fn(|band| (highest / f64::from(1_u32 << band)) as f32);
        let eye = ContrastSensitivity::adapted_to(BRIGHT);
        Self {
            settings,
            pictures: [reference, test],
            decoder: Decoder::new(settings.gamma, settings.swap_red_blue),
            adaptation_level: settings.adaptation_level(),
            frequencies,
            weights: frequencies.map(|frequency| (eye.at(PEAK_FREQUENCY) / eye.at(frequency)).min(f32::MAX)),
        }
    }

    /// Judges every pixel.
    pub(super) fn judge(&self) -> PdiffOutcome {
        let mut mask = Plane::new(self.pictures[0].width(), self.pictures[0].height());
        let width = mask.width();
        let bands = mask.pixels_mut().par_chunks_mut(width * BAND).enumerate();
        let sums: Vec<Vec<f64>> = bands.map(|(band, rows)| self.judge_band(BAND * band, rows)).collect();
        let pixels = mask.pixels().iter().filter(|visible| **visible).count();
        let pass = pixels == 0 || pixels < self.settings.threshold;
        PdiffOutcome { pixels, pass, error_sum: sums.iter().flatten().sum(), mask }
    }

    /// Fills the rows of the mask from row `top` on; returns each row's sum of errors.
    fn judge_band(&self, top: usize, mask: &mut [bool]) -> Vec<f64> {
        let [width, height] = [self.pictures[0].width(), self.pictures[0].height()];
        let band = top..top + mask.len() / width;
        let pyramids = self.pictures.map(|picture| {
            Pyramid::new(width, height, band.clone(), |y, row| {
                for (light, pixel) in row.iter_mut().zip(picture.row(y)) {
                    *light = self.decoder.luminance(*pixel) * self.settings.luminance;
                }
            })
        });
        band.zip(mask.chunks_exact_mut(width)).map(|(y, row)| self.judge_row(&pyramids, y, row)).collect()
    }

    /// Fills a row of the mask; returns its sum of errors.
    fn judge_row(&self, pyramids: &[Pyramid; 2], y: usize, mask: &mut [bool]) -> f64 {
        let levels = [pyramids[0].rows(y), pyramids[1].rows(y)];
        let colors = self.pictures.map(|picture| picture.row(y));
        let mut sum = 0.0;
        for (x, visible) in mask.iter_mut().enumerate() {
            let [a, b] = levels.map(|levels| levels.map(|row| row[x]));
            let adaptation = ((a[self.adaptation_level] + b[self.adaptation_level]) * 0.5).max(TINY);
            let light = (a[0] - b[0]).abs();
            let color = self.color_error(colors[0][x], colors[1][x], adaptation);
            sum += f64::from(light) + f64::from(color);
            *visible = self.is_visible(light, color, adaptation, &a, &b);
        }
        sum
    }

    fn color_error(&self, reference: [f32; 3], test: [f32; 3], adaptation: f32) -> f32 {
        if self.settings.luminance_only || adaptation < COLOR_VISION || reference == test {
            return 0.0;
        }
        let ([a, b], [c, d]) = (self.decoder.chroma(reference), self.decoder.chroma(test));
        ((a - c) * (a - c) + (b - d) * (b - d)) * self.settings.color_factor
    }

    /// Whether a difference of `light` in cd/m2 or of `color` is seen on levels `a` and `b`.
    fn is_visible(&self, light: f32, color: f32, adaptation: f32, a: &[f32; LEVELS], b: &[f32; LEVELS]) -> bool {
        if light == 0.0 && color <= 1.0 {
            return false;
        }
        let threshold = threshold_versus_intensity(adaptation);
        // The factor lies in 1..=10 and is dear; most pixels are decided without it, and in the same way.
        if light <= threshold && color <= 1.0 {
            return false;
        }
        if light > GREATEST_FACTOR * threshold || color > GREATEST_FACTOR {
            return true;
        }
        let factor = self.factor(adaptation, a, b);
        light > factor * threshold || color > factor
    }

    /// How much more than on a flat field the eye tolerates: each band's contrast counts by its share in the whole.
    fn factor(&self, adaptation: f32, a: &[f32; LEVELS], b: &[f32; LEVELS]) -> f32 {
        let eye = ContrastSensitivity::adapted_to(adaptation);
        let (mut contrasts, mut raised) = (0.0, 0.0);
        for band in 0..BANDS {
            let difference = |levels: &[f32; LEVELS]| (levels[band] - levels[band + 1]).abs();
            let base = a[band + 2].abs().max(b[band + 2].abs()).max(TINY);
            let contrast = difference(a).max(difference(b)) / base;
            contrasts += contrast;
            raised += contrast * self.weights[band] * masking(contrast * eye.at(self.frequencies[band]));
        }
        (raised / contrasts.max(TINY)).clamp(1.0, GREATEST_FACTOR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortcuts_decide_as_the_factor_does() {
        let image = Image::filled(512, 1, [0.5; 3]); // about 11 pixels per degree
        let settings = PerceptualDiff::default();
        let field = Field::new(&settings, &image, &image);
        let mut state = 1_u32;
        let mut draw = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / 16_777_216.0
        };
        let mut seen = [0; 2];
        for _ in 0..20_000 {
            let base = 100.0 * draw() * draw();
            let mut levels = || std::array::from_fn(|_| base * (1.0 + 0.02 * draw()));
            let (a, b) = (levels(), levels());
            let adaptation = (0.5 * (a[6] + b[6])).max(TINY);
            let threshold = threshold_versus_intensity(adaptation);
            let (light, color) = (12.0 * draw() * draw() * threshold, 12.0 * draw() * draw());
            let factor = field.factor(adaptation, &a, &b);
            let expected = light > factor * threshold || color > factor;
            assert_eq!(field.is_visible(light, color, adaptation, &a, &b), expected);
            seen[usize::from(expected)] += 1;
        }
        assert!(seen.iter().all(|count| *count > 2_000), "{seen:?}");
    }
}
