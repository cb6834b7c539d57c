//! Reads the values of tables, and reports what they cannot be.

use super::document::Table;
use super::value::{Kind, NUMBER, Read, TEXT, Value};
use super::words::{did_you_mean, either, listed};
use crate::report::Report;
use crate::source::Source;
use lightcuts_scene::Location;
use std::f32::consts::PI;
use std::ops::Range;

/// Makes something of values, and reports those of which it cannot: `None` means that an error was reported.
pub(super) struct Reader<'d> {
    pub(super) source: &'d Source<'d>,
    pub(super) report: Report,
    /// The offset that was located last, and what came of it.
    located: (usize, Location),
}

impl<'d> Reader<'d> {
    pub(super) fn new(source: &'d Source<'d>) -> Self {
        Self { source, report: Report::default(), located: (0, source.locate(0)) }
    }

    /// Where a table starts. Columns are counted on from the table before: a scene may be one long line.
    pub(super) fn locate(&mut self, table: Table<'_>) -> Location {
        let start = table.span().start;
        let (last, Location { line, column }) = self.located;
        let location = match self.source.text().get(last..start) {
            Some(between) if !between.contains('\n') => {
                Location { line, column: column + between.chars().count() as u32 }
            }
            _ => self.source.locate(start),
        };
        self.located = (start, location);
        location
    }

    pub(super) fn error(&mut self, span: Range<usize>, message: &str, expected: &str) {
        self.report.error(|| self.source.fault(span, message).expected(expected));
    }

    /// An error at the value of `key`, or at the table if it has none.
    pub(super) fn error_at(&mut self, table: Table<'_>, key: &str, message: &str, expected: &str) {
        self.error(table.get(key).map_or(table.span(), Value::span), message, expected);
    }

    pub(super) fn warn(&mut self, span: Range<usize>, message: &str) {
        self.report.warn(|| self.source.fault(span, message));
    }

    /// Warns about an angle above 0 that would be more likely in radians than in degrees.
    pub(super) fn warn_of_radians(&mut self, table: Table<'_>, key: &str) {
        let Some(value) = table.get(key) else { return };
        if let Read::Good(angle) = (NUMBER.read)(value)
            && angle > 0.0
            && angle <= PI
        {
            let degrees = angle.to_degrees();
            let message = format!("`{key}` is {angle} degrees; {angle} radians would be {degrees:.4} degrees");
            self.warn(value.span(), &message);
        }
    }

    /// Reads a value as of this kind.
    pub(super) fn read<T>(&mut self, value: Value<'_>, kind: Kind<T>) -> Option<T> {
        let (span, message) = match (kind.read)(value) {
            Read::Good(good) => return Some(good),
            Read::Other => (value.span(), format!("is {}", value.kind())),
            Read::Bad(span, message) => (span, message),
        };
        self.error(span, &format!("`{}` {message}", value.key), kind.expected);
        None
    }

    /// The value of a key that must be there.
    pub(super) fn required<T>(&mut self, table: Table<'_>, key: &str, kind: Kind<T>) -> Option<T> {
        let value = self.optional(table, key, kind)?;
        if value.is_none() {
            self.error(table.span(), &format!("`{key}` is missing"), kind.expected);
        }
        value
    }

    /// The value of a key that may be absent; the inner `None` means that.
    #[allow(clippy::option_option, reason = "the outer one is an error, as everywhere here")]
    pub(super) fn optional<T>(&mut self, table: Table<'_>, key: &str, kind: Kind<T>) -> Option<Option<T>> {
        table.get(key).map_or(Some(None), |value| self.read(value, kind).map(Some))
    }

    /// The value of a key, or `default` where it is absent.
    pub(super) fn or<T>(&mut self, table: Table<'_>, key: &str, kind: Kind<T>, default: T) -> Option<T> {
        Some(self.optional(table, key, kind)?.unwrap_or(default))
    }

    /// What a word stands for, of a closed set of words.
    pub(super) fn choice<T: Copy>(&mut self, table: Table<'_>, key: &str, known: &[(&str, T)]) -> Option<T> {
        let words: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
        let expected = format!("one of {}", listed(&words));
        let Some(value) = table.get(key) else {
            self.error(table.span(), &format!("`{key}` is missing"), &expected);
            return None;
        };
        let word = self.read(value, TEXT)?;
        let found = known.iter().find(|(known, _)| *known == word);
        if found.is_none() {
            let message = format!("unknown {key} `{word}`{}", did_you_mean(&word, &words));
            self.error(value.span(), &message, &expected);
        }
        found.map(|(_, meaning)| *meaning)
    }

