//! Section 5: what programs took, and how long submissions were.

use super::log::{Log, Stages, Work, merged};
use super::setup::Setup;
use crate::format::{block, grouped, mebibytes, milliseconds, seconds};
use crate::table::Table;
use anyhow::Result;
use lightcuts::gpu::{GovernorReport, StageReport};
use std::collections::BTreeSet;

const HEADER: [&str; 7] = [
    "work",
    "submissions",
    "within, s",
    "longest, ms",
    "longest later, ms",
    "beyond twice the budget",
    "bytes on the device",
];

#[expect(clippy::unnecessary_wraps, reason = "all sections have one type")]
pub(super) fn section(_: &Setup, log: &mut Log) -> Result<String> {
    let all = merged(log.works.iter().map(|work| &work.report));
    Ok(format!(
        "{}
`Later` and `beyond` are of submissions that began later than a second after the first: before that the governor has much
to learn. The time includes waits between submissions, the bytes are those at the end.

{}
The durations of all those submissions:

{}
Seconds and dispatches of programs in one render each, the last with a million VPLs:

{}",
        of_works(&log.works),
        verdict(&all),
        block(&all.lines()),
        of_renders(&log.renders),
    ))
}

/// A row per device that was opened.
pub(super) fn of_works(works: &[Work]) -> String {
    let mut table = Table::new(&HEADER);
    for Work { title, report, bytes } in works {
        table.push([
            title.clone(),
            grouped(report.submissions),
            format!("{:.2}", report.elapsed_s),
            milliseconds(report.longest_s),
            milliseconds(report.longest_later_s),
            report.beyond_twice_the_budget.to_string(),
            mebibytes(*bytes),
        ]);
    }
    table.markdown()
}

/// A row per program, a column per render.
fn of_renders(renders: &[(String, Stages)]) -> String {
    let header: Vec<&str> = std::iter::once("program").chain(renders.iter().map(|(title, _)| title.as_str())).collect();
    let programs: BTreeSet<&str> = renders.iter().flat_map(|(_, stages)| stages.keys().copied()).collect();
    let mut table = Table::new(&header);
    let cell = |stage: Option<&StageReport>| {
        stage.map_or_else(|| "-".to_owned(), |stage| format!("{} ({})", seconds(stage.seconds), stage.dispatches))
    };
    for program in programs {
        let cells = renders.iter().map(|(_, stages)| cell(stages.get(program)));
        table.push(std::iter::once(program.to_owned()).chain(cells));
    }
    table.markdown()
}

/// Whether the governor kept its promise, in words.
pub(super) fn verdict(report: &GovernorReport) -> String {
    let GovernorReport { budget_s, submissions, longest_later_s, beyond_twice_the_budget: beyond, .. } = *report;
    let limit = format!("twice the budget ({} ms)", milliseconds(2.0 * budget_s));
    let longest = format!("the longest took {} ms", milliseconds(longest_later_s));
    if submissions == 0 || longest_later_s == 0.0 {
        return format!("No submission began later than a second after the first, so none counts against {limit}.\n");
    }
    let of = format!("Of {} submissions", grouped(submissions));
    match beyond {
        0 => format!("{of} none after the first second took longer than {limit}; {longest}.\n"),
        _ => format!("**Missed:** {of} {beyond} after the first second took longer than {limit}; {longest}.\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verdict_is_in_words() {
        let mut report = GovernorReport { budget_s: 0.03, ..GovernorReport::default() };
        assert!(verdict(&report).starts_with("No submission began later"), "{}", verdict(&report));
        (report.submissions, report.longest_later_s) = (1_500, 0.0452);
        let kept = "Of 1 500 submissions none after the first second took longer than twice the budget (60.0 ms); ";
        assert_eq!(verdict(&report), format!("{kept}the longest took 45.2 ms.\n"));
        (report.beyond_twice_the_budget, report.longest_later_s) = (2, 0.08);
        assert!(verdict(&report).starts_with("**Missed:** Of 1 500 submissions 2 after"), "{}", verdict(&report));
    }

    #[test]
    fn programs_that_did_not_run_have_a_dash() {
        let stages = |name| Stages::from([(name, StageReport { seconds: 0.5, dispatches: 3 })]);
        let text = of_renders(&[("a".to_owned(), stages("gather_all")), ("b".to_owned(), stages("gather_cut"))]);
        assert!(text.contains("| gather_all | 0.500 (3) | -         |"), "{text}");
    }
}
