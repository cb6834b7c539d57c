//! What devices did while something was measured.

use lightcuts::gpu::{GovernorReport, GpuDevice, StageReport};
use std::collections::BTreeMap;

/// Seconds and dispatches of programs, by their names.
pub(super) type Stages = BTreeMap<&'static str, StageReport>;

/// Everything that was done so far.
#[derive(Debug, Default)]
pub(super) struct Log {
    /// From the opening of each device on.
    pub(super) works: Vec<Work>,
    /// Single renders, by what was rendered.
    pub(super) renders: Vec<(String, Stages)>,
}

/// What a device did from its opening on.
#[derive(Debug, Clone)]
pub(super) struct Work {
    pub(super) title: String,
    pub(super) report: GovernorReport,
    /// Bytes that were allocated at the end.
    pub(super) bytes: u64,
}

impl Work {
    pub(super) fn new(title: String, gpu: &GpuDevice<'_>) -> Self {
        Self { title, report: merged(&gpu.reports()), bytes: gpu.allocated_bytes() }
    }
}

/// Several reports as one; times are added up.
pub(super) fn merged<'r>(reports: impl IntoIterator<Item = &'r GovernorReport>) -> GovernorReport {
    let mut sum = GovernorReport::default();
    for report in reports {
        sum.budget_s = report.budget_s;
        sum.histogram.resize(sum.histogram.len().max(report.histogram.len()), 0);
        sum.histogram.iter_mut().zip(&report.histogram).for_each(|(sum, count)| *sum += count);
        sum.submissions += report.submissions;
        sum.longest_s = sum.longest_s.max(report.longest_s);
        sum.longest_later_s = sum.longest_later_s.max(report.longest_later_s);
        sum.beyond_twice_the_budget += report.beyond_twice_the_budget;
        sum.elapsed_s += report.elapsed_s;
        for (name, of) in &report.stages {
            let stage = sum.stages.entry(name).or_default();
            stage.seconds += of.seconds;
            stage.dispatches += of.dispatches;
        }
    }
    sum
}

/// What programs did between two reports of a device.
pub(super) fn since(before: &GovernorReport, after: &GovernorReport) -> Stages {
    let done = after.stages.iter().map(|(&name, now)| {
        let then = before.stages.get(name).copied().unwrap_or_default();
        let dispatches = now.dispatches - then.dispatches;
        (name, StageReport { seconds: now.seconds - then.seconds, dispatches })
    });
    done.filter(|(_, stage)| stage.dispatches > 0).collect()
}

/// Seconds of some programs together.
pub(super) fn seconds(stages: &Stages, names: &[&str]) -> f64 {
    names.iter().filter_map(|&name| stages.get(name)).map(|stage| stage.seconds).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(seconds: f64, dispatches: u64, histogram: &[u64]) -> GovernorReport {
        let stages = BTreeMap::from([("trace", StageReport { seconds, dispatches })]);
        GovernorReport { histogram: histogram.to_vec(), longest_s: seconds, stages, ..GovernorReport::default() }
    }

    #[test]
    fn reports_are_merged() {
        let sum = merged(&[report(1.0, 2, &[1]), report(2.0, 3, &[0, 4])]);
        assert_eq!((sum.histogram, sum.longest_s), (vec![1, 4], 2.0));
        assert_eq!(sum.stages["trace"], StageReport { seconds: 3.0, dispatches: 5 });
    }

    #[test]
    fn only_what_was_done_since_counts() {
        let (before, mut after) = (report(1.0, 2, &[]), report(1.5, 4, &[]));
        after.stages.insert("start", StageReport { seconds: 0.25, dispatches: 1 });
        let stages = since(&before, &after);
        assert_eq!(stages["trace"], StageReport { seconds: 0.5, dispatches: 2 });
        assert_eq!(seconds(&stages, &["trace", "start", "film"]), 0.75);
        assert!(since(&after, &after).is_empty());
    }
}
