//! Rules of experiment files beyond the kinds of their values.

use super::fault::{PlanError, Source};
use super::file::{ConfigurationTable, Document, Place, covers};
use lightcuts::gpu::DeviceChoice;
use lightcuts::image::metrics::Metric;
use std::collections::HashSet;

/// Most runs of a job and most threads.
const MAX_RUNS: u32 = 1000;
const MAX_THREADS: u32 = 1024;

/// Most tables of one kind, and most renders of a plan.
const MAX_TABLES: usize = 1000;
const MAX_JOBS: usize = 100_000;

/// Checks that a document is of a size that is worth looking through.
pub(super) fn size(source: &Source, document: &Document) -> Result<(), PlanError> {
    let kinds = [
        ("scene", document.scene.len()),
        ("configuration", document.configuration.len()),
        ("point", document.point.len()),
        ("section", document.section.len()),
    ];
    for (kind, count) in kinds {
        if count > MAX_TABLES {
            let message = format!("there are {count} tables [[{kind}]]");
            return Err(source.fault(kind, message, &format!("at most {MAX_TABLES}")));
        }
    }
    Ok(())
}

/// Checks the number of renders, as far as they are known.
pub(super) fn jobs(source: &Source, count: usize) -> Result<(), PlanError> {
    if count <= MAX_JOBS {
        return Ok(());
    }
    Err(source.fault("runs", format!("there are {count} or more renders"), &format!("at most {MAX_JOBS}")))
}

/// Checks everything but sections and settings.
pub(super) fn document(source: &Source, document: &Document) -> Result<(), PlanError> {
    word(source, "name", &document.name)?;
    number(source, "runs", document.runs, 1, MAX_RUNS)?;
    number(source, "threads", document.threads, 0, MAX_THREADS)?;
    list(source, "seeds", &document.seeds)?;
    metrics(source, document.metrics.as_deref())?;
    scenes(source, document)?;
    configurations(source, document)?;
    points(source, document)
}

/// A name is a part of file names: letters, digits, `.`, `-` and `_`, beginning with a letter or digit. Two `-` in a
/// row separate names there.
pub(super) fn word(source: &Source, path: &str, name: &str) -> Result<(), PlanError> {
    let fits = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_');
    let begins = name.starts_with(|c: char| c.is_ascii_alphanumeric());
    if begins && name.len() <= 64 && name.chars().all(fits) && !name.contains("--") && !name.ends_with(['-', '.']) {
        return Ok(());
    }
    let expected = "a word of at most 64 letters, digits, `.`, `_` and single `-`";
    Err(source.fault(path, format!("`{name}` cannot be a name"), expected))
}

fn number(source: &Source, path: &str, value: u32, least: u32, most: u32) -> Result<(), PlanError> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(source.fault(path, format!("{path} is {value}"), &format!("{least} to {most}")))
}

/// A list with at least one item and no item twice.
fn list<T: PartialEq + ToString>(source: &Source, path: &str, items: &[T]) -> Result<(), PlanError> {
    if items.is_empty() {
        return Err(source.fault(path, "the list is empty", "at least one item"));
    }
    match items.iter().enumerate().find(|(i, item)| items[..*i].contains(item)) {
        None => Ok(()),
        Some((i, item)) => {
            let message = format!("`{}` stands twice", item.to_string());
            Err(source.fault(&format!("{path}.{i}"), message, "each once"))
        }
    }
}

fn metrics(source: &Source, keys: Option<&[String]>) -> Result<(), PlanError> {
    let Some(keys) = keys else { return Ok(()) };
    list(source, "metrics", keys)?;
    let known = Metric::ALL.map(Metric::key);
    match keys.iter().enumerate().find(|(_, key)| !known.contains(&key.as_str())) {
        Some((i, key)) => Err(source.unknown(&format!("metrics.{i}"), "metric", key, known)),
        None => Ok(()),
    }
}

/// Fails on the second of two equal names; names are parts of file names, and some systems ignore case.
fn names<'a>(source: &Source, what: &str, names: impl Iterator<Item = &'a str>) -> Result<(), PlanError> {
    let mut taken = HashSet::new();
    for (i, name) in names.enumerate() {
        let path = format!("{what}.{i}.name");
        word(source, &path, name)?;
        if !taken.insert(name.to_ascii_lowercase()) {
            return Err(source.fault(&path, format!("two tables [[{what}]] have the name `{name}`"), "another name"));
        }
    }
    if taken.is_empty() {
        return Err(source.fault(what, format!("there is no [[{what}]]"), "at least one"));
    }
    Ok(())
}

