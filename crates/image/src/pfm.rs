//! Portable float maps: a header of three tokens and plain 32-bit floats, bottom row first.

use std::path::Path;

use crate::limits::Claim;
use crate::{Channels, Frame, Image, ImageError, Light, LightOptions, PictureLimits};

/// Longest header: `PF`, two sides and a scale never need more. What is longer is no header.
const MAX_HEADER_BYTES: usize = 128;
/// Bytes of one sample.
const SAMPLE_BYTES: usize = 4;

/// The three lines at the front of a file.
#[derive(Debug, PartialEq)]
struct Header {
    channels: Channels,
    width: usize,
    height: usize,
    /// Factor on every sample; its sign is the byte order, negative for little-endian.
    scale: f32,
    /// Bytes up to the first sample.
    length: usize,
}

/// Whether a file of these bytes is meant as a portable float map.
pub(crate) fn is_pfm(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'F' | b'f', space, ..] if space.is_ascii_whitespace())
}

/// The light of a portable float map (P. Debevec's format): `PF` for colour, `Pf` for grey.
///
/// The samples are multiplied by the magnitude of the scale, as OpenImageIO and Mitsuba do; Netpbm and OpenCV divide, and the
/// format's own description leaves it open. So a magnitude other than 1 is remarked. The numbers are taken as Rec. 709.
///
/// Fails with [`ImageError::Malformed`] unless the pixels fill the file exactly, and beyond the limits; allocates nothing
/// before that check.
pub(crate) fn decode_pfm(path: &Path, bytes: &[u8], options: &LightOptions<'_>) -> Result<Light, ImageError> {
    let header = Header::parse(bytes).map_err(|reason| ImageError::malformed(path, reason))?;
    let samples = header.samples(path, bytes, &options.limits)?;
    let from_bytes = if header.scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let factor = header.scale.abs();
    let sample = |index: usize| factor * from_bytes(samples[index]);
    let pixel = |x: usize, y: usize| {
        let index = (header.height - 1 - y) * header.width + x;
        match header.channels {
            Channels::Rgb => std::array::from_fn(|channel| sample(3 * index + channel)),
            _ => [sample(index); 3],
        }
    };
    Ok(Light {
        image: Image::from_fn(header.width, header.height, pixel),
        channels: header.channels,
        frame: Frame::whole(header.width, header.height),
        has_other_primaries: false,
        remarks: header.remark().into_iter().collect(),
    })
}

impl Header {
    /// The header, or what is wrong with it.
    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut at = 0;
        let channels = match token(bytes, &mut at)? {
            "PF" => Channels::Rgb,
            "Pf" => Channels::Grey,
            other => return Err(format!("expected PF or Pf, found {other:?}")),
        };
        let mut side = |what| {
            let text = token(bytes, &mut at)?;
            text.parse().map_err(|_| format!("expected the {what} in pixels, found {text:?}"))
        };
        let (width, height) = (side("width")?, side("height")?);
        let text = token(bytes, &mut at)?;
        let scale: f32 = text.parse().map_err(|_| format!("expected the scale, found {text:?}"))?;
        if !scale.is_finite() || scale == 0.0 {
            return Err(format!("the scale must be a finite number other than 0, not {scale}"));
        }
        Ok(Self { channels, width, height, scale, length: at })
    }

    /// What is to be said of the scale.
    fn remark(&self) -> Option<String> {
        let factor = self.scale.abs();
        let told = || {
            format!(
                "the header's scale is {}: the samples were multiplied by {factor}; some programs (Netpbm, OpenCV) divide by it",
                self.scale
            )
        };
        (factor != 1.0).then(told)
    }

    /// The samples of the file, all of them and nothing else.
    fn samples<'a>(
        &self,
        path: &Path,
        bytes: &'a [u8],
        limits: &PictureLimits,
    ) -> Result<&'a [[u8; SAMPLE_BYTES]], ImageError> {
        let samples_per_pixel = if self.channels == Channels::Rgb { 3 } else { 1 };
        let bytes_per_pixel = samples_per_pixel * SAMPLE_BYTES;
        let pixels = &bytes[self.length..];
        let claim =
            Claim { width: self.width, height: self.height, bytes_per_pixel, expansion: 1, file_bytes: pixels.len() };
        claim.check(path, limits)?;
        let expected = self.width * self.height * bytes_per_pixel; // no overflow: the claim is checked
        if pixels.len() != expected {
            let reason = format!("{} bytes follow its {expected} bytes of pixels", pixels.len() - expected);
            return Err(ImageError::malformed(path, reason));
        }
        Ok(pixels.as_chunks().0)
    }
}

