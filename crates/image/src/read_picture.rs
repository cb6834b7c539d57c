//! Any picture file as something to measure, told by its content.

use std::fmt;
use std::fs;
use std::path::Path;

use crate::png::{Decoded, decode_png};
use crate::{Frame, ImageError, Light, LightOptions, Picture, PictureFormat, Transfer, decode_light};

/// A picture file that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// What it holds.
    pub picture: Picture,
    /// The channels of the file.
    pub channels: Channels,
    /// Told by content.
    pub format: PictureFormat,
    /// Where the pixels lie.
    pub frame: Frame,
    /// Whether it holds light and not what a display shows: any file but a PNG of 8 bits and fewer.
    pub holds_light: bool,
    /// What a user must know of how the numbers were taken, a sentence each.
    pub remarks: Vec<String>,
}

/// Which channels a picture file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// One number per pixel; a [`Picture`] has it three times.
    Grey,
    /// The same, and an alpha, which a [`Picture`] does not keep.
    GreyAlpha,
    /// Red, green and blue, or the three components of a vector.
    Rgb,
    /// The same, and an alpha, which a [`Picture`] does not keep.
    Rgba,
}

impl Channels {
    /// The same colours with or without an alpha.
    pub(crate) fn with_alpha(self, has_alpha: bool) -> Self {
        match (self.without_alpha(), has_alpha) {
            (Self::Grey, true) => Self::GreyAlpha,
            (Self::Rgb, true) => Self::Rgba,
            (colours, _) => colours,
        }
    }

    /// The same colours without an alpha.
    #[must_use]
    pub fn without_alpha(self) -> Self {
        match self {
            Self::Grey | Self::GreyAlpha => Self::Grey,
            Self::Rgb | Self::Rgba => Self::Rgb,
        }
    }
}

impl fmt::Display for Channels {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::Grey => "Y",
            Self::GreyAlpha => "Y, A",
            Self::Rgb => "R, G, B",
            Self::Rgba => "R, G, B, A",
        })
    }
}

/// Reads a picture to be measured: EXR, PNG, portable float map or Radiance HDR, told apart by content, not by name.
///
/// | format | light | display |
/// | --- | --- | --- |
/// | EXR, PFM, HDR | the values, as linear Rec. 709 | light clamped, after `transfer`, rounded to 8 bits |
/// | PNG of 16 bits | code values / 65535, `transfer` undone | as above |
/// | PNG of 8 bits and fewer | code values / their greatest, `transfer` undone | the code values |
///
/// Grey becomes three equal channels; alpha is told in the [`Channels`] and dropped. `layer` names a layer of an EXR file:
/// `albedo` is made of `albedo.R`, `.G`, `.B`, or `.X`, `.Y`, `.Z`, or `.Y`, or `.Z`, or `.ID`; also a single channel or a part
/// by name. Of an EXR without a layer: the first part with `R`, `G`, `B`, or else with `Y`.
///
/// Fails with [`ImageError::Io`], or with [`ImageError::Malformed`] on a damaged file, on another format, on one above
/// [`MAX_PIXELS`](crate::MAX_PIXELS), and where there is no such layer.
pub fn read_picture(
    path: impl AsRef<Path>,
    transfer: Transfer,
    layer: Option<&str>,
) -> Result<PictureFile, ImageError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| ImageError::io("read", path, source))?;
    let unknown = || ImageError::malformed(path, "it is no EXR, PNG, PFM or Radiance HDR file");
    let format = PictureFormat::of(&bytes).ok_or_else(unknown)?;
    if let (Some(layer), true) = (layer, format != PictureFormat::Exr) {
        return Err(ImageError::malformed(path, format!("it has no layer {layer}: only EXR files have layers")));
    }
    let options = LightOptions { layer, ..LightOptions::default() };
    match decode_light(path, &bytes, &options) {
        Some(light) => light.map(|light| of_light(light, format, transfer)),
        None => decode_png(path, &bytes, &options.limits).map(|png| of_codes(png, transfer)),
    }
}

fn of_light(light: Light, format: PictureFormat, transfer: Transfer) -> PictureFile {
    let Light { image, channels, frame, remarks, .. } = light;
    let picture = Picture::from_linear(image, transfer);
    PictureFile { picture, channels, format, frame, holds_light: true, remarks }
}

/// A PNG of 16 bits says more than a display shows, so that it is taken as light, as every other precise format.
fn of_codes(png: Decoded, transfer: Transfer) -> PictureFile {
    let frame = Frame::whole(png.codes.width(), png.codes.height());
    let picture = if png.is_16_bit {
        Picture::from_linear(png.codes.map(|codes| codes.map(|code| transfer.decode(code))), transfer)
    } else {
        Picture::from_display(png.codes, transfer)
    };
    let (channels, format) = (png.channels, PictureFormat::Png);
    PictureFile { picture, channels, format, frame, holds_light: png.is_16_bit, remarks: Vec::new() }
}
