//! Curves over the number of VPLs, and crossovers in words.

use crate::fixture::{Results, assert_near, names, number};
use lightcuts_experiment::layout::{Content, Quantity};
use roxmltree::Document;

fn section(quantity: Quantity) -> Content {
    Content::Curves {
        scene: "simple".to_owned(),
        configurations: names(&["cpu", "cpu-lightcuts"]),
        quantity,
        crossover: Some(["cpu".to_owned(), "cpu-lightcuts".to_owned()]),
    }
}

/// Plain time is proportional to the number of VPLs, that of lightcuts to its square root; equal at 400 VPLs.
fn crossing() -> Results {
    let points = [100, 200, 800, 1600].map(|n| (n, 0.01 * n as f64, 0.2 * (n as f64).sqrt()));
    Results::sweep(&points)
}

#[test]
fn the_crossover_is_told_and_marked() {
    let report = crossing().with("c", section(Quantity::TimePerPixel)).report();
    assert!(
        report.page().contains("From about 400 VPLs on, CPU, lightcuts is faster than CPU. There both have"),
        "{}",
        report.page()
    );
    let chart = Document::parse(report.text("charts/c.svg")).unwrap();
    let texts: Vec<&str> = chart.descendants().filter_map(|node| node.text()).map(str::trim).collect();
    for expected in
        ["crossover: 400 VPLs", "Number of VPLs", "Processor time per pixel, µs", "CPU", "CPU, lightcuts", "1,000"]
    {
        assert!(texts.contains(&expected), "{expected} is missing in {texts:?}");
    }
    // A circle for each of 4 points and in the legend, and the ring; squares for the other curve.
    let count = |name: &str, fill: &str| {
        chart.descendants().filter(|node| node.has_tag_name(name) && node.attribute("fill") == Some(fill)).count()
    };
    assert_eq!([count("circle", "#0072B2"), count("rect", "#D55E00"), count("circle", "none")], [5, 5, 1]);
}

#[test]
fn values_are_times_per_pixel_of_choosing_and_shading() {
    let report = crossing().with("c", section(Quantity::TimePerPixel)).report();
    let row = report.row("c", &[("configuration", "cpu"), ("point", "800")]);
    assert_eq!(row["vpl_count"], "800");
    // The first run's times have a factor of 0.9; light tree and second pass are three quarters of what follows the
    // first.
    assert_near(number(&row, "value"), 1e6 * 8.0 * 0.75 * 0.9 / (96.0 * 96.0));
    assert_eq!(report.table("c").len(), 8);
}

#[test]
fn of_several_runs_the_least_time_counts_and_the_mean_of_other_quantities() {
    let twice_run = |quantity| {
        let mut results = crossing().with("c", section(quantity));
        results.rows.iter_mut().for_each(|row| row.stats.rays.shadow = 1_000 * row.stats.vpl_count);
        let mut second = results.rows.clone();
        for row in &mut second {
            row.run = 2;
            row.stats.passes.iter_mut().for_each(|pass| pass.cpu_s *= 3.0);
            row.stats.rays.shadow *= 2;
        }
        results.rows.extend(second);
        results.report()
    };
    let value = |quantity, column: &str| {
        number(&twice_run(quantity).row("c", &[("configuration", "cpu"), ("point", "800")]), column)
    };
    let per_pixel = value(Quantity::TimePerPixel, "value");
    assert_near(per_pixel, 1e6 * 8.0 * 0.75 * 0.9 / (96.0 * 96.0));
    assert_near(value(Quantity::TimePerPixel, "greatest"), 3.0 * per_pixel);
    assert_near(value(Quantity::TimePerVpl, "value"), 1e3 * per_pixel / 800.0);
    assert_near(value(Quantity::ShadowRays, "value"), 1_500.0 / (96.0 * 96.0));
}

#[test]
fn without_a_crossover_the_smaller_one_is_told() {
    let slower = [100, 1000].map(|n| (n, 0.01 * n as f64, 0.02 * n as f64));
    let page = Results::sweep(&slower).with("c", section(Quantity::TimePerPixel)).report().page().to_owned();
    let said =
        "There is no crossover in the measured range, 100 to 1,000 VPLs: CPU, lightcuts is nowhere faster than CPU.";
    assert!(page.contains(said), "{page}");
    let faster = [100, 1000].map(|n| (n, 0.02 * n as f64, 0.01 * n as f64));
    let page = Results::sweep(&faster).with("c", section(Quantity::TimePerPixel)).report().page().to_owned();
    assert!(page.contains("CPU, lightcuts is faster than CPU throughout."), "{page}");
}

#[test]
fn references_have_no_error_and_zero_has_no_place_on_the_axis() {
    let mut results = crossing().with("c", section(Quantity::Metric("rmse".to_owned())));
    let exact = results.rows.iter_mut().find(|row| row.stats.vpl_count == 100 && !row.comparisons.is_empty()).unwrap();
    exact.comparisons.get_mut("cpu").unwrap().metrics.insert("rmse".to_owned(), Some(0.0));
    let report = results.report();
    assert_eq!(report.row("c", &[("configuration", "cpu"), ("point", "100")])["value"], "");
    assert_eq!(report.row("c", &[("configuration", "cpu-lightcuts"), ("point", "100")])["value"], "0");
    let page = report.page();
    assert!(page.contains("CPU is compared with no reference."), "{page}");
    assert!(page.contains("There is no range yet in which both CPU and CPU, lightcuts were measured."), "{page}");
    let chart = Document::parse(report.text("charts/c.svg")).unwrap();
    let squares = chart.descendants().filter(|node| node.attribute("fill") == Some("#D55E00")).count();
    assert_eq!(squares, 3 + 1);
}

#[test]
fn points_that_no_job_has_are_left_out() {
    let mut results = crossing().with("c", section(Quantity::LightRatio));
    results.header.points.push("9999".to_owned());
    let report = results.report();
    assert!(report.table("c").iter().all(|row| row["point"] != "9999"));
    // A point that a job has is told, rendered or not.
    results.rows.retain(|row| row.point.as_deref() != Some("1600"));
    let report = results.report();
    assert_eq!(report.row("c", &[("point", "1600"), ("configuration", "cpu")])["rows"], "0");
    assert!(report.page().contains("Not rendered yet; lightcuts"));
}
