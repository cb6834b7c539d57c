//! The governor: how much work a submission may have, so that none runs longer than the budget and no watchdog fires.
//!
//! The thesis names this as its first future work: on Windows a kernel that ran for two seconds was killed with its
//! driver. Here each stage has a cost per unit of work, learnt from every submission; the next one is sized by it.

use std::collections::BTreeMap;
use std::time::Duration;

/// Share of the budget that a submission is planned for: what is left is for work that turns out more expensive.
const PLANNED_SHARE: f64 = 0.5;
/// Cost of a unit of a stage that has not run yet, in seconds: that of a ray on a slow software driver.
const FIRST_COST: f64 = 4e-6;
/// A cost falls at most to this share of what it was before: a submission is at most twice as large as the one before.
const GREATEST_FALL: f64 = 0.5;
/// The same once a submission came near what was planned. What was cheap then says little of what comes next: camera
/// rays into the sky cost almost nothing until the next tile shows the scene.
const GREATEST_FALL_SETTLED: f64 = 0.95;
/// Share of the plan from which on a cost is settled.
const SETTLED_SHARE: f64 = 0.5;
/// Seconds of the first bin of the histogram; each bin ends at twice the one before.
const FIRST_BIN: f64 = 0.000_25;

/// A stage's name: that of its program.
pub(crate) type StageName = &'static str;

/// What costs are learnt apart for: many a mirrored or refracted ray meets nothing, so the deeper layers of ray trees
/// say nothing of the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Work {
    pub(crate) stage: StageName,
    is_deep: bool,
}

/// What a unit of some work costs.
#[derive(Debug, Clone, Copy)]
struct Cost {
    seconds: f64,
    is_settled: bool,
}

/// Learns what work costs and says how much of it fits.
#[derive(Debug, Clone)]
pub(crate) struct Governor {
    budget_s: f64,
    costs: BTreeMap<Work, Cost>,
    /// Whether the current work is in a deeper layer than the first.
    pub(crate) is_deep: bool,
    pub(crate) report: GovernorReport,
}

/// What was submitted so far.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GovernorReport {
    /// Budget of a submission in seconds.
    pub budget_s: f64,
    /// Submissions by their duration: of the bin k those that took less than 0.25 ms x 2^k, and not less than half
    /// that.
    pub histogram: Vec<u64>,
    /// Number of submissions.
    pub submissions: u64,
    /// Duration of the longest one, in seconds.
    pub longest_s: f64,
    /// The longest one that began later than a second after the first.
    pub longest_later_s: f64,
    /// Submissions beyond twice the budget that began later than a second after the first.
    pub beyond_twice_the_budget: u64,
    /// Seconds and dispatches of each program.
    pub stages: BTreeMap<&'static str, StageReport>,
    /// Seconds from the first submission to the end of the last, waits between them included.
    pub elapsed_s: f64,
}

/// What a program took.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StageReport {
    /// Sum of the durations of its dispatches, in seconds.
    pub seconds: f64,
    /// Number of its dispatches.
    pub dispatches: u64,
}

impl Governor {
    pub(crate) fn new(budget: Duration) -> Self {
        let budget_s = budget.as_secs_f64();
        let report = GovernorReport { budget_s, ..GovernorReport::default() };
        Self { budget_s, costs: BTreeMap::new(), is_deep: false, report }
    }

    /// A stage in the current layer.
    pub(crate) fn work(&self, stage: StageName) -> Work {
        Work { stage, is_deep: self.is_deep }
    }

    /// Seconds that some units of work are expected to take.
    pub(crate) fn expected(&self, work: Work, units: f64) -> f64 {
        self.cost(work).seconds * units
    }

    /// Units of a stage that a submission may hold.
    pub(crate) fn allowance(&self, stage: StageName) -> f64 {
        self.planned() / self.cost(self.work(stage)).seconds
    }

    fn cost(&self, work: Work) -> Cost {
        self.costs.get(&work).copied().unwrap_or(Cost { seconds: FIRST_COST, is_settled: false })
    }

    /// Seconds that a submission is planned for.
    pub(crate) fn planned(&self) -> f64 {
        self.budget_s * PLANNED_SHARE
    }

