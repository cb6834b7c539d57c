//! What a GPU did for a render: a part of the statistics, and lines of the log.

use lightcuts::gpu::{Fleet, GovernorReport, GpuDevice};
use serde::Serialize;
use std::collections::BTreeMap;

/// The work of a GPU, from its opening to its loss or to the end.
#[derive(Debug, Serialize)]
pub(crate) struct GpuWork {
    name: String,
    budget_s: f64,
    submissions: u64,
    longest_s: f64,
    /// Of submissions later than a second after the first: before that the governor has much to learn.
    longest_later_s: f64,
    later_beyond_twice_the_budget: u64,
    elapsed_s: f64,
    /// Numbers of submissions: first of those below 0.25 ms, then each up to twice the duration of the one before.
    histogram: Vec<u64>,
    programs: BTreeMap<&'static str, ProgramWork>,
}

/// The work of one program.
#[derive(Debug, Serialize)]
struct ProgramWork {
    seconds: f64,
    dispatches: u64,
}

impl GpuWork {
    /// All that was done, in order.
    pub(crate) fn of(fleet: &Fleet<'_>) -> Vec<Self> {
        reports(fleet).map(|(gpu, report)| Self::new(&gpu.adapter().name, report)).collect()
    }

    fn new(name: &str, report: GovernorReport) -> Self {
        let programs = report.stages.into_iter();
        let programs =
            programs.map(|(name, it)| (name, ProgramWork { seconds: it.seconds, dispatches: it.dispatches }));
        Self {
            name: name.to_owned(),
            budget_s: report.budget_s,
            submissions: report.submissions,
            longest_s: report.longest_s,
            longest_later_s: report.longest_later_s,
            later_beyond_twice_the_budget: report.beyond_twice_the_budget,
            elapsed_s: report.elapsed_s,
            histogram: report.histogram,
            programs: programs.collect(),
        }
    }
}

/// Logs the submissions of every GPU.
pub(crate) fn log(fleet: &Fleet<'_>) {
    for (gpu, report) in reports(fleet) {
        tracing::info!(
            "{}: {} submissions within {:.2} s, the longest {:.1} ms, the budget {:.0} ms",
            gpu.adapter().name,
            report.submissions,
            report.elapsed_s,
            report.longest_s * 1e3,
            report.budget_s * 1e3
        );
        report.lines().iter().for_each(|line| tracing::info!("{line}"));
    }
}

fn reports<'f>(fleet: &'f Fleet<'_>) -> impl Iterator<Item = (&'f GpuDevice<'f>, GovernorReport)> {
    fleet.gpus().flat_map(|gpu| gpu.reports().into_iter().map(move |report| (gpu, report)))
}
