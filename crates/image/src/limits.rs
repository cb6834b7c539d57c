//! How much a file may ask for before anything is allocated.

use std::path::Path;

use crate::ImageError;

/// The largest picture that is read or written: 2^28 pixels, 16,384 x 16,384, 3 GiB of RGB.
pub const MAX_PIXELS: usize = 1 << 28;

/// The most bytes that the channels of one file may decode to: 16 GiB.
pub const MAX_DECODED_BYTES: usize = 1 << 34;

/// Greatest expansion of deflate, 1032:1 (RFC 1951: 258 bytes from two bits), with room for PXR24, which drops a
/// quarter of the bytes first. A file that claims more does not hold its pixels.
pub(crate) const MAX_EXPANSION: usize = 2048;

/// DWA compresses run lengths by deflate, so that its bound is a product; this one admits an all-black file.
pub(crate) const MAX_EXPANSION_DWA: usize = 1 << 17;

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
    /// Fails with [`ImageError::Malformed`] where the claim exceeds a limit or what the file's length can hold.
    ///
    /// A 377-byte file can claim 11 GiB; decoding it without this check aborts the process.
    pub(crate) fn check(&self, path: &Path) -> Result<(), ImageError> {
        let Self { width, height, .. } = *self;
        let pixels = width.saturating_mul(height);
        let bytes = pixels.saturating_mul(self.bytes_per_pixel);
        let refuse = |reason| Err(ImageError::malformed(path, format!("{width} x {height} pixels: {reason}")));
        if pixels == 0 {
            return refuse("the picture is empty".to_owned());
        }
        if pixels > MAX_PIXELS {
            return refuse(format!("more than the limit of {MAX_PIXELS}"));
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

    fn check(width: usize, height: usize, file_bytes: usize) -> Result<(), ImageError> {
        Claim { width, height, bytes_per_pixel: 12, expansion: MAX_EXPANSION, file_bytes }.check(Path::new("a.exr"))
    }

    #[test]
    fn limits_hold() {
        assert!(check(1920, 1080, 100_000).is_ok());
        assert!(check(1920, 1080, 377).is_err());
        assert!(check(0, 5, 377).is_err());
        assert!(check(MAX_PIXELS + 1, 1, usize::MAX).is_err());
        assert!(check(usize::MAX, usize::MAX, usize::MAX).is_err());
        assert!(check(1 << 14, 1 << 14, usize::MAX).is_ok());
    }
}
