//! `results.jsonl` as a file: torn, locked, malformed.

use crate::support::{Folder, HEAD, PAIR};
use lightcuts_experiment::{Results, ResultsError, RunError, Runner};
use std::fs;

fn text() -> String {
    format!("{HEAD}{PAIR}")
}

#[test]
fn every_row_survives_its_line() {
    let folder = Folder::new();
    folder.run(&text());
    let path = folder.out().join("results.jsonl");
    let lines = fs::read_to_string(&path).unwrap();
    assert_eq!(lines.lines().count(), 3, "a header and two rows");
    assert!(lines.ends_with('\n') && lines.starts_with("{\"kind\":\"header\",\"format\":1,"));
    let results = folder.results();
    assert_eq!(results.header.as_ref(), Some(&folder.plan(&text()).header));
    assert_eq!((results.rows.len(), results.current().len()), (2, 2));
}

#[test]
fn a_torn_last_line_is_cut_off_and_rendered_again() {
    let folder = Folder::new();
    folder.run(&text());
    let path = folder.out().join("results.jsonl");
    let whole = fs::read(&path).unwrap();
    let last = whole[..whole.len() - 1].iter().rposition(|&byte| byte == b'\n').unwrap() + 1;
    for cut in [last + 1, last + 40, whole.len() - 1] {
        fs::write(&path, &whole[..cut]).unwrap();
        assert_eq!(folder.results().rows.len(), 1, "readers pass over it");
        let outcome = folder.run(&text());
        assert_eq!((outcome.rendered, outcome.skipped), (1, 1));
        assert_eq!(fs::read(&path).unwrap()[..last], whole[..last], "what was finished is as it was");
        assert_eq!(folder.results().rows.len(), 2);
    }
}

#[test]
fn two_experiments_cannot_write_to_one_file() {
    let folder = Folder::new();
    let plan = folder.plan(&text());
    let first = Runner::open(&plan, &folder.out()).unwrap();
    let second = Runner::open(&plan, &folder.out()).unwrap_err();
    assert!(matches!(second, RunError::Results(ResultsError::InUse { .. })), "{second}");
    assert!(second.to_string().contains("results.jsonl is in use by another"), "{second}");
    drop(first);
    Runner::open(&plan, &folder.out()).unwrap();
}

#[test]
fn malformed_lines_are_told_by_number() {
    let folder = Folder::new();
    folder.run(&text());
    let path = folder.out().join("results.jsonl");
    let whole = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let cases = [
        (format!("{}\nnonsense\n{}\n", lines[0], lines[1]), "results.jsonl:2: this is not a record"),
        (format!("{}\n\n", lines[0]), "results.jsonl:2: this is not a record"),
        (whole.replacen("\"format\":1", "\"format\":99", 1), "results.jsonl:1: the format is 99"),
        ("{\"kind\":\"header\",\"format\":2,\"new\":true}\n".to_owned(), "results.jsonl:1: the format is 2"),
        (whole.replacen("\"run\":1", "\"run\":\"one\"", 1), "results.jsonl:2: this is not a record"),
    ];
    for (text, expected) in cases {
        fs::write(&path, text).unwrap();
        let error = Results::read(&path).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
    fs::write(&path, [0xff, 0xfe, b'\n']).unwrap();
    assert!(Results::read(&path).is_err());
    fs::write(&path, "").unwrap();
    assert_eq!(Results::read(&path).unwrap(), Results::default());
    assert!(matches!(Results::read(&folder.out()), Err(ResultsError::Unfit { .. })));
    assert!(matches!(Results::read(&folder.at("none")), Err(ResultsError::Io { .. })));
}
