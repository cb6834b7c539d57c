//! A picture as metrics see it: light, and what a display shows of it.

use rayon::prelude::*;

use crate::{Image, ImageError, Transfer};

/// A picture that can be measured.
///
/// Metrics of light (MSE, HDR-FLIP, ...) read `linear`; metrics of what an eye sees on a display (Perceptual Image Diff,
/// FLIP, SSIM, PSNR) read `display`. Both have one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    linear: Image,
    display: Image,
}

impl Picture {
    /// A picture of linear light, shown by clamping to 0..=1, `transfer` and rounding to 8 bits: the code values that
    /// [`write_png`](crate::write_png) writes.
    pub fn from_linear(linear: Image, transfer: Transfer) -> Self {
        let display = code_values(&linear, transfer);
        Self { linear, display }
    }

    /// A picture of linear light with what `shown`, the same light developed for a display (tone-mapped), looks like
    /// after `transfer` and rounding to 8 bits.
    ///
    /// Fails with [`ImageError::SizeMismatch`].
    pub fn developed(linear: Image, shown: &Image, transfer: Transfer) -> Result<Self, ImageError> {
        linear.expect_size_of(shown, "the developed picture")?;
        Ok(Self { linear, display: code_values(shown, transfer) })
    }

    /// A picture of code values in 0..=1, as a PNG stores them; its light is what `transfer` makes of them.
    pub fn from_display(display: Image, transfer: Transfer) -> Self {
        let linear = display.map(|pixel| pixel.map(|code| transfer.decode(code)));
        Self { linear, display }
    }

    /// Linear light; may hold values above 1, and non-finite ones where a renderer failed.
    pub fn linear(&self) -> &Image {
        &self.linear
    }

    /// Code values in 0..=1, always finite.
    pub fn display(&self) -> &Image {
        &self.display
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.linear.width()
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.linear.height()
    }
}

/// The code values of 8 bits, in 0..=1, that a display is sent for linear values. On all cores: large pictures take a power
/// per value.
fn code_values(linear: &Image, transfer: Transfer) -> Image {
    let mut display = linear.clone();
    display
        .pixels_mut()
        .par_iter_mut()
        .for_each(|pixel| *pixel = pixel.map(|value| f32::from(transfer.quantise(value)) / 255.0));
    display
}
