//! What does not add up in the thesis.

use crate::acceleration;
use crate::fixture::{Files, Results, assert_near, number};
use lightcuts_experiment::layout::{AccelerationRow, Content, Time};
use lightcuts_experiment::published::{Published, PublishedTime};

fn thesis() -> Files {
    let rows = [("overall", "cpu", "gpu-lightcuts", Time::Total)];
    let overall = Content::Acceleration {
        rows: rows
            .map(|(title, slow, fast, time)| AccelerationRow {
                title: title.to_owned(),
                slow: slow.to_owned(),
                fast: fast.to_owned(),
                time,
            })
            .to_vec(),
        published: Some("5.6".to_owned()),
        chart: "Overall".to_owned(),
    };
    Results::new()
        .with_thesis_figures()
        .with("a", acceleration::section(Some("5.5")))
        .with("b", overall)
        .with("slips", Content::PublishedArithmetic)
        .report()
}

#[test]
fn table_5_1_is_not_the_mean_of_its_runs() {
    let report = thesis();
    let of = |quantity| {
        let wanted = [("table", "5.1"), ("configuration", "cpu"), ("quantity", quantity)];
        report.row("slips-averages", &wanted)
    };
    let vpls = of("VPLs");
    assert_eq!(
        (vpls["average"].as_str(), number(&vpls, "mean_of_runs"), vpls["differs"].as_str()),
        ("271", 290.0, "true")
    );
    let first = of("First pass, s");
    assert!((number(&first, "mean_of_runs") - (0.933 + 0.891 + 0.8) / 3.0).abs() < 1e-6, "{first:?}");
}

#[test]
fn table_5_3_is_run_3_and_table_5_2_is_sound() {
    let report = thesis();
    assert!(report.page().contains("<li>5.3 (Galleon) repeats run 3 of C.3 in 4 rows.</li>"), "{}", report.page());
    assert!(report.page().contains("8 of 12 published averages are not the means of the published single runs."));
    assert!(report.table("slips-averages").iter().all(|row| row["table"] != "5.2"));
}

#[test]
fn totals_differ_from_their_passes_only_beyond_rounding() {
    let report = thesis();
    let of = |run, configuration| {
        let wanted = [("scene", "simple"), ("run", run), ("configuration", configuration)];
        report.row("slips-totals", &wanted)
    };
    let slip = of("average", "cpu-lightcuts");
    assert_eq!(slip["total_s"], "395.16");
    assert!((number(&slip, "sum_of_passes_s") - 395.153).abs() < 1e-6);
    assert!((number(&of("1", "cpu-lightcuts"), "sum_of_passes_s") - 416.546).abs() < 1e-6);
    // 0.933 + 86.989 = 87.922 is 87.92 when it is rounded.
    let rounded = |row: &std::collections::BTreeMap<String, String>| row["total_s"] == "87.92";
    assert!(!report.table("slips-totals").iter().any(rounded));
}

#[test]
fn accelerations_are_held_against_averages_and_runs() {
    let report = thesis();
    let simple = report.row("slips-accelerations", &[("table", "5.6"), ("scene", "simple")]);
    assert_near(number(&simple, "published_percent"), 9.941);
    assert_near(number(&simple, "from_averages_percent"), (77.753 / 73.287 - 1.0) * 100.0);
    let runs = (87.92 + 85.11 + 87.54) / (78.99 + 78.78 + 79.24);
    assert_near(number(&simple, "from_runs_percent"), (runs - 1.0) * 100.0);
    assert_eq!(simple["agrees_with"], "the single runs");
    assert_eq!(
        report.row("slips-accelerations", &[("table", "5.6"), ("scene", "galleon")])["agrees_with"],
        "the single runs"
    );
    // Venus agrees with both.
    assert!(!report.table("slips-accelerations").iter().any(|row| row["table"] == "5.6" && row["scene"] == "venus"));
}

#[test]
fn sound_figures_have_no_slips() {
    let time = |run: &str, first, second, total| PublishedTime {
        table: if run == "average" { "1" } else { "A.1" }.to_owned(),
        scene: "simple".to_owned(),
        run: run.to_owned(),
        config: "cpu".to_owned(),
        first_pass_s: first,
        second_pass_s: second,
        total_s: total,
        light_ratio_percent: None,
        vpl_count: 7,
    };
    let times = vec![time("average", 1.25, 3.25, 4.5), time("1", 1.125, 2.125, 3.25), time("2", 1.375, 4.375, 5.76)];
    let mut results = Results::new().with("slips", Content::PublishedArithmetic);
    results.header.published = Published { source: "a paper".to_owned(), times, accelerations: Vec::new() };
    let page = results.report().page().to_owned();
    assert!(page.contains("All 1 published averages are the means of their published runs."), "{page}");
    assert!(page.contains("1 of 3 published totals differ"), "{page}");
    results.header.published.times[2].total_s = 5.75;
    let page = results.report().page().to_owned();
    assert!(
        page.contains("All 3 published totals are the sums of their passes.") && !page.contains("<table>"),
        "{page}"
    );
    results.header.published = Published::default();
    assert!(results.report().page().contains("There are no published figures."));
}
