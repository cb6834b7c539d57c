//! Perceptual Image Diff: the number of pixels whose difference a viewer would see.
//!
//! H. Yee, "A Perceptual Metric for Production Testing", Journal of Graphics Tools 9(4), 2004. Written from the paper;
//! what it leaves open (borders, bands, the order of sums) is chosen so that the published program's figures come out.
//!
//! A pixel differs visibly where luminance or colour differ by more than a viewer's tolerance. That is the threshold of
//! a flat field times a factor of 1 to 10, which the contrast around the pixel raises: fine and busy structure hides
//! differences. The two pictures are one field to the viewer, so that the greater contrast of both counts.

use std::borrow::Cow;

use crate::{Image, ImageError, Plane};

mod color;
mod field;
mod pyramid;
#[cfg(test)]
mod tests;
mod vision;

use field::Field;
use pyramid::LEVELS;

/// The test of what a viewer sees: parameters as of the program with which the thesis compared its pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerceptualDiff {
    /// The angle that the picture's width covers in the viewer's eye, in degrees, above 0 and below 180.
    pub fov: f32,
    /// The power that makes light of code values, above 0.
    pub gamma: f32,
    /// The luminance of white on the display in cd/m2, above 0.
    pub luminance: f32,
    /// Pictures pass where fewer pixels than this differ visibly, and always where none does.
    pub threshold: usize,
    /// Whether only luminance is compared, not colour.
    pub luminance_only: bool,
    /// The weight of differences in colour, 0 or above; 0 is `luminance_only`.
    pub color_factor: f32,
    /// How often both pictures are halved, by the mean of 2 x 2 code values, before they are compared; an odd last
    /// column or row is dropped, and a side of one pixel ends it.
    pub downsample: u32,
    /// Whether red and blue are taken for each other.
    ///
    /// The figures of the published program come out only so, those of its version 1.1.1 for the thesis' pictures among
    /// them; `false` is what Yee 2004 describes.
    pub swap_red_blue: bool,
}

impl Default for PerceptualDiff {
    fn default() -> Self {
        Self {
            fov: 45.0,
            gamma: 2.2,
            luminance: 100.0,
            threshold: 100,
            luminance_only: false,
            color_factor: 1.0,
            downsample: 0,
            swap_red_blue: true,
        }
    }
}

/// What Perceptual Image Diff found.
#[derive(Clone, Debug, PartialEq)]
pub struct PdiffOutcome {
    /// Number of pixels that differ visibly; of the halved pictures where they were halved.
    pub pixels: usize,
    /// Whether the pictures pass for the same.
    pub pass: bool,
    /// The sum over all pixels, seen or not, of the difference of luminance in cd/m2 and the colour error, which is the
    /// squared distance in a* and b* where colour is compared.
    pub error_sum: f64,
    /// The pixels that differ visibly.
    pub mask: Plane<bool>,
}

impl PerceptualDiff {
    /// Compares two pictures of code values in 0..=1; others are clamped, NaN is 0.
    ///
    /// Fails with [`ImageError::SizeMismatch`], and with [`ImageError::Parameter`] where a parameter lies outside its
    /// range.
    pub fn compare(&self, reference: &Image, test: &Image) -> Result<PdiffOutcome, ImageError> {
        self.validate()?;
        reference.expect_size_of(test, "the test picture")?;
        let (mut reference, mut test) = (Cow::Borrowed(reference), Cow::Borrowed(test));
        for _ in 0..self.downsample {
            if reference.width() < 2 || reference.height() < 2 {
                break;
            }
            (reference, test) = (Cow::Owned(halved(&reference)), Cow::Owned(halved(&test)));
        }
        if reference.is_empty() {
            return Ok(PdiffOutcome { pixels: 0, pass: true, error_sum: 0.0, mask: reference.map(|_| false) });
        }
        Ok(Field::new(self, &reference, &test).judge())
    }

    fn validate(&self) -> Result<(), ImageError> {
        let ranges = [
            ("fov", "above 0 and below 180 degrees", self.fov, self.fov > 0.0 && self.fov < 180.0),
            ("gamma", "above 0", self.gamma, self.gamma > 0.0 && self.gamma.is_finite()),
            ("luminance", "above 0 cd/m2", self.luminance, self.luminance > 0.0 && self.luminance.is_finite()),
            (
                "color-factor",
                "0 or above",
                self.color_factor,
                self.color_factor >= 0.0 && self.color_factor.is_finite(),
            ),
        ];
        match ranges.into_iter().find(|(.., allowed)| !allowed) {
            Some((parameter, range, value, _)) => {
                Err(ImageError::Parameter { parameter, range, value: f64::from(value) })
            }
            None => Ok(()),
        }
    }

    /// The picture's width in degrees, as on a plane before the eye.
    fn degrees(&self) -> f64 {
        2.0 * (f64::from(self.fov) * 0.5).to_radians().tan().to_degrees()
    }

    /// The level to which the eye adapts: the first whose smoothing has a width of 2^level above the picture's degrees.
    ///
    /// Yee 2004 means the level that averages over one degree, which would be the pixels per degree; published figures
    /// have the degrees of the picture in this place.
    fn adaptation_level(&self) -> usize {
        (0..LEVELS).find(|level| f64::from(1_u32 << level) > self.degrees()).unwrap_or(LEVELS - 1)
    }
}

/// The mean of each 2 x 2 pixels.
fn halved(image: &Image) -> Image {
    Image::from_fn(image.width() / 2, image.height() / 2, |x, y| {
        let four = [
            image.get(2 * x, 2 * y),
            image.get(2 * x + 1, 2 * y),
            image.get(2 * x, 2 * y + 1),
            image.get(2 * x + 1, 2 * y + 1),
        ];
        std::array::from_fn(|channel| four.iter().map(|pixel| pixel[channel]).sum::<f32>() / 4.0)
    })
}
