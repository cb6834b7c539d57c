//! The values of curves as a table.

use super::{Kind, Request, Sample, Series};
use crate::report::device;
use crate::report::document::{Cell, Column, Csv, Kind as CellKind, Notes, Table, field};
use crate::report::number::{count, significant};

pub(super) fn table(request: &Request<'_>, all: &[Series<'_>]) -> Table {
    let mut notes = Notes::default();
    let counts = shared_counts(all);
    let rows = (0..points(all)).map(|i| row(request, all, i, counts.as_deref(), &mut notes)).collect();
    let mut csv = Csv::new(&["scene", "configuration", "point", "vpl_count", "value", "least", "greatest", "rows"]);
    for i in 0..points(all) {
        csv.rows.extend(all.iter().map(|series| csv_row(request, series, &series.samples[i])));
    }
    let title = request.quantity.title();
    Table {
        id: request.id.to_owned(),
        caption: format!(
            "{}: {title}; the {} where there are several runs or seeds, below it the least and the greatest.",
            request.scene.title,
            if request.quantity.is_time() { "least" } else { "mean" }
        ),
        columns: columns(all, counts.is_some()),
        names: 1,
        rows,
        notes,
        csv,
    }
}

fn points(all: &[Series<'_>]) -> usize {
    all.first().map_or(0, |series| series.samples.len())
}

/// The VPL count at each point if it is the same for every configuration: as a rule it is.
fn shared_counts(all: &[Series<'_>]) -> Option<Vec<Option<f64>>> {
    let at = |i: usize| {
        let mut counts: Vec<f64> = all.iter().filter_map(|series| Some(series.samples[i].vpls?.mean)).collect();
        counts.dedup();
        (counts.len() < 2).then(|| counts.first().copied())
    };
    (0..points(all)).map(at).collect()
}

fn columns(all: &[Series<'_>], shared: bool) -> Vec<Column> {
    let mut columns = vec![Column::new("Point")];
    if shared {
        columns.push(Column::new("VPLs"));
    }
    for series in all {
        let title = &series.configuration.title;
        if shared {
            columns.push(Column::new(title));
        } else {
            columns.extend(["VPLs", "value"].map(|column| Column::of(title, column)));
        }
    }
    columns
}

fn row(
    request: &Request<'_>,
    all: &[Series<'_>],
    i: usize,
    counts: Option<&[Option<f64>]>,
    notes: &mut Notes,
) -> Vec<Cell> {
    let number = |value: Option<f64>| value.map_or(Cell::none(), |value| Cell::number(count(value)));
    let mut cells = vec![Cell::name(all[0].samples[i].point.unwrap_or("-"))];
    cells.extend(counts.map(|counts| number(counts[i])));
    for series in all {
        let sample = &series.samples[i];
        if counts.is_none() {
            cells.push(number(sample.vpls.map(|vpls| vpls.mean)));
        }
        cells.push(value_cell(series, sample, request.quantity, notes));
    }
    cells
}

fn value_cell(series: &Series<'_>, sample: &Sample<'_>, quantity: Kind, notes: &mut Notes) -> Cell {
    let configuration = series.configuration;
    let reason = sample.found.note().or_else(|| {
        let is_reference = matches!(quantity, Kind::Metric(_)) && configuration.references.is_empty();
        is_reference.then(|| format!("{} is compared with no reference.", configuration.title))
    });
    let note = reason.map(|reason| notes.mark(reason));
    let none = || Cell::new(CellKind::Faint, sample.found.word());
    let device = if quantity.is_time() { device::mark(notes, &sample.found) } else { None };
    let cell = sample.value.map_or_else(none, |(value, spread)| Cell::within(value, spread, significant));
    cell.with_note(note).with_note(device)
}

fn csv_row(request: &Request<'_>, series: &Series<'_>, sample: &Sample<'_>) -> Vec<String> {
    let mut fields = vec![
        request.scene.name.clone(),
        series.configuration.name.clone(),
        sample.point.unwrap_or_default().to_owned(),
        field(sample.vpls.map(|vpls| vpls.mean)),
    ];
    let value = sample.value;
    let parts = [value.map(|(v, _)| v), value.map(|(_, v)| v.least), value.map(|(_, v)| v.greatest)];
    fields.extend(parts.map(field));
    fields.push(sample.found.rows().len().to_string());
    fields
}
