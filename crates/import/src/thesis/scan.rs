//! From text to directives with their fields, whatever they mean.

use super::field::{Bracket, Directive, Field, Number, Value};
use super::text_field::{self, TextField};
use crate::number::{NUMBER_EXAMPLE, NumberError, number_length, parse_number};
use std::ops::Range;

/// Every word that a field can start with; others at a line's start begin an unknown directive.
const KNOWN_WORDS: [&str; 38] = [
    "BK",
    "STRAT",
    "LOW_DISC",
    "BEST_CANDID",
    "PERS",
    "ORTHO",
    "C",
    "V",
    "U",
    "OMNI",
    "DIRP",
    "DIR",
    "SQU_A",
    "POS",
    "ATTEN",
    "S",
    "D",
    "A",
    "N",
    "H",
    "W",
    "DS",
    "SPH",
    "SQU",
    "CUB",
    "FRKE",
    "TEX",
    "R",
    "L",
    "PATH",
    "SMTH",
    "TRAN",
    "SCAL",
    "ROT",
    "MAT",
    "SH",
    "STRETCH",
    "REPEAT",
];

/// A place in the text where it cannot be understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SyntaxError {
    pub(super) span: Range<usize>,
    pub(super) message: String,
    pub(super) expected: String,
}

/// What the scanner finds at the start of a line.
#[derive(Debug)]
pub(super) enum Item<'t> {
    Directive(Directive<'t>),
    /// A directive's place and letter are known, but not what it says.
    Broken(char, SyntaxError),
    /// Text that belongs to no directive, up to the end of its first line.
    Unknown(Range<usize>),
}

/// Reads directives one after the other.
#[derive(Debug)]
pub(super) struct Scanner<'t> {
    text: &'t str,
    position: usize,
    /// Comments met so far, for the caller to drain.
    pub(super) comments: Vec<Range<usize>>,
}

impl<'t> Scanner<'t> {
    /// Starts at byte `position`.
    pub(super) fn new(text: &'t str, position: usize) -> Self {
        Self { text, position, comments: Vec::new() }
    }

