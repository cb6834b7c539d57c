//! Sums of published figures computed again: what does not add up in the publication.
//!
//! Two figures differ where rounding of either and of what they are computed from cannot explain it.

mod accelerations;
mod means;
mod totals;

use crate::published::PublishedTime;
use crate::report::document::{Block, Cell, Kind, Notice};
use crate::report::measured::Measured;
use crate::report::number::as_printed;

/// Room for the rounding of our own sums, relative.
const SLACK: f64 = 1e-9;

/// The three tables, or a sentence instead of each that has no row.
pub(super) fn blocks(measured: &Measured<'_>, id: &str) -> Vec<Block> {
    let published = &measured.header.published;
    if published.times.is_empty() && published.accelerations.is_empty() {
        return vec![Block::Notice(Notice::warning("There are no published figures."))];
    }
    let mut blocks = totals::blocks(measured, id);
    blocks.extend(means::blocks(measured, id));
    blocks.extend(accelerations::blocks(measured, id));
    blocks
}

/// Whether two figures lie further apart than their rounding explains.
fn differ(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() > tolerance + SLACK * a.abs().max(b.abs())
}

/// Title of a scene, or the name that the publication's data gives it.
fn scene_title(measured: &Measured<'_>, name: &str) -> String {
    measured.scene(name).map_or(name, |scene| &scene.title).to_owned()
}

/// Title of a configuration, or the name that the publication's data gives it.
fn configuration_title(measured: &Measured<'_>, name: &str) -> String {
    measured.configuration(name).map_or(name, |configuration| &configuration.title).to_owned()
}

/// Whether a row is a single run.
fn is_run(time: &PublishedTime) -> bool {
    time.run != crate::published::AVERAGE
}

/// A published figure, marked if it is contradicted.
fn published_cell(value: f64, slip: bool) -> Cell {
    Cell::new(if slip { Kind::Slip } else { Kind::Published }, as_printed(value))
}
