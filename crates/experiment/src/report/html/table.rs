//! Tables of the page.

use crate::report::document::{Cell, Column, Kind, Table};
use crate::report::number::roman;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};

/// As wide as a digit, and as a point.
const FIGURE_SPACE: &str = "\u{2007}";
const POINT_SPACE: &str = "\u{2008}";

/// A table with its caption, notes and data.
pub(super) fn markup(table: &Table, number: usize) -> Markup {
    let decimals: Vec<usize> = (0..table.columns.len()).map(|i| column_decimals(table, i)).collect();
    let data = format!("data:text/csv;base64,{}", STANDARD.encode(table.csv.to_text()));
    let caption = format!("{}:caption", table.id);
    html! {
        figure.table id={ (table.id) ":table" } {
            // Not within the table: a caption there is as wide as the table, which may be wider than the screen.
            figcaption id=(caption) {
                b { "Table " (roman(number)) "." } " " (table.caption) " "
                a.data download={ (table.id) ".csv" } href=(data) { "CSV" }
            }
            div.scroll tabindex="0" role="region" aria-labelledby=(caption) {
                table aria-labelledby=(caption) {
                    thead { (heads(&table.columns, table.names)) }
                    tbody {
                        @for (i, row) in table.rows.iter().enumerate() {
                            (body_row(table, i, row, &decimals))
                        }
                    }
                }
            }
            @if !table.notes.0.is_empty() {
                ol.notes {
                    @for (i, note) in table.notes.0.iter().enumerate() {
                        li id={ (table.id) ":note-" (i + 1) } { (note) }
                    }
                }
            }
        }
    }
}

/// A line of headings, or two where columns stand in groups.
fn heads(columns: &[Column], names: usize) -> Markup {
    let grouped = columns.iter().any(|column| column.group.is_some());
    let rows = if grouped { "2" } else { "1" };
    html! {
        tr {
            @for (i, (column, span)) in groups(columns).into_iter().enumerate() {
                @match &column.group {
                    Some(group) => th.group scope="colgroup" colspan=(span) { (group) },
                    None => th.name[i < names].first[i == 0] scope="col" rowspan=(rows) { span { (column.title) } },
                }
            }
        }
        @if grouped {
            tr {
                @for column in columns.iter().filter(|column| column.group.is_some()) {
                    th scope="col" { span { (column.title) } }
                }
            }
        }
    }
}

/// The first column of each group, or a column without one, with the number of columns.
fn groups(columns: &[Column]) -> Vec<(&Column, usize)> {
    let mut groups: Vec<(&Column, usize)> = Vec::new();
    for column in columns {
        match groups.last_mut() {
            Some((first, span)) if first.group.is_some() && first.group == column.group => *span += 1,
            _ => groups.push((column, 1)),
        }
    }
    groups
}

fn body_row(table: &Table, i: usize, row: &[Cell], decimals: &[usize]) -> Markup {
    // With several names, rows of one first name stand under it together.
    let first = |row: &[Cell]| row.first().map(|cell| cell.text.clone());
    let repeats = table.names > 1 && i > 0 && first(&table.rows[i - 1]) == first(row);
    let span = table.rows[i..].iter().take_while(|other| table.names > 1 && first(other) == first(row)).count();
    html! {
        tr.first[table.names > 1 && !repeats] {
            @for (place, cell) in row.iter().enumerate() {
                @if place == 0 && table.names > 1 {
                    @if !repeats {
                        th.name.first scope="rowgroup" rowspan=(span) { (content(table, cell, 0)) }
                    }
                } @else if place < table.names {
                    th.name.first[place == 0] scope="row" { (content(table, cell, 0)) }
                } @else {
                    td class=(class(cell.kind)) { (content(table, cell, decimals[place])) }
                }
            }
        }
    }
}

fn content(table: &Table, cell: &Cell, decimals: usize) -> Markup {
    html! {
        span.value { (shown(&cell.text)) }
        (padding(&cell.text, decimals))
        @if !cell.notes.is_empty() {
            sup {
                @for (i, note) in cell.notes.iter().enumerate() {
                    @if i > 0 { ", " }
                    a href={ "#" (table.id) ":note-" (note) } { (note) }
                }
            }
        }
        @if let Some(detail) = &cell.detail {
            small { (detail.replace('-', "\u{2212}")) }
        }
    }
}

fn class(kind: Kind) -> &'static str {
    match kind {
        Kind::Name => "name",
        Kind::Words => "words",
        Kind::Number => "number",
        Kind::Published => "published",
        Kind::Faint => "faint",
        Kind::Pass => "pass",
        Kind::Fail => "fail",
        Kind::Slip => "slip",
    }
}

/// Decimals of a plain number; `None` for anything else.
fn decimals(text: &str) -> Option<usize> {
    let is_plain = text.starts_with(|c: char| c.is_ascii_digit() || c == '-')
        && text.ends_with(|c: char| c.is_ascii_digit())
        && text.chars().all(|c| c.is_ascii_digit() || matches!(c, '-' | '.' | ','));
    is_plain.then(|| text.split_once('.').map_or(0, |(_, decimals)| decimals.len()))
}

fn column_decimals(table: &Table, column: usize) -> usize {
    table.rows.iter().filter_map(|row| decimals(&row.get(column)?.text)).max().unwrap_or(0)
}

/// With a true minus sign.
fn shown(text: &str) -> String {
    match text {
        "-" => "\u{2013}".to_owned(),
        _ if decimals(text).is_some() => text.replace('-', "\u{2212}"),
        _ => text.to_owned(),
    }
}

/// Room for absent decimals, so that points stand below each other.
fn padding(text: &str, most: usize) -> String {
    let Some(own) = decimals(text) else { return String::new() };
    let point = if own == 0 && most > 0 { POINT_SPACE } else { "" };
    format!("{point}{}", FIGURE_SPACE.repeat(most.saturating_sub(own)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_stand_below_each_other() {
        assert_eq!(padding("4,399.7", 3), "\u{2007}\u{2007}");
        assert_eq!(padding("-12", 2), "\u{2008}\u{2007}\u{2007}");
        assert_eq!([padding("12.34", 2), padding("absent", 3), padding("1.2e-5", 3)], ["", "", ""]);
        assert_eq!([shown("-12.5"), shown("-"), shown("not yet")], ["\u{2212}12.5", "\u{2013}", "not yet"]);
    }

    #[test]
    fn neighbours_of_a_group_share_a_heading() {
        let columns =
            [Column::new("a"), Column::of("g", "b"), Column::of("g", "c"), Column::new("d"), Column::new("e")];
        let spans: Vec<usize> = groups(&columns).into_iter().map(|(_, span)| span).collect();
        assert_eq!(spans, [1, 2, 1, 1]);
    }
}