fn scenes(source: &Source, document: &Document) -> Result<(), PlanError> {
    names(source, "scene", document.scene.iter().map(|scene| scene.name.as_str()))
}

fn configurations(source: &Source, document: &Document) -> Result<(), PlanError> {
    let all = &document.configuration;
    names(source, "configuration", all.iter().map(|configuration| configuration.name.as_str()))?;
    for (i, configuration) in all.iter().enumerate() {
        let path = format!("configuration.{i}");
        restriction(source, &path, configuration.scenes.as_ref(), document)?;
        device(source, &format!("{path}.device"), &configuration.device)?;
        if configuration.at == Place::LastPoint && !configuration.references.is_empty() {
            let message = "a configuration at the last point is a reference for others and has none itself";
            return Err(source.fault(&format!("{path}.references"), message, "no `references`, or no `at`"));
        }
        for (j, reference) in configuration.references.iter().enumerate() {
            let place = format!("{path}.references.{j}");
            let found = all.iter().find(|other| other.name == *reference).ok_or_else(|| {
                source.unknown(&place, "configuration", reference, all.iter().map(|other| other.name.as_str()))
            })?;
            check_reference(source, &place, configuration, found, document)?;
        }
        if !configuration.references.is_empty() {
            list(source, &format!("{path}.references"), &configuration.references)?;
        }
    }
    Ok(())
}

/// What is measured does not depend on what a machine happens to have.
fn device(source: &Source, path: &str, device: &DeviceChoice) -> Result<(), PlanError> {
    let is_definite = match device {
        DeviceChoice::Cpu | DeviceChoice::Gpu => true,
        DeviceChoice::Auto => false,
        DeviceChoice::Named(name) => !name.trim().is_empty(),
    };
    if is_definite {
        return Ok(());
    }
    let message = format!("`{device}` names no device");
    Err(source.fault(path, message, "`cpu`, `gpu` or a part of an adapter's name"))
}

fn check_reference(
    source: &Source,
    place: &str,
    configuration: &ConfigurationTable,
    reference: &ConfigurationTable,
    document: &Document,
) -> Result<(), PlanError> {
    let name = &reference.name;
    if *name == configuration.name {
        return Err(source.fault(place, format!("`{name}` is its own reference"), "another configuration"));
    }
    if !reference.references.is_empty() {
        let message = format!("the reference `{name}` has references itself");
        return Err(source.fault(place, message, "a configuration without `references`"));
    }
    let scenes = document.scene.iter().map(|scene| scene.name.as_str());
    let missing = scenes
        .filter(|scene| covers(configuration.scenes.as_ref(), scene) && !covers(reference.scenes.as_ref(), scene))
        .collect::<Vec<_>>();
    match missing[..] {
        [] => Ok(()),
        [scene, ..] => {
            let message = format!("the reference `{name}` is not rendered in the scene `{scene}`");
            Err(source.fault(place, message, "a configuration for all scenes of this one"))
        }
    }
}

/// Points have distinct names in each scene.
fn points(source: &Source, document: &Document) -> Result<(), PlanError> {
    for (i, point) in document.point.iter().enumerate() {
        let path = format!("point.{i}");
        word(source, &format!("{path}.name"), &point.name)?;
        restriction(source, &path, point.scenes.as_ref(), document)?;
        for scene in document.scene.iter().map(|scene| &scene.name) {
            let here = |scenes: &Option<Vec<String>>| covers(scenes.as_ref(), scene);
            let same = |name: &str| name.eq_ignore_ascii_case(&point.name);
            if here(&point.scenes) && document.point[..i].iter().any(|other| same(&other.name) && here(&other.scenes)) {
                let message = format!("two points of the scene `{scene}` have the name `{}`", point.name);
                return Err(source.fault(&format!("{path}.name"), message, "another name"));
            }
        }
    }
    Ok(())
}

/// `scenes` of a configuration or point.
fn restriction(
    source: &Source,
    path: &str,
    scenes: Option<&Vec<String>>,
    document: &Document,
) -> Result<(), PlanError> {
    let Some(scenes) = scenes else { return Ok(()) };
    let path = format!("{path}.scenes");
    list(source, &path, scenes)?;
    let known = document.scene.iter().map(|scene| scene.name.as_str());
    match scenes.iter().enumerate().find(|(_, scene)| !known.clone().any(|name| name == *scene)) {
        Some((i, scene)) => Err(source.unknown(&format!("{path}.{i}"), "scene", scene, known)),
        None => Ok(()),
    }
}
