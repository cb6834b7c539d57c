//! Lines of a file that is too large to hold: read one by one, joined where they end in a backslash.

use crate::Fault;
use crate::resolver::FileError;
use crate::source::{decode_line, first_binary_byte};
use std::io::{self, BufRead, BufReader, Read};
use std::ops::Range;
use std::path::Path;

/// Longest logical line, in bytes: a polygon of a million corners still fits.
const MAX_LINE: usize = 16 << 20;

/// What starts a comment, in OBJ and MTL files.
const COMMENT: char = '#';

/// Reads logical lines.
pub(crate) struct Lines<'a> {
    reader: BufReader<Box<dyn Read + 'a>>,
    path: &'a Path,
    name: &'a str,
    /// What the file should be, for messages: `an OBJ model`.
    what: &'static str,
    limit: u64,
    length: u64,
    number: u32,
    raw: Vec<u8>,
    text: String,
    /// Where in `text` each line of the file starts, and its number.
    parts: Vec<(usize, u32)>,
}

/// Why reading ends early.
pub(crate) enum ReadError {
    File(FileError),
    Content(Box<Fault>),
}

impl<'a> Lines<'a> {
    pub(crate) fn new(
        reader: Box<dyn Read + 'a>,
        path: &'a Path,
        name: &'a str,
        limit: u64,
        what: &'static str,
    ) -> Self {
        let reader = BufReader::with_capacity(1 << 16, reader);
        Self {
            reader,
            path,
            name,
            what,
            limit,
            length: 0,
            number: 0,
            raw: Vec::new(),
            text: String::new(),
            parts: Vec::new(),
        }
    }

    /// The same, where `lines` lines and `bytes` bytes of the file were read before.
    pub(crate) fn after(mut self, lines: u32, bytes: u64) -> Self {
        self.number = lines;
        self.length = bytes;
        self
    }

    /// Moves to the next line; false at the end of the file.
    pub(crate) fn advance(&mut self) -> Result<bool, ReadError> {
        self.text.clear();
        self.parts.clear();
        loop {
            if !self.read_raw()? {
                return Ok(!self.parts.is_empty());
            }
            let start = self.text.len();
            self.parts.push((start, self.number));
            self.text.push_str(&decode_line(&self.raw));
            if let Some(byte) = first_binary_byte(&self.raw) {
                let start = self.text.len() - decode_line(&self.raw[byte..]).len();
                let message = format!("byte {:#04x} shows that this is not text", self.raw[byte]);
                return Err(self.content_error(start..start + 1, &message));
            }
            if self.text.len() > MAX_LINE {
                let message = format!("the line is longer than {MAX_LINE} bytes");
                return Err(self.content_error(0..1, &message));
            }
            let Some(backslash) = continuation(&self.text[start..]) else { return Ok(true) };
            // A blank in place of the backslash keeps the columns right and the words apart.
            self.text.replace_range(start + backslash..=start + backslash, " ");
        }
    }

    /// The current line, without line break and comment sign interpretation.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// A fault at `span` of [`Self::text`].
    pub(crate) fn fault(&self, span: Range<usize>, message: &str) -> Fault {
        let part = self.parts.partition_point(|(start, _)| *start <= span.start).saturating_sub(1);
        let (start, number) = self.parts.get(part).copied().unwrap_or((0, self.number));
        let end = self.parts.get(part + 1).map_or(self.text.len(), |(end, _)| *end);
        let within = span.start.clamp(start, end) - start..span.end.clamp(start, end) - start;
        Fault::new(self.name, number, &self.text[start..end], within, message)
    }

    fn content_error(&self, span: Range<usize>, message: &str) -> ReadError {
        ReadError::Content(Box::new(self.fault(span, message).expected(&format!("{} in text form", self.what))))
    }

    /// Reads one line of the file into `raw`, without its end; false at the end of the file.
    fn read_raw(&mut self) -> Result<bool, ReadError> {
        self.raw.clear();
        let path = || self.path.to_path_buf();
        let count = read_line(&mut self.reader, &mut self.raw)
            .map_err(|error| ReadError::File(FileError::Io { path: path(), error }))?;
        self.length += count;
        if self.length > self.limit {
            return Err(ReadError::File(FileError::TooLong { path: path(), length: self.length, limit: self.limit }));
        }
        self.number += 1;
        if self.number == 1 && self.raw.starts_with(BYTE_ORDER_MARK) {
            self.raw.drain(..BYTE_ORDER_MARK.len());
        }
        Ok(count > 0)
    }
}

