//! Times, light ratio and VPL count of configurations in one scene, beside published ones.

use crate::layout::Time;
use crate::published::{AVERAGE, PublishedTime};
use crate::record::{ConfigurationInfo, Row, SceneInfo};
use crate::report::device::{self, told_seconds};
use crate::report::document::{Block, Cell, Column, Csv, Kind, Notes, Notice, Table, field};
use crate::report::measured::{Found, Measured, Spread, seconds, stand_in_note};
use crate::report::number::{as_printed, count, fixed, integer, significant};
use std::fmt::Write as _;

/// What a section asks for.
pub(super) struct Request<'a> {
    pub(super) id: &'a str,
    pub(super) scene: &'a SceneInfo,
    pub(super) configurations: Vec<&'a ConfigurationInfo>,
    /// Table of the published figures.
    pub(super) table: Option<&'a str>,
    pub(super) every_run: bool,
}

/// A row of the table.
struct Line<'a> {
    configuration: &'a ConfigurationInfo,
    title: String,
    point: Option<&'a str>,
    run: Option<u32>,
    found: Found<'a>,
    published: Option<&'a PublishedTime>,
}

/// A time with its heading and the published figure.
type Quantity = (Time, &'static str, fn(&PublishedTime) -> f64);

const TIMES: [Quantity; 3] = [
    (Time::FirstPass, "First pass, s", |published| published.first_pass_s),
    (Time::SecondPass, "Second pass, s", |published| published.second_pass_s),
    (Time::Total, "Total, s", |published| published.total_s),
];

const CSV_HEAD: [&str; 30] = [
    "scene",
    "configuration",
    "point",
    "run",
    "rows",
    "stand_in",
    "absent",
    "device",
    "first_pass_cpu_s",
    "first_pass_cpu_least_s",
    "first_pass_cpu_greatest_s",
    "first_pass_elapsed_s",
    "second_pass_cpu_s",
    "second_pass_cpu_least_s",
    "second_pass_cpu_greatest_s",
    "second_pass_elapsed_s",
    "total_cpu_s",
    "total_cpu_least_s",
    "total_cpu_greatest_s",
    "total_elapsed_s",
    "light_ratio_percent",
    "vpl_count",
    "published_first_pass_s",
    "published_second_pass_s",
    "published_total_s",
    "published_light_ratio_percent",
    "published_vpl_count",
    "first_pass_ratio",
    "second_pass_ratio",
    "total_ratio",
];

/// The table, and before it what limits its figures.
pub(super) fn blocks(measured: &Measured<'_>, request: &Request<'_>) -> Vec<Block> {
    let lines = lines(measured, request);
    let mut notes = Notes::default();
    let rows = lines.iter().map(|line| row(line, request, &mut notes)).collect();
    let mut csv = Csv::new(&CSV_HEAD);
    csv.rows = lines.iter().map(|line| csv_row(line, request)).collect();
    let table = Table {
        id: request.id.to_owned(),
        caption: caption(measured, request, &lines),
        columns: columns(request.table.is_some()),
        names: 1,
        rows,
        notes,
        csv,
    };
    let stand_in = stand_in_note(request.scene).map(|note| Block::Notice(Notice::warning(note)));
    stand_in.into_iter().chain([Block::Table(table)]).collect()
}

fn caption(measured: &Measured<'_>, request: &Request<'_>, lines: &[Line<'_>]) -> String {
    let renders = measured.header.runs as usize * measured.header.seeds.len();
    let what = match (request.every_run, renders) {
        (true, _) => "every run",
        (false, 0 | 1) => "one run",
        (false, _) => "mean over the runs, below it the least and the greatest",
    };
    let has_gpu = lines.iter().any(|line| device::note(&line.found).is_some());
    let of_gpus = if has_gpu { ", of GPUs elapsed seconds" } else { "" };
    let mut text = format!("{}: processor seconds over all threads{of_gpus}, {what}.", request.scene.title);
    if let Some(table) = request.table {
        let source = &measured.header.published.source;
        let _ = write!(text, " Beside them the published figures ({source}, {table}); the ratio is published / ours.");
    }
    text
}

fn columns(published: bool) -> Vec<Column> {
    let mut columns = vec![Column::new("Configuration")];
    let groups = TIMES.iter().map(|(_, title, _)| (*title, true)).chain([("Light ratio, %", false), ("VPLs", false)]);
    for (group, has_ratio) in groups {
        if published {
            columns.push(Column::of(group, "ours"));
            columns.push(Column::of(group, "published"));
            if has_ratio {
                columns.push(Column::of(group, "ratio"));
            }
        } else {
            columns.push(Column::new(group));
        }
    }
    columns
}

fn lines<'a>(measured: &Measured<'a>, request: &Request<'a>) -> Vec<Line<'a>> {
    let mut lines = Vec::new();
    for configuration in &request.configurations {
        for point in measured.points(request.scene) {
            let found = measured.find(request.scene, configuration, point);
            // Not every configuration is rendered at every point.
            if point.is_some() && found == Found::Unplanned {
                continue;
            }
            let title = point.map_or(configuration.title.clone(), |point| format!("{}, {point}", configuration.title));
            if request.every_run {
                lines.extend(single_runs(measured, request, configuration, point, &found, &title));
            } else {
                let published = published(measured, request, configuration, AVERAGE);
                lines.push(Line { configuration, title, point, run: None, found, published });
            }
        }
    }
    lines
}

/// A line for each run, ours and published ones.
fn single_runs<'a>(
    measured: &Measured<'a>,
    request: &Request<'a>,
    configuration: &'a ConfigurationInfo,
    point: Option<&'a str>,
    found: &Found<'a>,
    title: &str,
) -> Vec<Line<'a>> {
    let last_published =
        (1..).take_while(|run: &u32| published(measured, request, configuration, &run.to_string()).is_some());
    let runs = measured.header.runs.max(last_published.last().unwrap_or(0));
    let seeds = &measured.header.seeds;
    let of_run = |(run, seed): (u32, u32)| {
        let rows: Vec<&Row> = found.rows().iter().filter(|row| row.run == run && row.seed == seed).copied().collect();
        let found = match found {
            _ if !rows.is_empty() => Found::Rows(rows),
            Found::Absent(reason) => Found::Absent(reason),
            _ if run > measured.header.runs => Found::Unplanned,
            _ => Found::Pending,
        };
        let seed_name = if seeds.len() > 1 { format!(", seed {seed}") } else { String::new() };
        let title = format!("{title}{seed_name}, run {run}");
        let published = published(measured, request, configuration, &run.to_string());
        Line { configuration, title, point, run: Some(run), found, published }
    };
    seeds.iter().flat_map(|&seed| (1..=runs).map(move |run| (run, seed))).map(of_run).collect()
}

