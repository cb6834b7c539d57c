//! A report before it has a form: what Markdown, HTML and CSV are made of.

use super::measured::Spread;
use std::path::PathBuf;

/// A report.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Document {
    pub(super) title: String,
    /// Markdown.
    pub(super) description: String,
    /// Terms with their texts.
    pub(super) provenance: Vec<(String, String)>,
    /// Notes that stand at the top of the report.
    pub(super) notices: Vec<Notice>,
    pub(super) parts: Vec<Part>,
}

/// A section of a report.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    /// Anchor.
    pub(super) id: String,
    pub(super) title: String,
    /// Markdown.
    pub(super) text: String,
    pub(super) blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Block {
    Notice(Notice),
    Table(Table),
    Chart(Chart),
    Pictures(Pictures),
}

/// A sentence that stands out, with the cases it speaks of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Notice {
    pub(super) tone: Tone,
    pub(super) text: String,
    pub(super) items: Vec<String>,
}

/// How much a notice stands out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tone {
    /// Something found out.
    Finding,
    /// Something that limits what the figures say.
    Warning,
}

impl Notice {
    pub(super) fn finding(text: impl Into<String>) -> Self {
        Self { tone: Tone::Finding, text: text.into(), items: Vec::new() }
    }

    pub(super) fn warning(text: impl Into<String>) -> Self {
        Self { tone: Tone::Warning, text: text.into(), items: Vec::new() }
    }

    pub(super) fn with_items(self, items: Vec<String>) -> Self {
        Self { items, ..self }
    }
}

/// A table for people, with the same figures for machines.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table {
    /// File name without its ending, and anchor.
    pub(super) id: String,
    pub(super) caption: String,
    pub(super) columns: Vec<Column>,
    /// How many columns, from the left, name the row.
    pub(super) names: usize,
    pub(super) rows: Vec<Vec<Cell>>,
    pub(super) notes: Notes,
    pub(super) csv: Csv,
}

/// A column. Neighbours of one group stand under one heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Column {
    pub(super) group: Option<String>,
    pub(super) title: String,
}

impl Column {
    pub(super) fn new(title: impl Into<String>) -> Self {
        Self { group: None, title: title.into() }
    }

    pub(super) fn of(group: &str, title: impl Into<String>) -> Self {
        Self { group: Some(group.to_owned()), title: title.into() }
    }
}

/// A cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cell {
    pub(super) text: String,
    pub(super) kind: Kind,
    /// Smaller, under the text.
    pub(super) detail: Option<String>,
    /// Numbers of its notes.
    pub(super) notes: Vec<usize>,
}

/// What a cell is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Names the row.
    Name,
    Words,
    Number,
    /// A figure of others.
    Published,
    /// Without meaning here: an empty place, or a figure that cannot be compared.
    Faint,
    Pass,
    Fail,
    /// A published figure that another one contradicts.
    Slip,
}

impl Cell {
    pub(super) fn new(kind: Kind, text: impl Into<String>) -> Self {
        Self { text: text.into(), kind, detail: None, notes: Vec::new() }
    }

    pub(super) fn name(text: impl Into<String>) -> Self {
        Self::new(Kind::Name, text)
    }

    pub(super) fn number(text: impl Into<String>) -> Self {
        Self::new(Kind::Number, text)
    }

    /// A mean, and below it the least and the greatest value if they differ as far as is shown.
    pub(super) fn mean(spread: Spread, format: impl Fn(f64) -> String) -> Self {
        Self::within(spread.mean, spread, format)
    }

    /// A value that stands for several, with the least and the greatest of them unless they look alike.
    pub(super) fn within(value: f64, spread: Spread, format: impl Fn(f64) -> String) -> Self {
        let (least, greatest) = (format(spread.least), format(spread.greatest));
        let range = (least != greatest).then(|| format!("{least} – {greatest}"));
        Self::number(format(value)).with_detail(range)
    }

    /// There is nothing to say.
    pub(super) fn none() -> Self {
        Self::new(Kind::Faint, "-")
    }

    pub(super) fn with_detail(self, detail: Option<String>) -> Self {
        Self { detail, ..self }
    }

    /// With one note more, if there is one.
    pub(super) fn with_note(mut self, note: Option<usize>) -> Self {
        self.notes.extend(note);
        self.notes.sort_unstable();
        self
    }
}

/// Notes under a table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Notes(pub(super) Vec<String>);

impl Notes {
    /// The number, from 1, of a note with this text.
    pub(super) fn mark(&mut self, text: impl Into<String>) -> usize {
        let text = text.into();
        let place = self.0.iter().position(|note| *note == text).unwrap_or_else(|| {
            self.0.push(text);
            self.0.len() - 1
        });
        place + 1
    }
}

/// A table for machines.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Csv {
    pub(super) head: Vec<&'static str>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Csv {
    pub(super) fn new(head: &[&'static str]) -> Self {
        Self { head: head.to_vec(), rows: Vec::new() }
    }

    /// The text of the file, with quotes where a field needs them (RFC 4180).
    pub(super) fn to_text(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.head).expect("memory takes every record");
        for row in &self.rows {
            writer.write_record(row).expect("every row has the columns of the head");
        }
        let bytes = writer.into_inner().expect("memory takes every byte");
        String::from_utf8(bytes).expect("fields are texts")
    }
}

/// A number of a CSV file, or nothing.
pub(super) fn field(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// A chart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Chart {
    /// File name without its ending, and anchor.
    pub(super) id: String,
    pub(super) caption: String,
    /// What it shows, for those who cannot see it.
    pub(super) alternative: String,
    pub(super) svg: String,
}

/// Pictures of one scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pictures {
    pub(super) items: Vec<Picture>,
    pub(super) pairs: Vec<Pair>,
    /// Configurations without a picture, with the reason.
    pub(super) absent: Vec<(String, String)>,
}

/// A picture file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Picture {
    pub(super) path: PathBuf,
    pub(super) title: String,
    /// What it shows, for those who cannot see it.
    pub(super) alternative: String,
}

/// Two pictures under one slider.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    /// The left one.
    pub(super) left: Picture,
    /// The right one.
    pub(super) right: Picture,
    /// Their FLIP map with its mean, or the one against another reference, with its title.
    pub(super) map: Option<Map>,
}

/// A FLIP map.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Map {
    pub(super) picture: Picture,
    /// Mean FLIP, 0 to 1.
    pub(super) mean: Option<f64>,
    /// The reference where it is not the left picture.
    pub(super) against: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_with_commas_quotes_and_breaks_survive_csv() {
        let fields = ["a,b", "say \"so\"", "two\nlines", "", " plain "].map(str::to_owned).to_vec();
        let csv = Csv { head: vec!["1", "2", "3", "4", "5"], rows: vec![fields.clone()] };
        let text = csv.to_text();
        assert!(text.starts_with("1,2,3,4,5\n\"a,b\",\"say \"\"so\"\"\","), "{text}");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let read: Vec<String> = reader.records().next().unwrap().unwrap().iter().map(str::to_owned).collect();
        assert_eq!(read, fields);
    }

    #[test]
    fn equal_notes_share_a_number() {
        let mut notes = Notes::default();
        assert_eq!([notes.mark("a"), notes.mark("b"), notes.mark("a")], [1, 2, 1]);
        assert_eq!(notes.0, ["a", "b"]);
    }
}
