//! Portable float maps (P. Debevec's format): `PF` for colour, `Pf` for grey; the bottom row first.

use super::light::{Claim, light, malformed};
use super::{Bounds, Decoded, TextureError};

/// Longest header, in bytes.
const MAX_HEADER: usize = 128;
const SAMPLE_BYTES: usize = 4;

pub(super) fn is_pfm(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'F' | b'f', space, ..] if space.is_ascii_whitespace())
}

/// The light: samples times the magnitude of the header's scale, whose sign is the byte order.
pub(super) fn decode(bytes: &[u8], bounds: Bounds) -> Result<Decoded, TextureError> {
    let mut at = 0;
    let channels = if token(bytes, &mut at)? == "PF" { 3 } else { 1 };
    let (width, height): (usize, usize) = (number(bytes, &mut at)?, number(bytes, &mut at)?);
    let scale: f32 = number(bytes, &mut at)?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(malformed(format!("the scale must be a finite number other than 0, not {scale}")));
    }
    let samples = &bytes[at..];
    let bytes_per_texel = channels * SAMPLE_BYTES;
    let claim = Claim { width, height, bytes_per_texel, expansion: 1, file_bytes: samples.len() };
    let size = claim.check(bounds)?;
    let samples = samples.as_chunks::<SAMPLE_BYTES>().0;
    let from_bytes = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let sample = |index: usize| scale.abs() * from_bytes(samples[index]);
    let texel = |index: usize| std::array::from_fn(|channel| sample(channels * index + channel.min(channels - 1)));
    let rows = (0..height).rev();
    let texels = rows.flat_map(|row| (row * width..(row + 1) * width).map(texel)).collect();
    Ok(light(size.0, size.1, texels))
}

fn number<T: std::str::FromStr>(bytes: &[u8], at: &mut usize) -> Result<T, TextureError> {
    let text = token(bytes, at)?;
    text.parse().map_err(|_| malformed(format!("`{text}` in the header is not a number")))
}

/// The next token, moving `at` past it and past the ONE white space after it: samples may look like white space.
fn token<'a>(bytes: &'a [u8], at: &mut usize) -> Result<&'a str, TextureError> {
    let header = &bytes[..bytes.len().min(MAX_HEADER)];
    let ended = || malformed("the header ends too early");
    let start =
        *at + header.get(*at..).unwrap_or_default().iter().position(|b| !b.is_ascii_whitespace()).ok_or_else(ended)?;
    let end = start + header[start..].iter().position(u8::is_ascii_whitespace).ok_or_else(ended)?;
    *at = end + 1;
    std::str::from_utf8(&header[start..end]).map_err(|_| malformed("the header is no text"))
}

#[cfg(test)]
mod tests {
    use super::super::Texels;
    use super::super::light::{bounds, decode};

    #[test]
    fn rows_run_from_the_bottom_in_both_byte_orders() {
        let values = [0.25_f32, 0.5, 1.0, 2.0];
        let little: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let big: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
        for (header, samples) in [("Pf\n2 2\n-2.0\n", little), ("Pf 2 2 2 ", big)] {
            let decoded = decode(&[header.as_bytes(), &samples].concat(), bounds()).expect("it is PFM").expect("sound");
            assert_eq!(decoded.texels, Texels::Light(vec![[2.0; 3], [4.0; 3], [0.5; 3], [1.0; 3]]));
        }
        let colour = [b"PF\n1 1\n-1\n".to_vec(), values[..3].iter().flat_map(|v| v.to_le_bytes()).collect()].concat();
        let decoded = decode(&colour, bounds()).expect("it is PFM").expect("sound");
        assert_eq!(decoded.texels, Texels::Light(vec![[0.25, 0.5, 1.0]]));
    }

    #[test]
    fn damage_is_told() {
        for header in
            ["PF\n", "PF\n1", "PF\n0 1\n-1\n", "PF\n1 1\n0\n", "PF\n1 1\nnan\n", "PF\n9 9\n-1\n", "Pf\n-1 1 1\n"]
        {
            let error =
                decode(&[header.as_bytes(), &[0; 12]].concat(), bounds()).expect("it is PFM").expect_err(header);
            assert!(error.to_string().starts_with("cannot be decoded: "), "{header}: {error}");
        }
    }
}
