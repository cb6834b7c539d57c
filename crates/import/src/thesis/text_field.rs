//! Where a file name ends: names may contain blanks, and separators between fields are optional.

/// The fields whose value is a file name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TextField {
    /// `PATH:file.obj`.
    Path,
    /// `TEX:file mode`.
    Texture,
}

/// Names of fields that may follow a file name without a separator, with the bracket that they must open.
const FOLLOWERS: [(&str, char); 19] = [
    ("SMTH", '('),
    ("TRAN", '{'),
    ("SCAL", '{'),
    ("SCAL", '('),
    ("ROT", '{'),
    ("MAT", '('),
    ("FRKE", '{'),
    ("TEX", ':'),
    ("PATH", ':'),
    ("SH", '('),
    ("C", '{'),
    ("N", '{'),
    ("V", '{'),
    ("H", '{'),
    ("S", '{'),
    ("D", '{'),
    ("A", '{'),
    ("L", '('),
    ("R", '('),
];

/// How textures may be laid out.
const MODES: [&str; 3] = ["STRETCH", "REPEAT", "STRAIGHT"];

/// Longest file name, in bytes: what Linux takes, and a bound on the time that looking for its end takes.
const MAX_NAME: usize = 4096;

/// A file name with what belongs to it.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Found<'t> {
    pub(super) text: &'t str,
    pub(super) mode: Option<&'t str>,
    /// Bytes of the line that they take.
    pub(super) length: usize,
}

impl TextField {
    /// The field with this name.
    pub(super) fn of(name: &str) -> Option<Self> {
        let known = [("PATH", Self::Path), ("TEX", Self::Texture)];
        known.into_iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, kind)| kind)
    }

    pub(super) fn example(self) -> &'static str {
        match self {
            Self::Path => "PATH:model.obj",
            Self::Texture => "TEX:image.png STRETCH",
        }
    }
}

/// Splits the file name off the rest of a text, of which only the current line counts.
pub(super) fn split(kind: TextField, rest: &str) -> Found<'_> {
    let line = &rest[..rest.floor_char_boundary(MAX_NAME.min(rest.len()))];
    let line = line.find('\n').map_or(line, |end| &line[..end]);
    let limit = line.find('|').unwrap_or(line.len());
    let limit = follower(&line[..limit]).unwrap_or(limit);
    let part = line[..limit].trim_end();
    let (text, mode) = match kind {
        TextField::Path => (part, None),
        TextField::Texture => split_mode(part),
    };
    Found { text: unquoted(text.trim_end()), mode, length: part.len() }
}

/// Where a field starts after a file name with an extension.
fn follower(line: &str) -> Option<usize> {
    // A name starts with a letter, so that every offset is at a character's border.
    let mut starts = line.bytes().enumerate().filter(|(_, byte)| byte.is_ascii_alphabetic()).map(|(i, _)| i);
    starts.find(|&i| starts_field(&line[i..]) && ends_name(line[..i].trim_end()))
}

/// Whether a file name, maybe with its mode, is complete at the end of `text`.
fn ends_name(text: &str) -> bool {
    // Looks back over an extension and a mode only, so that long lines take linear time.
    let text = &text[text.floor_char_boundary(text.len().saturating_sub(24))..];
    has_extension(split_mode(text).0.trim_end())
}

fn starts_field(text: &str) -> bool {
    FOLLOWERS.iter().any(|(name, bracket)| {
        text.get(..name.len()).is_some_and(|head| head.eq_ignore_ascii_case(name))
            && text[name.len()..].trim_start().starts_with(*bracket)
    })
}

fn has_extension(name: &str) -> bool {
    let Some((_, extension)) = name.rsplit_once('.') else { return name.ends_with('"') };
    let extension = extension.trim_end_matches('"');
    (1..=5).contains(&extension.len()) && extension.bytes().all(|byte| byte.is_ascii_alphanumeric())
}

/// The last word is the mode if it is one.
fn split_mode(part: &str) -> (&str, Option<&str>) {
    match part.rsplit_once([' ', '\t', ':']) {
        Some((name, word)) if MODES.iter().any(|mode| mode.eq_ignore_ascii_case(word)) => (name, Some(word)),
        _ => (part, None),
    }
}

fn unquoted(text: &str) -> &str {
    text.strip_prefix('"').and_then(|inner| inner.strip_suffix('"')).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(kind: TextField, line: &str) -> (&str, Option<&str>, &str) {
        let found = split(kind, line);
        (found.text, found.mode, &line[found.length..])
    }

    #[test]
    fn paths_end_at_separators_and_fields() {
        let path = |line| found(TextField::Path, line);
        assert_eq!(path("a b.obj | SMTH(1)"), ("a b.obj", None, " | SMTH(1)"));
        assert_eq!(path("a.obj SMTH(1)"), ("a.obj", None, " SMTH(1)"));
        assert_eq!(path("a.objSMTH(1)"), ("a.obj", None, "SMTH(1)"));
        assert_eq!(path("a (S{1).obj"), ("a (S{1).obj", None, ""));
        assert_eq!(path("no extension S{1}"), ("no extension S{1}", None, ""));
        assert_eq!(path("\"a b.obj\" mat(0)"), ("a b.obj", None, " mat(0)"));
    }

    #[test]
    fn textures_have_a_mode() {
        let texture = |line| found(TextField::Texture, line);
        assert_eq!(texture("my wood.png repeat|C{0,0,0}"), ("my wood.png", Some("repeat"), "|C{0,0,0}"));
        assert_eq!(texture("wood.png STRETCH"), ("wood.png", Some("STRETCH"), ""));
        assert_eq!(texture("wood.png STRETCH C{0,0,0}"), ("wood.png", Some("STRETCH"), " C{0,0,0}"));
        assert_eq!(texture("wood.png STRETCHC{0,0,0}"), ("wood.png", Some("STRETCH"), "C{0,0,0}"));
        assert_eq!(texture("repeat wood.png"), ("repeat wood.png", None, ""));
        assert_eq!(texture("wood.png C{0,0,0}"), ("wood.png", None, " C{0,0,0}"));
    }
}
