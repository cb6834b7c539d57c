//! The text at the front of a Radiance picture, and the line that says how its pixels run.

use crate::primaries::Primaries;

/// Longest text at the front: histories of commands are long, but not that long.
const MAX_BYTES: usize = 1 << 20;

/// What a pixel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pixels {
    Rgbe,
    Xyze,
}

/// One of the two axes of the resolution line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Axis {
    is_y: bool,
    /// From the bottom to the top, or from left to right.
    is_positive: bool,
    pub(super) length: usize,
}

/// All that is known before the first pixel.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) pixels: Pixels,
    /// Factors that were applied to each channel: exposures and corrections.
    pub(super) applied: [f64; 3],
    pub(super) primaries: Option<Primaries>,
    /// Height over width of a pixel.
    pub(super) aspect: f64,
    /// The axis along which scan lines follow each other.
    pub(super) outer: Axis,
    /// The axis along which the pixels of a scan line do.
    pub(super) inner: Axis,
    /// Bytes up to the first pixel.
    pub(super) length: usize,
}

impl Header {
    /// The header, or what is wrong with it.
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut lines = Lines { bytes: &bytes[..bytes.len().min(MAX_BYTES)], at: 0, number: 0 };
        let mut header = Self {
            pixels: Pixels::Rgbe,
            applied: [1.0; 3],
            primaries: None,
            aspect: 1.0,
            outer: Axis { is_y: true, is_positive: false, length: 0 },
            inner: Axis { is_y: false, is_positive: true, length: 0 },
            length: 0,
        };
        loop {
            let line = lines.next()?;
            if line.is_empty() {
                break;
            }
            header.take(&line).map_err(|reason| lines.fault(&line, &reason))?;
        }
        let line = lines.next()?;
        (header.outer, header.inner) =
            axes(&line).ok_or_else(|| lines.fault(&line, "expected the resolution, such as `-Y 480 +X 640`"))?;
        header.length = lines.at;
        header.checked()
    }

    /// One line of the text. What no variable begins is free text: commands that made the picture, a view, a comment; so is
    /// what is indented, which was copied from the header of another picture.
    fn take(&mut self, line: &str) -> Result<(), String> {
        let Some((name, value)) = line.split_once('=') else { return Ok(()) };
        match name {
            "FORMAT" => self.pixels = format(value.trim())?,
            "EXPOSURE" => {
                let [exposure] = positive(value)?;
                self.applied = self.applied.map(|factor| factor * exposure);
            }
            "COLORCORR" => {
                let correction: [f64; 3] = positive(value)?;
                self.applied = std::array::from_fn(|channel| self.applied[channel] * correction[channel]);
            }
            "PIXASPECT" => self.aspect *= positive::<1>(value)?[0],
            "PRIMARIES" => self.primaries = Some(Primaries::new(numbers(value)?)),
            _ => {}
        }
        Ok(())
    }

    fn checked(self) -> Result<Self, String> {
        let factors = self.applied.iter().chain([&self.aspect]);
        if factors.into_iter().all(|factor| factor.is_finite() && *factor > 0.0) {
            return Ok(self);
        }
        Err("the product of its EXPOSURE, COLORCORR or PIXASPECT lines is out of range".to_owned())
    }

    pub(super) fn width(&self) -> usize {
        if self.outer.is_y { self.inner.length } else { self.outer.length }
    }

    pub(super) fn height(&self) -> usize {
        if self.outer.is_y { self.outer.length } else { self.inner.length }
    }

    /// Column and row, from the top left, of pixel `inner` of scan line `outer`.
    pub(super) fn place(&self, outer: usize, inner: usize) -> (usize, usize) {
        let at = |axis: Axis, index: usize| {
            // Y counts upwards, rows count downwards.
            if axis.is_positive == axis.is_y { axis.length - 1 - index } else { index }
        };
        let (outer, inner) = (at(self.outer, outer), at(self.inner, inner));
        if self.outer.is_y { (inner, outer) } else { (outer, inner) }
    }
}

/// Lines of text with their numbers.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
}

impl Lines<'_> {
    fn next(&mut self) -> Result<String, String> {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|byte| *byte == b'\n').ok_or("the header ends too early")?;
        self.at += end + 1;
        self.number += 1;
        let line = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
        Ok(String::from_utf8_lossy(line).into_owned())
    }

    fn fault(&self, line: &str, reason: &str) -> String {
        let shown: String = line.chars().take(60).collect();
        format!("line {} of its header, `{}`: {reason}", self.number, shown.escape_debug())
    }
}

