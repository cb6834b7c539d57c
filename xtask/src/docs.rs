//! Tests that the documentation tells of what is there: links lead somewhere, named files, functions and tests exist.

use crate::project::root;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// All files under a folder with this extension.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn pages() -> Vec<PathBuf> {
    let mut pages = files(&root().join("docs"), "md");
    pages.extend(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root().join(name)));
    pages
}

/// Targets of `[text](target)`.
fn links(text: &str) -> Vec<&str> {
    text.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(target, _)| target)).collect()
}

/// The name that a heading has in a link.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().to_lowercase();
    kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>().replace(' ', "-")
}

/// Words between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

#[test]
fn links_lead_somewhere() {
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        let targets = links(&text).into_iter().filter(|target| !target.contains("://"));
        for target in targets {
            let (file, section) = target.split_once('#').unwrap_or((target, ""));
            let path = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(path.exists(), "{}: no file {target}", page.display());
            if !section.is_empty() {
                let other = fs::read_to_string(&path).unwrap();
                let found = other.lines().filter(|line| line.starts_with('#')).any(|line| anchor(line) == section);
                assert!(found, "{}: no section {target}", page.display());
            }
        }
    }
}

#[test]
fn named_files_exist() {
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        let is_path = |word: &&str| {
            ["crates/", "scenes/", "docs/", "fuzz/", "xtask/"].iter().any(|start| word.starts_with(start))
        };
        for path in quoted(&text).filter(is_path).filter(|word| !word.contains([' ', '\n', '*'])) {
            assert!(root().join(path).exists(), "{}: no file {path}", page.display());
        }
    }
}

#[test]
fn functions_and_tests_of_the_theory_exist() {
    let sources: Vec<String> =
        files(&root().join("crates"), "rs").iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let tests: BTreeSet<&str> = sources
        .iter()
        .flat_map(|source| source.split("#[test]").skip(1))
        .filter_map(|rest| rest.split_once("fn ")?.1.split_once('('))
        .map(|(name, _)| name)
        .collect();
    let theory = fs::read_to_string(root().join("docs/theory.md")).unwrap();
    let rows = theory.lines().filter(|line| line.starts_with("| ") && line.contains("` in `crates/"));
    for row in rows {
        let words: Vec<&str> = quoted(row).collect();
        let place = words.iter().position(|word| word.starts_with("crates/")).unwrap();
        let source = fs::read_to_string(root().join(words[place])).unwrap();
        let name = words[place - 1];
        let defined = ["fn", "struct", "impl"].iter().any(|keyword| {
            let definition = format!("{keyword} {name}");
            source.split(&definition).skip(1).any(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        });
        assert!(defined, "{name} is not in {}", words[place]);
        assert!(words.len() > place + 1, "no test for {name}");
        for test in &words[place + 1..] {
            assert!(tests.contains(test), "no test {test}");
        }
    }
}

#[test]
fn the_architecture_names_every_module() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    for krate in fs::read_dir(root().join("crates")).unwrap() {
        for module in fs::read_dir(krate.unwrap().path().join("src")).unwrap() {
            let path = module.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap();
            let named = ["lib", "main"].contains(&stem) || text.contains(&format!("`{stem}`"));
            assert!(named, "ARCHITECTURE.md does not tell of {}", path.display());
        }
    }
}

#[test]
fn anchors_are_those_of_headings() {
    assert_eq!(anchor("## Exit codes"), "exit-codes");
    assert_eq!(anchor("# C: camera, `x`"), "c-camera-x");
}
