//! Tables of errors, and targets.

use super::Scene;
use super::case::Case;
use super::cornell::{PEERS, PEERS_SECONDS};
use crate::table::Table;
use crate::table::verdict;
use std::fmt::Write as _;

/// How much lower the error of lightcuts is to be than that of path tracing in the occluded box, after [`OCCLUDED_S`].
const LEAST_GAIN: f64 = 5.0;
const OCCLUDED_S: f64 = 3.0;
/// How much higher the error of `auto` may be than that of the better one.
const MOST_REGRET: f64 = 1.3;
/// Times at which no other renderer may be better in the Cornell box.
const CORNELL_S: [f64; 2] = [3.0, 10.0];

pub(super) const REMARKS: &str = "
relMSE: mean of e^2 / (ref^2 + 0.01) over pixels and channels, less that of the reference itself. Seconds are CPU seconds over
two threads; what a render worked more or less is made up for by 1 / time.
";

/// Errors of an integrator, one for each time.
pub(super) struct Measured {
    pub(super) name: &'static str,
    pub(super) errors: Vec<f64>,
}

/// The table of a scene with what it was to show.
pub(super) fn section(case: &Case, seconds: &[f64], rows: &[Measured]) -> String {
    let (noise, size) = (case.reference.noise, case.size);
    let mut text = format!("\n### {}, {size} x {size}\n\nThe reference's own relMSE is {noise:.1e}.\n\n", case.title);
    text += &table(case.scene, seconds, rows);
    let lines = targets(case.scene, seconds, rows);
    if !lines.is_empty() {
        let _ = write!(text, "\n{}\n", lines.join("\n"));
    }
    text
}

fn table(scene: Scene, seconds: &[f64], rows: &[Measured]) -> String {
    let titles: Vec<String> = seconds.iter().map(|seconds| format!("{seconds} s")).collect();
    let header: Vec<&str> = std::iter::once("renderer").chain(titles.iter().map(String::as_str)).collect();
    let mut table = Table::new(&header);
    let show = |error: f64| format!("{error:.2e}");
    for row in rows {
        table.push(std::iter::once(row.name.to_owned()).chain(row.errors.iter().map(|&error| show(error))));
    }
    if scene == Scene::Cornell {
        for (name, _) in PEERS {
            let errors = seconds.iter().map(|&seconds| peer(name, seconds).map_or_else(|| "-".to_owned(), show));
            table.push(std::iter::once(name.to_owned()).chain(errors));
        }
    }
    table.markdown()
}

/// What another renderer's error is after some time.
fn peer(name: &str, seconds: f64) -> Option<f64> {
    let (_, errors) = PEERS.iter().find(|(peer, _)| *peer == name)?;
    errors[PEERS_SECONDS.iter().position(|&of| of == seconds)?]
}

fn targets(scene: Scene, seconds: &[f64], rows: &[Measured]) -> Vec<String> {
    let error = |name: &str, at: f64| {
        let row = rows.iter().find(|row| row.name == name)?;
        Some(row.errors[seconds.iter().position(|&of| of == at)?])
    };
    let mut lines = Vec::new();
    if scene == Scene::Occluded
        && let (Some(path), Some(lightcuts)) = (error("path", OCCLUDED_S), error("lightcuts", OCCLUDED_S))
    {
        let gain = path / lightcuts;
        let met = verdict(gain >= LEAST_GAIN);
        lines.push(format!(
            "* lightcuts at {OCCLUDED_S} s: {gain:.1} times less than path, at least {LEAST_GAIN}: {met}"
        ));
    }
    for &at in seconds {
        let better = ["path", "lightcuts"].iter().filter_map(|name| error(name, at)).reduce(f64::min);
        if let (Some(auto), Some(better)) = (error("auto", at), better) {
            let regret = auto / better;
            let met = verdict(regret <= MOST_REGRET);
            lines.push(format!("* auto at {at} s: {regret:.2} of the better one, at most {MOST_REGRET}: {met}"));
        }
    }
    for at in CORNELL_S.into_iter().filter(|_| scene == Scene::Cornell) {
        let ours = rows.iter().filter_map(|row| error(row.name, at)).reduce(f64::min);
        let theirs = PEERS.iter().filter_map(|(name, _)| peer(name, at)).reduce(f64::min);
        if let (Some(ours), Some(theirs)) = (ours, theirs) {
            let (share, met) = (ours / theirs, verdict(ours <= theirs));
            lines.push(format!("* ours at {at} s: {share:.2} of the best of the others, at most 1: {met}"));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_met_or_missed() {
        let row = |name, errors: [f64; 2]| Measured { name, errors: errors.to_vec() };
        let rows = [row("path", [0.6, 0.2]), row("lightcuts", [0.1, 0.05]), row("auto", [0.12, 0.1])];
        let verdicts = |scene| -> Vec<String> {
            let lines = targets(scene, &[3.0, 10.0], &rows);
            lines.iter().map(|line| line.rsplit(": ").next().unwrap_or_default().to_owned()).collect()
        };
        assert_eq!(verdicts(Scene::Occluded), ["met", "met", "missed"]);
        assert_eq!(verdicts(Scene::Cornell), ["met", "missed", "missed", "missed"]);
        assert!(table(Scene::Cornell, &[3.0, 7.0], &rows).contains("| 1.34e-2 | -"));
    }
}
