//! Image files to texels: PNG and JPEG, and for the physical model light in EXR, Radiance HDR and portable float maps.

mod light;

use ::image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits as DecoderLimits};
use lightcuts_scene::ImageDesc;
use std::io::Cursor;

/// Memory that a decoder may use beside the image itself.
const DECODER_SCRATCH: u64 = 64 << 20;

/// Bytes of a texel as [`Texels::Bytes`].
const BYTES_PER_TEXEL: u64 = 4;

/// Why bytes are no texture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TextureError {
    #[error("is neither a PNG nor a JPEG image")]
    NoTexture,
    #[error("is no PNG, JPEG, EXR, Radiance HDR or PFM image")]
    UnknownFormat,
    #[error("is {width} x {height} texels, but at most {side} x {side} are possible")]
    TooLarge { width: u32, height: u32, side: u32 },
    #[error("takes {bytes} bytes of memory, but there is room for {room} only")]
    NoRoom { bytes: u64, room: u64 },
    #[error("cannot be decoded: {0}")]
    Corrupt(#[from] ::image::ImageError),
    #[error("cannot be decoded: {0}")]
    Malformed(String),
}

/// What the numbers of an image mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ImageUse {
    /// Colours; code values are in sRGB.
    Color,
    /// Normals, masks and weights, as they are.
    Data,
}

/// The largest image to decode.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    /// Width and height in texels.
    pub(crate) side: u32,
    /// Size in memory.
    pub(crate) bytes: u64,
}

/// A decoded image.
#[derive(Debug, PartialEq)]
pub(crate) struct Decoded {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) texels: Texels,
    /// Whether light is another for colours than for data, its primaries being other ones.
    pub(crate) uses_differ: bool,
    /// What a user must know of how light was taken, a sentence each.
    pub(crate) remarks: Vec<String>,
}

/// Texels, top row first.
#[derive(Debug, PartialEq)]
pub(crate) enum Texels {
    /// Code values; alpha is 255 where the file has none.
    Bytes(Vec<[u8; 4]>),
    /// Linear light, of Rec. 709 where colours are wanted; data as the file has them.
    Light(Vec<[f32; 3]>),
}

impl Bounds {
    /// Fails for an image that is too large, before anything is allocated for it.
    fn check(self, width: u32, height: u32, bytes_per_texel: u64) -> Result<(), TextureError> {
        let Self { side, bytes: room } = self;
        if width > side || height > side {
            return Err(TextureError::TooLarge { width, height, side });
        }
        let bytes = u64::from(width) * u64::from(height) * bytes_per_texel;
        if bytes > room { Err(TextureError::NoRoom { bytes, room }) } else { Ok(()) }
    }
}

/// Decodes an image of at most `side` texels each way to 8-bit RGB. Grey becomes equal channels, alpha is dropped and
/// 16-bit values are rounded to 8; no transfer curve is applied, as in the thesis.
pub(crate) fn decode_rgb(name: &str, bytes: &[u8], side: u32) -> Result<ImageDesc, TextureError> {
    let format = format_of(bytes)?.ok_or(TextureError::NoTexture)?;
    let image = decode_bytes(bytes, format, Bounds { side, bytes: u64::MAX })?.into_rgb8();
    let (width, height) = image.dimensions();
    let texels = image.pixels().map(|texel| texel.0).collect();
    Ok(ImageDesc { name: name.to_owned(), width, height, texels })
}

/// Decodes an image of any of the formats, told apart by content. 16-bit values of PNG files are rounded to 8.
pub(crate) fn decode(bytes: &[u8], bounds: Bounds, wanted: ImageUse) -> Result<Decoded, TextureError> {
    let Some(format) = format_of(bytes)? else {
        return light::decode(bytes, bounds, wanted).unwrap_or(Err(TextureError::UnknownFormat));
    };
    let image = decode_bytes(bytes, format, bounds)?;
    let image = image.into_rgba8();
    let (width, height) = image.dimensions();
    let texels = image.into_raw().as_chunks().0.to_vec();
    Ok(Decoded { width, height, texels: Texels::Bytes(texels), uses_differ: false, remarks: Vec::new() })
}

/// PNG or JPEG; `None` for anything else.
fn format_of(bytes: &[u8]) -> Result<Option<ImageFormat>, TextureError> {
    let guessed = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(::image::ImageError::IoError)?;
    Ok(guessed.format().filter(|format| matches!(format, ImageFormat::Png | ImageFormat::Jpeg)))
}

fn decode_bytes(bytes: &[u8], format: ImageFormat, bounds: Bounds) -> Result<DynamicImage, TextureError> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = DecoderLimits::default();
    // Four channels of 16 bits, the largest that a PNG file holds.
    limits.max_alloc = Some(u64::from(bounds.side) * u64::from(bounds.side) * 8 + DECODER_SCRATCH);
    reader.limits(limits);
    let decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    // The header alone was read so far: nothing is allocated for an image that claims too much.
    bounds.check(width, height, BYTES_PER_TEXEL)?;
    Ok(DynamicImage::from_decoder(decoder)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::image::{GrayAlphaImage, ImageBuffer, Luma, LumaA, Rgba};

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).expect("an image in memory can be encoded");
        bytes.into_inner()
    }

    fn texel(image: impl Into<DynamicImage>) -> [u8; 3] {
        decode_rgb("t", &encoded(&image.into(), ImageFormat::Png), 16).expect("a sound image").texels[0]
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
        let error = decode_rgb("t", &bytes, 16).expect_err("17 is more than 16");
        assert_eq!(error.to_string(), "is 17 x 1 texels, but at most 16 x 16 are possible");
    }

    #[test]
    fn alpha_is_kept_for_the_physical_model() {
        let bounds = Bounds { side: 16, bytes: 8 };
        let decoded = |image: DynamicImage| decode(&encoded(&image, ImageFormat::Png), bounds, ImageUse::Color);
        let grey = decoded(GrayAlphaImage::from_pixel(2, 1, LumaA([77, 3])).into()).expect("a sound image");
        assert_eq!((grey.width, grey.height), (2, 1));
        assert_eq!(grey.texels, Texels::Bytes(vec![[77, 77, 77, 3]; 2]));
        let opaque = decoded(DynamicImage::new_rgb8(1, 1)).expect("a sound image");
        assert_eq!(opaque.texels, Texels::Bytes(vec![[0, 0, 0, 255]]));
        let error = decoded(DynamicImage::new_rgb8(3, 1)).expect_err("12 is more than 8").to_string();
        assert_eq!(error, "takes 12 bytes of memory, but there is room for 8 only");
        assert_eq!(
            decode(b"x", bounds, ImageUse::Data).expect_err("no image").to_string(),
            "is no PNG, JPEG, EXR, Radiance HDR or PFM image"
        );
    }
}
