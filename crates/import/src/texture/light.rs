//! Formats that hold light, told apart by content.
//!
//! They are decoded as `lightcuts-image` does it, which reads paths only; here bytes may come from anywhere.

use super::{Bounds, Decoded, Texels, TextureError, exr, hdr, pfm};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Bytes of a texel as [`Texels::Light`].
pub(super) const BYTES_PER_TEXEL: u64 = 12;

/// What a header claims.
pub(super) struct Claim {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Of one texel, once it is decoded.
    pub(super) bytes_per_texel: usize,
    /// Greatest ratio of decoded bytes to bytes in the file.
    pub(super) expansion: usize,
    /// Length of the file.
    pub(super) file_bytes: usize,
}

impl Claim {
    /// Fails where the claim exceeds a limit or what the file's length can hold; the size, if it does not.
    pub(super) fn check(&self, bounds: Bounds) -> Result<(u32, u32), TextureError> {
        let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        let (width, height) = (side(self.width), side(self.height));
        if width == 0 || height == 0 {
            return Err(malformed("the image is empty"));
        }
        bounds.check(width, height, BYTES_PER_TEXEL)?;
        let bytes = self.width.saturating_mul(self.height).saturating_mul(self.bytes_per_texel);
        if bytes > self.file_bytes.saturating_mul(self.expansion) {
            return Err(malformed(format!(
                "{width} x {height} texels cannot come from a file of {} bytes",
                self.file_bytes
            )));
        }
        Ok((width, height))
    }
}

/// The light in `bytes`; `None` if they are in none of the formats.
pub(super) fn decode(bytes: &[u8], bounds: Bounds) -> Option<Result<Decoded, TextureError>> {
    let decode = match () {
        () if exr::is_exr(bytes) => exr::decode,
        () if hdr::is_hdr(bytes) => hdr::decode,
        () if pfm::is_pfm(bytes) => pfm::decode,
        () => return None,
    };
    // Last resort: damaged data can make the decoders fail an assertion, and a file must never end the program. Nothing
    // that outlives them is changed, so nothing can be left half changed.
    let outcome = catch_unwind(AssertUnwindSafe(|| decode(bytes, bounds)));
    Some(outcome.unwrap_or_else(|_| Err(malformed("the data are damaged"))))
}

pub(super) fn light(width: u32, height: u32, texels: Vec<[f32; 3]>) -> Decoded {
    Decoded { width, height, texels: Texels::Light(texels) }
}

pub(super) fn malformed(reason: impl Into<String>) -> TextureError {
    TextureError::Malformed(reason.into())
}

#[cfg(test)]
pub(super) fn bounds() -> Bounds {
    Bounds { side: 64, bytes: 1 << 20 }
}
