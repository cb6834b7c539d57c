//! PNG files: 8-bit pictures for eyes.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder as _, ImageEncoder as _};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::limits::{Claim, MAX_EXPANSION, PictureLimits, check_writable};
use crate::{Channels, Image, ImageError, write_atomic};

mod text;

/// How a linear value in 0..=1 becomes a code value in 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transfer {
    /// The value itself, as the thesis shows its pictures.
    #[default]
    Linear,
    /// The transfer of IEC 61966-2-1, which a display expects: linear near black, then a power of 1 / 2.4.
    Srgb,
}

impl Transfer {
    /// Linear value to code value; both 0..=1.
    pub fn encode(self, linear: f32) -> f32 {
        match self {
            Self::Linear => linear,
            Self::Srgb if linear <= 0.003_130_8 => 12.92 * linear,
            Self::Srgb => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
        }
    }

    /// Code value to linear value; both 0..=1.
    pub fn decode(self, code: f32) -> f32 {
        match self {
            Self::Linear => code,
            Self::Srgb if code <= 0.040_45 => code / 12.92,
            Self::Srgb => ((code + 0.055) / 1.055).powf(2.4),
        }
    }

    /// Linear value to 8 bits: clamped to 0..=1, transferred, rounded to the nearest of 0..=255; NaN is 0.
    pub fn quantise(self, linear: f32) -> u8 {
        // `max` before `min`: it is what turns a NaN into 0.
        #[allow(clippy::manual_clamp)]
        let clamped = linear.max(0.0).min(1.0);
        (self.encode(clamped) * 255.0).round() as u8
    }
}

/// Writes an 8-bit RGB PNG, atomically; see [`Transfer::quantise`] for the values.
///
/// The same picture gives the same bytes. Fails with [`ImageError::Encode`] on an empty picture or one above
/// [`MAX_PIXELS`](crate::MAX_PIXELS), and as [`write_atomic`].
pub fn write_png(path: impl AsRef<Path>, image: &Image, transfer: Transfer) -> Result<(), ImageError> {
    write_png_with_text(path, image, transfer, &[])
}

/// Writes a PNG as [`write_png`] does, with texts such as `("lightcuts:job", toml)` in `iTXt` chunks (UTF-8, plain).
///
/// Fails as [`write_png`], and with [`ImageError::Name`] where a keyword does not have the 1 to 79 printable Latin-1
/// characters that the format asks for.
pub fn write_png_with_text(
    path: impl AsRef<Path>,
    image: &Image,
    transfer: Transfer,
    texts: &[(&str, &str)],
) -> Result<(), ImageError> {
    let path = path.as_ref();
    check_writable(path, image.width(), image.height())?;
    let mut bytes = encoded(image, transfer).map_err(|error| ImageError::encode(path, error.to_string()))?;
    text::insert(&mut bytes, texts)?;
    write_atomic(path, &bytes)
}

fn encoded(image: &Image, transfer: Transfer) -> image::ImageResult<Vec<u8>> {
    let mut codes = vec![0; 3 * image.pixels().len()];
    let quantise = |(codes, pixel): (&mut [u8], &[f32; 3])| {
        codes.copy_from_slice(&pixel.map(|value| transfer.quantise(value)));
    };
    codes.par_chunks_exact_mut(3).zip(image.pixels()).for_each(quantise);
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive).write_image(
        &codes,
        image.width() as u32, // the casts hold: `check_writable` bounds both sides
        image.height() as u32,
        ExtendedColorType::Rgb8,
    )?;
    Ok(bytes)
}

/// Reads a PNG of any kind as linear RGB: code values divided by their maximum, then `transfer` undone; alpha is
/// dropped.
///
/// Fails with [`ImageError::Io`], or with [`ImageError::Malformed`] on a damaged file and on one above
/// [`MAX_PIXELS`](crate::MAX_PIXELS).
pub fn read_png(path: impl AsRef<Path>, transfer: Transfer) -> Result<Image, ImageError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| ImageError::io("read", path, source))?;
    let codes = decode_png(path, &bytes, &PictureLimits::default())?.codes;
    Ok(codes.map(|pixel| pixel.map(|code| transfer.decode(code))))
}

/// What a PNG holds.
pub(crate) struct Decoded {
    /// Code values in 0..=1; grey three times, without alpha.
    pub(crate) codes: Image,
    /// The channels of the file; of a palette, those of its colours.
    pub(crate) channels: Channels,
    /// Whether the file's samples have 16 bits.
    pub(crate) is_16_bit: bool,
}

/// Decodes the bytes of a PNG; fails as [`read_png`] does, and beyond `limits`.
pub(crate) fn decode_png(path: &Path, bytes: &[u8], limits: &PictureLimits) -> Result<Decoded, ImageError> {
    let malformed = |error: image::ImageError| ImageError::malformed(path, error.to_string());
    let decoder = PngDecoder::new(Cursor::new(bytes)).map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    let color = decoder.color_type();
    let claim = Claim {
        width: width as usize,
        height: height as usize,
        bytes_per_pixel: usize::from(color.bytes_per_pixel()),
        // A bit of a black and white picture becomes a byte.
        expansion: 8 * MAX_EXPANSION,
        file_bytes: bytes.len(),
    };
    claim.check(path, limits)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(malformed)?;
    let is_16_bit = color.bytes_per_pixel() / color.channel_count() == 2;
    // Divided here, so that grey and colour of one code value are one number.
    let pixels = if is_16_bit {
        picture.into_rgb16().pixels().map(|pixel| pixel.0.map(|code| f32::from(code) / 65_535.0)).collect()
    } else {
        picture.into_rgb8().pixels().map(|pixel| pixel.0.map(|code| f32::from(code) / 255.0)).collect()
    };
    let codes = Image::from_pixels(width as usize, height as usize, pixels)?;
    let colours = if color.has_color() { Channels::Rgb } else { Channels::Grey };
    Ok(Decoded { codes, channels: colours.with_alpha(color.has_alpha()), is_16_bit })
}

