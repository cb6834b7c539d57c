//! Running the `lightcuts` command and reading the statistics that it writes.

use crate::experiment::Case;
use crate::place;
use anyhow::{Context as _, Result, bail};
use serde::Deserialize;
use std::path::Path;
use std::process::Command;

/// Which VPLs light a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Configuration {
    /// All of them.
    Plain,
    /// Those that the thesis' lightcuts select.
    Lightcuts,
}

impl Configuration {
    /// In the order of their numbers.
    pub(crate) const ALL: [Self; 2] = [Self::Plain, Self::Lightcuts];

    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Lightcuts => "lightcuts",
        }
    }

    /// Value of `--gather`.
    fn strategy(self) -> &'static str {
        match self {
            Self::Plain => "all",
            Self::Lightcuts => "lightcuts",
        }
    }
}

/// What counts of a `--stats` file.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub(crate) struct Measured {
    pub(crate) vpl_count: u64,
    pub(crate) light_ratio_percent: f64,
    pub(crate) total_cpu_s: f64,
}

/// Renders a scene several times in each configuration by turns, on some threads, so that a slow minute of the machine hits both;
/// returns for each configuration its counts and the median of its times.
pub(crate) fn interleaved(
    cli: &Path,
    case: &Case,
    threads: usize,
    models: &Path,
    folder: &Path,
    runs: u32,
) -> Result<[Measured; 2]> {
    let mut measured = [Vec::new(), Vec::new()];
    for run in 1..=runs {
        for configuration in Configuration::ALL {
            let title = format!("{}, {}, {threads} threads", case.title, configuration.title());
            let result = once(cli, case, configuration, threads, models, folder).with_context(|| title.clone())?;
            println!("{title}, {run}/{runs}: {:.2} CPU s", result.total_cpu_s);
            measured[configuration as usize].push(result);
        }
    }
    Ok(measured.map(|runs| {
        let first = runs[0];
        Measured { total_cpu_s: median(runs.iter().map(|run| run.total_cpu_s).collect()), ..first }
    }))
}

fn once(
    cli: &Path,
    case: &Case,
    configuration: Configuration,
    threads: usize,
    models: &Path,
    folder: &Path,
) -> Result<Measured> {
    let stats = folder.join("stats.json");
    let mut command = Command::new(cli);
    command.arg("render").arg(place::root().join("scenes/thesis").join(case.file));
    command.args(["--reproduce", "--quiet", "--gather", configuration.strategy(), "--threads", &threads.to_string()]);
    command.arg("--search-path").arg(models).arg("-o").arg(folder.join("picture.png")).arg("--stats").arg(&stats);
    let output = command.output().context("cannot run lightcuts")?;
    if !output.status.success() {
        bail!("lightcuts: {}: {}", output.status, String::from_utf8_lossy(&output.stderr).trim());
    }
    let text = std::fs::read_to_string(&stats).context("lightcuts wrote no statistics")?;
    serde_json::from_str(&text).context("the statistics lack something")
}

/// The run whose figure is the middle one, so that its other figures go with it. `runs` has an odd number.
pub(crate) fn middle<T>(mut runs: Vec<T>, figure: impl Fn(&T) -> f64) -> T {
    runs.sort_by(|a, b| figure(a).total_cmp(&figure(b)));
    runs.swap_remove(runs.len() / 2)
}

/// The middle value, or the mean of the two middle ones. `values` is not empty.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) { f64::midpoint(values[middle - 1], values[middle]) } else { values[middle] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_of_odd_and_even_numbers() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![9.0]), 9.0);
        assert_eq!(median(vec![4.0, 1.0, 3.0, 100.0]), 3.5);
    }

    #[test]
    fn the_middle_run_keeps_its_figures() {
        let runs = vec![(3.0, "slow"), (1.0, "fast"), (2.0, "middle")];
        assert_eq!(middle(runs, |run| run.0), (2.0, "middle"));
        assert_eq!(middle(vec![9.0], |&run| run), 9.0);
    }

    #[test]
    fn statistics_may_hold_more() {
        let text =
            r#"{"version": "0.1.0", "vpl_count": 290, "light_ratio_percent": 68.5, "total_cpu_s": 0.25, "rays": {}}"#;
        let expected = Measured { vpl_count: 290, light_ratio_percent: 68.5, total_cpu_s: 0.25 };
        assert_eq!(serde_json::from_str::<Measured>(text).unwrap(), expected);
    }
}
