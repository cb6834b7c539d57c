//! Texts in which offsets become lines and columns, and bytes that become texts.

use crate::Fault;
use lightcuts_scene::Location;
use std::borrow::Cow;
use std::ops::Range;

/// A named text.
#[derive(Debug)]
pub(crate) struct Source<'t> {
    name: String,
    text: Cow<'t, str>,
    line_starts: Vec<usize>,
}

impl<'t> Source<'t> {
    pub(crate) fn new(name: &str, text: impl Into<Cow<'t, str>>) -> Self {
        let text = text.into();
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(i, _)| i + 1);
        let line_starts = std::iter::once(0).chain(breaks).collect();
        Self { name: name.to_owned(), text, line_starts }
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Line and column of a byte offset.
    pub(crate) fn locate(&self, offset: usize) -> Location {
        let (number, line) = self.line(offset);
        let start = self.line_starts[number];
        let column = line[..line.floor_char_boundary(offset - start)].chars().count() + 1;
        Location { line: number as u32 + 1, column: column as u32 }
    }

    /// A fault at `span`, in bytes of the text.
    pub(crate) fn fault(&self, span: Range<usize>, message: &str) -> Fault {
        let (number, line) = self.line(span.start);
        let start = self.line_starts[number];
        Fault::new(&self.name, number as u32 + 1, line, span.start - start..span.end.max(span.start) - start, message)
    }

    /// Number from 0 and text of the line that holds `offset`.
    fn line(&self, offset: usize) -> (usize, &str) {
        let number = self.line_starts.partition_point(|&start| start <= offset) - 1;
        let end = self.line_starts.get(number + 1).copied().unwrap_or(self.text.len());
        (number, self.text[self.line_starts[number]..end].trim_end_matches(['\n', '\r']))
    }
}

/// The text of `bytes`: UTF-8 with or without byte order mark, else Latin-1. Lines that all end in `\r`, as those of old files do,
/// end in `\n` then. Bytes that are no text are one fault.
pub(crate) fn decode<'b>(name: &str, bytes: &'b [u8]) -> Result<Cow<'b, str>, Fault> {
    if let Some(offset) = first_binary_byte(bytes) {
        return Err(binary_fault(name, bytes, offset));
    }
    let text = match decode_line(bytes) {
        Cow::Borrowed(text) => Cow::Borrowed(text.trim_start_matches('\u{feff}')),
        Cow::Owned(text) => Cow::Owned(text),
    };
    let ends_in_returns = text.contains('\r') && !text.contains('\n');
    Ok(if ends_in_returns { Cow::Owned(text.replace('\r', "\n")) } else { text })
}

/// UTF-8, else Latin-1 (old files have it in comments and names).
pub(crate) fn decode_line(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()),
    }
}

/// Offset of the first byte that no text has: a control character other than blanks, line ends and the DOS end mark.
pub(crate) fn first_binary_byte(bytes: &[u8]) -> Option<usize> {
    bytes.iter().position(|&byte| matches!(byte, 0..=8 | 14..=25 | 27..=31 | 127))
}

fn binary_fault(name: &str, bytes: &[u8], offset: usize) -> Fault {
    let line_start = bytes[..offset].iter().rposition(|&byte| byte == b'\n').map_or(0, |i| i + 1);
    let line = bytes[..offset].split(|&byte| byte == b'\n').count() as u32;
    let before = String::from_utf8_lossy(&bytes[line_start..offset]).into_owned();
    let shown = format!("{before}\u{fffd}");
    let message = format!("byte {offset} of the file is {:#04x}, so this is not text", bytes[offset]);
    let fault = Fault::new(name, line, &shown, before.len()..shown.len(), &message);
    // What stands before it may be no text either, and is nothing for a terminal.
    let fault = if before.is_ascii() { fault } else { fault.without_excerpt() };
    fault.expected("a text in UTF-8 or Latin-1")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_characters_from_one() {
        let source = Source::new("a", "ab\r\nüc\n");
        let at = |offset| (source.locate(offset).line, source.locate(offset).column);
        assert_eq!([at(0), at(1), at(4), at(6), at(8)], [(1, 1), (1, 2), (2, 1), (2, 2), (3, 1)]);
    }

    #[test]
    fn text_is_told_from_binary() {
        assert_eq!(decode("a", b"\xef\xbb\xbfS\xc3\xbc").as_deref(), Ok("Sü"));
        assert_eq!(decode("a", b"# \xfc").as_deref(), Ok("# ü"));
        assert_eq!(decode("a", b"\xef\xbb\xbfa\rb\r\rc").as_deref(), Ok("a\nb\n\nc"));
        assert_eq!(decode("a", b"a\r\nb\rc").as_deref(), Ok("a\r\nb\rc"));
        let hidden = decode("a", b"ab\xe2\xf3\0").unwrap_err();
        assert_eq!(hidden.location().column, 5);
        assert!(!format!("{hidden:?}").contains("ab"), "{hidden:?}");
        let fault = decode("a", b"S |\nBK\0").unwrap_err();
        assert_eq!(
            fault.to_string(),
            "a:2:3: byte 6 of the file is 0x00, so this is not text; expected a text in UTF-8 or Latin-1"
        );
    }
}