/// Reads the text of keyword `keyword` as [`write_png_with_text`] stores it; `None` where there is none.
///
/// Fails with [`ImageError::Io`]. Chunks are not checked beyond their bounds.
pub fn read_png_text(path: impl AsRef<Path>, keyword: &str) -> Result<Option<String>, ImageError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| ImageError::io("read", path, source))?;
    Ok(text::find(&bytes, keyword))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn scratch() -> (tempfile::TempDir, PathBuf) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        (directory, path)
    }

    #[test]
    fn values_are_clamped_and_rounded() {
        let cases = [(0.0, 0), (-1.0, 0), (1.0, 255), (7.0, 255), (f32::NAN, 0), (f32::INFINITY, 255), (0.5, 128)];
        for (value, expected) in cases {
            assert_eq!(Transfer::Linear.quantise(value), expected, "{value}");
        }
        assert_eq!(Transfer::Linear.quantise(0.4999 / 255.0), 0);
        assert_eq!(Transfer::Linear.quantise(0.5001 / 255.0), 1);
        assert_eq!(Transfer::Srgb.quantise(f32::NAN), 0);
        assert_eq!(Transfer::Srgb.quantise(0.214_041_14), 128); // 0.5 by the sRGB formula is 0.2140
        assert_eq!(Transfer::Srgb.quantise(1.0), 255);
    }

    #[test]
    fn every_code_value_survives_both_transfers() {
        let (_directory, path) = scratch();
        for transfer in [Transfer::Linear, Transfer::Srgb] {
            let code = |x: usize| transfer.decode(x as f32 / 255.0);
            let image = Image::from_fn(256, 2, |x, y| [code(x), code(255 - x), code((x + 7 * y) % 256)]);
            write_png(&path, &image, transfer).unwrap();
            let read = read_png(&path, transfer).unwrap();
            assert!(crate::max_abs_difference(&image, &read).unwrap() < 1e-6);
        }
    }

    #[test]
    fn texts_survive_and_the_picture_stays_readable() {
        let (_directory, path) = scratch();
        let image = Image::from_fn(5, 4, |x, y| [x as f32 / 5.0, y as f32 / 5.0, 1.0]);
        let job = "scene = \"a\"\n# Grüße 世界\n".repeat(5_000);
        write_png_with_text(&path, &image, Transfer::Linear, &[("lightcuts:job", &job), ("b", "")]).unwrap();
        assert_eq!(read_png_text(&path, "lightcuts:job").unwrap(), Some(job));
        assert_eq!(read_png_text(&path, "b").unwrap(), Some(String::new()));
        assert_eq!(read_png_text(&path, "none").unwrap(), None);
        assert!(crate::max_abs_difference(&image, &read_png(&path, Transfer::Linear).unwrap()).unwrap() < 0.002);
    }

    #[test]
    fn an_empty_picture_is_refused() {
        let (_directory, path) = scratch();
        assert!(matches!(write_png(&path, &Image::new(0, 0), Transfer::Linear), Err(ImageError::Encode { .. })));
        assert!(!path.exists());
    }

    #[test]
    fn damaged_files_are_errors() {
        let (_directory, path) = scratch();
        write_png(&path, &Image::filled(9, 9, [0.3; 3]), Transfer::Linear).unwrap();
        let whole = fs::read(&path).unwrap();
        let mut other_size = whole.clone();
        other_size[19] = 8; // 8 x 9: the CRC of the header is wrong then
        for bytes in [&whole[..whole.len() / 2], &other_size, b"", b"GIF89a"] {
            fs::write(&path, bytes).unwrap();
            assert!(read_png(&path, Transfer::Linear).unwrap_err().to_string().contains("a.png"));
        }
    }

    #[test]
    fn a_file_beyond_the_limits_is_refused() {
        let bytes = encoded(&Image::filled(9, 7, [0.3; 3]), Transfer::Linear).unwrap();
        let read = |limits| decode_png(Path::new("a.png"), &bytes, &limits);
        let any = PictureLimits::default();
        assert!(read(PictureLimits { side: 9, pixels: 63, bytes: 63 * 12 }).is_ok());
        let cases = [
            (PictureLimits { side: 8, ..any }, "at most 8 x 8"),
            (PictureLimits { pixels: 62, ..any }, "more than the limit of 62"),
            (PictureLimits { bytes: 755, ..any }, "there is room for 755 only"),
        ];
        for (limits, expected) in cases {
            let error = read(limits).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(error.starts_with("cannot read a.png: 9 x 7 pixels") && error.contains(expected), "{error}");
        }
    }
}
