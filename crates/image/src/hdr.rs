//! Radiance pictures (.hdr, .pic): three mantissas of 8 bits with a common exponent, of RGB or of XYZ.
//!
//! After Radiance's own documents: "The RADIANCE Picture File Format" and its man pages `ra_xyze`, `pfilt` and `pvalue`, with
//! Ward, "Real Pixels", Graphics Gems II.

mod header;
mod scanline;

use std::path::Path;

use crate::limits::Claim;
use crate::primaries::{Matrix, Primaries, convert, inverse};
use crate::{Channels, Frame, Image, ImageError, Light, LightOptions};
use header::{Header, Pixels};
use scanline::read_scanline;

/// What the first line of a file may be.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];
/// Greatest expansion that is believed. Old run lengths have no bound: eight bytes can stand for a whole row.
const MAX_EXPANSION: usize = 1 << 17;
/// Lumens per watt of Radiance's white, by which its XYZ (in lumens) and its RGB (in watts) differ: WHTEFFICACY of its
/// `color.h`.
const LUMENS_PER_WATT: f64 = 179.0;
/// Radiance's own primaries with its white of equal energy (`STDPRIMS` of its `color.h`). They are what RGBE files without
/// `PRIMARIES` have, and all programs take those for Rec. 709.
const RADIANCE: Primaries =
    Primaries { red: [0.640, 0.330], green: [0.290, 0.600], blue: [0.150, 0.060], white: [1.0 / 3.0, 1.0 / 3.0] };
/// Pixel aspect ratios nearer to 1 are square.
const ASPECT_TOLERANCE: f64 = 1e-3;

/// Whether a file of these bytes is meant as a Radiance picture.
pub(crate) fn is_hdr(bytes: &[u8]) -> bool {
    SIGNATURES.iter().any(|signature| bytes.starts_with(signature))
}

/// The light of a Radiance picture, in watts per steradian and square metre as Radiance has it.
///
/// A component is the middle of its step, `(m + 0.5) / 256 * 2^(e - 128)`, for writers cut mantissas off; exponent 0 is black.
/// It is divided by the product of all `EXPOSURE` lines and, per channel, of all `COLORCORR` lines. XYZ becomes RGB as
/// `ra_xyze -r` makes it: by Radiance's primaries and white, over its 179 lumens per watt. Colours of other `PRIMARIES` become
/// Rec. 709. Rows and columns may run in any of the eight ways that the resolution line can say.
///
/// Fails with [`ImageError::Malformed`] on damage, on values out of range and beyond the limits.
pub(crate) fn decode_hdr(path: &Path, bytes: &[u8], options: &LightOptions<'_>) -> Result<Light, ImageError> {
    let malformed = |reason: String| ImageError::malformed(path, reason);
    let header = Header::parse(bytes).map_err(malformed)?;
    let (width, height) = (header.width(), header.height());
    let claim = Claim { width, height, bytes_per_pixel: 12, expansion: MAX_EXPANSION, file_bytes: bytes.len() };
    claim.check(path, &options.limits)?;
    let (matrix, mut remarks) = conversion(&header).map_err(malformed)?;
    let mut image = pixels(&header, &bytes[header.length..]).map_err(malformed)?;
    if options.is_data {
        remarks.clear();
    } else if let Some(matrix) = &matrix {
        convert(&mut image, matrix);
    }
    remarks.extend(aspect_remark(header.aspect));
    let frame = Frame::whole(width, height);
    Ok(Light { image, channels: Channels::Rgb, frame, has_other_primaries: matrix.is_some(), remarks })
}

