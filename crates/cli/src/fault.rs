//! A fault at a place in a text: file, line and column in the message, the line with a mark under it.

use crate::exit::{Exit, Failure};
use miette::{LabeledSpan, MietteDiagnostic, NamedSource, Report};
use std::ops::Range;

/// Longest line, in bytes, that is shown; a longer one is no line for people.
const MAX_LINE: usize = 400;

/// A fault of `text`, the content of `name`, at `span` in bytes; `label` goes under the mark.
pub(crate) fn fault(exit: Exit, name: &str, text: &str, span: Range<usize>, message: &str, label: &str) -> Failure {
    let start = text.floor_char_boundary(span.start.min(text.len()));
    let end = text.floor_char_boundary(span.end.min(text.len())).max(start);
    let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let line_length = text[line_start..].find('\n').unwrap_or(text.len() - line_start);
    let line = text[..start].matches('\n').count() + 1;
    let column = text[line_start..start].chars().count() + 1;
    let diagnostic = MietteDiagnostic::new(format!("{name}:{line}:{column}: {message}"));
    if line_length > MAX_LINE {
        return Failure::new(exit, diagnostic.with_help(label));
    }
    let diagnostic = diagnostic.with_label(LabeledSpan::new_primary_with_span(Some(label.to_owned()), start..end));
    let report = Report::new(diagnostic).with_source_code(NamedSource::new(name, text.to_owned()));
    Failure { exit, report }
}

/// The rest of a line from a place that is given as line and column, both from 1.
pub(crate) fn span_at(text: &str, line: usize, column: usize) -> Range<usize> {
    let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1));
    let line_start = starts.take(line).last().unwrap_or(0);
    let rest = text[line_start..].lines().next().unwrap_or("");
    let offset = rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(i, _)| i);
    line_start + offset..line_start + rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_place_is_safe() {
        for text in ["", "ä", "ab\nüc\r\n"] {
            for a in 0..9 {
                for b in 0..9 {
                    let span = span_at(text, a, b);
                    assert!(text.get(span).is_some());
                    let failure = fault(Exit::Input, "f", text, a..b, "m", "l");
                    assert!(format!("{:?}", failure.report).contains("f:"));
                }
            }
        }
        assert_eq!(span_at("ab\nüc\r\n", 2, 2), 5..6);
    }
}
