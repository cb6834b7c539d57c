//! How pictures differ from their references: the verdict of Perceptual Image Diff and other metrics.

use super::listed;
use crate::record::{ConfigurationInfo, Row, SceneInfo};
use crate::report::document::{Block, Cell, Column, Csv, Kind, Notes, Notice, Table, field};
use crate::report::measured::{Found, Measured, Spread, stand_in_note};
use crate::report::number::{count, significant};
use lightcuts::image::metrics::Metric;

/// What a section asks for.
pub(super) struct Request<'a> {
    pub(super) id: &'a str,
    pub(super) configurations: Vec<&'a ConfigurationInfo>,
    pub(super) metrics: Vec<Metric>,
    /// Scenes for which the publication says `Pass`.
    pub(super) published_pass: Vec<&'a SceneInfo>,
}

/// A configuration against one of its references in a scene, at a point.
struct Case<'a> {
    scene: &'a SceneInfo,
    configuration: &'a ConfigurationInfo,
    reference: &'a ConfigurationInfo,
    point: Option<&'a str>,
    found: Found<'a>,
}

impl Case<'_> {
    /// A metric over the rows that have it.
    fn metric(&self, metric: Metric) -> Option<Spread> {
        Spread::of(self.found.rows().iter().filter_map(|row| value(row, &self.reference.name, metric)))
    }

    /// Whether every picture passes; `None` where none was judged.
    fn passes(&self) -> Option<bool> {
        Some(self.metric(Metric::PdiffPass)?.least >= 1.0)
    }

    /// In place of a value.
    fn word(&self, metric: Metric) -> &'static str {
        let measured = |row: &&Row| {
            let comparison = row.comparisons.get(&self.reference.name);
            comparison.is_some_and(|comparison| comparison.metrics.contains_key(metric.key()))
        };
        match (&self.found, metric) {
            // JSON has no number for the infinity of equal pictures.
            (Found::Rows(rows), Metric::Psnr) if rows.iter().any(measured) => "infinite",
            (Found::Rows(_), _) => "none",
            (found, _) => found.word(),
        }
    }

    fn title(&self) -> String {
        let point = self.point.map_or(String::new(), |point| format!(" at {point}"));
        format!("{}, {}{point} against {}", self.scene.title, self.configuration.title, self.reference.title)
    }
}

/// A metric of a row against a reference.
pub(super) fn value(row: &Row, reference: &str, metric: Metric) -> Option<f64> {
    row.comparisons.get(reference)?.metrics.get(metric.key()).copied().flatten()
}

/// What the publication claims and what was found, then the table.
pub(super) fn blocks(measured: &Measured<'_>, request: &Request<'_>) -> Result<Vec<Block>, String> {
    let cases = cases(measured, request)?;
    let mut notes = Notes::default();
    let columns = columns(request);
    let rows = cases.iter().map(|case| row(case, request, &mut notes)).collect();
    let table = Table {
        id: request.id.to_owned(),
        caption: "Each picture against its references. Perceptual Image Diff passes where fewer pixels than its \
                  threshold differ visibly."
            .to_owned(),
        names: 3,
        columns,
        rows,
        notes,
        csv: csv(&cases, request),
    };
    Ok(claim(&cases, request).into_iter().map(Block::Notice).chain([Block::Table(table)]).collect())
}

fn cases<'a>(measured: &Measured<'a>, request: &Request<'a>) -> Result<Vec<Case<'a>>, String> {
    let mut cases = Vec::new();
    for scene in &measured.header.scenes {
        for &configuration in &request.configurations {
            for reference in &configuration.references {
                let reference = measured.configuration(reference)?;
                for point in measured.points(scene) {
                    let found = measured.find(scene, configuration, point);
                    if found == Found::Unplanned {
                        continue;
                    }
                    cases.push(Case { scene, configuration, reference, point, found });
                }
            }
        }
    }
    Ok(cases)
}

