//! Published averages against the means of the published single runs.

use super::{configuration_title, differ, is_run, published_cell, scene_title};
use crate::published::PublishedTime;
use crate::report::document::{Block, Cell, Column, Csv, Kind, Notes, Notice, Table};
use crate::report::measured::{Measured, Spread};
use crate::report::number::{count, fixed, rounding};
use crate::report::section::counted;

/// A quantity of a published row, with its heading and how a mean is written.
type Quantity = (&'static str, fn(f64) -> String, fn(&PublishedTime) -> Option<f64>);

const QUANTITIES: [Quantity; 5] = [
    ("First pass, s", three_decimals, |time| Some(time.first_pass_s)),
    ("Second pass, s", three_decimals, |time| Some(time.second_pass_s)),
    ("Total, s", three_decimals, |time| Some(time.total_s)),
    ("Light ratio, %", three_decimals, |time| time.light_ratio_percent),
    ("VPLs", count, |time| Some(time.vpl_count as f64)),
];

fn three_decimals(mean: f64) -> String {
    fixed(mean, 3)
}

/// A published average beside the single runs that it should be the mean of.
struct Case<'a> {
    average: &'a PublishedTime,
    /// Table of the runs.
    runs_table: &'a str,
    runs: Vec<&'a PublishedTime>,
}

impl Case<'_> {
    /// The average, the mean of the runs, and whether they differ.
    fn compared(&self, quantity: Quantity) -> Option<(f64, f64, bool)> {
        let (_, _, value) = quantity;
        let average = value(self.average)?;
        let runs: Vec<f64> = self.runs.iter().filter_map(|run| value(run)).collect();
        let of_runs = runs.iter().map(|run| rounding(*run)).fold(0.0, f64::max);
        let mean = Spread::of(runs)?.mean;
        Some((average, mean, differ(average, mean, rounding(average) + of_runs)))
    }

    fn is_slip(&self) -> bool {
        QUANTITIES.iter().any(|quantity| self.compared(*quantity).is_some_and(|(_, _, differs)| differs))
    }

    /// The run that the average repeats in every figure.
    fn repeated_run(&self) -> Option<&str> {
        let equal = |run: &&&PublishedTime| QUANTITIES.iter().all(|(_, _, value)| value(run) == value(self.average));
        Some(&self.runs.iter().find(equal)?.run)
    }
}

/// How many averages are none, and which.
pub(super) fn blocks(measured: &Measured<'_>, id: &str) -> Vec<Block> {
    let times = &measured.header.published.times;
    let cases: Vec<Case<'_>> = times.iter().filter(|time| !is_run(time)).filter_map(|time| case(times, time)).collect();
    let (all, slips): (usize, Vec<Case<'_>>) = (cases.len(), cases.into_iter().filter(Case::is_slip).collect());
    if all == 0 {
        return Vec::new();
    }
    if slips.is_empty() {
        let text = format!("All {all} published averages are the means of their published runs.");
        return vec![Block::Notice(Notice::finding(text))];
    }
    let text = format!("{} of {all} published averages are not the means of the published single runs.", slips.len());
    let notice = Notice::finding(text).with_items(repeated(measured, &slips));
    vec![Block::Notice(notice), Block::Table(table(measured, id, &slips))]
}

fn case<'a>(times: &'a [PublishedTime], average: &'a PublishedTime) -> Option<Case<'a>> {
    let of_same = |time: &&PublishedTime| is_run(time) && time.scene == average.scene && time.config == average.config;
    let runs: Vec<&PublishedTime> = times.iter().filter(of_same).collect();
    Some(Case { average, runs_table: &runs.first()?.table, runs })
}

/// Which tables repeat a single run.
fn repeated(measured: &Measured<'_>, slips: &[Case<'_>]) -> Vec<String> {
    let mut found: Vec<(String, usize)> = Vec::new();
    for case in slips {
        let Some(run) = case.repeated_run() else { continue };
        let scene = scene_title(measured, &case.average.scene);
        let text = format!("{} ({scene}) repeats run {run} of {}", case.average.table, case.runs_table);
        match found.iter_mut().find(|(known, _)| *known == text) {
            Some((_, count)) => *count += 1,
            None => found.push((text, 1)),
        }
    }
    found.into_iter().map(|(text, count)| format!("{text} in {}.", counted(count, "row"))).collect()
}

fn table(measured: &Measured<'_>, id: &str, slips: &[Case<'_>]) -> Table {
    let mut columns = ["Tables", "Scene", "Configuration"].map(Column::new).to_vec();
    for (title, _, _) in QUANTITIES {
        columns.extend(["average", "runs"].map(|column| Column::of(title, column)));
    }
    columns.push(Column::new("Remark"));
    let mut csv =
        Csv::new(&["table", "runs_table", "scene", "configuration", "quantity", "average", "mean_of_runs", "differs"]);
    let mut rows = Vec::new();
    for case in slips {
        let mut cells = vec![
            Cell::name(format!("{}, {}", case.average.table, case.runs_table)),
            Cell::name(scene_title(measured, &case.average.scene)),
            Cell::name(configuration_title(measured, &case.average.config)),
        ];
        for quantity in QUANTITIES {
            cells.extend(cells_of(case, quantity));
            csv.rows.extend(csv_row(case, quantity));
        }
        let remark = case.repeated_run().map(|run| format!("is run {run}"));
        cells.push(remark.map_or(Cell::none(), |text| Cell::new(Kind::Words, text)));
        rows.push(cells);
    }
    Table {
        id: format!("{id}-averages"),
        caption: "Published averages beside the means of the published single runs; marked where they differ."
            .to_owned(),
        columns,
        names: 3,
        rows,
        notes: Notes::default(),
        csv,
    }
}

fn cells_of(case: &Case<'_>, quantity: Quantity) -> [Cell; 2] {
    let Some((average, mean, differs)) = case.compared(quantity) else { return [Cell::none(), Cell::none()] };
    [published_cell(average, differs), Cell::number(quantity.1(mean))]
}

fn csv_row(case: &Case<'_>, quantity: Quantity) -> Option<Vec<String>> {
    let (average, mean, differs) = case.compared(quantity)?;
    let time = case.average;
    let names = [time.table.as_str(), case.runs_table, &time.scene, &time.config, quantity.0].map(str::to_owned);
    Some(names.into_iter().chain([average.to_string(), format!("{mean:.6}"), differs.to_string()]).collect())
}
