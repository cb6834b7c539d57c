//! Reports as a whole: files, faults, provenance, pictures.

use crate::fixture::{Files, Results, names, times};
use lightcuts_experiment::layout::Content;
use lightcuts_experiment::{Report, ReportError};
use std::fs;
use std::path::Path;

fn images() -> Content {
    let configurations = names(&["cpu", "cpu-lightcuts", "gpu"]);
    Content::Images { scene: "simple".to_owned(), configurations, point: None }
}

#[test]
fn every_file_is_written_and_the_same_results_give_the_same_bytes() {
    let results = Results::new()
        .with_thesis_figures()
        .with_pictures()
        .with("t", times("simple", Some("5.1")))
        .with("a", crate::acceleration::section(Some("5.5")))
        .with("i", images());
    let report = results.try_report().unwrap();
    assert!(report.missing.is_empty(), "{:?}", report.missing);
    let folder = results.folder().join("new/report");
    let written = report.write(&folder).unwrap();
    let relative: Vec<&Path> = written.iter().map(|path| path.strip_prefix(&folder).unwrap()).collect();
    let expected = ["tables/t.csv", "tables/a.csv", "charts/a.svg", "report.md", "index.html"];
    assert_eq!(relative, expected.map(Path::new));
    for (path, (_, content)) in written.iter().zip(&report.files) {
        assert_eq!(&fs::read(path).unwrap(), content, "{}", path.display());
    }
    // Again, over the files of the first time.
    assert_eq!(results.try_report().unwrap(), report);
    report.write(&folder).unwrap();
}

#[test]
fn pictures_are_embedded_once_and_missing_ones_are_told() {
    let results = Results::new().with_pictures().with("i", images());
    let report = results.report();
    // Two pictures and the map of their difference.
    assert_eq!(report.page().matches("src=\"data:image/png;base64,").count(), 3);
    assert!(report.page().contains("alt=\"Simple, CPU, lightcuts\""));
    assert!(report.page().contains("FLIP against CPU: mean <b>0.0625</b>"));
    assert!(report.page().contains("Absent: there is no graphics adapter."));
    fs::remove_file(results.folder().join("images/simple--cpu-lightcuts.png")).unwrap();
    let report = results.report();
    let reason = "images/simple--cpu-lightcuts.png cannot be shown: there is no such file";
    assert_eq!(report.0.missing, [reason]);
    assert!(report.page().contains(reason) && !report.page().contains("data-stage="));
}

#[test]
fn the_page_stays_below_15_megabytes_with_30_large_pictures() {
    let mut results = Results::new();
    let side = 512;
    // Renders have edges and smooth shades; these have a little noise as well, and 300 KB each.
    for (i, row) in results.rows.iter_mut().take(6).enumerate() {
        row.png = format!("{i}.png");
    }
    let picture = lightcuts::image::Image::from_fn(side, side, |x, y| {
        let noise = ((x * 7919 + y * 104_729) % 13) as f32 / 1300.0;
        [x as f32 / side as f32, y as f32 / side as f32, ((x + y) as f32 / 60.0).sin().abs()].map(|value| value + noise)
    });
    let path = results.folder().join("0.png");
    lightcuts::image::write_png(&path, &picture, lightcuts::image::Transfer::Linear).unwrap();
    let one = fs::metadata(&path).unwrap().len();
    let page = results.with("i", images()).report().page().len() as u64;
    // Everything but pictures is small; base64 adds a third.
    assert!(page < one * 4 / 3 + 100_000, "{page} bytes with a picture of {one}");
    assert!(30 * (one * 4 / 3) < 15_000_000, "a picture of {one} bytes");
}

#[test]
fn rows_of_several_origins_are_told() {
    let mut results = Results::new().with("t", times("simple", None));
    assert!(!results.report().page().contains("do not come from one place"));
    results.rows[0].revision = "fedcba-dirty".to_owned();
    results.rows[1].device.threads = 8;
    let report = results.report();
    for expected in [
        "The rows do not come from one place.",
        "2 revisions of the program: 0123456789abcdef; fedcba-dirty.",
        "2 devices: Test Processor (CPU, 1 thread); Test Processor (CPU, 8 threads).",
        "built from changed sources",
        "2026-11-22 21:21 UTC",
        "18 of 18 planned",
    ] {
        assert!(report.page().contains(expected), "{expected} is missing");
        assert!(report.text("report.md").contains(expected), "{expected} is missing in the Markdown");
    }
}

#[test]
fn faults_tell_file_line_and_section() {
    let results = Results::new();
    let path = results.write();
    let good = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = good.lines().collect();
    fs::write(&path, format!("{}\n{}\n{{\"kind\":\"run\"}}\n{}\n", lines[0], lines[1], lines[2])).unwrap();
    let error = Report::read(&path).unwrap_err().to_string();
    assert!(error.contains("results.jsonl:3: "), "{error}");
    fs::write(&path, "").unwrap();
    assert!(matches!(Report::read(&path).unwrap_err(), ReportError::NoHeader { .. }));
    // A torn last line is what a killed experiment leaves behind.
    fs::write(&path, format!("{}\n{}\n{{\"kind\":\"ru", lines[0], lines[1])).unwrap();
    assert!(Report::read(&path).is_ok());
    assert!(Report::read(&results.folder().join("none")).unwrap_err().to_string().contains("cannot read"));
    let unknown = Results::new().with("t", times("atlantis", None)).try_report().unwrap_err().to_string();
    assert!(unknown.contains("section `t`: it names the scene `atlantis`"), "{unknown}");
    let metric = Content::Agreement {
        configurations: names(&["cpu-lightcuts"]),
        metrics: names(&["ssimm"]),
        published_pass: Vec::new(),
    };
    let unknown = Results::new().with("v", metric).try_report().unwrap_err().to_string();
    assert!(unknown.contains("section `v`: there is no metric \"ssimm\""), "{unknown}");
}

#[test]
fn an_output_that_cannot_be_written_is_an_error() {
    let results = Results::new();
    let report = results.try_report().unwrap();
    let file = results.folder().join("file");
    fs::write(&file, "").unwrap();
    assert!(matches!(report.write(&file).unwrap_err(), ReportError::Folder { .. }));
    let folder = results.folder().join("report");
    fs::create_dir_all(folder.join("index.html/taken")).unwrap();
    assert!(matches!(report.write(&folder).unwrap_err(), ReportError::Write(_)));
}

#[test]
fn an_experiment_without_rows_has_a_report() {
    let mut results = Results::new()
        .with_thesis_figures()
        .with("t", times("simple", Some("5.1")))
        .with("a", crate::acceleration::section(Some("5.5")))
        .with("i", images());
    results.rows.clear();
    let report = Files(results.try_report().unwrap());
    assert!(report.page().contains("18 of 18 planned renders are not done yet"));
    assert!(report.text("report.md").contains("not yet"));
}