/// Says plainly where the publication's `Pass` does not hold, and where it does.
fn claim(cases: &[Case<'_>], request: &Request<'_>) -> Option<Notice> {
    let scenes: Vec<&str> = request.published_pass.iter().map(|scene| scene.title.as_str()).collect();
    if scenes.is_empty() {
        return None;
    }
    let claimed: Vec<&Case<'_>> = cases.iter().filter(|case| request.published_pass.contains(&case.scene)).collect();
    let judged = claimed.iter().filter(|case| case.passes().is_some()).count();
    let failed: Vec<String> =
        claimed.iter().filter(|case| case.passes() == Some(false)).map(|case| failure(case)).collect();
    let says = format!("The publication says Pass for {}.", listed(&scenes));
    Some(match (failed.len(), judged) {
        (_, 0) => Notice::warning(format!("{says} No picture was judged here yet.")),
        (0, _) => {
            Notice::finding(format!("{says} Here the verdict is PASS as well, in {judged} of {judged} comparisons."))
        }
        (failures, _) => {
            let text =
                format!("{says} That is not what comes out here: in {failures} of {judged} comparisons ours is FAIL.");
            Notice::warning(text).with_items(failed)
        }
    })
}

fn failure(case: &Case<'_>) -> String {
    let pixels = case
        .metric(Metric::PdiffPx)
        .map_or(String::new(), |pixels| format!(", {} differing pixels", count(pixels.mean)));
    let stand_in = if case.scene.stand_in.is_some() { " (a stand-in)" } else { "" };
    format!("{}{stand_in}: FAIL{pixels}.", case.title())
}

fn columns(request: &Request<'_>) -> Vec<Column> {
    let mut columns = ["Scene", "Configuration", "Reference"].map(Column::new).to_vec();
    for metric in displayed(request) {
        let unit = if metric.unit().is_empty() { String::new() } else { format!(", {}", metric.unit()) };
        columns.push(Column::new(format!("{}{unit}", metric.title())));
    }
    if !request.published_pass.is_empty() {
        columns.push(Column::new("Published verdict"));
    }
    columns
}

/// The columns: pixel count and verdict of Perceptual Image Diff share one, named by the count.
fn displayed(request: &Request<'_>) -> Vec<Metric> {
    let mut metrics: Vec<Metric> = Vec::new();
    for metric in &request.metrics {
        let metric = if *metric == Metric::PdiffPass { Metric::PdiffPx } else { *metric };
        if !metrics.contains(&metric) {
            metrics.push(metric);
        }
    }
    metrics
}

fn row(case: &Case<'_>, request: &Request<'_>, notes: &mut Notes) -> Vec<Cell> {
    let point = case.point.map_or(String::new(), |point| format!(", {point}"));
    let reason = case.found.note();
    let mut cells = vec![
        Cell::name(&case.scene.title).with_note(stand_in_note(case.scene).map(|text| notes.mark(text))),
        Cell::name(format!("{}{point}", case.configuration.title)).with_note(reason.map(|text| notes.mark(text))),
        Cell::name(&case.reference.title),
    ];
    for metric in displayed(request) {
        cells.push(match case.metric(metric) {
            None => Cell::new(Kind::Faint, case.word(metric)),
            Some(pixels) if metric == Metric::PdiffPx => verdict(case, pixels),
            Some(spread) if metric.unit() == "px" => Cell::mean(spread, count),
            Some(spread) => Cell::mean(spread, significant),
        });
    }
    if !request.published_pass.is_empty() {
        let says_pass = request.published_pass.contains(&case.scene);
        cells.push(if says_pass { Cell::new(Kind::Published, "Pass") } else { Cell::none() });
    }
    cells
}

fn verdict(case: &Case<'_>, pixels: Spread) -> Cell {
    let size = case.found.rows().first().map_or(0.0, |row| row.width as f64 * row.height as f64);
    let share = format!("{} %", significant(100.0 * pixels.mean / size));
    let (kind, word) = match case.passes() {
        Some(true) => (Kind::Pass, "PASS"),
        Some(false) => (Kind::Fail, "FAIL"),
        None => return Cell::number(count(pixels.mean)).with_detail(Some(share)),
    };
    Cell::new(kind, word).with_detail(Some(format!("{} px, {share}", count(pixels.mean))))
}

/// With both values of Perceptual Image Diff if one is asked for.
fn csv_metrics(request: &Request<'_>) -> Vec<Metric> {
    let both = [Metric::PdiffPx, Metric::PdiffPass];
    let metrics = displayed(request).into_iter();
    metrics.flat_map(|metric| if metric == both[0] { both.to_vec() } else { vec![metric] }).collect()
}

fn csv(cases: &[Case<'_>], request: &Request<'_>) -> Csv {
    let mut head = vec!["scene", "stand_in", "configuration", "reference", "point", "rows"];
    let metrics = csv_metrics(request);
    head.extend(metrics.iter().map(|metric| metric.key()));
    head.push("published_verdict");
    let mut csv = Csv::new(&head);
    for case in cases {
        let mut fields = vec![
            case.scene.name.clone(),
            case.scene.stand_in.is_some().to_string(),
            case.configuration.name.clone(),
            case.reference.name.clone(),
            case.point.unwrap_or_default().to_owned(),
            case.found.rows().len().to_string(),
        ];
        fields.extend(metrics.iter().map(|metric| field(case.metric(*metric).map(|spread| spread.mean))));
        let says_pass = request.published_pass.contains(&case.scene);
        fields.push(if says_pass { "Pass".to_owned() } else { String::new() });
        csv.rows.push(fields);
    }
    csv
}
