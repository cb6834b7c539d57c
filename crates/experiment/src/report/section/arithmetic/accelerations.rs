//! Published accelerations against those computed from the published times, averages and single runs.

use super::{differ, is_run, published_cell, scene_title};
use crate::layout::{AccelerationRow, Content, Time};
use crate::published::PublishedTime;
use crate::report::document::{Block, Cell, Column, Csv, Kind, Notes, Notice, Table, field};
use crate::report::measured::Measured;
use crate::report::number::{fixed, rounding};
use crate::report::section::acceleration::percent;

/// A published acceleration with what it should be.
struct Case<'a> {
    table: &'a str,
    row: &'a AccelerationRow,
    scene: &'a str,
    published: f64,
    averages: Option<Computed>,
    runs: Option<Computed>,
}

/// An acceleration computed from published times.
#[derive(Clone, Copy)]
struct Computed {
    percent: f64,
    /// How far rounding of the times may have moved it.
    tolerance: f64,
}

impl Case<'_> {
    fn differs_from(&self, computed: Option<Computed>) -> bool {
        computed.is_some_and(|c| differ(self.published, c.percent, c.tolerance + rounding(self.published)))
    }

    /// What the figure agrees with, in words.
    fn verdict(&self) -> &'static str {
        let agrees = |computed: Option<Computed>| computed.is_some() && !self.differs_from(computed);
        match (agrees(self.averages), agrees(self.runs)) {
            (true, true) => "both",
            (true, false) => "the averages",
            (false, true) => "the single runs",
            (false, false) => "neither",
        }
    }
}

/// How many accelerations do not follow from the tables of averages, and which.
pub(super) fn blocks(measured: &Measured<'_>, id: &str) -> Vec<Block> {
    let cases = cases(measured);
    let all = cases.len();
    let slips: Vec<Case<'_>> =
        cases.into_iter().filter(|case| case.differs_from(case.averages) || case.differs_from(case.runs)).collect();
    if all == 0 {
        return Vec::new();
    }
    if slips.is_empty() {
        let text = format!("All {all} published accelerations follow from the published times.");
        return vec![Block::Notice(Notice::finding(text))];
    }
    let count = |verdict| slips.iter().filter(|case| case.verdict() == verdict).count();
    let text = format!(
        "{} of {all} published accelerations contradict the published averages or the published single runs: {} agree \
         with the single runs alone, {} with the averages alone, {} with neither.",
        slips.len(),
        count("the single runs"),
        count("the averages"),
        count("neither")
    );
    vec![Block::Notice(Notice::finding(text)), Block::Table(table(measured, id, &slips))]
}

/// Every published acceleration that a section has a row for: that row says what it is computed from.
fn cases<'a>(measured: &Measured<'a>) -> Vec<Case<'a>> {
    let header = measured.header;
    let mut cases = Vec::new();
    for section in &header.sections {
        let Content::Acceleration { rows, published: Some(table), .. } = &section.content else { continue };
        for row in rows {
            for scene in &header.scenes {
                let Some(published) = header.published.acceleration(table, &row.title, &scene.name) else { continue };
                let times = |is_wanted: fn(&PublishedTime) -> bool| {
                    let of = |configuration| times(measured, &scene.name, configuration, row.time, is_wanted);
                    computed(&of(&row.slow), &of(&row.fast))
                };
                let (averages, runs) = (times(|time| !is_run(time)), times(is_run));
                cases.push(Case { table, row, scene: &scene.name, published, averages, runs });
            }
        }
    }
    cases
}

/// The published times of a configuration in a scene.
fn times(
    measured: &Measured<'_>,
    scene: &str,
    configuration: &str,
    time: Time,
    is_wanted: fn(&PublishedTime) -> bool,
) -> Vec<f64> {
    let of_it = measured.header.published.times.iter().filter(|t| t.scene == scene && t.config == configuration);
    of_it
        .filter(|t| is_wanted(t))
        .map(|t| match time {
            Time::FirstPass => t.first_pass_s,
            Time::SecondPass => t.second_pass_s,
            Time::Total => t.total_s,
        })
        .collect()
}

/// From the means of the slow and the fast times.
fn computed(slow: &[f64], fast: &[f64]) -> Option<Computed> {
    let mean = |times: &[f64]| {
        let count = times.len() as f64;
        let rounding = times.iter().map(|time| rounding(*time)).fold(0.0, f64::max);
        (!times.is_empty()).then(|| (times.iter().sum::<f64>() / count, rounding))
    };
    let ((slow, slow_rounding), (fast, fast_rounding)) = (mean(slow)?, mean(fast)?);
    // To first order, relative errors add up in a quotient.
    let tolerance = 100.0 * slow / fast * (slow_rounding / slow + fast_rounding / fast);
    Some(Computed { percent: percent(slow, fast)?, tolerance }).filter(|computed| computed.tolerance.is_finite())
}

fn table(measured: &Measured<'_>, id: &str, slips: &[Case<'_>]) -> Table {
    let mut csv = Csv::new(&[
        "table",
        "row",
        "scene",
        "published_percent",
        "from_averages_percent",
        "from_runs_percent",
        "agrees_with",
    ]);
    let mut rows = Vec::new();
    for case in slips {
        let from = |computed: Option<Computed>| {
            computed.map_or(Cell::none(), |computed| Cell::number(fixed(computed.percent, 3)))
        };
        rows.push(vec![
            Cell::name(case.table),
            Cell::name(&case.row.title),
            Cell::name(scene_title(measured, case.scene)),
            published_cell(case.published, case.verdict() == "neither"),
            from(case.averages),
            from(case.runs),
            Cell::new(Kind::Words, case.verdict()),
        ]);
        let names = [case.table, &case.row.title, case.scene].map(str::to_owned);
        let figures = [Some(case.published), case.averages.map(|c| c.percent), case.runs.map(|c| c.percent)].map(field);
        csv.rows.push(names.into_iter().chain(figures).chain([case.verdict().to_owned()]).collect());
    }
    let titles =
        ["Table", "Row", "Scene", "Published, %", "From the averages, %", "From the single runs, %", "Agrees with"];
    Table {
        id: format!("{id}-accelerations"),
        caption: "Published accelerations beside those computed from the published times.".to_owned(),
        columns: titles.map(Column::new).to_vec(),
        names: 3,
        rows,
        notes: Notes::default(),
        csv,
    }
}