    /// Takes note of what a part of a submission took.
    pub(crate) fn learn(&mut self, work: Work, units: f64, seconds: f64) {
        let stages = self.report.stages.entry(work.stage).or_default();
        stages.seconds += seconds;
        stages.dispatches += 1;
        if units > 0.0 && seconds.is_finite() {
            let before = self.cost(work);
            let is_settled = before.is_settled || seconds >= self.planned() * SETTLED_SHARE;
            let fall = if is_settled { GREATEST_FALL_SETTLED } else { GREATEST_FALL };
            self.costs.insert(work, Cost { seconds: (seconds / units).max(before.seconds * fall), is_settled });
        }
    }

    /// Records a whole submission; begin and end are measured from the beginning of the first one.
    pub(crate) fn finish(&mut self, began_s: f64, seconds: f64) {
        let report = &mut self.report;
        let bin = (seconds / FIRST_BIN).max(0.5).log2().floor() as i64 + 1;
        let bin = bin.max(0) as usize;
        if report.histogram.len() <= bin {
            report.histogram.resize(bin + 1, 0);
        }
        report.histogram[bin] += 1;
        report.submissions += 1;
        report.longest_s = report.longest_s.max(seconds);
        report.elapsed_s = report.elapsed_s.max(began_s + seconds);
        if began_s > 1.0 {
            report.longest_later_s = report.longest_later_s.max(seconds);
            report.beyond_twice_the_budget += u64::from(seconds > 2.0 * self.budget_s);
        }
    }
}

impl GovernorReport {
    /// The histogram as lines of text.
    pub fn lines(&self) -> Vec<String> {
        let mut end = FIRST_BIN * 1e3;
        let mut lines = Vec::new();
        for &count in &self.histogram {
            if count > 0 {
                lines.push(format!("{:>9.2} .. {end:>9.2} ms  {count:>8}", end / 2.0));
            }
            end *= 2.0;
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs work of a given true cost per unit under a governor; returns the durations of the submissions.
    fn run(mut units: f64, cost: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut governor = Governor::new(Duration::from_millis(30));
        let (mut durations, mut done) = (Vec::new(), 0.0);
        while units > 0.0 {
            let part = governor.allowance("work").max(1.0).min(units);
            let seconds = part * cost(done);
            governor.learn(governor.work("work"), part, seconds);
            governor.finish(0.0, seconds);
            durations.push(seconds);
            units -= part;
            done += part;
        }
        durations
    }

    #[test]
    fn cheap_work_grows_to_the_planned_share() {
        let durations = run(1e9, |_| 1e-9);
        assert!(durations.len() < 90, "{}", durations.len());
        assert!(durations.iter().all(|&s| s < 0.0151));
        assert!(durations[30] > 0.014);
    }

    #[test]
    fn work_that_gets_four_times_as_expensive_stays_within_twice_the_budget() {
        let durations = run(1e6, |done| if (done as u64 / 30_000).is_multiple_of(2) { 1e-6 } else { 4e-6 });
        assert!(durations.iter().all(|&s| s <= 0.060_001), "{durations:?}");
    }

    #[test]
    fn a_while_of_cheap_work_misleads_nobody() {
        let durations = run(1e6, |done| if (done as u64 / 60_000).is_multiple_of(2) { 4e-6 } else { 1e-7 });
        let beyond = durations.iter().filter(|&&s| s > 0.060_001).count();
        assert_eq!(beyond, 0, "{durations:?}");
    }

    #[test]
    fn layers_are_learnt_apart() {
        let mut governor = Governor::new(Duration::from_millis(30));
        governor.learn(governor.work("work"), 1000.0, 0.01);
        governor.is_deep = true;
        governor.learn(governor.work("work"), 1000.0, 1e-6);
        assert!(governor.allowance("work") > 2000.0);
        governor.is_deep = false;
        assert!((governor.allowance("work") - 1500.0).abs() < 1e-6);
    }

    #[test]
    fn work_far_beyond_the_first_guess_shrinks_at_once() {
        let durations = run(100_000.0, |_| 1e-4);
        assert!(durations[1..].iter().all(|&s| s <= 0.0151), "{:?}", &durations[..4]);
    }

    #[test]
    fn durations_fall_into_bins_that_double() {
        let mut governor = Governor::new(Duration::from_millis(30));
        for seconds in [0.0, 0.000_2, 0.000_3, 0.02, 0.07] {
            governor.finish(2.0, seconds);
        }
        let report = &governor.report;
        assert_eq!((report.submissions, report.beyond_twice_the_budget), (5, 1));
        assert_eq!(report.histogram.iter().sum::<u64>(), 5);
        assert_eq!(report.histogram[0], 2);
        assert!(report.lines().last().unwrap().contains("64.00 ..    128.00"), "{:?}", report.lines());
    }
}
