//! Names and texts come from files: nothing in them may become markup, script or path.

use crate::fixture::{Results, names, times};
use lightcuts_experiment::layout::{Content, Quantity};
use roxmltree::Document;

const EVIL: &str = "<script>alert(1)</script>\"'><img src=http://example.org/x onerror=alert(1)>&|`*_\u{1}";

fn evil() -> Results {
    let curves = Content::Curves {
        scene: "simple".to_owned(),
        configurations: names(&["cpu", "cpu-lightcuts"]),
        quantity: Quantity::TimePerPixel,
        crossover: None,
    };
    let images = Content::Images { scene: "simple".to_owned(), configurations: names(&["cpu", "gpu"]), point: None };
    let mut results = Results::new()
        .with_thesis_figures()
        .with("t", times("simple", Some("5.1")))
        .with("a", crate::acceleration::section(Some("5.5")))
        .with("c", curves)
        .with("i", images)
        .with("s", Content::PublishedArithmetic);
    let header = &mut results.header;
    for text in [&mut header.title, &mut header.description, &mut header.name, &mut header.published.source] {
        EVIL.clone_into(text);
    }
    header.scenes.iter_mut().for_each(|scene| EVIL.clone_into(&mut scene.title));
    header.scenes[1].stand_in = Some(EVIL.to_owned());
    for configuration in &mut header.configurations {
        EVIL.clone_into(&mut configuration.title);
        configuration.absent = configuration.absent.as_ref().map(|_| EVIL.to_owned());
    }
    for section in &mut header.sections {
        EVIL.clone_into(&mut section.title);
        EVIL.clone_into(&mut section.text);
    }
    for row in &mut results.rows {
        let device = &mut row.device.name;
        for text in [&mut row.png, &mut row.version, &mut row.revision, &mut row.finished, device] {
            EVIL.clone_into(text);
        }
    }
    results
}

#[test]
fn nothing_becomes_markup() {
    let report = evil().report();
    let page = report.page();
    // The page's own script is the only one, and no tag comes from a text.
    assert_eq!(page.matches("<script").count(), 1);
    assert!(!page.contains("<img src=http") && !page.contains("<script>alert"), "{page}");
    assert!(page.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    assert_eq!(page.matches("onerror=").count(), page.matches("src=http://example.org/x onerror=").count());
    for chart in ["charts/a.svg", "charts/c.svg"] {
        let svg = report.text(chart);
        let tree = Document::parse(svg).unwrap_or_else(|error| panic!("{chart}: {error}"));
        assert!(tree.descendants().all(|node| !node.has_tag_name("script") && !node.has_tag_name("img")), "{svg}");
    }
}

#[test]
fn markdown_keeps_its_tables() {
    let report = evil().report();
    let markdown = report.text("report.md");
    let lines: Vec<&str> = markdown.lines().collect();
    for (i, line) in lines.iter().enumerate().filter(|(_, line)| line.starts_with("| ---")) {
        let cells = |line: &str| line.replace("\\|", "").matches('|').count();
        let expected = cells(line);
        assert_eq!(cells(lines[i - 1]), expected, "{}", lines[i - 1]);
        for row in lines[i + 1..].iter().take_while(|line| line.starts_with('|')) {
            assert_eq!(cells(row), expected, "{row}");
        }
    }
}

#[test]
fn the_policy_allows_the_page_its_own_script_alone() {
    let report = Results::new().report();
    let page = report.page();
    assert!(
        page.contains("default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-"),
        "{page}"
    );
}

#[test]
fn ids_that_are_no_words_are_refused() {
    for id in ["", "../x", "a/b", "a b", ".hidden", "ä", "a\"b", &"x".repeat(81)] {
        let error = Results::new().with(id, Content::Text).try_report().unwrap_err().to_string();
        assert!(error.contains("an id is a word"), "{id}: {error}");
    }
    let error = Results::new().with("a", Content::Text).with("A", Content::Text).try_report().unwrap_err().to_string();
    assert!(error.contains("section `A`: another section has files with the name `a`"), "{error}");
}
