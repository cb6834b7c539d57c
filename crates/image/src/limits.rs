//! How much a file may ask for before anything is allocated.

use std::path::Path;

use crate::ImageError;

/// The largest picture that is read or written: 2^28 pixels, 16,384 x 16,384, 3 GiB of RGB.
pub const MAX_PIXELS: usize = 1 << 28;

/// The most bytes that the channels of one file may decode to: 16 GiB.
pub const MAX_DECODED_BYTES: usize = 1 << 34;

/// Bytes of a pixel of a picture in memory: three floats.
const BYTES_PER_PIXEL: usize = 12;

/// Greatest expansion of deflate, 1032:1 (RFC 1951: 258 bytes from two bits), with room for PXR24, which drops a
/// quarter of the bytes first. A file that claims more does not hold its pixels.
pub(crate) const MAX_EXPANSION: usize = 2048;

/// DWA compresses run lengths by deflate, so that its bound is a product; this one admits an all-black file.
pub(crate) const MAX_EXPANSION_DWA: usize = 1 << 17;

/// The largest picture that a reader accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureLimits {
    /// Greatest width and height, in pixels.
    pub side: usize,
    /// Most pixels.
    pub pixels: usize,
    /// Most memory of the picture itself, at 12 bytes a pixel.
    pub bytes: usize,
}

impl Default for PictureLimits {
    /// [`MAX_PIXELS`] of any shape.
    fn default() -> Self {
        Self { side: usize::MAX, pixels: MAX_PIXELS, bytes: MAX_DECODED_BYTES }
    }
}

/// What a header claims about a picture of a file.
pub(crate) struct Claim {
    /// Width in pixels.
    pub(crate) width: usize,
    /// Height in pixels.
    pub(crate) height: usize,
    /// Bytes per pixel once decoded.
    pub(crate) bytes_per_pixel: usize,
    /// Greatest ratio of decoded bytes to bytes in the file.
    pub(crate) expansion: usize,
    /// Length of the file in bytes.
    pub(crate) file_bytes: usize,
}

impl Claim {
    /// Fails with [`ImageError::Malformed`] where the claim exceeds a limit or what the file's length can hold; to be asked
    /// before anything is allocated for it.
    pub(crate) fn check(&self, path: &Path, limits: &PictureLimits) -> Result<(), ImageError> {
        let Self { width, height, .. } = *self;
        let pixels = width.saturating_mul(height);
        let bytes = pixels.saturating_mul(self.bytes_per_pixel);
        let picture_bytes = pixels.saturating_mul(BYTES_PER_PIXEL);
        let refuse = |reason| Err(ImageError::malformed(path, format!("{width} x {height} pixels: {reason}")));
        if pixels == 0 {
            return refuse("the picture is empty".to_owned());
        }
        if width.max(height) > limits.side {
            return refuse(format!("at most {} x {} are possible", limits.side, limits.side));
        }
        if pixels > limits.pixels {
            return refuse(format!("more than the limit of {}", limits.pixels));
        }
        if picture_bytes > limits.bytes {
            return refuse(format!("{picture_bytes} bytes of memory, but there is room for {} only", limits.bytes));
        }
        if bytes > MAX_DECODED_BYTES {
            return refuse(format!("{bytes} bytes, more than the limit of {MAX_DECODED_BYTES}"));
        }
        if bytes > self.file_bytes.saturating_mul(self.expansion) {
            return refuse(format!("{bytes} bytes cannot come from a file of {} bytes", self.file_bytes));
        }
        Ok(())
    }
}

/// Fails with [`ImageError::Encode`] unless the picture has 1 to [`MAX_PIXELS`] pixels.
pub(crate) fn check_writable(path: &Path, width: usize, height: usize) -> Result<(), ImageError> {
    if (1..=MAX_PIXELS).contains(&width.saturating_mul(height)) {
        return Ok(());
    }
    Err(ImageError::encode(path, format!("{width} x {height} pixels; there must be 1 to {MAX_PIXELS}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: PictureLimits = PictureLimits { side: 20, pixels: 300, bytes: 2400 };

    fn check(width: usize, height: usize, file_bytes: usize, limits: PictureLimits) -> Result<(), String> {
        let claim = Claim { width, height, bytes_per_pixel: 12, expansion: 4, file_bytes };
        claim.check(Path::new("a.exr"), &limits).map_err(|error| error.to_string())
    }

    #[test]
    fn each_limit_holds_and_is_told() {
        assert_eq!(check(20, 10, 600, SMALL), Ok(()));
        let refused = |width, height, file_bytes, expected: &str| {
            let found = check(width, height, file_bytes, SMALL).unwrap_err();
            assert!(found.starts_with("cannot read a.exr: ") && found.ends_with(expected), "{found}");
        };
        refused(0, 5, 600, "the picture is empty");
        refused(21, 1, 600, "at most 20 x 20 are possible");
        refused(1, 21, 600, "at most 20 x 20 are possible");
        refused(20, 16, 6000, "more than the limit of 300");
        refused(15, 15, 6000, "2700 bytes of memory, but there is room for 2400 only");
        refused(20, 10, 599, "2400 bytes cannot come from a file of 599 bytes");
    }

    #[test]
    fn no_product_of_sides_overflows() {
        let any = PictureLimits::default();
        assert!(check(usize::MAX, usize::MAX, usize::MAX, any).is_err());
        assert!(check(MAX_PIXELS + 1, 1, usize::MAX, any).is_err());
        assert!(check(1 << 14, 1 << 14, usize::MAX, any).is_ok());
    }
}