/// The pixels at their places, over the exposure.
fn pixels(header: &Header, mut bytes: &[u8]) -> Result<Image, String> {
    let steps: [f64; 256] = std::array::from_fn(|exponent| 2.0_f64.powi(exponent as i32 - 136));
    let value = |[r, g, b, exponent]: [u8; 4]| -> [f32; 3] {
        let of = |mantissa: u8, channel: usize| {
            let value = (f64::from(mantissa) + 0.5) * steps[usize::from(exponent)] / header.applied[channel];
            if exponent == 0 { 0.0 } else { value as f32 }
        };
        [of(r, 0), of(g, 1), of(b, 2)]
    };
    let mut image = Image::new(header.width(), header.height());
    let mut line = vec![[0; 4]; header.inner.length];
    for row in 0..header.outer.length {
        read_scanline(&mut bytes, &mut line).map_err(|reason| format!("scan line {}: {reason}", row + 1))?;
        for (column, pixel) in line.iter().enumerate() {
            let (x, y) = header.place(row, column);
            image.set(x, y, value(*pixel));
        }
    }
    Ok(image)
}

/// What makes linear Rec. 709 of the pixels, if anything has to, and what is to be said of it.
fn conversion(header: &Header) -> Result<(Option<Matrix>, Vec<String>), String> {
    let mut remarks = Vec::new();
    match (header.pixels, header.primaries) {
        (Pixels::Xyze, primaries) => {
            if primaries.is_some() {
                remarks.push("PRIMARIES means nothing for pixels in XYZ and is not used".to_owned());
            }
            remarks.push(format!(
                "its XYZ became RGB by Radiance's primaries and its white of {LUMENS_PER_WATT} lumens per watt"
            ));
            let to_xyz = RADIANCE.to_xyz().ok_or("Radiance's primaries span no colours")?;
            Ok((Some(inverse(to_xyz).map(|row| row.map(|value| value / LUMENS_PER_WATT))), remarks))
        }
        (Pixels::Rgbe, Some(primaries)) => {
            let matrix = primaries.to_rec_709();
            let matrix = matrix.ok_or_else(|| format!("its PRIMARIES ({primaries}) span no space of colours"))?;
            if primaries.is_near(&RADIANCE) || primaries.is_near(&Primaries::REC_709) {
                return Ok((None, remarks));
            }
            remarks.push(format!("its colours were converted from its PRIMARIES ({primaries}) to Rec. 709 (Bradford)"));
            Ok((Some(matrix), remarks))
        }
        (Pixels::Rgbe, None) => Ok((None, remarks)),
    }
}

