//! One thing wrong at one place: the unit of every error and warning about the content of a file.

use lightcuts_scene::Location;
use miette::{LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::fmt;
use std::ops::Range;

/// Characters of a line that are shown on either side of the place in question.
const EXCERPT_REACH: usize = 70;

/// Characters of a message at most; a longer one quotes something that nobody will read.
const MAX_MESSAGE: usize = 1000;

/// Something wrong in a file: where, what, and what was expected instead.
///
/// Its `Display` form is `file:line:column: message; expected ...`, in one line. As a diagnostic it carries the line in
/// question, cut around the place where the line is long.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    file: String,
    location: Location,
    message: String,
    expected: Option<String>,
    excerpt: Excerpt,
}

/// The part of a line that is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Excerpt {
    text: String,
    /// Bytes of `text` to mark.
    mark: Range<usize>,
}

impl Fault {
    /// `span` is in bytes of `line_text`, the text of line number `line`.
    pub(crate) fn new(file: &str, line: u32, line_text: &str, span: Range<usize>, message: &str) -> Self {
        let start = floor_boundary(line_text, span.start);
        let column = line_text[..start].chars().count() as u32 + 1;
        Self {
            file: cut(file),
            location: Location { line, column },
            message: cut(message),
            expected: None,
            excerpt: Excerpt::new(line_text, start..span.end),
        }
    }

    /// Adds what was expected, to follow the word "expected".
    #[must_use]
    pub(crate) fn expected(mut self, expected: &str) -> Self {
        self.expected = (!expected.is_empty()).then(|| cut(expected));
        self
    }

    /// The same without the text at its place, where that is none to be shown.
    #[must_use]
    pub(crate) fn without_excerpt(mut self) -> Self {
        self.excerpt = Excerpt { text: "(binary)".to_owned(), mark: 0.."(binary)".len() };
        self
    }

    /// The same place with another message.
    #[must_use]
    pub(crate) fn with_message(mut self, message: &str) -> Self {
        self.message = cut(message);
        self
    }

    /// Name of the file, as it was given.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Line and column, from 1.
    pub fn location(&self) -> Location {
        self.location
    }

    /// What is wrong, and what was expected if there is something to say.
    pub fn message(&self) -> String {
        match &self.expected {
            Some(expected) => format!("{}; expected {expected}", self.message),
            None => self.message.clone(),
        }
    }

    /// The marked place. Without a text: the message says what was expected.
    pub(crate) fn label(&self) -> LabeledSpan {
        LabeledSpan::new_primary_with_span(None, self.excerpt.mark.clone())
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Location { line, column } = self.location;
        write!(f, "{}:{line}:{column}: {}", self.file, self.message())
    }
}

impl std::error::Error for Fault {}

impl miette::Diagnostic for Fault {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(self)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(self.label())))
    }
}

/// The source is the excerpt alone, under its true line number: the file itself may be large and is not kept.
impl SourceCode for Fault {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let text = self.excerpt.text.as_bytes();
        let end = span.offset().checked_add(span.len()).filter(|&end| end <= text.len());
        let end = end.ok_or(MietteError::OutOfBounds)?;
        // Asked without context, miette wants to know where the span starts: the file's column, not the excerpt's.
        let (range, column) = if lines_before + lines_after == 0 {
            (span.offset()..end, self.location.column.saturating_sub(1) as usize)
        } else {
            (0..text.len(), 0)
        };
        let at = SourceSpan::from(range.clone());
        let line = self.location.line.saturating_sub(1) as usize;
        let contents = MietteSpanContents::new_named(self.file.clone(), &text[range], at, line, column, 1);
        Ok(Box::new(contents))
    }
}

impl Excerpt {
    fn new(line: &str, span: Range<usize>) -> Self {
        let from = back(line, span.start, EXCERPT_REACH);
        let to = forward(line, span.start, EXCERPT_REACH);
        let end = floor_boundary(line, span.end).clamp(span.start, to);
        let head = if from > 0 { "…" } else { "" };
        let tail = if to < line.len() { "…" } else { "" };
        // Control characters would move the caret or the terminal's cursor.
        let visible = |part: &str| part.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>();
        let before = format!("{head}{}", visible(&line[from..span.start]));
        let marked = visible(&line[span.start..end]);
        let start = before.len();
        let text = format!("{before}{marked}{}{tail}", visible(&line[end..to]));
        Self { mark: start..start + marked.len(), text }
    }
}

/// The last character boundary of `text` at or before `offset`.
fn floor_boundary(text: &str, offset: usize) -> usize {
    text.floor_char_boundary(offset.min(text.len()))
}

/// The offset `count` characters before `offset`.
fn back(text: &str, offset: usize, count: usize) -> usize {
    text[..offset].char_indices().rev().take(count).last().map_or(offset, |(i, _)| i)
}

/// The offset `count` characters after `offset`.
fn forward(text: &str, offset: usize, count: usize) -> usize {
    text[offset..].char_indices().nth(count).map_or(text.len(), |(i, _)| offset + i)
}

/// `text`, cut to [`MAX_MESSAGE`] characters in one line.
fn cut(text: &str) -> String {
    let mut short: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(MAX_MESSAGE).collect();
    if text.chars().nth(MAX_MESSAGE).is_some() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_display_form_is_one_line_with_the_place() {
        let fault = Fault::new("a.txt", 3, "ü {x}", 4..5, "`x` is not a number").expected("0.5");
        assert_eq!(fault.to_string(), "a.txt:3:4: `x` is not a number; expected 0.5");
    }

    #[test]
    fn long_lines_are_cut_around_the_place() {
        let line = format!("{}HERE{}", "a".repeat(100_000), "ä".repeat(100_000));
        let fault = Fault::new("a.txt", 1, &line, 100_000..100_004, "odd");
        assert!(fault.excerpt.text.chars().count() < 160);
        assert_eq!(&fault.excerpt.text[fault.excerpt.mark.clone()], "HERE");
        assert_eq!(fault.location().column, 100_001);
    }

    #[test]
    fn any_span_is_safe() {
        for line in ["", "ä", "äöü\tx"] {
            for start in 0..9 {
                for end in 0..9 {
                    let fault = Fault::new("", 1, line, start..end, "");
                    let read = fault.read_span(&fault.excerpt.mark.clone().into(), 1, 1).map(|c| c.line());
                    assert!(matches!(read, Ok(0)));
                }
            }
        }
    }
}
