//! Textures: PNG and JPEG files to texels.

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits as DecoderLimits};
use lightcuts_scene::ImageDesc;
use std::io::Cursor;

/// Memory that a decoder may use beside the image itself.
const DECODER_SCRATCH: u64 = 64 << 20;

/// Why bytes are no texture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TextureError {
    #[error("is neither a PNG nor a JPEG image")]
    UnknownFormat,
    #[error("is {width} x {height} texels, but at most {side} x {side} are possible")]
    TooLarge { width: u32, height: u32, side: u32 },
    #[error("cannot be decoded: {0}")]
    Corrupt(#[from] image::ImageError),
}

/// Decodes an image of at most `side` texels each way to 8-bit RGB. Grey becomes equal channels, alpha is dropped and
/// 16-bit values are rounded to 8; no transfer curve is applied, as in the thesis.
pub(crate) fn decode(name: &str, bytes: &[u8], side: u32) -> Result<ImageDesc, TextureError> {
    let guessed = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(image::ImageError::IoError)?;
    if !matches!(guessed.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return Err(TextureError::UnknownFormat);
    }
    let mut reader = guessed;
    let mut limits = DecoderLimits::default();
    // Four channels of 16 bits, the largest that a PNG file holds.
    limits.max_alloc = Some(u64::from(side) * u64::from(side) * 8 + DECODER_SCRATCH);
    reader.limits(limits);
    let decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    // The header alone was read so far: nothing is allocated for an image that claims too much.
    if width > side || height > side {
        return Err(TextureError::TooLarge { width, height, side });
    }
    let image = DynamicImage::from_decoder(decoder)?.into_rgb8();
    let texels = image.pixels().map(|texel| texel.0).collect();
    Ok(ImageDesc { name: name.to_owned(), width, height, texels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayAlphaImage, ImageBuffer, Luma, LumaA, Rgba};

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).expect("an image in memory can be encoded");
        bytes.into_inner()
    }

    fn texel(image: impl Into<DynamicImage>) -> [u8; 3] {
        decode("t", &encoded(&image.into(), ImageFormat::Png), 16).expect("a sound image").texels[0]
    }

    #[test]
    fn other_pixel_formats_become_rgb() {
        let grey = GrayAlphaImage::from_pixel(2, 1, LumaA([77, 3]));
        assert_eq!(texel(grey), [77, 77, 77]);
        let deep: ImageBuffer<Luma<u16>, Vec<u16>> = ImageBuffer::from_pixel(1, 1, Luma([257 * 200]));
        assert_eq!(texel(deep), [200, 200, 200]);
        let alpha: ImageBuffer<Rgba<u8>, Vec<u8>> = ImageBuffer::from_pixel(1, 1, Rgba([1, 2, 3, 0]));
        assert_eq!(texel(alpha), [1, 2, 3]);
    }

    #[test]
    fn the_header_is_checked_first() {
        let bytes = encoded(&DynamicImage::new_rgb8(17, 1), ImageFormat::Png);
        let error = decode("t", &bytes, 16).expect_err("17 is more than 16");
        assert_eq!(error.to_string(), "is 17 x 1 texels, but at most 16 x 16 are possible");
    }
}
