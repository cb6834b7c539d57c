//! Settings from four sources, by laying TOML tables over each other.

use super::JobFile;
use crate::args::{RenderArgs, SettingFlags};
use crate::exit::Failure;
use lightcuts::Settings;
use lightcuts::rendering::{Model, overlay, value_in};
use toml::{Table, Value};

/// The model of light asked for: by the flags, else by the last job file that names one, else that of the scene.
pub(crate) fn model(scene: Model, files: &[JobFile], flags: &SettingFlags) -> Model {
    let of_flags = model_in(&flags.table());
    of_flags.or_else(|| files.iter().rev().find_map(JobFile::model)).unwrap_or(scene)
}

/// `recommended` (built-in defaults with the scene's recommendations, in the model of light of the render), under the
/// job files in their order, under the flags; checked, so that rendering cannot fail. Fails at a key of a job file that
/// has no meaning in the model.
pub(crate) fn resolve(recommended: &Settings, files: &[JobFile], flags: &SettingFlags) -> Result<Settings, Failure> {
    let unexpected = |error: &dyn ToString| Failure::usage(error.to_string(), "see `lightcuts render --help`");
    let mut table = Table::try_from(recommended).map_err(|error| unexpected(&error))?;
    for file in files {
        overlay(&mut table, &file.settings_for(recommended.run.model)?);
    }
    let given = flags.table();
    overlay(&mut table, &given);
    let lends = |file: &JobFile| file.span_of("sampling.samples").is_some();
    if value_in(&given, "sampling.samples").is_none() && !files.iter().any(lends) {
        lift_samples(&mut table);
    }
    let settings: Settings = table.try_into().map_err(|error: toml::de::Error| unexpected(&error.message()))?;
    settings.validate().map_err(|error| {
        let culprit = files.iter().rev().find_map(|file| Some((file, file.span_of(&error.name)?)));
        match (value_in(&given, &error.name), culprit) {
            (Some(value), _) => {
                let option = flags.option_for(&error.name);
                // A switch is typed without its value.
                let told = if value.is_bool() {
                    format!("{option} needs {}", error.expected)
                } else {
                    format!("{option} is {}; expected {}", error.value, error.expected)
                };
                Failure::usage(told, "see `lightcuts render --help`")
            }
            (None, Some((file, span))) => file.out_of_range(&error, span),
            (None, None) => Failure::usage(error.to_string(), "this is what the scene recommends; set another value"),
        }
    })?;
    Ok(settings)
}

/// Where time or noise ends a render of the physical model, there is no number of samples that would end it earlier
/// unless one is given.
fn lift_samples(table: &mut Table) {
    let has_other_limit = table.clone().try_into().is_ok_and(|settings: Settings| settings.has_other_limit());
    if let Some(sampling) = table.get_mut("sampling").and_then(Value::as_table_mut).filter(|_| has_other_limit) {
        sampling.insert("samples".to_owned(), Value::Integer(0));
    }
}

/// Fails if the command line sets what has no meaning in the model of light of the render; `of_scene` is that of its
/// scene.
pub(crate) fn require_fitting(args: &RenderArgs, model: Model, of_scene: Model) -> Result<(), Failure> {
    let foreign = args.foreign_options(model);
    if foreign.is_empty() {
        return Ok(());
    }
    let (have, them) = if foreign.len() == 1 { ("has", "it") } else { ("have", "them") };
    let message = format!("{} {have} no meaning in {} of light", foreign.join(", "), model.title());
    let help = match (model, of_scene) {
        (Model::Physical, Model::Physical) => format!("leave {them} out: the scene is of the physical model"),
        (Model::Physical, Model::Thesis) => format!("leave {them} out, or render with --model thesis"),
        (Model::Thesis, _) => format!("leave {them} out, or render with --model physical"),
    };
    let counterparts = args.counterparts(model);
    let counterparts = counterparts.iter().map(|[ours, given]| format!("{ours} takes the place of {given}"));
    let counterparts: Vec<String> = counterparts.collect();
    let told = if counterparts.is_empty() {
        String::new()
    } else {
        format!("; in {} {}", model.title(), counterparts.join(", and "))
    };
    Err(Failure::usage(message, help + &told))
}

/// The model that a table of settings names.
pub(super) fn model_in(settings: &Table) -> Option<Model> {
    value_in(settings, "run.model")?.clone().try_into().ok()
}
