//! Settings from four sources, by laying TOML tables over each other.

use super::JobFile;
use crate::args::SettingFlags;
use crate::exit::Failure;
use lightcuts::Settings;
use lightcuts::rendering::{Model, overlay};
use toml::{Table, Value};

/// `scene` (built-in defaults with the scene's recommendations), under the job files in their order, under the flags;
/// checked, so that rendering cannot fail.
pub(crate) fn resolve(scene: &Settings, files: &[JobFile], flags: &SettingFlags) -> Result<Settings, Failure> {
    let unexpected = |error: &dyn ToString| Failure::usage(error.to_string(), "see `lightcuts render --help`");
    let mut table = Table::try_from(scene).map_err(|error| unexpected(&error))?;
    for file in files {
        overlay(&mut table, &file.settings);
    }
    let flags = Table::try_from(flags).map_err(|error| unexpected(&error))?;
    overlay(&mut table, &flags);
    let is_given =
        files.iter().map(|file| &file.settings).chain([&flags]).any(|given| is_set(given, "sampling.samples"));
    if !is_given {
        lift_samples(&mut table);
    }
    let settings: Settings = table.try_into().map_err(|error: toml::de::Error| unexpected(&error.message()))?;
    settings.validate().map_err(|error| {
        let culprit = files.iter().rev().find_map(|file| Some((file, file.span_of(&error.name)?)));
        match culprit {
            _ if is_set(&flags, &error.name) => Failure::usage(error.to_string(), "it comes from the command line"),
            Some((file, span)) => file.out_of_range(&error, span),
            None => Failure::usage(error.to_string(), "it comes from the scene's recommendations"),
        }
    })?;
    Ok(settings)
}

/// Where time or noise ends a render of the physical model, there is no number of samples that would end it earlier unless one is
/// given.
fn lift_samples(table: &mut Table) {
    let has_other_limit = table.clone().try_into().is_ok_and(|settings: Settings| settings.has_other_limit());
    if let Some(sampling) = table.get_mut("sampling").and_then(Value::as_table_mut).filter(|_| has_other_limit) {
        sampling.insert("samples".to_owned(), Value::Integer(0));
    }
}

/// Tables and keys that matter in the thesis' model of light only.
const OF_THESIS: [&str; 14] = [
    "vpl",
    "ambient-occlusion",
    "caustics.step",
    "caustics.radius",
    "caustics.min-photons",
    "caustics.min-reflection",
    "caustics.min-refraction",
    "caustics.min-diffuse",
    "bloom",
    "gather.threshold",
    "run.max-depth",
    "sampling.sampler",
    "sampling.adaptive-samples",
    "sampling.adaptive-threshold",
];

/// Those of the physical model.
const OF_PHYSICAL: [&str; 1] = ["physical"];

/// Fails if the command line sets what does not matter in a model of light.
pub(crate) fn require_fitting(flags: &SettingFlags, model: Model) -> Result<(), Failure> {
    let table =
        Table::try_from(flags).map_err(|error| Failure::usage(error.to_string(), "see `lightcuts render --help`"))?;
    let (foreign, name) = match model {
        Model::Thesis => (&OF_PHYSICAL[..], "thesis'"),
        Model::Physical => (&OF_THESIS[..], "physical"),
    };
    match foreign.iter().find(|key| is_set(&table, key)) {
        None => Ok(()),
        Some(key) => Err(Failure::usage(
            format!("an option of `{key}` is given, which has no meaning in the {name} model of light"),
            "leave it out, or choose the other model with --model",
        )),
    }
}

/// Whether `table.key` has a value.
fn is_set(table: &Table, parameter: &str) -> bool {
    let (first, rest) = parameter.split_once('.').unwrap_or((parameter, ""));
    match table.get(first) {
        Some(Value::Table(inner)) if rest.is_empty() => inner.values().any(|value| !is_empty_table(value)),
        Some(Value::Table(inner)) => is_set(inner, rest),
        found => found.is_some(),
    }
}

fn is_empty_table(value: &Value) -> bool {
    value.as_table().is_some_and(Table::is_empty)
}
