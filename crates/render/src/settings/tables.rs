//! Settings in TOML texts: tables laid over each other, places in the text, faults in plain words.

use std::ops::Range;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

/// Lays `upper` over `lower`: tables key by key, any other value as a whole.
pub fn overlay(lower: &mut Table, upper: &Table) {
    for (key, value) in upper {
        match (lower.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => overlay(below, above),
            _ => {
                lower.insert(key.clone(), value.clone());
            }
        }
    }
}

/// The value at `path` in a text, such as `image.width` or `scene.0.file`, with its span in bytes; a list's items are
/// counted from 0. `None` where there is none, or no TOML.
pub fn value_at<'t>(text: &'t str, path: &str) -> Option<Spanned<DeValue<'t>>> {
    let document = DeTable::parse(text).ok()?;
    let span = document.span();
    let mut value = Spanned::new(span, DeValue::Table(document.into_inner()));
    for step in path.split('.') {
        value = match value.into_inner() {
            DeValue::Table(mut table) => table.remove(step)?,
            DeValue::Array(items) => items.into_iter().nth(step.parse().ok()?)?,
            _ => return None,
        };
    }
    Some(value)
}

/// Something wrong in a TOML text, in words for people who do not know Rust.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TomlFault {
    /// Where, in bytes.
    pub span: Range<usize>,
    /// What is wrong and what was expected.
    pub message: String,
    /// A few words to stand beside the place: what was probably meant, else what was expected.
    pub label: String,
}

impl TomlFault {
    /// Of an error of the TOML reader.
    pub fn new(error: &toml::de::Error) -> Self {
        Self::with_more_keys(error, &[])
    }

    /// The same, where `more_keys` may stand beside the tables of [`Settings`](super::Settings), as in a job file.
    pub fn with_more_keys(error: &toml::de::Error, more_keys: &[&str]) -> Self {
        let message = error.message();
        let span = error.span().unwrap_or_default();
        // The reader has a message of its own for the keys of struct variants.
        let keys =
            message.strip_prefix("unexpected keys in table: ").and_then(|rest| rest.split_once(", available keys: "));
        if let Some((unexpected, known)) = keys {
            let known: Vec<&str> = known.split(", ").collect();
            return Self::unknown(span, "key", unexpected.split(", ").next().unwrap_or(unexpected), &known);
        }
        let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        let is_unknown = message.starts_with("unknown ") && quoted.len() > 1;
        if !is_unknown {
            return Self { span, message: plain_words(message), label: "here".to_owned() };
        }
        let mut known = quoted[1..].to_vec();
        if known.contains(&"ambient-occlusion") {
            known.extend(more_keys);
        }
        let what = if message.starts_with("unknown variant") { "value" } else { "key" };
        Self::unknown(span, what, quoted[0], &known)
    }

    /// Of a `word` that is none of the `known` ones; `what` it should have been: `key`, `scene`, ...
    pub fn unknown(span: Range<usize>, what: &str, word: &str, known: &[&str]) -> Self {
        let expected = format!("expected {}", listed(known));
        let label = nearest(word, known).map_or(expected.clone(), |near| format!("did you mean `{near}`?"));
        Self { span, message: format!("unknown {what} `{word}`; {expected}"), label }
    }
}

fn plain_words(message: &str) -> String {
    let words = [
        ("expected f32", "expected a number"),
        ("expected u16", "expected a whole number, 0 or more"),
        ("expected u32", "expected a whole number, 0 or more"),
        ("expected a sequence", "expected a list"),
        ("expected a map", "expected a table"),
        ("invalid type: map", "wrong kind of value: a table"),
        ("invalid type: sequence", "wrong kind of value: a list"),
        ("invalid type", "wrong kind of value"),
        ("floating point", "number"),
        ("missing field", "missing key"),
    ];
    let told = words.iter().fold(message.to_owned(), |text, (from, to)| text.replace(from, to));
    // serde names the struct that a table is read into.
    match told.split_once("expected struct ") {
        Some((before, _)) => format!("{before}expected a table"),
        None => told.replace('\n', "; "),
    }
}

fn listed(words: &[&str]) -> String {
    words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

/// The known word that `word` was probably meant to be.
fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let distance = |other: &str| strsim::damerau_levenshtein(word, other);
    let near = known.iter().copied().min_by_key(|other| distance(other))?;
    (distance(near) <= 1 + near.len() / 4).then_some(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_suggested_and_far_ones_not() {
        assert_eq!(nearest("smaples", &["sampler", "samples"]), Some("samples"));
        assert_eq!(nearest("lightcut", &["all", "lightcuts"]), Some("lightcuts"));
        assert_eq!(nearest("zebra", &["all", "lightcuts"]), None);
    }

    #[test]
    fn tables_are_laid_over_key_by_key_and_lists_as_a_whole() {
        let table = |text: &str| toml::from_str::<Table>(text).unwrap();
        let mut lower = table("a = 1\nlist = [1, 2]\n[b]\nx = 1\n[b.c]\ny = 2\nz = 3");
        overlay(&mut lower, &table("list = [3]\nnew = true\n[b.c]\ny = 9"));
        assert_eq!(lower, table("a = 1\nlist = [3]\nnew = true\n[b]\nx = 1\n[b.c]\ny = 9\nz = 3"));
    }

    #[test]
    fn places_are_found() {
        let text = "[image]\nwidth = 0\n[[scene]]\n[[scene]]\nfiles = ['a', 'bc']\n";
        let at = |path| value_at(text, path).map(|value| &text[value.span()]);
        assert_eq!(at("image.width"), Some("0"));
        assert_eq!(at("scene.1.files.1"), Some("'bc'"));
        for absent in ["image.height", "scene.2", "scene.x", "image.width.x", ""] {
            assert_eq!(at(absent), None, "{absent}");
        }
        assert!(value_at("[image", "image").is_none());
    }
}
