//! The file names of an `mtllib` line. The format separates names by blanks, and writers put blanks into names.

/// Readings of an `mtllib` line to be tried in order, until the files of one exist: the whole line as one name, names
/// that end in `.mtl`, single words. `\ ` is a blank that belongs to a name.
pub(crate) fn library_names(line: &str) -> Vec<Vec<String>> {
    let words = split_words(line);
    let mut grouped: Vec<String> = Vec::new();
    let mut open = false;
    for word in &words {
        match grouped.last_mut().filter(|_| open) {
            Some(name) => *name = format!("{name} {word}"),
            None => grouped.push(word.clone()),
        }
        open = !ends_name(word);
    }
    let mut readings = vec![vec![line.replace("\\ ", " ")], grouped, words];
    readings.dedup();
    readings
}

fn ends_name(word: &str) -> bool {
    word.get(word.len().saturating_sub(4)..).is_some_and(|end| end.eq_ignore_ascii_case(".mtl"))
}

fn split_words(line: &str) -> Vec<String> {
    // No text has this character here: the reader refuses control characters.
    let protected = line.replace("\\ ", "\0");
    protected.split_ascii_whitespace().map(|word| word.replace('\0', " ")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_separate_names_or_belong_to_them() {
        let read = |line| library_names(line);
        assert_eq!(read("a.mtl"), [["a.mtl"]]);
        assert_eq!(read("my a.mtl b.mtl")[1..], [vec!["my a.mtl", "b.mtl"], vec!["my", "a.mtl", "b.mtl"]]);
        assert_eq!(read("x.mtl my\\ a.mtl")[1..], [vec!["x.mtl", "my a.mtl"]]);
        assert_eq!(read("")[0], [""]);
    }
}
