//! The rows of the thesis' experiment.

use crate::experiment::Case;
use crate::measure::{Configuration, Measured};
use crate::table::{Table, verdict};

/// Most CPU seconds of lightcuts relative to plain: choosing must not cost more than a tenth of what it chooses among.
const MAX_LIGHTCUTS_RATIO: f64 = 1.10;

const HEADER: [&str; 10] = [
    "scene",
    "configuration",
    "threads",
    "VPLs",
    "light ratio",
    "CPU s",
    "original CPU s",
    "factor",
    "target",
    "lightcuts / plain",
];

/// One line of the table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    cells: [String; HEADER.len()],
}

impl Row {
    /// `plain_cpu_s` is what the plain configuration took, where this one is to be compared with it.
    pub(crate) fn new(
        case: &Case,
        configuration: Configuration,
        threads: usize,
        measured: Measured,
        plain_cpu_s: Option<f64>,
    ) -> Self {
        let absent = || "-".to_owned();
        let (original, factor, target) = match case.reference {
            None => (absent(), absent(), absent()),
            Some(reference) => {
                let original = reference.original_cpu_s[configuration as usize];
                let factor = original / measured.total_cpu_s;
                let target = reference.target_factor;
                let verdict = verdict(factor >= target);
                (format!("{original:.1}"), format!("{factor:.1}"), format!("{target:.0} {verdict}"))
            }
        };
        let ratio = plain_cpu_s.map_or_else(absent, |plain| {
            let ratio = measured.total_cpu_s / plain;
            format!("{ratio:.2}, at most {MAX_LIGHTCUTS_RATIO:.2} {}", verdict(ratio <= MAX_LIGHTCUTS_RATIO))
        });
        let cells = [
            case.title.clone(),
            configuration.title().to_owned(),
            threads.to_string(),
            measured.vpl_count.to_string(),
            format!("{:.4} %", measured.light_ratio_percent),
            format!("{:.2}", measured.total_cpu_s),
            original,
            factor,
            target,
            ratio,
        ];
        Self { cells }
    }
}

/// The table of all rows.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let mut table = Table::new(&HEADER);
    for row in rows {
        table.push(row.cells.clone());
    }
    table.markdown()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Scene;
    use std::path::Path;

    fn measured(total_cpu_s: f64) -> Measured {
        Measured { vpl_count: 290, light_ratio_percent: 68.31304, total_cpu_s }
    }

    fn case(scene: Scene) -> Case {
        Case::new(scene, Path::new("no such folder"))
    }

    #[test]
    fn targets_are_met_or_missed() {
        let row =
            |seconds: f64| Row::new(&case(Scene::Simple), Configuration::Lightcuts, 2, measured(seconds), Some(0.64));
        let met = row(0.7).cells;
        let expected = [
            "Simple",
            "lightcuts",
            "2",
            "290",
            "68.3130 %",
            "0.70",
            "14.7",
            "21.0",
            "20 met",
            "1.09, at most 1.10 met",
        ];
        assert_eq!(met, expected);
        let missed = row(1.0).cells;
        assert_eq!(missed[7..], ["14.7", "20 missed", "1.56, at most 1.10 missed"]);
    }

    #[test]
    fn stand_ins_have_no_factor() {
        let row = Row::new(&case(Scene::Venus), Configuration::Plain, 1, measured(1.0), None);
        assert_eq!(row.cells[0], "Venus (stand-in)");
        assert_eq!(row.cells[6..], ["-", "-", "-", "-"]);
    }
}
