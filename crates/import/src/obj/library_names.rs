//! The file names of an `mtllib` line. The format separates names by blanks, and writers put blanks into names.

use crate::lines::without_comment;

/// Readings of an `mtllib` line to be tried in order, until the files of one exist: the whole line as one name, names
/// that end in `.mtl`, single words. `\ ` is a blank that belongs to a name. What follows a ` #` belongs to the name
/// where there is such a file, else it is a comment.
pub(crate) fn library_names(line: &str) -> Vec<Vec<String>> {
    let short = without_comment(line).trim_ascii();
    let whole = (short.len() < line.len()).then(|| vec![line.to_owned()]);
    whole.into_iter().chain(readings(short)).collect()
}

fn readings(line: &str) -> Vec<Vec<String>> {
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
        assert_eq!(read("a.mtl # b"), [["a.mtl # b"], ["a.mtl"]]);
        assert_eq!(read("a#1.mtl"), [["a#1.mtl"]]);
    }
}
