//! Radiance pictures (.hdr, .pic): colours of 8 bits with a common exponent.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder as _};

use crate::limits::Claim;
use crate::{Image, ImageError};

/// What the first line of a file may be.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];
/// Greatest expansion that is believed. Old run lengths have no bound: eight bytes can stand for a whole row.
const MAX_EXPANSION: usize = 1 << 17;

/// Whether a file of these bytes is meant as a Radiance picture.
pub(crate) fn is_hdr(bytes: &[u8]) -> bool {
    SIGNATURES.iter().any(|signature| bytes.starts_with(signature))
}

/// The light of a Radiance picture (Ward, "Real Pixels", Graphics Gems II): samples divided by the header's `EXPOSURE`,
/// which tells the factor that was already applied to them.
///
/// Reads `FORMAT=32-bit_rle_rgbe` with rows from the top, in every kind of run length. Fails with
/// [`ImageError::Malformed`] on anything else, on damage and on a picture above [`MAX_PIXELS`](crate::MAX_PIXELS).
pub(crate) fn decode_hdr(path: &Path, bytes: &[u8]) -> Result<Image, ImageError> {
    // Last resort: damaged run lengths can overflow the decoder's arithmetic, and a file must never end the program.
    // Nothing is shared with the closure, so nothing can be left half changed.
    catch_unwind(AssertUnwindSafe(|| decode(path, bytes)))
        .unwrap_or_else(|_| Err(ImageError::malformed(path, "the HDR decoder failed on damaged data")))
}

fn decode(path: &Path, bytes: &[u8]) -> Result<Image, ImageError> {
    let malformed = |error: image::ImageError| ImageError::malformed(path, error.to_string());
    // Not strict: the strict decoder refuses the signature `#?RGBE`, which many programs write.
    let decoder = HdrDecoder::new_nonstrict(bytes).map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    Claim { width, height, bytes_per_pixel: 12, expansion: MAX_EXPANSION, file_bytes: bytes.len() }.check(path)?;
    let exposure = decoder.metadata().exposure.unwrap_or(1.0);
    if !(exposure.is_finite() && exposure > 0.0) {
        return Err(ImageError::malformed(path, format!("EXPOSURE must be a positive number, not {exposure}")));
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(malformed)?.into_rgb32f();
    let pixels = picture.pixels().map(|pixel| pixel.0.map(|value| value / exposure)).collect();
    Image::from_pixels(width, height, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(text: &str, pixels: &[u8]) -> Result<Image, ImageError> {
        decode_hdr(Path::new("a.hdr"), &[text.as_bytes(), pixels].concat())
    }

    /// 128 x 2^(129 - 136) = 1, 64 is a half of it.
    const PIXEL: [u8; 4] = [128, 64, 0, 129];

    #[test]
    fn plain_pixels_run_lengths_and_both_signatures() {
        for signature in ["#?RADIANCE", "#?RGBE"] {
            let header = format!("{signature}\n# comment\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
            assert!(is_hdr(header.as_bytes()));
            let image = decode(&header, &[PIXEL, [0; 4]].concat()).unwrap();
            assert_eq!(image.pixels(), [[1.0, 0.5, 0.0], [0.0; 3]]);
        }
        // Old run length: `1 1 1 n` repeats the pixel before it n times.
        let image = decode("#?RGBE\n\n-Y 1 +X 9\n", &[PIXEL, [1, 1, 1, 8]].concat()).unwrap();
        assert_eq!(image, Image::filled(9, 1, [1.0, 0.5, 0.0]));
        // New run length: four components, each a run of 8 (136 = 128 + 8).
        let rows = [2, 2, 0, 8, 136, 128, 136, 64, 136, 0, 136, 129];
        assert_eq!(decode("#?RGBE\n\n-Y 1 +X 8\n", &rows).unwrap(), Image::filled(8, 1, [1.0, 0.5, 0.0]));
    }

    #[test]
    fn the_exposure_is_taken_back() {
        let header = "#?RADIANCE\nEXPOSURE=4\nEXPOSURE=0.5\n\n-Y 1 +X 1\n";
        assert_eq!(decode(header, &PIXEL).unwrap().get(0, 0), [0.5, 0.25, 0.0]);
        for exposure in ["0", "-1", "nan", "inf"] {
            let found = decode(&format!("#?RGBE\nEXPOSURE={exposure}\n\n-Y 1 +X 1\n"), &PIXEL).unwrap_err().to_string();
            assert!(found.contains("EXPOSURE must be a positive number"), "{found}");
        }
    }

    #[test]
    fn damaged_files_are_errors() {
        let cases: [(&str, &[u8]); 8] = [
            ("#?RADIANCE", b""),
            ("#?RADIANCE\n\n", b""),
            ("#?RADIANCE\n\n-Y 1 +X 2\n", &PIXEL),
            ("#?RADIANCE\n\n-Y 0 +X 2\n", &PIXEL),
            ("#?RADIANCE\n\n+X 1 -Y 1\n", &PIXEL),
            ("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", &PIXEL),
            ("#?RADIANCE\n\n-Y 4294967295 +X 4294967295\n", &PIXEL),
            ("#?RADIANCE\n\n-Y 16384 +X 16384\n", &PIXEL),
        ];
        for (header, pixels) in cases {
            let found = decode(header, pixels).unwrap_err().to_string();
            assert!(found.starts_with("cannot read a.hdr: "), "{found}");
        }
    }

    #[test]
    fn no_damage_of_run_lengths_ends_the_program() {
        let markers = |count: u8, length: usize| [PIXEL.to_vec(), [1, 1, 1, count].repeat(length)].concat();
        for count in [0, 1, 255] {
            assert!(decode("#?RGBE\n\n-Y 1 +X 300\n", &markers(count, 40)).is_err(), "{count}");
        }
    }
}
