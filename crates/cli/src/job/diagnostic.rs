//! Faults in job files, said with file, line and column, the line itself, and what was expected.

use crate::exit::{Exit, Failure};
use crate::fault::fault;

/// The keys of a job file beside the tables of settings.
pub(super) const TOP_KEYS: [&str; 3] = ["scene", "search-path", "read-vpls"];

/// An error of the TOML reader, in words for people who do not know Rust.
pub(super) fn toml_fault(name: &str, text: &str, error: &toml::de::Error) -> Failure {
    let message = error.message();
    let span = error.span().unwrap_or_default();
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let is_unknown = message.starts_with("unknown ") && quoted.len() > 1;
    if !is_unknown {
        return fault(Exit::Usage, name, text, span, &plain_words(message), "here");
    }
    let mut known = quoted[1..].to_vec();
    if known.contains(&"ambient-occlusion") {
        known.extend(TOP_KEYS);
    }
    let what = if message.starts_with("unknown variant") { "value" } else { "key" };
    let expected = format!("expected {}", listed(&known));
    let label = nearest(quoted[0], &known).map_or(expected.clone(), |near| format!("did you mean `{near}`?"));
    fault(Exit::Usage, name, text, span, &format!("unknown {what} `{}`; {expected}", quoted[0]), &label)
}

fn plain_words(message: &str) -> String {
    let words = [
        ("expected f32", "expected a number"),
        ("expected u32", "expected a whole number, 0 or more"),
        ("expected a sequence", "expected a list"),
        ("invalid type: map", "wrong kind of value: a table"),
        ("invalid type: sequence", "wrong kind of value: a list"),
        ("invalid type", "wrong kind of value"),
        ("floating point", "number"),
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
}
