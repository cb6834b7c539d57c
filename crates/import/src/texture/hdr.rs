//! Radiance pictures (Ward, "Real Pixels", Graphics Gems II).

use super::light::{Claim, light, malformed};
use super::{Bounds, Decoded, TextureError};
use ::image::codecs::hdr::HdrDecoder;
use ::image::{DynamicImage, ImageDecoder};

/// What the first line of a file may be.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

/// Greatest expansion that is believed: eight bytes of old run lengths can stand for a whole row.
const MAX_EXPANSION: usize = 1 << 17;

pub(super) fn is_hdr(bytes: &[u8]) -> bool {
    SIGNATURES.iter().any(|signature| bytes.starts_with(signature))
}

/// The light: samples divided by the header's `EXPOSURE`, which tells the factor that was already applied to them.
pub(super) fn decode(bytes: &[u8], bounds: Bounds) -> Result<Decoded, TextureError> {
    // Not strict: the strict decoder refuses the signature `#?RGBE`, which many programs write.
    let decoder = HdrDecoder::new_nonstrict(bytes)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    let claim = Claim { width, height, bytes_per_texel: 12, expansion: MAX_EXPANSION, file_bytes: bytes.len() };
    let (width, height) = claim.check(bounds)?;
    let exposure = decoder.metadata().exposure.unwrap_or(1.0);
    if !(exposure.is_finite() && exposure > 0.0) {
        return Err(malformed(format!("EXPOSURE must be a positive number, not {exposure}")));
    }
    let picture = DynamicImage::from_decoder(decoder)?.into_rgb32f();
    Ok(light(width, height, picture.pixels().map(|texel| texel.0.map(|value| value / exposure)).collect()))
}

#[cfg(test)]
mod tests {
    use super::super::Texels;
    use super::super::light::{bounds, decode};

    #[test]
    fn light_is_read_and_damage_told() {
        // 128 x 2^(129 - 136) = 1; the exposure of a half is taken back.
        let file = |header: &str, texels: &[u8]| [header.as_bytes(), texels].concat();
        let sound = file("#?RGBE\nEXPOSURE=0.5\n\n-Y 1 +X 1\n", &[128, 64, 0, 129]);
        let decoded = decode(&sound, bounds()).expect("it is HDR").expect("it is sound");
        assert_eq!(decoded.texels, Texels::Light(vec![[2.0, 1.0, 0.0]]));
        for (header, texels) in [
            ("#?RADIANCE\n\n-Y 1 +X 2\n", &[128, 64, 0, 129][..]),
            ("#?RADIANCE\n\n-Y 65 +X 1\n", &[]),
            ("#?RADIANCE\n\n-Y 0 +X 1\n", &[]),
            ("#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n", &[128, 64, 0, 129]),
            ("#?RGBE\n\n-Y 1 +X 60\n", &[1; 160]),
        ] {
            assert!(decode(&file(header, texels), bounds()).expect("it is HDR").is_err(), "{header}");
        }
    }
}
