//! Tables of a TOML text, with the places of their keys.

use super::reader::Reader;
use super::value::{NUMBER, TEXT, Value, WHOLE};
use super::words::{did_you_mean, listed};
use crate::source::Source;
use crate::{Fault, ImportError, Limits};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What the key `format` says in every scene.
const FORMAT: &str = "lightcuts-scene";

/// The only version so far.
const VERSION: i64 = 1;

/// Tables by which a scene is known that lacks its head.
const TABLES: [&str; 6] = ["camera", "environment", "material", "mesh", "object", "light"];

/// What the TOML reader says of numbers with a mistake.
const INVALID_FLOAT: &str = "invalid float";

/// What a person reads who opens another file.
const HEADER_EXAMPLE: &str = "a scene that starts with `format = \"lightcuts-scene\"` and `version = 1`";

/// One table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Table<'d> {
    entries: &'d DeTable<'d>,
    /// Bytes of its header, or of all of it where it stands in a line.
    start: usize,
    end: usize,
}

/// The document of a text. Fails for a text that is not TOML, too long, or not a scene.
pub(super) fn parse<'d>(source: &'d Source<'d>, limits: &Limits) -> Result<Spanned<DeTable<'d>>, ImportError> {
    let text = source.text();
    if text.len() as u64 > limits.document_bytes {
        let message = format!("the text has {} bytes", text.len());
        return Err(source.fault(0..0, &message).expected(&format!("at most {}", limits.document_bytes)).into());
    }
    let document = DeTable::parse(text).map_err(|error| toml_fault(source, &error))?;
    check_header(source, &document)?;
    Ok(document)
}

fn toml_fault(source: &Source<'_>, error: &toml::de::Error) -> Fault {
    let (message, expected) = error.message().split_once(", expected ").unwrap_or((error.message(), ""));
    let span = error.span().unwrap_or_default();
    if message == INVALID_FLOAT {
        // What the reader expects is part of one, or a word such as `nan`, which scenes refuse.
        let span = word_around(source.text(), span.start);
        let message = format!("`{}` is not a number", &source.text()[span.clone()]);
        return source.fault(span, &message).expected(NUMBER.expected);
    }
    source.fault(span, message).expected(if expected == "nothing" { "" } else { expected })
}

/// The value around `offset`, if it is a number or ought to be one.
fn word_around(text: &str, offset: usize) -> Range<usize> {
    let offset = text.floor_char_boundary(offset.min(text.len()));
    let is_part = |c: char| !c.is_whitespace() && !"=,[]{}#".contains(c);
    let start = text[..offset].trim_end_matches(is_part).len();
    let end = text.len() - text[offset..].trim_start_matches(is_part).len();
    start..end
}

/// Jobs and other files are TOML too.
fn check_header(source: &Source<'_>, document: &Spanned<DeTable<'_>>) -> Result<(), ImportError> {
    let table = Table::of(document);
    if table.get("format").is_none() {
        if let Some((key, span)) = table.misspelt_format() {
            let message = format!("unknown key `{key}` of a scene: did you mean `format`?");
            return Err(source.fault(span, &message).expected(HEADER_EXAMPLE).into());
        }
        let part = TABLES.iter().find_map(|key| Some((*key, table.get(key)?)));
        let message = match part {
            Some((key, value)) => {
                let shown = if value.items().is_some() { format!("[[{key}]]") } else { format!("[{key}]") };
                format!("there is a `{shown}`, as in a scene, but the key `format` is missing")
            }
            None => {
                "this is not a scene: the key `format` is missing (a job file names its scene with the key `scene`)"
                    .to_owned()
            }
        };
        return Err(source.fault(0..0, &message).expected(HEADER_EXAMPLE).into());
    }
    let mut reader = Reader::new(source);
    if let Some(format) = reader.required(table, "format", TEXT)
        && format != FORMAT
    {
        reader.error_at(table, "format", &format!("`format` is `{format}`"), HEADER_EXAMPLE);
    }
    if let Some(version) = reader.required(table, "version", WHOLE)
        && version != VERSION
    {
        reader.error_at(table, "version", &format!("version {version} of the format is not supported"), "1");
    }
    Ok(reader.report.finish().map(|_| ())?)
}

impl<'d> Table<'d> {
    /// A whole document.
    pub(super) fn of(document: &'d Spanned<DeTable<'d>>) -> Self {
        // Its own span would be its first header.
        Self { entries: document.get_ref(), start: 0, end: 0 }
    }

    /// A value that is a table.
    pub(super) fn of_value(value: &'d DeValue<'d>, span: Range<usize>) -> Option<Self> {
        Some(Self { entries: value.as_table()?, start: span.start, end: span.end })
    }

