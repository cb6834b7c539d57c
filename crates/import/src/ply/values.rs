//! The numbers of a file's body, one after the other, whatever their encoding.

use super::header::{Element, Encoding, Header, Number};
use crate::Fault;
use crate::lines::{Lines, ReadError, words};
use crate::number::{NUMBER_EXAMPLE, parse_exact};
use crate::resolver::FileError;
use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;

/// One of the things of an element, for messages.
#[derive(Clone, Copy)]
pub(super) struct Row<'h> {
    pub(super) element: &'h Element,
    /// From 0.
    pub(super) index: u64,
}

/// The body of a file.
pub(super) struct Values<'a> {
    body: Body<'a>,
    path: &'a Path,
    file: &'a str,
    limit: u64,
}

enum Body<'a> {
    Text {
        lines: Lines<'a>,
        /// The part of the line that is yet to be read, and the word that was read last.
        rest: Range<usize>,
        word: Range<usize>,
    },
    Bytes {
        reader: Box<dyn Read + 'a>,
        is_big_endian: bool,
        /// Where in the file the last number starts, and the next one.
        start: u64,
        end: u64,
    },
}

impl Row<'_> {
    /// `vertex 3 of 8`.
    fn name(self) -> String {
        format!("{} {} of {}", self.element.name, self.index + 1, self.element.count)
    }
}

impl<'a> Values<'a> {
    /// Of a file whose header was read from `reader`.
    pub(super) fn new(header: &Header, reader: Box<dyn Read + 'a>, path: &'a Path, file: &'a str, limit: u64) -> Self {
        let (lines, bytes) = (header.lines, header.bytes);
        let body = match header.encoding {
            Encoding::Text => Body::Text {
                lines: Lines::new(reader, path, file, limit, "a PLY model").after(lines, bytes),
                rest: 0..0,
                word: 0..0,
            },
            encoding => {
                Body::Bytes { reader, is_big_endian: encoding == Encoding::BigEndian, start: bytes, end: bytes }
            }
        };
        Self { body, path, file, limit }
    }

    /// Name of the file.
    pub(super) fn file(&self) -> &str {
        self.file
    }

    /// A fault at the number that was read last.
    pub(super) fn fault(&self, row: Row<'_>, message: &str) -> Fault {
        match &self.body {
            Body::Text { lines, word, .. } => lines.fault(word.clone(), &format!("{}: {message}", row.name())),
            // Bytes have no line; the one that announces them does.
            Body::Bytes { start, .. } => {
                row.element.fault(self.file, &format!("{}, at byte {start}: {message}", row.name()))
            }
        }
    }

    /// An error at the number that was read last.
    pub(super) fn error(&self, row: Row<'_>, message: &str, expected: &str) -> ReadError {
        ReadError::Content(Box::new(self.fault(row, message).expected(expected)))
    }

    /// The next number, whatever it is.
    pub(super) fn skip(&mut self, number: Number, row: Row<'_>) -> Result<(), ReadError> {
        match self.body {
            Body::Text { .. } => self.next_word(row),
            Body::Bytes { .. } => self.next_bytes(number, row).map(|_| ()),
        }
    }

    /// The next number, a whole one.
    pub(super) fn whole(&mut self, number: Number, row: Row<'_>) -> Result<i64, ReadError> {
        let value = match self.body {
            Body::Bytes { .. } => self.next_bytes(number, row)?,
            Body::Text { .. } => {
                self.next_word(row)?;
                let word = self.word();
                return word.parse().map_err(|_| {
                    self.error(row, &format!("`{word}` is not a whole number"), "a whole number such as 3")
                });
            }
        };
        if value.fract() != 0.0 || value.abs() > f64::from(u32::MAX) {
            return Err(self.error(row, &format!("{value} is not a whole number"), "a whole number such as 3"));
        }
        Ok(value as i64)
    }

    /// The next number, which a 32-bit one must be able to hold; `name` is what it is.
    pub(super) fn finite(&mut self, number: Number, name: &str, row: Row<'_>) -> Result<f64, ReadError> {
        if let Body::Text { .. } = self.body {
            self.next_word(row)?;
            let word = self.word();
            return parse_exact(word).map_err(|error| self.error(row, &error.message(word), NUMBER_EXAMPLE));
        }
        let value = self.next_bytes(number, row)?;
        if !(value as f32).is_finite() {
            return Err(self.error(row, &format!("{name} is {}", value as f32), "a finite 32-bit number"));
        }
        Ok(value)
    }

    fn word(&self) -> &str {
        match &self.body {
            Body::Text { lines, word, .. } => &lines.text()[word.clone()],
            Body::Bytes { .. } => "",
        }
    }

    /// Moves to the next word; line breaks do not matter.
    fn next_word(&mut self, row: Row<'_>) -> Result<(), ReadError> {
        let Body::Text { lines, rest, word } = &mut self.body else { return Ok(()) };
        loop {
            if let Some(next) = words(lines.text(), rest.clone()).next() {
                rest.start = next.end;
                *word = next;
                return Ok(());
            }
            if !lines.advance()? {
                let fault = lines.fault(0..0, &format!("the file ends in {}", row.name()));
                return Err(ReadError::Content(Box::new(fault)));
            }
            *rest = 0..lines.text().len();
        }
    }

    /// The next number of a binary body.
    fn next_bytes(&mut self, number: Number, row: Row<'_>) -> Result<f64, ReadError> {
        Ok(match number {
            Number::I8 => i8::from_ne_bytes(self.bytes(row)?).into(),
            Number::U8 => u8::from_ne_bytes(self.bytes(row)?).into(),
            Number::I16 => i16::from_ne_bytes(self.bytes(row)?).into(),
            Number::U16 => u16::from_ne_bytes(self.bytes(row)?).into(),
            Number::I32 => i32::from_ne_bytes(self.bytes(row)?).into(),
            Number::U32 => u32::from_ne_bytes(self.bytes(row)?).into(),
            Number::F32 => f32::from_ne_bytes(self.bytes(row)?).into(),
            Number::F64 => f64::from_ne_bytes(self.bytes(row)?),
        })
    }

    /// The next bytes, in this machine's order.
    fn bytes<const N: usize>(&mut self, row: Row<'_>) -> Result<[u8; N], ReadError> {
        let mut bytes = [0; N];
        let Body::Bytes { reader, is_big_endian, start, end } = &mut self.body else { return Ok(bytes) };
        *start = *end;
        *end += N as u64;
        let too_long = *end > self.limit;
        match reader.read_exact(&mut bytes) {
            Ok(()) if too_long => {
                let (path, length) = (self.path.to_path_buf(), *end);
                return Err(ReadError::File(FileError::TooLong { path, length, limit: self.limit }));
            }
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                let message = format!("the file ends in {}, at byte {}", row.name(), *start);
                return Err(ReadError::Content(Box::new(row.element.fault(self.file, &message))));
            }
            Err(error) => return Err(ReadError::File(FileError::Io { path: self.path.to_path_buf(), error })),
        }
        if *is_big_endian != cfg!(target_endian = "big") {
            bytes.reverse();
        }
        Ok(bytes)
    }
}
