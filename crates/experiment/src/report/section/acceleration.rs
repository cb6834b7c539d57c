//! How much faster one configuration is than another in every scene, beside published figures.

use crate::layout::{AccelerationRow, Time};
use crate::record::{Row, SceneInfo};
use crate::report::chart::bars::{Bar, BarChart, Group};
use crate::report::device::{self, told_seconds};
use crate::report::document::{Block, Cell, Chart, Column, Csv, Kind, Notes, Notice, Table, field};
use crate::report::measured::{Found, Measured, seconds, stand_in_note};
use crate::report::number::{as_printed, fixed};
use std::fmt::Write as _;

/// What a section asks for.
pub(super) struct Request<'a> {
    pub(super) id: &'a str,
    pub(super) rows: &'a [AccelerationRow],
    /// Table of the published figures.
    pub(super) table: Option<&'a str>,
    /// Title of the bar chart.
    pub(super) chart: &'a str,
}

/// An acceleration in one scene.
#[derive(Default)]
struct Figure {
    /// Of the seconds that are shown for each, in percent.
    ours: Option<f64>,
    /// Of elapsed seconds, in percent.
    elapsed: Option<f64>,
    published: Option<f64>,
    /// In place of a figure of ours.
    word: &'static str,
    /// Why there is none.
    reason: Option<String>,
    /// What GPU it is of, if any.
    device: Option<String>,
}

/// The table and its chart.
pub(super) fn blocks(measured: &Measured<'_>, request: &Request<'_>) -> Result<Vec<Block>, String> {
    let scenes: Vec<&SceneInfo> = measured.header.scenes.iter().collect();
    let mut figures = Vec::new();
    for row in request.rows {
        let of_row: Result<Vec<Figure>, String> =
            scenes.iter().map(|scene| figure(measured, request, row, scene)).collect();
        figures.push(of_row?);
    }
    let mut blocks = Vec::new();
    let stand_ins: Vec<String> = scenes.iter().filter_map(|scene| stand_in_note(scene)).collect();
    if !stand_ins.is_empty() {
        blocks.push(Block::Notice(Notice::warning("Not every scene is the published one.").with_items(stand_ins)));
    }
    blocks.push(Block::Table(table(measured, request, &scenes, &figures)));
    blocks.push(Block::Chart(chart(measured, request, &scenes, &figures)?));
    Ok(blocks)
}

/// (slow / fast - 1) * 100 %.
pub(super) fn percent(slow: f64, fast: f64) -> Option<f64> {
    Some((slow / fast - 1.0) * 100.0).filter(|percent| percent.is_finite())
}

fn figure(
    measured: &Measured<'_>,
    request: &Request<'_>,
    row: &AccelerationRow,
    scene: &SceneInfo,
) -> Result<Figure, String> {
    let pair = [measured.configuration(&row.slow)?, measured.configuration(&row.fast)?];
    let published =
        request.table.and_then(|table| measured.header.published.acceleration(table, &row.title, &scene.name));
    let mut figure = Figure { published, word: "-", ..Figure::default() };
    let found = pair.map(|configuration| measured.find(scene, configuration, measured.last_point(scene)));
    for found in &found {
        if let Some(reason) = found.note() {
            (figure.word, figure.reason) = (found.word(), Some(reason));
        }
    }
    let mean = |found: &Found<'_>, time: fn(&Row, Time) -> f64| Some(found.spread(|r| time(r, row.time))?.mean);
    let of_both = |time| percent(mean(&found[0], time)?, mean(&found[1], time)?);
    (figure.ours, figure.elapsed) = (of_both(told_seconds), of_both(|row, time| seconds(row, time).1));
    figure.device = found.iter().find_map(device::note).filter(|_| figure.ours.is_some());
    Ok(figure)
}

fn table(measured: &Measured<'_>, request: &Request<'_>, scenes: &[&SceneInfo], figures: &[Vec<Figure>]) -> Table {
    let mut notes = Notes::default();
    let mut columns = vec![Column::new("Acceleration")];
    for scene in scenes {
        let title = format!("{}, %", scene.title);
        if request.table.is_some() {
            columns.extend(["ours", "published"].map(|column| Column::of(&title, column)));
        } else {
            columns.push(Column::new(title));
        }
    }
    let mut rows = Vec::new();
    for (row, of_row) in request.rows.iter().zip(figures) {
        let mut cells = vec![Cell::name(&row.title)];
        for (scene, figure) in scenes.iter().zip(of_row) {
            cells.extend(cells_of(figure, scene, request.table.is_some(), &mut notes));
        }
        rows.push(cells);
    }
    let csv = csv(request, scenes, figures);
    Table {
        id: request.id.to_owned(),
        caption: caption(measured, request, figures),
        columns,
        names: 1,
        rows,
        notes,
        csv,
    }
}

