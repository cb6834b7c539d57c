//! Tables and charts of accelerations.

use crate::fixture::{Files, Results, assert_near, number};
use lightcuts_experiment::layout::{AccelerationRow, Content, Time};
use roxmltree::{Document, Node};

pub(crate) fn section(published: Option<&str>) -> Content {
    let row = |title: &str, slow: &str, fast: &str, time| AccelerationRow {
        title: title.to_owned(),
        slow: slow.to_owned(),
        fast: fast.to_owned(),
        time,
    };
    Content::Acceleration {
        rows: vec![
            row("cpu pass 2", "cpu", "cpu-lightcuts", Time::SecondPass),
            row("gpu pass 2", "gpu", "gpu-lightcuts", Time::SecondPass),
        ],
        published: published.map(str::to_owned),
        chart: "What lightcuts gains".to_owned(),
    }
}

fn report() -> Files {
    let mut results = Results::new().with_thesis_figures().with("a", section(Some("5.5")));
    results.scene("galleon").stand_in = Some("our ship".to_owned());
    results.report()
}

#[test]
fn accelerations_are_slow_over_fast_less_one() {
    let report = report();
    let of = |row, scene| report.row("a", &[("row", row), ("scene", scene)]);
    // 4 s against 8 s.
    let simple = of("cpu pass 2", "simple");
    assert_near(number(&simple, "percent"), -50.0);
    assert_near(number(&simple, "elapsed_percent"), -50.0);
    assert_eq!(simple["published_percent"], "-82.1");
    let absent = of("gpu pass 2", "venus");
    assert_eq!((absent["percent"].as_str(), absent["published_percent"].as_str()), ("", "5.54"));
    assert!(absent["missing"].contains("no graphics adapter"), "{absent:?}");
    assert_eq!(of("cpu pass 2", "galleon")["stand_in"], "true");
    let page = report.page();
    assert!(page.contains("\u{2212}50.0") && page.contains("Galleon is a stand-in: our ship"), "{page}");
}

/// Filled rectangles of a colour.
fn rectangles(chart: &Document<'_>, color: &str) -> usize {
    let is_one = |node: &Node<'_, '_>| node.has_tag_name("rect") && node.attribute("fill") == Some(color);
    chart.descendants().filter(is_one).count()
}

fn texts(chart: &Document<'_>) -> Vec<String> {
    let texts = chart.descendants().filter(|node| node.has_tag_name("text"));
    texts.filter_map(|node| node.text()).map(|text| text.trim().to_owned()).collect()
}

#[test]
fn the_chart_has_a_bar_for_each_figure() {
    let report = report();
    let svg = report.text("charts/a.svg");
    let chart = Document::parse(svg).unwrap();
    // Ours: a bar of the CPU in each scene and its sign in the legend; of the GPU the sign alone.
    assert_eq!(rectangles(&chart, "#0072B2"), 3 + 1);
    assert_eq!(rectangles(&chart, "#D55E00"), 1);
    // Published ones are outlined: a tint of the colour.
    assert_eq!([rectangles(&chart, "#C7E0EE"), rectangles(&chart, "#F6DCC7")], [3, 3]);
    let texts = texts(&chart);
    for expected in [
        "Simple",
        "Venus",
        "Galleon (stand-in)",
        "cpu pass 2",
        "gpu pass 2",
        "ours",
        "published",
        "Acceleration, %",
        "absent",
    ] {
        assert!(texts.iter().any(|text| text == expected), "{expected} is missing in {texts:?}");
    }
    // The axis spans every value.
    assert!(
        texts.iter().any(|text| text == "\u{2212}100") && texts.iter().any(|text| text == "\u{2212}82.1"),
        "{texts:?}"
    );
    assert!(
        report.page().contains(
            "aria-label=\"Bar chart of What lightcuts gains. Simple, cpu pass 2: -50.0 %, the thesis -82.1 %."
        )
    );
}

#[test]
fn bars_have_the_lengths_of_their_values() {
    let report = report();
    let chart = Document::parse(report.text("charts/a.svg")).unwrap();
    let bars = chart.descendants().filter(|node| node.attribute("fill") == Some("#0072B2"));
    let heights: Vec<i32> = bars.map(|bar| bar.attribute("height").unwrap().parse().unwrap()).collect();
    // All three are -50 %; the fourth is the legend's.
    let axis = |tick: &str| -> i32 {
        let label = chart.descendants().find(|node| node.text().is_some_and(|text| text.trim() == tick)).unwrap();
        label.attribute("y").unwrap().parse().unwrap()
    };
    let per_100 = axis("\u{2212}100") - axis("0");
    assert!(per_100 > 50, "{per_100}");
    for height in &heights[1..] {
        assert!((2 * height - per_100).abs() <= 2 || *height == 12, "{heights:?} at {per_100} pixels per 100 %");
    }
}

#[test]
fn without_published_figures_only_ours_are_drawn() {
    let report = Results::new().with("a", section(None)).report();
    let chart = Document::parse(report.text("charts/a.svg")).unwrap();
    assert_eq!([rectangles(&chart, "#0072B2"), rectangles(&chart, "#C7E0EE")], [4, 0]);
    assert!(!texts(&chart).contains(&"published".to_owned()));
}