fn format(name: &str) -> Result<Pixels, String> {
    match name {
        "32-bit_rle_rgbe" => Ok(Pixels::Rgbe),
        "32-bit_rle_xyze" => Ok(Pixels::Xyze),
        _ => Err("expected the format 32-bit_rle_rgbe or 32-bit_rle_xyze".to_owned()),
    }
}

/// `N` numbers with white space between them.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let expected = || if N == 1 { "expected a number".to_owned() } else { format!("expected {N} numbers") };
    let parsed: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    parsed.ok().and_then(|numbers| <[f64; N]>::try_from(numbers).ok()).ok_or_else(expected)
}

/// `N` positive numbers.
fn positive<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let expected =
        || if N == 1 { "expected a positive number".to_owned() } else { format!("expected {N} positive numbers") };
    let numbers = numbers(text).map_err(|_| expected())?;
    let is_sound = numbers.iter().all(|number| number.is_finite() && *number > 0.0);
    is_sound.then_some(numbers).ok_or_else(expected)
}

/// Both axes of a resolution line, the outer one first.
fn axes(line: &str) -> Option<(Axis, Axis)> {
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let [first, first_length, second, second_length] = words[..] else { return None };
    let axis = |name: &str, length: &str| {
        let (is_positive, is_y) = match name {
            "+X" => (true, false),
            "-X" => (false, false),
            "+Y" => (true, true),
            "-Y" => (false, true),
            _ => return None,
        };
        let is_number = length.bytes().all(|byte| byte.is_ascii_digit());
        Some(Axis { is_y, is_positive, length: length.parse().ok().filter(|_| is_number)? })
    };
    let (outer, inner) = (axis(first, first_length)?, axis(second, second_length)?);
    (outer.is_y != inner.is_y).then_some((outer, inner))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaint(text: &str) -> String {
        Header::parse(text.as_bytes()).unwrap_err()
    }

    #[test]
    fn values_out_of_range_are_told_with_their_line() {
        for value in ["0", "-1", "nan", "inf", "", "x", "1 2"] {
            let found = complaint(&format!("#?RGBE\nEXPOSURE={value}\n\n-Y 1 +X 1\n"));
            assert_eq!(found, format!("line 2 of its header, `EXPOSURE={value}`: expected a positive number"));
        }
        for value in ["1 2", "1 2 3 4", "1 -2 3", "1 0 1", "1 nan 1", "", "1,1,1"] {
            let found = complaint(&format!("#?RGBE\n#\nCOLORCORR= {value}\n\n-Y 1 +X 1\n"));
            assert_eq!(found, format!("line 3 of its header, `COLORCORR= {value}`: expected 3 positive numbers"));
        }
        assert!(complaint("#?RGBE\nPRIMARIES=1 2\n\n-Y 1 +X 1\n").ends_with("expected 8 numbers"));
        assert!(complaint("#?RGBE\nPIXASPECT=0\n\n-Y 1 +X 1\n").ends_with("expected a positive number"));
        assert!(complaint("#?RGBE\nFORMAT=16-bit\n\n-Y 1 +X 1\n").ends_with("32-bit_rle_rgbe or 32-bit_rle_xyze"));
        let product = complaint("#?RGBE\nEXPOSURE=1e200\nEXPOSURE=1e200\n\n-Y 1 +X 1\n");
        assert!(product.contains("the product"), "{product}");
    }

    #[test]
    fn resolutions_that_are_none_are_told() {
        for line in
            ["", "-Y 1", "-Y 1 +Y 1", "1 2", "-Y 1 +X 1 x", "Y 1 X 1", "-Y -1 +X 1", "-Y +1 +X 1", "-Y 1.5 +X 1"]
        {
            let found = complaint(&format!("#?RGBE\n\n{line}\n"));
            assert_eq!(
                found,
                format!("line 3 of its header, `{line}`: expected the resolution, such as `-Y 480 +X 640`")
            );
        }
        for text in ["#?RADIANCE", "#?RADIANCE\n\n", "#?RADIANCE\n\n-Y 1 +X 1", "#?RADIANCE\n-Y 1 +X 1\n"] {
            assert_eq!(complaint(text), "the header ends too early", "{text:?}");
        }
    }

    #[test]
    fn line_ends_of_both_kinds_and_any_spaces_are_read() {
        let header =
            Header::parse(b"#?RADIANCE\r\nFORMAT= 32-bit_rle_xyze \r\n\r\n-Y       12 +X  7\r\npixels").unwrap();
        assert_eq!((header.pixels, header.width(), header.height()), (Pixels::Xyze, 7, 12));
        assert_eq!(header.length, 59);
    }
}