fn cells_of(figure: &Figure, scene: &SceneInfo, with_published: bool, notes: &mut Notes) -> Vec<Cell> {
    let stand_in = stand_in_note(scene);
    let published_kind = if stand_in.is_none() { Kind::Published } else { Kind::Faint };
    let note = figure.reason.clone().or(stand_in).map(|text| notes.mark(text));
    let device = figure.device.as_ref().map(|text| notes.mark(text));
    let ours = match figure.ours {
        Some(percent) => Cell::number(fixed(percent, 1)),
        None => Cell::new(Kind::Faint, figure.word),
    };
    let mut cells = vec![ours.with_note(note).with_note(device)];
    if with_published {
        let text = figure.published.map(as_printed);
        cells.push(text.map_or(Cell::none(), |text| Cell::new(published_kind, text)));
    }
    cells
}

fn caption(measured: &Measured<'_>, request: &Request<'_>, figures: &[Vec<Figure>]) -> String {
    let has_gpu = figures.iter().flatten().any(|figure| figure.device.is_some());
    let of_gpus = if has_gpu { ", of GPUs elapsed seconds" } else { "" };
    let mut text =
        format!("Acceleration (slow / fast - 1) * 100 % of the mean processor seconds{of_gpus}; below 0 is slower.");
    if !measured.header.points.is_empty() {
        text += " In each scene at the last point of the sweep.";
    }
    if let Some(table) = request.table {
        let _ = write!(text, " Beside them the published figures ({}, {table}).", measured.header.published.source);
    }
    text
}

fn csv(request: &Request<'_>, scenes: &[&SceneInfo], figures: &[Vec<Figure>]) -> Csv {
    let mut csv = Csv::new(&[
        "row",
        "slow",
        "fast",
        "scene",
        "stand_in",
        "missing",
        "percent",
        "elapsed_percent",
        "published_percent",
    ]);
    for (row, of_row) in request.rows.iter().zip(figures) {
        for (scene, figure) in scenes.iter().zip(of_row) {
            let names = [&row.title, &row.slow, &row.fast, &scene.name].map(String::clone);
            let mut fields = names.to_vec();
            fields.push(scene.stand_in.is_some().to_string());
            fields.push(figure.reason.clone().unwrap_or_default());
            fields.extend([figure.ours, figure.elapsed, figure.published].map(field));
            csv.rows.push(fields);
        }
    }
    csv
}

fn chart(
    measured: &Measured<'_>,
    request: &Request<'_>,
    scenes: &[&SceneInfo],
    figures: &[Vec<Figure>],
) -> Result<Chart, String> {
    let group = |(i, scene): (usize, &&SceneInfo)| {
        let star = if scene.stand_in.is_some() { " (stand-in)" } else { "" };
        let bars = figures.iter().enumerate().flat_map(|(series, of_row)| {
            let figure = &of_row[i];
            let ours = Bar { series, published: false, value: figure.ours, word: figure.word };
            let published = Bar { series, published: true, value: figure.published, word: "-" };
            std::iter::once(ours).chain(request.table.map(|_| published))
        });
        Group { label: format!("{}{star}", scene.title), bars: bars.collect() }
    };
    let chart = BarChart {
        y_title: "Acceleration, %".to_owned(),
        series: request.rows.iter().map(|row| row.title.clone()).collect(),
        groups: scenes.iter().enumerate().map(group).collect(),
    };
    let beside = if request.table.is_some() { " Filled: ours. Outlined: published." } else { "" };
    Ok(Chart {
        id: request.id.to_owned(),
        caption: format!("{}.{beside}", request.chart.trim_end_matches('.')),
        alternative: alternative(measured, request, scenes, figures),
        svg: chart.to_svg()?,
    })
}

/// The bars in words.
fn alternative(
    measured: &Measured<'_>,
    request: &Request<'_>,
    scenes: &[&SceneInfo],
    figures: &[Vec<Figure>],
) -> String {
    let mut text = format!("Bar chart of {}.", request.chart);
    let said = |figure: Option<f64>, word: &str| figure.map_or(word.to_owned(), |percent| format!("{percent:.1} %"));
    for (i, scene) in scenes.iter().enumerate() {
        for (row, of_row) in request.rows.iter().zip(figures) {
            let figure = &of_row[i];
            let _ = write!(text, " {}, {}: {}", scene.title, row.title, said(figure.ours, figure.word));
            if request.table.is_some() {
                let _ = write!(text, ", {} {}", measured.header.published.source, said(figure.published, "none"));
            }
            text.push('.');
        }
    }
    text
}
