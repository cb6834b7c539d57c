//! Tables of times: means, spreads, ratios, absent devices, stand-ins, single runs.

use crate::fixture::{Results, assert_near, names, number, times};
use lightcuts_experiment::layout::Content;

#[test]
fn means_spreads_and_ratios_are_those_of_the_rows() {
    let report = Results::new().with_thesis_figures().with("t", times("simple", Some("5.1"))).report();
    let row = report.row("t", &[("configuration", "cpu")]);
    // 4.0 s times 0.9, 1.0 and 1.1; the published second pass took 76.945 s.
    for (column, expected) in [
        ("rows", 3.0),
        ("first_pass_cpu_s", 0.04),
        ("second_pass_cpu_s", 4.0),
        ("second_pass_cpu_least_s", 3.6),
        ("second_pass_cpu_greatest_s", 4.4),
        ("second_pass_elapsed_s", 2.0),
        ("total_cpu_s", 4.04),
        ("light_ratio_percent", 100.0),
        ("vpl_count", 290.0),
        ("published_second_pass_s", 76.945),
        ("published_vpl_count", 271.0),
        ("second_pass_ratio", 76.945 / 4.0),
        ("first_pass_ratio", 0.808 / 0.04),
        ("total_ratio", 77.753 / 4.04),
    ] {
        assert_near(number(&row, column), expected);
    }
    assert_eq!(row["published_light_ratio_percent"], "");
    let page = report.page();
    for shown in
        ["76.945", "3.60 – 4.40", "4.00", "19.2", "68.313", "Beside them the published figures (the thesis, 5.1)"]
    {
        assert!(page.contains(shown), "{shown} is missing");
    }
}

#[test]
fn absent_devices_keep_their_published_figures() {
    let report = Results::new().with_thesis_figures().with("t", times("simple", Some("5.1"))).report();
    let row = report.row("t", &[("configuration", "gpu")]);
    assert_eq!((row["total_cpu_s"].as_str(), row["rows"].as_str()), ("", "0"));
    assert_eq!(row["absent"], "there is no graphics adapter");
    assert_eq!((row["total_ratio"].as_str(), row["published_total_s"].as_str()), ("", "53.353"));
    let markdown = report.text("report.md");
    assert!(markdown.contains("| GPU <sup>1</sup> | absent | 7.891 | - | absent | 45.457 |"), "{markdown}");
    assert!(markdown.contains("1. Absent: there is no graphics adapter."), "{markdown}");
}

#[test]
fn stand_ins_are_named_and_compared_with_nothing() {
    let mut results = Results::new().with_thesis_figures().with("t", times("venus", Some("5.2")));
    results.scene("venus").stand_in = Some("our statue of as many triangles".to_owned());
    let report = results.report();
    let row = report.row("t", &[("configuration", "cpu")]);
    assert_eq!((row["stand_in"].as_str(), row["total_ratio"].as_str()), ("true", ""));
    assert_eq!(row["published_total_s"], "1422.187");
    let page = report.page();
    assert!(page.contains("Venus is a stand-in: our statue of as many triangles"), "{page}");
    assert!(page.contains("<td class=\"faint\"><span class=\"value\">1,422.187</span></td>"), "{page}");
    assert!(!page.contains("<td class=\"published\">"));
}

#[test]
fn every_run_has_a_row_of_its_own() {
    let content = Content::Times {
        scene: "simple".to_owned(),
        configurations: names(&["cpu", "gpu"]),
        published: Some("C.1".to_owned()),
        every_run: true,
    };
    let mut results = Results::new().with_thesis_figures().with("t", content);
    // Two runs are planned, the second is not done; the publication has a third.
    results.rows.retain(|row| row.run < 3);
    results.header.runs = 2;
    results.plan_all();
    results.rows.retain(|row| row.run < 2);
    let report = results.report();
    let of_run = |run| report.row("t", &[("configuration", "cpu"), ("run", run)]);
    assert_near(number(&of_run("1"), "second_pass_cpu_s"), 3.6);
    assert_eq!(of_run("1")["published_second_pass_s"], "86.989");
    assert_eq!(
        (of_run("2")["second_pass_cpu_s"].as_str(), of_run("2")["published_second_pass_s"].as_str()),
        ("", "84.214")
    );
    assert_eq!(of_run("3")["published_second_pass_s"], "86.739");
    assert_eq!(report.table("t").len(), 6);
    let markdown = report.text("report.md");
    assert!(markdown.contains("| CPU, run 2 <sup>1</sup> | not yet | 0.891 |"), "{markdown}");
    assert!(markdown.contains("| CPU, run 3 | - | 0.8 |"), "{markdown}");
    assert!(markdown.contains("6 of 12 planned renders are not done yet"), "{markdown}");
}

#[test]
fn rows_of_earlier_plans_do_not_count() {
    let mut results = Results::new().with("t", times("simple", None));
    // The settings were edited: the jobs have other hashes, and one was rendered so far.
    for job in &mut results.header.jobs {
        job.job += "-edited";
    }
    let mut edited = results.rows[0].clone();
    edited.job += "-edited";
    edited.stats.passes[0].cpu_s = 7.0;
    results.rows.push(edited);
    let report = results.report();
    let row = report.row("t", &[("configuration", "cpu")]);
    assert_eq!(row["rows"], "1");
    assert_near(number(&row, "first_pass_cpu_s"), 7.0);
    assert_eq!(report.row("t", &[("configuration", "cpu-lightcuts")])["rows"], "0");
}
