//! How pictures differ: verdicts, and what the publication says of them.

use crate::fixture::{Results, metrics, names, number};
use lightcuts_experiment::layout::Content;

fn section(published_pass: &[&str]) -> Content {
    Content::Agreement {
        configurations: names(&["cpu-lightcuts", "gpu"]),
        metrics: names(&["pdiff_px", "flip_ldr", "rmse", "psnr"]),
        published_pass: names(published_pass),
    }
}

#[test]
fn a_fail_against_a_published_pass_is_said_in_words() {
    let mut results = Results::new().with("v", section(&["simple", "venus"]));
    for row in results.rows.iter_mut().filter(|row| row.scene == "venus") {
        row.comparisons.values_mut().for_each(|comparison| comparison.metrics = metrics(42.0, 1.0));
    }
    let report = results.report();
    let page = report.page();
    let said = "The publication says Pass for Simple and Venus. That is not what comes out here: in 1 of 2 comparisons ours \
                is FAIL.";
    assert!(page.contains(said), "{page}");
    assert!(page.contains("<li>Simple, CPU, lightcuts against CPU: FAIL, 9,569 differing pixels.</li>"), "{page}");
    // 9,569 of 96 x 96 pixels would be more than all; the share is what the numbers give.
    assert!(
        page.contains("<td class=\"fail\"><span class=\"value\">FAIL</span><small>9,569 px, 104 %</small></td>"),
        "{page}"
    );
    assert!(
        page.contains("<td class=\"pass\"><span class=\"value\">PASS</span><small>42 px, 0.456 %</small></td>"),
        "{page}"
    );
    assert!(report.text("report.md").contains("**FAIL** (9,569 px, 104 %) | 0.0625 | 0.0125 | infinite | Pass |"));
}

#[test]
fn agreement_with_the_publication_is_said_too() {
    let mut results = Results::new().with("v", section(&["simple"]));
    for row in &mut results.rows {
        row.comparisons.values_mut().for_each(|comparison| comparison.metrics = metrics(0.0, 1.0));
    }
    let page = results.report().page().to_owned();
    assert!(
        page.contains("The publication says Pass for Simple. Here the verdict is PASS as well, in 1 of 1 comparisons.")
    );
    results.rows.clear();
    assert!(results.report().page().contains("No picture was judged here yet."));
}

#[test]
fn the_data_has_values_and_verdicts_of_every_comparison() {
    let report = Results::new().with("v", section(&[])).report();
    assert_eq!(report.table("v").len(), 6);
    let row = report.row("v", &[("scene", "galleon"), ("configuration", "cpu-lightcuts"), ("reference", "cpu")]);
    assert_eq!([number(&row, "pdiff_px"), number(&row, "pdiff_pass"), number(&row, "flip_ldr")], [9569.0, 0.0, 0.0625]);
    assert_eq!((row["psnr"].as_str(), row["rows"].as_str()), ("", "3"));
    let absent = report.row("v", &[("scene", "galleon"), ("configuration", "gpu")]);
    assert_eq!((absent["pdiff_px"].as_str(), absent["rows"].as_str()), ("", "0"));
    assert!(!report.page().contains("The publication says"));
}