/// What some editors begin a text in UTF-8 with.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads a line without its end, which is `\n`, `\r\n` or `\r`; how many bytes were read, 0 at the end of the file. A line beyond
/// [`MAX_LINE`] is cut off somewhere after that.
fn read_line(reader: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<u64> {
    let mut count = 0;
    while line.len() <= MAX_LINE {
        let buffer = filled(reader)?;
        let end = buffer.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let part = &buffer[..end.unwrap_or(buffer.len())];
        line.extend_from_slice(part);
        let end = end.map(|end| buffer[end]);
        let used = part.len() + usize::from(end.is_some());
        reader.consume(used);
        count += used as u64;
        if end == Some(b'\r') && filled(reader)?.first() == Some(&b'\n') {
            reader.consume(1);
            count += 1;
        }
        if end.is_some() || used == 0 {
            break;
        }
    }
    Ok(count)
}

/// What comes next, empty at the end of the file; a signal does not end it.
fn filled(reader: &mut impl BufRead) -> io::Result<&[u8]> {
    while reader.fill_buf().is_err_and(|error| error.kind() == io::ErrorKind::Interrupted) {}
    reader.fill_buf()
}

/// Where the backslash is of a line that goes on in the next; blanks may follow it.
pub(crate) fn continuation(line: &str) -> Option<usize> {
    let before = line.trim_ascii_end().strip_suffix('\\')?;
    (!ends_in_comment(line)).then_some(before.len())
}

/// Whether a comment, in which a backslash means nothing, ends the line. A `#` within a word belongs to a name.
fn ends_in_comment(line: &str) -> bool {
    without_comment(line).len() < line.len()
}

/// A line up to a comment that starts it or stands behind a blank: where names are expected, which may hold a `#`.
pub(crate) fn without_comment(line: &str) -> &str {
    let starts = line.match_indices(COMMENT).map(|(i, _)| i);
    let mut comments = starts.filter(|&i| i == 0 || line[..i].ends_with(|c: char| c.is_ascii_whitespace()));
    comments.next().map_or(line, |i| &line[..i])
}

/// The length of a line up to its first `#`: where numbers are expected.
pub(crate) fn length_without_comment(line: &str) -> usize {
    line.find(COMMENT).unwrap_or(line.len())
}

/// The words of a part of `text`, as spans of `text`.
pub(crate) fn words(text: &str, range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let base = text.as_ptr() as usize;
    text[range].split_ascii_whitespace().map(move |word| {
        let start = word.as_ptr() as usize - base;
        start..start + word.len()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// The logical lines of a file, and the place of each one's last character.
    fn read(text: &str, capacity: usize) -> Vec<(String, u32, u32)> {
        let reader: Box<dyn Read> = Box::new(Cursor::new(text.as_bytes().to_vec()));
        let mut lines = Lines::new(reader, Path::new("a"), "a", 1 << 20, "a test");
        lines.reader = BufReader::with_capacity(capacity, Box::new(Cursor::new(text.as_bytes().to_vec())));
        let mut all = Vec::new();
        while matches!(lines.advance(), Ok(true)) {
            let end = lines.text().trim_end().len();
            let place = lines.fault(end.saturating_sub(1)..end, "").location();
            all.push((lines.text().trim_end().to_owned(), place.line, place.column));
        }
        all
    }

    /// Whatever ends the lines, and wherever the file is cut up while it is read.
    #[test]
    fn every_line_end_is_one() {
        let text = "v 1\n\n# c\nf 1 \\\n2 3\nend";
        let line = |text: &str, line, column| (text.to_owned(), line, column);
        let expected =
            [line("v 1", 1, 3), line("", 2, 1), line("# c", 3, 3), line("f 1  2 3", 5, 3), line("end", 6, 3)];
        for end in ["\n", "\r\n", "\r"] {
            for capacity in 1..9 {
                assert_eq!(read(&text.replace('\n', end), capacity), expected, "{end:?} {capacity}");
                assert_eq!(read(&format!("{text}\n").replace('\n', end), capacity), expected, "{end:?} {capacity}");
            }
        }
    }

    #[test]
    fn blanks_may_follow_the_backslash_of_a_line_that_goes_on() {
        for blanks in ["", " ", "\t  "] {
            let found = read(&format!("f 1 \\{blanks}\n2 3\n"), 64);
            assert_eq!((found.len(), found[0].1, found[0].2), (1, 2, 3), "{blanks:?}");
            assert_eq!(found[0].0.split_ascii_whitespace().collect::<Vec<_>>(), ["f", "1", "2", "3"]);
        }
        assert_eq!(read("# a\\ \nf 1\n", 64).len(), 2, "a comment does not go on");
        assert_eq!(read("o a\\b \nf 1\n", 64).len(), 2, "nor does a backslash inside");
    }
}
