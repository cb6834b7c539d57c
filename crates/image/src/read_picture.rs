//! Any picture file as something to measure, told by its content.

use std::fmt;
use std::fs;
use std::path::Path;

use crate::exr_picture::decode_exr_picture;
use crate::hdr::{decode_hdr, is_hdr};
use crate::pfm::{decode_pfm, is_pfm};
use crate::png::{Decoded, decode_png};
use crate::{Image, ImageError, Picture, Transfer};

/// The first bytes of an EXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// The first bytes of a PNG file.
const PNG: [u8; 8] = [0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a];

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
/// | EXR, PFM, HDR | the values | light clamped, after `transfer`, rounded to 8 bits |
/// | PNG of 16 bits | code values / 65535, `transfer` undone | as above |
/// | PNG of 8 bits and fewer | code values / their greatest, `transfer` undone | the code values |
///
/// Grey becomes three equal channels; alpha is told in the [`Channels`] and dropped, colours are taken as they are stored.
/// `layer` names a layer of an EXR file: `albedo` is made of `albedo.R`, `.G`, `.B`, or `.X`, `.Y`, `.Z`, or `.Y`, or
/// `.Z`; also a single channel or a part by name. Of an EXR without a layer: the first part with `R`, `G`, `B`, or else
/// with `Y`.
///
/// Fails with [`ImageError::Io`], or with [`ImageError::Malformed`] on a damaged file, on another format, on one above
/// [`MAX_PIXELS`](crate::MAX_PIXELS), and where there is no such layer.
pub fn read_picture(
    path: impl AsRef<Path>,
    transfer: Transfer,
    layer: Option<&str>,
) -> Result<(Picture, Channels), ImageError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| ImageError::io("read", path, source))?;
    let of_light = |(linear, channels): (Image, Channels)| (Picture::from_linear(linear, transfer), channels);
    if bytes.starts_with(&EXR) {
        return decode_exr_picture(path, &bytes, layer).map(of_light);
    }
    if let Some(layer) = layer {
        return Err(ImageError::malformed(path, format!("it has no layer {layer}: only EXR files have layers")));
    }
    match () {
        () if bytes.starts_with(&PNG) => decode_png(path, &bytes).map(|png| of_codes(png, transfer)),
        () if is_pfm(&bytes) => decode_pfm(path, &bytes).map(of_light),
        () if is_hdr(&bytes) => decode_hdr(path, &bytes).map(|light| of_light((light, Channels::Rgb))),
        () => Err(ImageError::malformed(path, "it is no EXR, PNG, PFM or Radiance HDR file")),
    }
}

/// A PNG of 16 bits says more than a display shows, so that it is taken as light, as every other precise format.
fn of_codes(png: Decoded, transfer: Transfer) -> (Picture, Channels) {
    let picture = if png.is_16_bit {
        Picture::from_linear(png.codes.map(|codes| codes.map(|code| transfer.decode(code))), transfer)
    } else {
        Picture::from_display(png.codes, transfer)
    };
    (picture, png.channels)
}
