//! The report as Markdown.

use super::document::{Block, Cell, Chart, Column, Document, Kind, Notice, Part, Pictures, Table, Tone};
use super::number::{roman, significant};
use super::prose::escaped;
use std::fmt::Write as _;

/// A text that grows by paragraphs.
struct Writer(String);

/// The whole file.
pub(super) fn to_markdown(document: &Document) -> String {
    let mut writer = Writer(String::new());
    writer.paragraph(&format!("# {}", escaped(&document.title)));
    writer.paragraph(&document.description);
    let terms = document.provenance.iter().map(|(term, text)| format!("* {term}: {}", escaped(text)));
    writer.paragraph(&terms.collect::<Vec<_>>().join("\n"));
    document.notices.iter().for_each(|notice| writer.notice(notice));
    let mut numbers = (0, 0);
    for part in &document.parts {
        writer.part(part, &mut numbers);
    }
    writer.0
}

impl Writer {
    fn paragraph(&mut self, text: &str) {
        if text.trim().is_empty() {
            return;
        }
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        self.0 += text.trim();
        self.0.push('\n');
    }

    /// `numbers` are those of the last table and figure.
    fn part(&mut self, part: &Part, numbers: &mut (usize, usize)) {
        self.paragraph(&format!("## {}", escaped(&part.title)));
        self.paragraph(&part.text);
        for block in &part.blocks {
            match block {
                Block::Notice(notice) => self.notice(notice),
                Block::Table(table) => {
                    numbers.0 += 1;
                    self.table(table, numbers.0);
                }
                Block::Chart(chart) => {
                    numbers.1 += 1;
                    self.chart(chart, numbers.1);
                }
                Block::Pictures(pictures) => self.pictures(pictures, &part.id),
            }
        }
    }

    fn notice(&mut self, notice: &Notice) {
        let word = match notice.tone {
            Tone::Finding => "Result",
            Tone::Warning => "Note",
        };
        let mut text = format!("> **{word}.** {}", escaped(&notice.text));
        if !notice.items.is_empty() {
            text.push_str("\n>");
        }
        for item in &notice.items {
            let _ = write!(text, "\n> * {}", escaped(item)); // writing to a String cannot fail
        }
        self.paragraph(&text);
    }

    fn table(&mut self, table: &Table, number: usize) {
        self.paragraph(&format!(
            "**Table {}.** {} ([CSV](tables/{}.csv))",
            roman(number),
            escaped(&table.caption),
            table.id
        ));
        let mut lines = vec![line(table.columns.iter().map(heading))];
        let rules = (0..table.columns.len()).map(|i| if i < table.names { "---" } else { "---:" }.to_owned());
        lines.push(line(rules));
        lines.extend(table.rows.iter().map(|row| line(row.iter().map(cell))));
        self.paragraph(&lines.join("\n"));
        let notes = table.notes.0.iter().enumerate().map(|(i, note)| format!("{}. {}", i + 1, escaped(note)));
        self.paragraph(&notes.collect::<Vec<_>>().join("\n"));
    }

    fn chart(&mut self, chart: &Chart, number: usize) {
        let alternative = escaped(&chart.alternative);
        self.paragraph(&format!("![{alternative}](charts/{}.svg)", chart.id));
        self.paragraph(&format!("**Figure {}.** {}", roman(number), escaped(&chart.caption)));
    }

    fn pictures(&mut self, pictures: &Pictures, id: &str) {
        let mut lines = vec![format!("The pictures and sliders are on [the page](index.html#{id}).")];
        lines.push(String::new());
        lines.extend(pictures.items.iter().map(|picture| format!("* {}", escaped(&picture.alternative))));
        lines.extend(pictures.absent.iter().map(|(_, reason)| format!("* {}", escaped(reason))));
        self.paragraph(&lines.join("\n"));
        if pictures.pairs.is_empty() {
            return;
        }
        let mut lines = vec![line(["Left", "Right", "FLIP against", "Mean"].map(str::to_owned))];
        lines.push(line(["---", "---", "---", "---:"].map(str::to_owned)));
        for pair in &pictures.pairs {
            let map = pair.map.as_ref();
            let against = map.map_or("-", |map| map.against.as_ref().unwrap_or(&pair.left.title));
            let mean = map.and_then(|map| map.mean).map_or("-".to_owned(), significant);
            let texts = [&pair.left.title, &pair.right.title, against, mean.as_str()];
            lines.push(line(texts.map(escaped)));
        }
        self.paragraph(&lines.join("\n"));
    }
}

fn line(cells: impl IntoIterator<Item = String>) -> String {
    format!("| {} |", cells.into_iter().collect::<Vec<_>>().join(" | "))
}

/// Markdown has one line of headings: the group is said with each.
fn heading(column: &Column) -> String {
    let group = column.group.as_ref().map_or(String::new(), |group| format!("{group}: "));
    escaped(&format!("{group}{}", column.title))
}

fn cell(cell: &Cell) -> String {
    let mut text = escaped(&cell.text);
    if matches!(cell.kind, Kind::Fail | Kind::Slip) {
        text = format!("**{text}**");
    }
    if let Some(detail) = &cell.detail {
        let _ = write!(text, " ({})", escaped(detail));
    }
    if !cell.notes.is_empty() {
        let numbers: Vec<String> = cell.notes.iter().map(usize::to_string).collect();
        let _ = write!(text, " <sup>{}</sup>", numbers.join(", "));
    }
    text
}
