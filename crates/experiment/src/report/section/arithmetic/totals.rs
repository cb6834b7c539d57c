//! First pass + second pass against the published total.

use super::{configuration_title, differ, published_cell, scene_title};
use crate::published::PublishedTime;
use crate::report::document::{Block, Cell, Column, Csv, Notes, Notice, Table};
use crate::report::measured::Measured;
use crate::report::number::{fixed, rounding};

/// A total that is not the sum of its parts.
struct Slip<'a> {
    time: &'a PublishedTime,
    sum: f64,
}

/// How many there are, and which.
pub(super) fn blocks(measured: &Measured<'_>, id: &str) -> Vec<Block> {
    let times = &measured.header.published.times;
    let slips: Vec<Slip<'_>> = times.iter().filter_map(slip).collect();
    let all = times.len();
    if slips.is_empty() {
        return vec![Block::Notice(Notice::finding(format!(
            "All {all} published totals are the sums of their passes."
        )))];
    }
    let excess = slips.iter().map(|slip| (slip.time.total_s - slip.sum).abs()).fold(0.0, f64::max);
    let text = format!(
        "{} of {all} published totals differ from the sum of their passes by more than rounding explains, by {} s at most.",
        slips.len(),
        fixed(excess, 3)
    );
    vec![Block::Notice(Notice::finding(text)), Block::Table(table(measured, id, &slips))]
}

fn slip(time: &PublishedTime) -> Option<Slip<'_>> {
    let sum = time.first_pass_s + time.second_pass_s;
    let tolerance = [time.first_pass_s, time.second_pass_s, time.total_s].map(rounding).iter().sum();
    differ(time.total_s, sum, tolerance).then_some(Slip { time, sum })
}

fn table(measured: &Measured<'_>, id: &str, slips: &[Slip<'_>]) -> Table {
    let mut csv = Csv::new(&["table", "scene", "configuration", "run", "total_s", "sum_of_passes_s"]);
    let mut rows = Vec::new();
    for Slip { time, sum } in slips {
        let (total, sum_text) = (time.total_s.to_string(), fixed(*sum, 3));
        rows.push(vec![
            Cell::name(&time.table),
            Cell::name(scene_title(measured, &time.scene)),
            Cell::name(configuration_title(measured, &time.config)),
            Cell::name(&time.run),
            published_cell(time.total_s, true),
            Cell::number(&sum_text),
            Cell::number(fixed(time.total_s - sum, 3)),
        ]);
        let names = [&time.table, &time.scene, &time.config, &time.run].map(String::clone);
        csv.rows.push(names.into_iter().chain([total, format!("{sum:.6}")]).collect());
    }
    let titles =
        ["Table", "Scene", "Configuration", "Run", "Published total, s", "Sum of its passes, s", "Difference, s"];
    Table {
        id: format!("{id}-totals"),
        caption: "Published totals that are not the sums of their passes.".to_owned(),
        columns: titles.map(Column::new).to_vec(),
        names: 4,
        rows,
        notes: Notes::default(),
        csv,
    }
}