    pub(super) fn span(self) -> Range<usize> {
        self.start..self.end
    }

    pub(super) fn get(self, key: &str) -> Option<Value<'d>> {
        let (key, value) = self.entries.get_key_value(key)?;
        Some(Value::new(key.get_ref(), value))
    }

    pub(super) fn has(self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// A key like `format`, or any key with what `format` says.
    fn misspelt_format(self) -> Option<(&'d str, Range<usize>)> {
        let is_like = |key: &str, value: &DeValue<'_>| {
            value.as_str() == Some(FORMAT) || (value.is_str() && did_you_mean(key, &["format"]).contains("`format`"))
        };
        let mut near = self.entries.iter().filter(|(key, value)| is_like(key.get_ref().as_ref(), value.get_ref()));
        near.next().map(|(key, _)| (key.get_ref().as_ref(), key.span()))
    }

    /// Reports keys that are not among `known`; `what` is the table: `a sphere`. `None` if there are some: what else there is to
    /// say of the table may follow from them.
    pub(super) fn check_keys(self, reader: &mut Reader<'_>, what: &str, known: &[&[&'static str]]) -> Option<()> {
        let known = known.concat();
        let mut unknown: Vec<_> = self.entries.keys().filter(|key| !known.contains(&key.get_ref().as_ref())).collect();
        unknown.sort_by_key(|key| key.span().start);
        for key in &unknown {
            if reader.report.is_full() {
                break;
            }
            let word = key.get_ref().as_ref();
            let message = format!("unknown key `{word}` of {what}{}", did_you_mean(word, &known));
            reader.error(key.span(), &message, &format!("one of {}", listed(&known)));
        }
        unknown.is_empty().then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        let source = Source::new("a.toml", text);
        parse(&source, &Limits::default()).expect_err(text).to_string()
    }

    #[test]
    fn other_files_are_told_what_a_scene_is() {
        let other = message("scene = \"a.txt\"\n");
        assert!(other.starts_with("a.toml:1:1: this is not a scene: the key `format` is missing"), "{other}");
        assert!(other.contains("expected a scene that starts with `format = \"lightcuts-scene\"`"), "{other}");
        let headless = message("[[object]]\ntype = \"mesh\"\n");
        assert!(
            headless.starts_with("a.toml:1:1: there is a `[[object]]`, as in a scene, but the key `format`"),
            "{headless}"
        );
        assert!(message("[camera]\n").contains("there is a `[camera]`"));
        for (text, key) in [("version = 1\nformt = 'lightcuts-scene'", "formt"), ("\nFormat = 'x'\n[camera]", "Format")]
        {
            let expected =
                format!("a.toml:2:1: unknown key `{key}` of a scene: did you mean `format`?; expected a scene");
            assert!(message(text).starts_with(&expected), "{}", message(text));
        }
        assert!(message("format = \"x\"\nversion = 1").starts_with("a.toml:1:10: `format` is `x`; expected a scene"));
        assert!(message("format = 3").starts_with("a.toml:1:10: `format` is a number; expected a string"));
        assert!(message("format = \"lightcuts-scene\"").starts_with("a.toml:1:1: `version` is missing; expected"));
        let newer = message("format = \"lightcuts-scene\"\nversion = 2");
        assert_eq!(newer, "a.toml:2:11: version 2 of the format is not supported; expected 1");
    }

    #[test]
    fn broken_toml_is_placed() {
        assert_eq!(message("a = 1\nb = [1,\n"), "a.toml:2:8: unclosed array; expected `]`");
        assert_eq!(message("a = 1\na = 2"), "a.toml:2:1: duplicate key");
        for (text, column, number) in
            [("a = np.5", 5, "np.5"), ("a = 0.5.3", 5, "0.5.3"), ("a = [1, nx]", 9, "nx"), ("a = { b = i }", 11, "i")]
        {
            let expected = format!("a.toml:1:{column}: `{number}` is not a number; expected a number such as 1.5");
            assert_eq!(message(text), expected, "{text}");
        }
        assert_eq!(message("a = 01"), "a.toml:1:5: unexpected leading zero");
        let deep = format!("a = {}", "[".repeat(100_000));
        assert!(message(&deep).starts_with("a.toml:1:"), "{}", message(&deep));
        let source = Source::new("a.toml", "a = 1");
        let error = parse(&source, &Limits { document_bytes: 4, ..Limits::default() }).expect_err("it is long");
        assert_eq!(error.to_string(), "a.toml:1:1: the text has 5 bytes; expected at most 4");
    }
}