fn published<'a>(
    measured: &Measured<'a>,
    request: &Request<'_>,
    configuration: &ConfigurationInfo,
    run: &str,
) -> Option<&'a PublishedTime> {
    measured.header.published.time(request.table?, &request.scene.name, &configuration.name, run)
}

fn row(line: &Line<'_>, request: &Request<'_>, notes: &mut Notes) -> Vec<Cell> {
    let comparable = request.scene.stand_in.is_none();
    let reason = line.found.note().or_else(|| stand_in_note(request.scene));
    let name = Cell::name(&line.title).with_note(reason.map(|reason| notes.mark(reason)));
    let mut cells = vec![name.with_note(device::mark(notes, &line.found))];
    let published_kind = if comparable { Kind::Published } else { Kind::Faint };
    let of_others = |value: Option<String>| value.map_or(Cell::none(), |text| Cell::new(published_kind, text));
    let has_published = request.table.is_some();
    for (time, _, figure) in TIMES {
        let ours = line.found.spread(|row| told_seconds(row, time));
        cells.push(own_cell(ours, significant, &line.found));
        if has_published {
            let figure = line.published.map(figure);
            cells.push(of_others(figure.map(as_printed)));
            let ratio = ratio(figure, ours).filter(|_| comparable);
            cells.push(ratio.map_or(Cell::none(), |ratio| Cell::number(significant(ratio))));
        }
    }
    cells.push(own_cell(light_ratio(line), |percent| fixed(percent, 3), &line.found));
    if has_published {
        cells.push(of_others(line.published.and_then(|published| published.light_ratio_percent).map(as_printed)));
    }
    cells.push(own_cell(vpl_count(line), count, &line.found));
    if has_published {
        cells.push(of_others(line.published.map(|published| integer(published.vpl_count as f64))));
    }
    cells
}

fn own_cell(spread: Option<Spread>, format: impl Fn(f64) -> String, found: &Found<'_>) -> Cell {
    spread.map_or(Cell::new(Kind::Faint, found.word()), |spread| Cell::mean(spread, format))
}

fn light_ratio(line: &Line<'_>) -> Option<Spread> {
    line.found.spread(|row| row.stats.light_ratio_percent)
}

fn vpl_count(line: &Line<'_>) -> Option<Spread> {
    line.found.spread(|row| row.stats.vpl_count as f64)
}

fn ratio(published: Option<f64>, ours: Option<Spread>) -> Option<f64> {
    Some(published? / ours?.mean).filter(|ratio| ratio.is_finite())
}

fn csv_row(line: &Line<'_>, request: &Request<'_>) -> Vec<String> {
    let absent = if let Found::Absent(reason) = line.found { reason } else { "" };
    let stand_in = request.scene.stand_in.is_some();
    let mut fields = vec![
        request.scene.name.clone(),
        line.configuration.name.clone(),
        line.point.unwrap_or_default().to_owned(),
        line.run.map_or(String::new(), |run| run.to_string()),
        line.found.rows().len().to_string(),
        stand_in.to_string(),
        absent.to_owned(),
        line.found.rows().first().map_or(String::new(), |row| row.device.kind.clone()),
    ];
    let mut ratios = Vec::new();
    for (time, _, figure) in TIMES {
        let cpu = line.found.spread(|row| seconds(row, time).0);
        let told = line.found.spread(|row| told_seconds(row, time));
        let elapsed = line.found.spread(|row| seconds(row, time).1);
        fields.extend([cpu.map(|spread| spread.mean), cpu.map(|spread| spread.least)].map(field));
        fields.extend([cpu.map(|spread| spread.greatest), elapsed.map(|spread| spread.mean)].map(field));
        ratios.push(field(ratio(line.published.map(figure), told).filter(|_| !stand_in)));
    }
    fields.extend([light_ratio(line), vpl_count(line)].map(|spread| field(spread.map(|spread| spread.mean))));
    fields.extend(TIMES.map(|(_, _, figure)| field(line.published.map(figure))));
    fields.push(field(line.published.and_then(|published| published.light_ratio_percent)));
    fields.push(line.published.map_or(String::new(), |published| published.vpl_count.to_string()));
    fields.extend(ratios);
    fields
}
