//! Where the figures come from, and what of that limits them.

use super::document::Notice;
use super::measured::Measured;
use crate::record::{DeviceInfo, Row};
use std::collections::BTreeSet;

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
        ("Device", joined(&distinct(rows, |row| device(&row.device)))),
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

/// What a reader must know before all else.
pub(super) fn notices(measured: &Measured<'_>) -> Vec<Notice> {
    let (header, rows) = (measured.header, measured.rows());
    let mut notices = Vec::new();
    let several = [
        ("revisions of the program", distinct(rows, |row| row.revision.clone())),
        ("versions of the program", distinct(rows, |row| row.version.clone())),
        ("devices", distinct(rows, |row| device(&row.device))),
    ];
    let mixed: Vec<String> = several
        .into_iter()
        .filter(|(_, names)| names.len() > 1)
        .map(|(what, names)| format!("{} {what}: {}.", names.len(), joined(&names)))
        .collect();
    if !mixed.is_empty() {
        let text = "The rows do not come from one place. Times of different ones cannot be compared with each other:";
        notices.push(Notice::warning(text).with_items(mixed));
    }
    if distinct(rows, |row| row.revision.clone()).iter().any(|revision| revision.ends_with("-dirty")) {
        let text = "Some rows come from a program that was built from changed sources: its revision does not tell all.";
        notices.push(Notice::warning(text));
    }
    if rows.len() < header.jobs.len() {
        let text = format!(
            "{} of {} planned renders are not done yet; lightcuts experiment goes on where it stopped.",
            header.jobs.len() - rows.len(),
            header.jobs.len()
        );
        notices.push(Notice::warning(text));
    }
    notices
}

/// `2026-11-22 21:21` of `2026-11-22T21:21:32Z`.
fn minute(date: &str) -> String {
    date.get(..16).unwrap_or(date).replacen('T', " ", 1)
}

fn device(device: &DeviceInfo) -> String {
    let threads = match device.threads {
        0 => String::new(),
        1 => ", 1 thread".to_owned(),
        threads => format!(", {threads} threads"),
    };
    format!("{} ({}{threads})", device.name, device.kind.to_uppercase())
}

/// What the rows say, each once, in order.
fn distinct(rows: &[&Row], said: impl Fn(&Row) -> String) -> Vec<String> {
    rows.iter().map(|row| said(row)).collect::<BTreeSet<_>>().into_iter().collect()
}

fn joined(names: &[String]) -> String {
    if names.is_empty() { "-".to_owned() } else { names.join("; ") }
}