/// The next token, moving `at` past it and past the ONE white space after it: samples may look like white space.
fn token<'a>(bytes: &'a [u8], at: &mut usize) -> Result<&'a str, String> {
    let header = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
    let ended = || "the header ends too early".to_owned();
    let start = *at + header[*at..].iter().position(|byte| !byte.is_ascii_whitespace()).ok_or_else(ended)?;
    let end = start + header[start..].iter().position(u8::is_ascii_whitespace).ok_or_else(ended)?;
    *at = end + 1;
    std::str::from_utf8(&header[start..end]).map_err(|_| "the header is no text".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(header: &str, samples: &[u8]) -> Result<Light, ImageError> {
        let limits = PictureLimits { side: 64, pixels: 1000, ..PictureLimits::default() };
        let options = LightOptions { limits, ..LightOptions::default() };
        decode_pfm(Path::new("a.pfm"), &[header.as_bytes(), samples].concat(), &options)
    }

    fn complaint(header: &str, samples: &[u8]) -> String {
        decode(header, samples).unwrap_err().to_string()
    }

    #[test]
    fn rows_run_from_the_bottom_in_both_byte_orders() {
        let values: Vec<f32> = (0..12).map(|i| 0.25 * i as f32).collect();
        let little: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let big: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
        for (header, samples) in [("PF\n2 2\n-1.0\n", &little), ("PF 2\r2\t1 ", &big)] {
            let Light { image, channels, remarks, .. } = decode(header, samples).unwrap();
            assert_eq!(remarks, [""; 0]);
            assert_eq!(channels, Channels::Rgb);
            assert_eq!(image.row(1), [[0.0, 0.25, 0.5], [0.75, 1.0, 1.25]], "the file's first row is the bottom one");
            assert_eq!(image.row(0), [[1.5, 1.75, 2.0], [2.25, 2.5, 2.75]]);
        }
    }

    #[test]
    fn the_scale_multiplies_and_that_is_said() {
        for (scale, factor) in [("-2", 2.0), ("0.25", 0.25), ("-1e3", 1000.0)] {
            let bytes = if scale.starts_with('-') { 0.5_f32.to_le_bytes() } else { 0.5_f32.to_be_bytes() };
            let Light { image, channels, remarks, .. } = decode(&format!("Pf\n1 1\n{scale}\n"), &bytes).unwrap();
            assert_eq!((image.get(0, 0), channels), ([0.5 * factor; 3], Channels::Grey));
            assert!(remarks[0].contains(&format!("multiplied by {factor};")), "{remarks:?}");
        }
        for scale in ["-1", "1.0", "-1.000"] {
            assert_eq!(decode(&format!("Pf\n1 1\n{scale}\n"), &[0; 4]).unwrap().remarks.len(), 0);
        }
    }

    #[test]
    fn samples_that_look_like_white_space_belong_to_the_pixels() {
        let image = decode("Pf\n1 1\n-1\n", b"\n\n\n\n").unwrap().image;
        assert_eq!(image.get(0, 0), [f32::from_le_bytes(*b"\n\n\n\n"); 3]);
    }

    #[test]
    fn malformed_headers_are_explained() {
        let cases = [
            ("PF\n2", "the header ends too early"),
            ("PF\n0 1\n-1\n", "empty"),
            ("PF\n-2 2\n-1\n", "expected the width in pixels, found \"-2\""),
            ("PF\n2 2.5\n-1\n", "expected the height in pixels, found \"2.5\""),
            ("PF\n2 99999999999999999999999\n-1\n", "expected the height"),
            ("PF\n2 2\nnan\n", "a finite number other than 0, not NaN"),
            ("PF\n2 2\n-inf\n", "not -inf"),
            ("PF\n2 2\n0\n", "not 0"),
            ("PF\n2 2\nsmall\n", "expected the scale, found \"small\""),
            ("PF\n65 1\n-1\n", "at most 64 x 64"),
            ("PF\n40 40\n-1\n", "more than the limit of 1000"),
            ("PF\n16 16\n-1\n", "cannot come from a file of 4 bytes"),
            ("PF\n# a comment\n1 1\n-1\n", "expected the width in pixels, found \"#\""),
            ("PG\n1 1\n-1\n", "expected PF or Pf"),
        ];
        for (header, expected) in cases {
            let found = complaint(header, &[0; 4]);
            assert!(found.starts_with("cannot read a.pfm") && found.contains(expected), "{header:?}: {found}");
        }
        assert!(complaint(&format!("PF\n{}1 1\n-1\n", " ".repeat(200)), &[0; 12]).contains("ends too early"));
    }

    #[test]
    fn the_pixels_fill_the_file() {
        assert!(decode("PF\n1 1\n-1\n", &[0; 12]).is_ok());
        assert!(complaint("PF\n1 1\n-1\n", &[0; 11]).contains("cannot come from a file of 11 bytes"));
        assert!(complaint("PF\n1 1\n-1\n", &[0; 14]).contains("2 bytes follow"));
        assert!(is_pfm(b"Pf\n") && !is_pfm(b"PF") && !is_pfm(b"P6\n") && !is_pfm(b""));
    }
}
