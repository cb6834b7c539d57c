//! Words of a closed set, for messages.

/// Longest word for which a near one is looked up: the distance takes time in its square, and nobody mistypes more.
const LONGEST: usize = 40;

/// Most known words that are looked at.
const MOST: usize = 1000;

/// `` `a`, `b` ``
pub(super) fn listed(words: &[&str]) -> String {
    quoted(words).join(", ")
}

/// `` `a` or `b` ``
pub(super) fn either(words: &[&str]) -> String {
    quoted(words).join(" or ")
}

fn quoted(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| format!("`{word}`")).collect()
}

/// `` : did you mean `albedo`? `` for `albdeo`; nothing if no known word is near.
pub(super) fn did_you_mean(word: &str, known: &[&str]) -> String {
    nearest(word, known).map_or_else(String::new, |near| format!(": did you mean `{near}`?"))
}

fn nearest<'w>(word: &str, known: &[&'w str]) -> Option<&'w str> {
    if word.len() > LONGEST {
        return None;
    }
    let distance = |other: &str| strsim::damerau_levenshtein(word, other);
    let short = known.iter().copied().take(MOST).filter(|other| other.len() <= LONGEST);
    let near = short.min_by_key(|other| distance(other))?;
    (distance(near) <= near.len().max(word.len()) / 3).then_some(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_suggested_and_far_ones_not() {
        assert_eq!(nearest("albdeo", &["alpha", "albedo"]), Some("albedo"));
        assert_eq!(nearest("lihgt", &["light"]), Some("light"));
        assert_eq!(nearest("cam", &["name", "camera"]), None);
        assert_eq!(nearest("zebra", &["alpha", "albedo"]), None);
        assert_eq!(nearest(&"x".repeat(100), &["x"]), None);
    }
}
