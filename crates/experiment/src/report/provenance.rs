//! Where the figures come from, and what of that limits them.

use super::device;
use super::document::Notice;
use super::measured::Measured;
use crate::record::Row;
use std::collections::{BTreeMap, BTreeSet};

/// Terms with their texts, in the order of the page.
pub(super) fn terms(measured: &Measured<'_>) -> Vec<(String, String)> {
    let header = measured.header;
    let rows = measured.rows();
    let finished = distinct(rows, |row| minute(&row.finished));
    let dates = match finished.as_slice() {
        [] => "nothing yet".to_owned(),
        [only] => format!("{only} UTC"),
        [first, .., last] => format!("{first} to {last} UTC"),
    };
    let seeds: Vec<String> = header.seeds.iter().map(u32::to_string).collect();
    let mut terms = vec![
        ("Experiment", header.name.clone()),
        ("Rendered", dates),
        ("Device", joined(&distinct(rows, |row| device::named(&row.device)))),
        ("Program", joined(&distinct(rows, |row| format!("lightcuts {}", row.version)))),
        ("Revision", joined(&distinct(rows, |row| row.revision.clone()))),
        ("Renders", format!("{} of {} planned", rows.len(), header.jobs.len())),
        ("Runs of each", header.runs.to_string()),
        ("Seeds", joined(&seeds)),
    ];
    if !header.published.source.is_empty() {
        terms.push(("Published figures", header.published.source.clone()));
    }
    terms.into_iter().map(|(term, text)| (term.to_owned(), text)).collect()
}

/// Notes that stand at the top of the report.
pub(super) fn notices(measured: &Measured<'_>) -> Vec<Notice> {
    let all = [mixed(measured), software(measured), faulty(measured), changed(measured), unfinished(measured)];
    all.into_iter().flatten().collect()
}

/// Rows of several programs or machines.
fn mixed(measured: &Measured<'_>) -> Option<Notice> {
    let rows = measured.rows();
    let mut several = vec![
        ("revisions of the program", distinct(rows, |row| row.revision.clone())),
        ("versions of the program", distinct(rows, |row| row.version.clone())),
    ];
    several.extend(devices(rows).into_values().map(|names| ("devices", names.into_iter().collect())));
    let mixed: BTreeSet<String> = several
        .into_iter()
        .filter(|(_, names)| names.len() > 1)
        .map(|(what, names)| format!("{} {what}: {}.", names.len(), joined(&names)))
        .collect();
    let text = "The rows do not come from one place. Times of different ones cannot be compared with each other:";
    (!mixed.is_empty()).then(|| Notice::warning(text).with_items(mixed.into_iter().collect()))
}

/// The devices of which there is one if all is well: the CPU for all its configurations, a GPU for each of its own,
/// which may ask for different ones.
fn devices<'a>(rows: &[&'a Row]) -> BTreeMap<Option<&'a str>, BTreeSet<String>> {
    let mut devices: BTreeMap<_, BTreeSet<String>> = BTreeMap::new();
    for row in rows {
        let group = (!device::is_cpu(&row.device)).then_some(row.configuration.as_str());
        devices.entry(group).or_default().insert(device::named(&row.device));
    }
    devices
}

/// A GPU that is none.
fn software(measured: &Measured<'_>) -> Option<Notice> {
    let mut rows = measured.rows().iter();
    let row = rows.find(|row| device::is_software(&row.device))?;
    let text = format!(
        "{} rendered as a GPU. {} Its pictures and counts tell that the GPU's programs are right; its times tell nothing \
         of GPUs.",
        row.device.name,
        device::SLOW
    );
    Some(Notice::warning(text))
}

/// Times with work in them that was done twice, or by another device.
fn faulty(measured: &Measured<'_>) -> Option<Notice> {
    let rows = measured.rows().iter().filter(|row| row.stats.device_faults > 0);
    let items: Vec<String> = rows
        .map(|row| format!("{}, {}, run {}: {}.", row.scene, row.configuration, row.run, device::named(&row.device)))
        .collect();
    let text = "In these renders the device did not return all its results. They were computed again, in part by the \
                CPU, so their times are not the device's:";
    (!items.is_empty()).then(|| Notice::warning(text).with_items(items))
}

/// Rows of a program without a known revision.
fn changed(measured: &Measured<'_>) -> Option<Notice> {
    let text = "Some rows come from a program that was built from changed sources: its revision does not tell all.";
    let is_dirty = measured.rows().iter().any(|row| row.revision.ends_with("-dirty"));
    is_dirty.then(|| Notice::warning(text))
}

/// What is still to be rendered.
fn unfinished(measured: &Measured<'_>) -> Option<Notice> {
    let (done, planned) = (measured.rows().len(), measured.header.jobs.len());
    let text = format!(
        "{} of {planned} planned renders are not done yet; lightcuts experiment continues where it stopped.",
        planned.saturating_sub(done)
    );
    (done < planned).then(|| Notice::warning(text))
}

/// `2026-11-22 21:21` of `2026-11-22T21:21:32Z`.
fn minute(date: &str) -> String {
    date.get(..16).unwrap_or(date).replacen('T', " ", 1)
}

/// What the rows say, each once, in order.
fn distinct(rows: &[&Row], said: impl Fn(&Row) -> String) -> Vec<String> {
    rows.iter().map(|row| said(row)).collect::<BTreeSet<_>>().into_iter().collect()
}

fn joined(names: &[String]) -> String {
    if names.is_empty() { "-".to_owned() } else { names.join("; ") }
}