fn aspect_remark(aspect: f64) -> Option<String> {
    let told = || format!("its pixels are {aspect} times as high as wide (PIXASPECT); they are taken as squares");
    ((aspect - 1.0).abs() > ASPECT_TOLERANCE).then(told)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PictureLimits;

    fn read(text: &str, pixels: &[u8], is_data: bool) -> Result<Light, ImageError> {
        let limits = PictureLimits { side: 1000, pixels: 4000, ..PictureLimits::default() };
        let options = LightOptions { is_data, limits, ..LightOptions::default() };
        decode_hdr(Path::new("a.hdr"), &[text.as_bytes(), pixels].concat(), &options)
    }

    fn decode(text: &str, pixels: &[u8]) -> Image {
        read(text, pixels, false).unwrap().image
    }

    fn near(found: [f32; 3], expected: [f64; 3]) {
        let is_near = |(a, b): (&f32, &f64)| (f64::from(*a) - b).abs() <= 1e-5 * b.abs().max(1e-3);
        assert!(found.iter().zip(&expected).all(is_near), "{found:?}, expected {expected:?}");
    }

    /// The step is 2^(129 - 136) = 1/128.
    const PIXEL: [u8; 4] = [128, 64, 0, 129];
    const LIGHT: [f32; 3] = [128.5 / 128.0, 64.5 / 128.0, 0.5 / 128.0];

    #[test]
    fn a_component_is_the_middle_of_its_step_and_exponent_0_is_black() {
        for signature in ["#?RADIANCE", "#?RGBE"] {
            let header = format!("{signature}\n# comment\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n");
            assert!(is_hdr(header.as_bytes()));
            let image = decode(&header, &[PIXEL, [255, 255, 255, 0], [1, 0, 0, 136]].concat());
            assert_eq!(image.pixels(), [LIGHT, [0.0; 3], [1.5, 0.5, 0.5]]);
        }
    }

    /// Whatever the light: a writer that cuts off and this reader have no bias, and no error above half a step.
    #[test]
    fn light_that_was_cut_off_comes_back_without_bias() {
        let mut state = 7_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let (mut error, mut light) = (0.0, 0.0);
        for _ in 0..4000 {
            let level = 0.01 * 1000.0_f64.powf(random());
            let rgb = [1.0, 0.3, 0.1].map(|part| part * level);
            let exponent = rgb[0].log2().floor() as i32 + 1;
            let step = 2.0_f64.powi(exponent - 8);
            let [r, g, b] = rgb.map(|value| (value / step) as u8);
            let found = decode("#?RGBE\n\n-Y 1 +X 1\n", &[r, g, b, (exponent + 128) as u8]).get(0, 0);
            for (found, value) in found.iter().zip(rgb) {
                assert!((f64::from(*found) - value).abs() <= 0.5001 * step, "{found}, {value}");
                (error, light) = (error + f64::from(*found) - value, light + value);
            }
        }
        assert!((error / light).abs() < 1e-4, "{}", error / light);
    }

    #[test]
    fn exposures_and_corrections_are_multiplied_and_taken_back() {
        let header = "#?RADIANCE\nEXPOSURE=4\nCOLORCORR= 2 1 0.5\nEXPOSURE= 5e-1\nCOLORCORR=1 4 1\n\n-Y 1 +X 1\n";
        near(decode(header, &PIXEL).get(0, 0), [128.5 / 512.0, 64.5 / 1024.0, 0.5 / 128.0]);
        // An indented line is of the history of another file.
        let header = "#?RADIANCE\n\tEXPOSURE=4\n COLORCORR=9 9 9\n\n-Y 1 +X 1\n";
        assert_eq!(decode(header, &PIXEL).get(0, 0), LIGHT);
    }

    #[test]
    fn xyz_becomes_watts_by_radiances_primaries() {
        // White: X, Y and Z alike.
        let header = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n";
        let light = read(header, &[178, 178, 178, 136], false).unwrap();
        near(light.image.get(0, 0), [178.5 / 179.0; 3]);
        assert!(light.has_other_primaries && light.remarks[0].contains("179 lumens"), "{:?}", light.remarks);
        // What `ra_xyze` makes of light: X, Y, Z of (1, 0.5, 0.25), with EXPOSURE 1 / 179 as it writes it.
        let xyz = crate::primaries::applied(RADIANCE.to_xyz().unwrap(), [1.0, 0.5, 0.25]);
        let [x, y, z] = xyz.map(|value| (value * 256.0) as u8);
        let header = "#?RADIANCE\nEXPOSURE=5.586592e-03\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n";
        let found = decode(header, &[x, y, z, 128]).get(0, 0);
        let step = 3.0 / 256.0; // half a step of each of X, Y, Z, through the matrix
        assert!(found.iter().zip([1.0, 0.5, 0.25]).all(|(a, b)| (a - b).abs() < step), "{found:?}");
        assert_eq!(read(header, &PIXEL, true).unwrap().remarks.len(), 0, "data stay as they are");
    }

    #[test]
    fn other_primaries_become_rec_709() {
        let file = |primaries: &str| format!("#?RADIANCE\nPRIMARIES= {primaries}\n\n-Y 1 +X 1\n");
        let own = "0.6400 0.3300 0.2900 0.6000 0.1500 0.0600 0.3333 0.3333";
        let light = read(&file(own), &PIXEL, false).unwrap();
        assert_eq!((light.image.get(0, 0), light.remarks.len()), (LIGHT, 0), "Radiance's own are taken as Rec. 709");
        let rec_2020 = "0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290";
        let light = read(&file(rec_2020), &[127, 127, 127, 129], false).unwrap();
        near(light.image.get(0, 0), [127.5 / 128.0; 3]);
        assert!(light.remarks[0].contains("red 0.7080 0.2920"), "{:?}", light.remarks);
        // Red of Rec. 2020 in Rec. 709, from the matrix of ITU-R BT.2087.
        let red = decode(&file(rec_2020), &[255, 0, 0, 144]).get(0, 0).map(|value| f64::from(value) / (255.5 * 256.0));
        assert!((red[0] - 1.6605).abs() < 5e-3 && (red[1] + 0.1246).abs() < 5e-3, "{red:?}");
        let complaint = read(&file("0 0 0 0 0 0 0 0"), &PIXEL, false).unwrap_err().to_string();
        assert!(complaint.contains("span no space of colours"), "{complaint}");
    }

    #[test]
    fn pixels_that_are_not_square_are_remarked() {
        let of = |aspect: &str| read(&format!("#?RGBE\nPIXASPECT={aspect}\n\n-Y 1 +X 1\n"), &PIXEL, false).unwrap();
        assert!(of("2").remarks[0].starts_with("its pixels are 2 times as high as wide"));
        assert_eq!(of("1.0000").remarks.len(), 0);
    }

    /// A picture of 2 x 3 whose pixels all differ, written in each of the eight ways.
    #[test]
    fn every_orientation_is_the_same_picture() {
        let at = |x: usize, y: usize| [100 + x as u8, 110 + y as u8, 0, 129];
        let expected =
            decode("#?RGBE\n\n-Y 3 +X 2\n", &[at(0, 0), at(1, 0), at(0, 1), at(1, 1), at(0, 2), at(1, 2)].concat());
        for (sign_y, sign_x, rows_first) in [(true, true), (true, false), (false, true), (false, false)]
            .into_iter()
            .flat_map(|(y, x)| [(y, x, true), (y, x, false)])
        {
            let rows: Vec<usize> = if sign_y { (0..3).rev().collect() } else { (0..3).collect() };
            let columns: Vec<usize> = if sign_x { (0..2).collect() } else { (0..2).rev().collect() };
            let sign = |plus| if plus { '+' } else { '-' };
            let (y, x) = (format!("{}Y 3", sign(sign_y)), format!("{}X 2", sign(sign_x)));
            let (line, pixels): (String, Vec<[u8; 4]>) = if rows_first {
                (format!("{y} {x}"), rows.iter().flat_map(|y| columns.iter().map(|x| at(*x, *y))).collect())
            } else {
                (format!("{x} {y}"), columns.iter().flat_map(|x| rows.iter().map(|y| at(*x, *y))).collect())
            };
            assert_eq!(decode(&format!("#?RGBE\n\n{line}\n"), &pixels.concat()), expected, "{line}");
        }
    }

    #[test]
    fn limits_hold_before_anything_is_read() {
        let complaint = |line: &str| read(&format!("#?RGBE\n\n{line}\n"), &PIXEL, false).unwrap_err().to_string();
        assert!(complaint("-Y 1001 +X 1").contains("at most 1000 x 1000"));
        assert!(complaint("+X 100 -Y 100").contains("more than the limit of 4000"));
        assert!(complaint("-Y 0 +X 2").contains("the picture is empty"));
        assert!(complaint("-Y 2 +X 1").contains("scan line 2: the file ends"));
    }

    /// Any bytes after a sound header are pixels or an error.
    #[test]
    fn no_bytes_end_the_program() {
        let mut state = 1_u32;
        for length in 0..4000 {
            let mut random = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            };
            let bytes: Vec<u8> = (0..length % 200).map(|_| [random(), random() % 4][length % 2]).collect();
            let _ = read("#?RGBE\n\n-Y 3 +X 20\n", &bytes, false);
        }
    }
}
