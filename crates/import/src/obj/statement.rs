//! The statements of an MTL file, and their numbers.

use crate::lines::{continuation, length_without_comment};
use crate::number::{NUMBER_EXAMPLE, NumberError, parse_number};
use crate::report::Report;
use crate::source::Source;
use glam::{Mat3, Vec3};
use std::ops::Range;

/// From CIE XYZ to linear RGB with the primaries and the white of Rec. 709 (IEC 61966-2-1), column by column.
const RGB_OF_XYZ: Mat3 = Mat3::from_cols(
    Vec3::new(3.240_454_2, -0.969_266, 0.055_643_4),
    Vec3::new(-1.537_138_5, 1.876_010_8, -0.204_025_9),
    Vec3::new(-0.498_531_4, 0.041_556, 1.057_225_2),
);

/// The lines of a text as spans of it; one that ends in a backslash goes on in the next.
pub(super) fn statements(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut start = 0;
    std::iter::from_fn(move || {
        let mut end = start;
        while let Some(length) = text[end..].split_inclusive('\n').next().map(str::len) {
            let line = &text[end..end + length];
            end += length;
            if continuation(line).is_none() {
                break;
            }
        }
        let span = start..end;
        start = end;
        (!span.is_empty()).then_some(span)
    })
}

/// The words of a value that holds numbers: no comment, no backslash of a line that goes on.
fn number_words(value: &str) -> impl Iterator<Item = &str> {
    let words = value[..length_without_comment(value)].split_ascii_whitespace();
    words.map(|word| word.trim_end_matches('\\')).filter(|word| !word.is_empty())
}

/// Statements whose numbers are red, green and blue.
const COLORS: [&str; 6] = ["Ka", "Kd", "Ks", "Ke", "Kt", "Tf"];

/// Up to three numbers; one alone stands for all three, as the format has it. `value` is a part of the text, `span` that of the
/// statement. Numbers too large for 32 bits become the largest there is, with a warning.
pub(super) fn numbers(source: &Source<'_>, report: &mut Report, value: &str, span: Range<usize>) -> Option<Vec3> {
    let mut words = number_words(value).peekable();
    match words.peek().copied() {
        Some("spectral") => {
            let message = "`spectral` colours are not supported: the value is ignored";
            report.warn(|| source.fault(span, message));
            return None;
        }
        Some("xyz") => {
            let _ = words.next();
            let xyz = color(source, report, words, span)?;
            return Some((RGB_OF_XYZ * xyz).max(Vec3::ZERO));
        }
        Some("-halo") => {
            let _ = words.next();
            report.warn(|| source.fault(span.clone(), "`-halo` is not supported: the value holds from every side"));
        }
        _ => {}
    }
    color(source, report, words, span)
}

fn color<'v>(
    source: &Source<'_>,
    report: &mut Report,
    words: impl Iterator<Item = &'v str>,
    span: Range<usize>,
) -> Option<Vec3> {
    let mut numbers = [0.0; 3];
    let mut count = 0;
    for word in words.take(3) {
        let start = word.as_ptr() as usize - source.text().as_ptr() as usize;
        let place = |message: &str| source.fault(start..start + word.len(), message);
        numbers[count] = match parse_number(word) {
            Ok(number) => number,
            Err(error @ NumberError::TooLarge) => {
                let used = if word.starts_with('-') { f32::MIN } else { f32::MAX };
                report.warn(|| place(&format!("{}: {used:e} is used", error.message(word))));
                used
            }
            Err(error) => {
                report.error(|| place(&error.message(word)).expected(NUMBER_EXAMPLE));
                return None;
            }
        };
        count += 1;
    }
    let [first, second, third] = numbers;
    match count {
        0 => {
            report.error(|| source.fault(span, "the value is missing").expected(NUMBER_EXAMPLE));
            None
        }
        1 => Some(Vec3::splat(first)),
        2 => {
            let keyword = source.text()[span.clone()].split_ascii_whitespace().next().unwrap_or_default();
            if COLORS.contains(&keyword) {
                let message = format!("`{keyword}` has 2 numbers instead of 1 or 3: {first} is used for blue as well");
                report.warn(|| source.fault(span, &message));
            }
            Some(Vec3::new(first, second, first))
        }
        _ => Some(Vec3::new(first, second, third)),
    }
}