    /// The next item; `None` at the end of the text.
    pub(super) fn next_item(&mut self) -> Option<Item<'t>> {
        self.skip_blanks_and_comments();
        self.peek()?;
        if !self.at_directive() {
            let start = self.position;
            let end = self.line_end();
            self.skip_to_directive();
            return Some(Item::Unknown(start..end));
        }
        let letter = char::from(self.bytes()[self.position].to_ascii_uppercase());
        let start = self.position;
        self.position += 1;
        match self.fields() {
            Ok(fields) => Some(Item::Directive({
                let end = fields.last().map_or(start + 1, |field| field.span.end);
                Directive::new(letter, start..end, fields)
            })),
            Err(error) => {
                self.skip_to_directive();
                Some(Item::Broken(letter, error))
            }
        }
    }

    /// The character that is read next.
    pub(super) fn place(&self) -> Range<usize> {
        self.position..(self.position + 1).min(self.text.len())
    }

    fn bytes(&self) -> &'t [u8] {
        self.text.as_bytes()
    }

    fn peek(&self) -> Option<u8> {
        self.bytes().get(self.position).copied()
    }

    fn rest(&self) -> &'t str {
        &self.text[self.position..]
    }

    /// End of the current line, without its line break.
    fn line_end(&self) -> usize {
        let rest = self.rest();
        self.position + rest.find('\n').map_or(rest, |i| &rest[..i]).trim_end().len()
    }

    /// Moves to the next line.
    fn skip_line(&mut self) {
        let rest = self.rest();
        self.position += rest.find('\n').map_or(rest.len(), |i| i + 1);
    }

    fn skip_comment(&mut self) {
        self.comments.push(self.position..self.line_end());
        self.skip_line();
    }

    /// Moves to the next character that is no blank, over line breaks and comments. Tells whether a line was ended.
    fn skip_blanks_and_comments(&mut self) -> bool {
        let mut new_line = false;
        while let Some(byte) = self.peek() {
            match byte {
                b'#' => {
                    self.skip_comment();
                    new_line = true;
                }
                b'\n' => {
                    self.position += 1;
                    new_line = true;
                }
                _ if is_blank(byte) => self.position += 1,
                _ => break,
            }
        }
        new_line
    }

    fn skip_to_directive(&mut self) {
        loop {
            self.skip_line();
            self.skip_blanks_and_comments();
            if self.peek().is_none() || self.at_directive() {
                return;
            }
        }
    }

    /// Whether the character here, the first of its line, starts a directive: see the rule in the module above.
    fn at_directive(&self) -> bool {
        let Some(letter) = self.peek() else { return false };
        matches!(letter.to_ascii_uppercase(), b'S' | b'C' | b'L' | b'P' | b'O') && self.is_lone_letter()
    }

    fn is_lone_letter(&self) -> bool {
        let after = &self.bytes()[self.position + 1..];
        let blanks = after.iter().take_while(|&&byte| is_blank(byte)).count();
        match after.get(blanks) {
            None | Some(b'|' | b':') => true,
            Some(b'\n') => !matches!(after.trim_ascii_start().first(), Some(b'{' | b'(')),
            Some(byte) => blanks > 0 && byte.is_ascii_alphabetic(),
        }
    }

    /// Whether the line that starts here belongs to no directive known.
    fn at_unknown_directive(&self) -> bool {
        let Some(byte) = self.peek() else { return false };
        if !byte.is_ascii_alphabetic() {
            // Brackets, separators and digits are mistakes inside a directive and better reported there.
            return !matches!(byte, b'{' | b'}' | b'(' | b')' | b',' | b';' | b'.' | b'-' | b'+')
                && !byte.is_ascii_digit();
        }
        let name = self.name_here();
        if name.len() == 1 && self.is_lone_letter() {
            return true;
        }
        let after = self.rest()[name.len()..].trim_start_matches([' ', '\t']);
        let has_value = after.starts_with(['{', '(', ':']) || number_length(after) > 0;
        !has_value && !KNOWN_WORDS.iter().chain(&["STRAIGHT"]).any(|known| known.eq_ignore_ascii_case(name))
    }

    fn name_here(&self) -> &'t str {
        let length = self.rest().bytes().take_while(|byte| byte.is_ascii_alphabetic() || *byte == b'_').count();
        &self.rest()[..length]
    }

    fn fields(&mut self) -> Result<Vec<Field<'t>>, SyntaxError> {
        let mut fields = Vec::new();
        loop {
            let mut line_start = self.skip_blanks_and_comments();
            while matches!(self.peek(), Some(b'|' | b':')) {
                self.position += 1;
                line_start = self.skip_blanks_and_comments();
            }
            if self.peek().is_none() || line_start && (self.at_directive() || self.at_unknown_directive()) {
                return Ok(fields);
            }
            fields.push(self.field()?);
        }
    }

    fn field(&mut self) -> Result<Field<'t>, SyntaxError> {
        let start = self.position;
        let name = self.name_here();
        if name.is_empty() {
            return Err(self.unexpected("a field such as S{0.2, 0.2, 0.2} or SH(20)"));
        }
        self.position += name.len();
        let value = if let Some(kind) = TextField::of(name) { self.text_value(kind)? } else { self.value(name)? };
        Ok(Field::new(name, start..self.position, value))
    }

    fn text_value(&mut self, kind: TextField) -> Result<Value<'t>, SyntaxError> {
        self.skip_line_blanks();
        if self.peek() != Some(b':') {
            return Err(self.unexpected(kind.example()));
        }
        self.position += 1;
        self.skip_line_blanks();
        let found = text_field::split(kind, self.rest());
        if found.text.is_empty() {
            return Err(syntax_error(self.position..self.position + 1, "a file name is missing", kind.example()));
        }
        self.position += found.length;
        Ok(Value::Text { text: found.text, mode: found.mode })
    }

    /// The value after a field's name, if any.
    fn value(&mut self, name: &str) -> Result<Value<'t>, SyntaxError> {
        let after_name = self.position;
        self.skip_whitespace();
        match self.peek() {
            Some(b'{') => {
                let numbers = self.bracketed(name, b'}')?;
                let angle = if name.eq_ignore_ascii_case("ROT") { self.angle()? } else { None };
                Ok(Value::Numbers { bracket: Bracket::Curly, numbers, angle })
            }
            Some(b'(') => {
                Ok(Value::Numbers { bracket: Bracket::Round, numbers: self.bracketed(name, b')')?, angle: None })
            }
            _ => {
                self.position = after_name;
                let number = self.bare_number()?;
                self.position = if number.is_some() { self.position } else { after_name };
                Ok(number.map_or(Value::Word, |number| Value::Numbers {
                    bracket: Bracket::Round,
                    numbers: vec![number],
                    angle: None,
                }))
            }
        }
    }

    /// The angle after `ROT{}`: `:45` or `(45)`.
    fn angle(&mut self) -> Result<Option<Number>, SyntaxError> {
        let before = self.position;
        self.skip_whitespace();
        if self.peek() == Some(b'(') {
            let numbers = self.bracketed("ROT", b')')?;
            return Ok(numbers.into_iter().next());
        }
        self.position = before;
        let number = self.bare_number()?;
        self.position = if number.is_some() { self.position } else { before };
        Ok(number)
    }

    /// A number without brackets, after an optional `:`.
    fn bare_number(&mut self) -> Result<Option<Number>, SyntaxError> {
        self.skip_line_blanks();
        if self.peek() == Some(b':') {
            self.position += 1;
            self.skip_line_blanks();
        }
        let length = number_length(self.rest());
        if length == 0 {
            return Ok(None);
        }
        let start = self.position;
        self.position += length;
        let token = &self.text[start..self.position];
        let value = parse_number(token).map_err(|error| self.number_error(start..self.position, error))?;
        Ok(Some(Number { value, span: start..self.position }))
    }

    /// The numbers up to the bracket `close`, from the opening one.
    fn bracketed(&mut self, name: &str, close: u8) -> Result<Vec<Number>, SyntaxError> {
        let open = self.position;
        self.position += 1;
        let mut numbers = Vec::new();
        loop {
            self.skip_blanks_and_comments();
            numbers.push(self.number()?);
            self.skip_blanks_and_comments();
            match self.peek() {
                Some(b',') => self.position += 1,
                Some(byte) if byte == close => {
                    self.position += 1;
                    return Ok(numbers);
                }
                Some(_) => return Err(self.unexpected(&format!("`,` or the `{}` that ends {name}", char::from(close)))),
                None => {
                    let message = format!("the text ends inside {name}");
                    return Err(syntax_error(open..self.text.len(), &message, &format!("`{}`", char::from(close))));
                }
            }
        }
    }

    fn number(&mut self) -> Result<Number, SyntaxError> {
        let start = self.position;
        let ends = |c: char| c.is_whitespace() || ",;|:/{}()[]#".contains(c);
        let token = self.rest().split(ends).next().unwrap_or_default();
        if token.is_empty() {
            return Err(self.unexpected(NUMBER_EXAMPLE));
        }
        self.position += token.len();
        let value = parse_number(token).map_err(|error| self.number_error(start..self.position, error))?;
        Ok(Number { value, span: start..self.position })
    }

    fn skip_line_blanks(&mut self) {
        self.position += self.rest().bytes().take_while(|&byte| is_blank(byte)).count();
    }

    fn skip_whitespace(&mut self) {
        self.position += self.rest().bytes().take_while(|&byte| is_blank(byte) || byte == b'\n').count();
    }

    fn unexpected(&self, expected: &str) -> SyntaxError {
        let start = self.position;
        match self.rest().chars().next() {
            Some(c) => syntax_error(start..start + c.len_utf8(), &format!("unexpected `{c}`"), expected),
            None => syntax_error(start..start, "the text ends too early", expected),
        }
    }

    fn number_error(&self, span: Range<usize>, error: NumberError) -> SyntaxError {
        let message = error.message(&self.text[span.clone()]);
        syntax_error(span, &message, NUMBER_EXAMPLE)
    }
}

/// Blanks within a line; a carriage return counts, so that both kinds of line ends work. 0x1a ends old DOS files.
fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c | 0x1a)
}

fn syntax_error(span: Range<usize>, message: &str, expected: &str) -> SyntaxError {
    SyntaxError { span, message: message.to_owned(), expected: expected.to_owned() }
}
