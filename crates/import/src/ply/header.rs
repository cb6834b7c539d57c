//! What a file says about itself.

use crate::Fault;
use crate::lines::ReadError;
use crate::report::Report;
use crate::resolver::FileError;
use std::io::{BufRead, Read};
use std::path::Path;

/// Longest line of a header, in bytes.
const MAX_LINE: usize = 4096;

/// Most lines of a header; comments count.
const MAX_LINES: u32 = 10_000;

/// How values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The types of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// What an element has: one number, or several with their number in front.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    /// Type of the number in front, of lists.
    pub(super) count: Option<Number>,
    pub(super) number: Number,
}

/// Things of one kind: vertices, faces.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The line that announces it, for messages.
    line: u32,
    text: String,
}

/// The head of a file.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Its own size.
    pub(super) lines: u32,
    pub(super) bytes: u64,
    last_line: String,
}

impl Number {
    const NAMES: [(&str, &str, Self); 8] = [
        ("char", "int8", Self::I8),
        ("uchar", "uint8", Self::U8),
        ("short", "int16", Self::I16),
        ("ushort", "uint16", Self::U16),
        ("int", "int32", Self::I32),
        ("uint", "uint32", Self::U32),
        ("float", "float32", Self::F32),
        ("double", "float64", Self::F64),
    ];

    fn of_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(old, new, _)| *old == name || *new == name).map(|(_, _, number)| *number)
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

impl Element {
    /// A fault at the line that announces it.
    pub(super) fn fault(&self, file: &str, message: &str) -> Fault {
        Fault::new(file, self.line, &self.text, 0..self.text.len(), message)
    }
}

impl Header {
    /// Reads up to and with the line `end_header`.
    pub(super) fn read(
        reader: &mut impl BufRead,
        path: &Path,
        file: &str,
        report: &mut Report,
    ) -> Result<Self, ReadError> {
        let mut parser =
            Parser { file, path, number: 0, bytes: 0, line: String::new(), encoding: None, elements: vec![] };
        if !parser.advance(reader)? || parser.line != "ply" {
            return Err(parser.error("the first line is not `ply`", "a PLY model"));
        }
        while parser.advance(reader)? {
            if parser.number > MAX_LINES {
                return Err(parser.error(&format!("the header has more than {MAX_LINES} lines"), "`end_header`"));
            }
            if parser.line == "end_header" {
                return parser.finish();
            }
            parser.parse_line(report)?;
        }
        Err(parser.error("the header has no end", "`end_header`"))
    }

    pub(super) fn element(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|element| element.name == name)
    }

    /// A fault at its last line.
    pub(super) fn fault(&self, file: &str, message: &str) -> Fault {
        Fault::new(file, self.lines, &self.last_line, 0..self.last_line.len(), message)
    }
}

struct Parser<'a> {
    file: &'a str,
    path: &'a Path,
    number: u32,
    bytes: u64,
    /// The current line, without its end.
    line: String,
    encoding: Option<Encoding>,
    elements: Vec<Element>,
}

impl Parser<'_> {
    fn error(&self, message: &str, expected: &str) -> ReadError {
        ReadError::Content(Box::new(self.fault(message).expected(expected)))
    }

    fn fault(&self, message: &str) -> Fault {
        Fault::new(self.file, self.number, &self.line, 0..self.line.len(), message)
    }

    /// Moves to the next line; false at the end of the file.
    fn advance(&mut self, reader: &mut impl BufRead) -> Result<bool, ReadError> {
        let mut raw = Vec::new();
        let io_error = |error| ReadError::File(FileError::Io { path: self.path.to_path_buf(), error });
        let count = reader.take(MAX_LINE as u64 + 1).read_until(b'\n', &mut raw).map_err(io_error)?;
        self.number += 1;
        self.bytes += count as u64;
        // Comments may be in any encoding.
        String::from_utf8_lossy(&raw).trim_ascii().clone_into(&mut self.line);
        if count > MAX_LINE {
            return Err(self.error(&format!("the line is longer than {MAX_LINE} bytes"), "a PLY header"));
        }
        Ok(count > 0)
    }

    fn parse_line(&mut self, report: &mut Report) -> Result<(), ReadError> {
        let line = self.line.clone();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            [] | ["comment" | "obj_info", ..] => Ok(()),
            ["format", ..] => self.format(&words),
            ["element", ..] => self.element(&words),
            ["property", ..] => self.property(&words),
            [word, ..] => {
                // Some writers forget the word `comment`.
                let message = format!("`{word}` is not a keyword of a PLY header: the line is ignored");
                report.warn(|| self.fault(&message));
                Ok(())
            }
        }
    }

    fn format(&mut self, words: &[&str]) -> Result<(), ReadError> {
        self.encoding = match words {
            [_, "ascii", "1.0"] => Some(Encoding::Text),
            [_, "binary_little_endian", "1.0"] => Some(Encoding::LittleEndian),
            [_, "binary_big_endian", "1.0"] => Some(Encoding::BigEndian),
            _ => None,
        };
        let expected = "`format ascii 1.0`, `format binary_little_endian 1.0` or `format binary_big_endian 1.0`";
        self.encoding.map_or_else(|| Err(self.error("the format is unknown", expected)), |_| Ok(()))
    }

    fn element(&mut self, words: &[&str]) -> Result<(), ReadError> {
        let example = "a line such as `element vertex 8`";
        let [_, name, count] = words else {
            return Err(self.error("the number of elements is missing", example));
        };
        let Ok(count) = count.parse() else {
            return Err(self.error(&format!("`{count}` is not a number of elements"), example));
        };
        if self.elements.iter().any(|element| element.name == *name) {
            return Err(self.error(&format!("the element `{name}` is given twice"), "another name"));
        }
        let (name, text) = ((*name).to_owned(), self.line.clone());
        self.elements.push(Element { name, count, properties: Vec::new(), line: self.number, text });
        Ok(())
    }

    fn property(&mut self, words: &[&str]) -> Result<(), ReadError> {
        let (count, number, name) = match words[1..] {
            ["list", count, number, name] => (Some(self.number_type(count)?), self.number_type(number)?, name),
            [number, name] if number != "list" => (None, self.number_type(number)?, name),
            _ => return Err(self.error("the property has no name", "a line such as `property float x`")),
        };
        if count.is_some_and(|count| !count.is_whole()) {
            let message = format!("a list cannot have `{}` items in number", words[2]);
            return Err(self.error(&message, "a whole type such as uchar"));
        }
        let property = Property { name: name.to_owned(), count, number };
        match self.elements.last_mut() {
            Some(element) => element.properties.push(property),
            None => return Err(self.error("a property before the first element", "a line such as `element vertex 8`")),
        }
        Ok(())
    }

    fn number_type(&self, name: &str) -> Result<Number, ReadError> {
        Number::of_name(name).ok_or_else(|| {
            let names: Vec<&str> = Number::NAMES.iter().map(|(old, _, _)| *old).collect();
            self.error(&format!("`{name}` is not a type"), &format!("one of {}", names.join(", ")))
        })
    }

    fn finish(self) -> Result<Header, ReadError> {
        let Some(encoding) = self.encoding else {
            return Err(self.error("the format is missing", "`format ascii 1.0` or another"));
        };
        let Self { number, bytes, line, elements, .. } = self;
        Ok(Header { encoding, elements, lines: number, bytes, last_line: line })
    }
}