    /// The one of `keys` that the table has; an error unless it is one alone.
    pub(super) fn exactly_one(&mut self, table: Table<'_>, keys: &[&'static str]) -> Option<&'static str> {
        let one = self.at_most_one(table, keys)?;
        if one.is_none() {
            self.error(table.span(), &format!("{} is missing", either(keys)), "one of them");
        }
        one
    }

    /// The one of `keys` that the table has, if it has one; an error if it has more.
    #[allow(clippy::option_option, reason = "the outer one is an error, as everywhere here")]
    pub(super) fn at_most_one(&mut self, table: Table<'_>, keys: &[&'static str]) -> Option<Option<&'static str>> {
        let mut found = keys.iter().copied().filter(|key| table.has(key));
        let first = found.next();
        if let Some(second) = found.next() {
            let message = format!("`{second}` beside `{}`", first.unwrap_or_default());
            self.error_at(table, second, &message, "one of them alone");
            return None;
        }
        Some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::super::value::{COLOR, FLAG, MATRIX, VECTOR, WHOLE};
    use super::*;
    use glam::Vec3;
    use toml::de::DeTable;

    /// What the key `a` of a text is read as.
    fn read<T>(text: &str, kind: Kind<T>) -> Result<T, String> {
        let source = Source::new("a.toml", text);
        let document = DeTable::parse(text).expect("it is TOML");
        let mut reader = Reader::new(&source);
        let value = reader.required(Table::of(&document), "a", kind);
        reader.report.finish().map_err(|faults| faults.to_string())?;
        Ok(value.expect("without an error there is a value"))
    }

    #[test]
    fn every_spelling_of_a_value_is_read() {
        for (text, value) in
            [("1", 1.0), ("-0.5", -0.5), ("1e3", 1000.0), ("0x10", 16.0), ("1_000", 1000.0), ("+2", 2.0)]
        {
            assert_eq!(read(&format!("a = {text}"), NUMBER), Ok(value), "{text}");
        }
        assert_eq!(read("a = [1, 2.5,\n -3]", VECTOR), Ok(Vec3::new(1.0, 2.5, -3.0)));
        assert_eq!(read("a = 0.5", COLOR), Ok(Vec3::splat(0.5)));
        assert_eq!(read("a = [1, 0, 0.5]", COLOR), Ok(Vec3::new(1.0, 0.0, 0.5)));
        assert_eq!(read("a = 'x'", TEXT).as_deref(), Ok("x"));
        assert_eq!(read("a = true", FLAG), Ok(true));
        let rows = read("a = [[1, 0, 0, 4], [0, 1, 0, 5], [0, 0, 1, 6], [0, 0, 0, 1]]", MATRIX).expect("it is one");
        assert_eq!(rows[1], [0.0, 1.0, 0.0, 5.0]);
    }

    #[test]
    fn other_values_are_refused_where_they_stand() {
        let refused = |text: &str, message: &str| {
            let error = read(text, VECTOR).expect_err(text);
            assert!(error.starts_with(&format!("a.toml:1:{message}; expected three numbers")), "{error}");
        };
        refused("a = 'x'", "5: `a` is a string");
        refused("a = {}", "5: `a` is a table");
        refused("a = true", "5: `a` is true or false");
        refused("a = 1979-05-27", "5: `a` is a date");
        refused("a = [1, 2]", "5: `a` has 2 items instead of 3");
        refused("a = [1, 'x', 2]", "9: `a` holds a string");
        refused("a = [1, 2, nan]", "12: `a` is not a number");
        refused("a = [1, -inf, 2]", "9: `a` is too large for a 32-bit number");
        refused("a = [1, 1e39, 2]", "9: `a` is too large for a 32-bit number");
        refused("b = 1", "1: `a` is missing");
        assert!(read("a = 99999999999999999999", WHOLE).is_err());
        assert!(
            read("a = [[1], [2], [3], [4]]", MATRIX).expect_err("short").contains("1:6: `a` has 1 items instead of 4")
        );
    }
}
