//! Jobs in files: TOML, alone or in the header of a picture.

use super::diagnostic::{TOP_KEYS, toml_fault};
use super::merge::model_in;
use super::{kind, path};
use crate::args::{counterpart_of, scope_of};
use crate::exit::{Exit, Failure};
use crate::fault::fault;
use lightcuts::rendering::{Model, Scope, keys_of, value_at, value_in};
use lightcuts::{Settings, SettingsError, image};
use serde::Deserialize;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, Deserializer};
use toml::{Table, Value};

/// Name of the text in a picture that holds the whole job as TOML.
pub(crate) const JOB_ATTRIBUTE: &str = "lightcuts:job";
/// Name of the text in a picture that holds the version of the program that made it.
pub(crate) const VERSION_ATTRIBUTE: &str = "lightcuts:version";
/// Text in a picture that was not finished: `false`.
pub(crate) const COMPLETE_ATTRIBUTE: &str = "lightcuts:complete";

/// Longest job file in bytes; a whole job has about 2 KB.
const MAX_BYTES: u64 = 1 << 20;

/// The part of a job that a file gives. Paths are relative to the current folder.
#[derive(Debug)]
pub(crate) struct JobFile {
    name: String,
    text: String,
    pub(crate) scene: Option<PathBuf>,
    pub(crate) search_path: Vec<PathBuf>,
    pub(crate) crease_angle: Option<f32>,
    pub(crate) read_vpls: Option<PathBuf>,
    /// The tables of settings, with the keys that are there.
    settings: Table,
}

/// The keys beside the settings.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Head {
    scene: Option<String>,
    #[serde(default)]
    search_path: Vec<String>,
    crease_angle: Option<f32>,
    read_vpls: Option<String>,
}

/// Whether the extension is `extension`, in either case.
pub(crate) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

/// Whether a file holds a job and not a scene: pictures do, and TOML files that are no scenes. What cannot be read
/// counts as a scene: reading it will tell why.
pub(crate) fn is_job_carrier(path: &Path) -> bool {
    ["exr", "png"].iter().any(|extension| has_extension(path, extension))
        || (has_extension(path, "toml") && start_of(path).is_some_and(|text| !kind::is_scene(&text)))
}

/// The text of a regular file, or as much of it as a job may have.
fn start_of(path: &Path) -> Option<String> {
    require_regular(path).ok()?;
    let mut bytes = Vec::new();
    std::fs::File::open(path).ok()?.take(MAX_BYTES).read_to_end(&mut bytes).ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

impl JobFile {
    /// Reads a job file, or the job of a picture.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let directory = path.parent().unwrap_or(Path::new(""));
        let name = path.display().to_string();
        if !has_extension(path, "exr") && !has_extension(path, "png") {
            return Self::parse(&name, &read_text(path)?, directory);
        }
        let text = picture_text(path, JOB_ATTRIBUTE)?.ok_or_else(|| {
            Failure::input(format!("{name} holds no job: only pictures that lightcuts wrote can be rendered again"))
        })?;
        Self::new(&format!("{name} ({JOB_ATTRIBUTE})"), &text, directory, true)
    }

    /// The job of a TOML text in `directory`.
    pub(crate) fn parse(name: &str, text: &str, directory: &Path) -> Result<Self, Failure> {
        Self::new(name, text, directory, false)
    }

    fn new(name: &str, text: &str, directory: &Path, in_picture: bool) -> Result<Self, Failure> {
        let (head, settings) = checked(text).map_err(|error| toml_fault(name, text, &error))?;
        if let Some(angle) = head.crease_angle.filter(|angle| !(0.0..=180.0).contains(angle)) {
            let span = value_at(text, "crease-angle").map(|value| value.span()).unwrap_or_default();
            let message = format!("crease-angle is {angle}");
            return Err(fault(Exit::Usage, name, text, span, &message, "expected an angle from 0 to 180 degrees"));
        }
        let find = |path: &String| path::find(path, directory, in_picture);
        Ok(Self {
            name: name.to_owned(),
            text: text.to_owned(),
            scene: head.scene.as_ref().map(find),
            search_path: head.search_path.iter().map(find).collect(),
            crease_angle: head.crease_angle,
            read_vpls: head.read_vpls.as_ref().map(find),
            settings,
        })
    }

    /// How people know it.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Whether it has neither keys nor tables.
    pub(crate) fn is_empty(&self) -> bool {
        self.text.parse::<Table>().is_ok_and(|table| table.is_empty())
    }

    /// Where this job sets the parameter `table.key`, if it does.
    pub(super) fn span_of(&self, parameter: &str) -> Option<Range<usize>> {
        value_at(&self.text, parameter).map(|value| value.span())
    }

    /// The model of light that this job names.
    pub(crate) fn model(&self) -> Option<Model> {
        model_in(&self.settings)
    }

    /// The settings that this job lends to a render in a model of light. Where the render is in another model than the
    /// job names, as `--model` can ask for, these are those that both models have.
    ///
    /// Fails at a key that has no meaning in the job's own model, or, where it names none, in that of the render.
    pub(super) fn settings_for(&self, model: Model) -> Result<Table, Failure> {
        let own = self.model().unwrap_or(model);
        let mut settings = self.settings.clone();
        let read_vpls = self.read_vpls.iter().map(|_| "read-vpls".to_owned());
        let tolerates_defaults = self.is_whole();
        for key in keys_of(&self.settings).into_iter().chain(read_vpls) {
            let Some(scope) = scope_of(&key) else { continue };
            let is_fine = scope.includes(own) || (tolerates_defaults && self.is_default(&key));
            if !is_fine {
                return Err(self.foreign(&key, own));
            }
            if !scope.includes(model) {
                remove(&mut settings, &key);
            }
        }
        Ok(settings)
    }

    /// Whether this job holds every table of both models, as those do that earlier versions wrote.
    fn is_whole(&self) -> bool {
        let is_table_of_one = |key: &&str| matches!(Scope::of(key), Some(Scope::Only(_)));
        let defaults = Table::try_from(Settings::default()).unwrap_or_default();
        self.model().is_some()
            && defaults.keys().map(String::as_str).filter(is_table_of_one).all(|key| self.settings.contains_key(key))
    }

    /// Whether this job sets a parameter to its built-in default.
    fn is_default(&self, key: &str) -> bool {
        let read: Result<Settings, _> = self.settings.clone().try_into();
        let Ok(Ok(read)) = read.map(Table::try_from) else { return false };
        let defaults = Table::try_from(Settings::default()).unwrap_or_default();
        value_in(&read, key).is_some_and(|value| value_in(&defaults, key) == Some(value))
    }

    /// The complaint about a parameter without a meaning in the model.
    fn foreign(&self, key: &str, model: Model) -> Failure {
        let message = format!("`{key}` has no meaning in {} of light", model.title());
        let span = self.span_of(key).unwrap_or_default();
        let label = if model == Model::Thesis { "only with --model physical" } else { "only in the thesis' model" };
        let label = counterpart_of(key).map_or_else(
            || label.to_owned(),
            |other| format!("{label}; `{other}` takes its place in {}", model.title()),
        );
        fault(Exit::Usage, &self.name, &self.text, span, &message, &label)
    }

    /// The complaint about a crease angle, if this job has one, for a scene in the thesis' text format.
    pub(crate) fn needless_crease_angle(&self) -> Option<Failure> {
        self.crease_angle?;
        let span = self.span_of("crease-angle").unwrap_or_default();
        let message = "`crease-angle` has no meaning in the thesis' text format";
        Some(fault(Exit::Usage, &self.name, &self.text, span, message, "only for scenes in TOML"))
    }

    /// The complaint that this job names the thesis' model for a scene that it cannot render.
    pub(crate) fn wrong_model(&self) -> Failure {
        let span = self.span_of("run.model").unwrap_or_default();
        let message = "run.model is thesis, but the scene is of the physical model";
        let label = "with --model physical the settings are used that both models have";
        fault(Exit::Usage, &self.name, &self.text, span, message, label)
    }

    /// The complaint about a parameter that this job sets at `span`.
    pub(super) fn out_of_range(&self, error: &SettingsError, span: Range<usize>) -> Failure {
        fault(Exit::Usage, &self.name, &self.text, span, &error.to_string(), &format!("expected {}", error.expected))
    }
}

/// Checks a job's text as far as it can be without the scene: syntax, keys, kinds of values.
fn checked(text: &str) -> Result<(Head, Table), toml::de::Error> {
    let head = toml::from_str(text)?;
    let mut document = DeTable::parse(text)?;
    let mut settings: Table = toml::from_str(text)?;
    for key in TOP_KEYS {
        document.get_mut().remove(key);
        settings.remove(key);
    }
    Settings::deserialize(Deserializer::from(document))?;
    Ok((head, settings))
}

/// Removes `table.key`.
fn remove(table: &mut Table, key: &str) {
    match key.split_once('.') {
        None => drop(table.remove(key)),
        Some((first, rest)) => {
            if let Some(Value::Table(inner)) = table.get_mut(first) {
                remove(inner, rest);
            }
        }
    }
}

fn read_text(path: &Path) -> Result<String, Failure> {
    let refuse =
        |why: &str| Failure::usage(format!("cannot read the job {}: {why}", path.display()), "a job is a TOML file");
    require_regular(path).map_err(|why| refuse(&why))?;
    let file = std::fs::File::open(path).map_err(|error| refuse(&error.to_string()))?;
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|error| refuse(&error.to_string()))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(refuse("it is longer than 1 MiB"));
    }
    String::from_utf8(bytes).map_err(|_| refuse("it is not UTF-8 text"))
}

/// The text `keyword` in the header of a picture.
fn picture_text(path: &Path, keyword: &str) -> Result<Option<String>, Failure> {
    require_picture(path)?;
    let text = if has_extension(path, "exr") {
        image::read_exr_attributes(path).map(|mut attributes| attributes.remove(keyword))
    } else {
        image::read_png_text(path, keyword)
    };
    text.map_err(Failure::input)
}

/// Fails unless there is a regular file: a pipe would be waited for without end.
pub(crate) fn require_regular(path: &Path) -> Result<(), String> {
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => Ok(()),
        Ok(_) => Err("it is not a regular file".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

/// Fails unless there is a regular file to read a picture from.
pub(crate) fn require_picture(path: &Path) -> Result<(), Failure> {
    require_regular(path).map_err(|why| Failure::input(format!("cannot read the picture {}: {why}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaint(text: &str) -> String {
        let failure = JobFile::parse("job.toml", text, Path::new("")).unwrap_err();
        let labels = failure.report.labels().into_iter().flatten();
        labels.fold(failure.report.to_string(), |all, label| format!("{all} | {}", label.label().unwrap_or_default()))
    }

    #[test]
    fn typos_are_named_with_their_place_and_the_nearest_key() {
        let typo = complaint("scene = 'a'\n[sampling]\nsmaples = 4\n");
        assert!(typo.starts_with("job.toml:3:1: unknown key `smaples`; expected `sampler`, `samples`"), "{typo}");
        assert!(typo.ends_with("did you mean `samples`?"), "{typo}");
        let typo = complaint("secne = 'a'");
        assert!(typo.starts_with("job.toml:1:1: unknown key `secne`") && typo.contains("mean `scene`?"), "{typo}");
        let typo = complaint("[gather]\nstrategy = 'lightcut'\n");
        assert!(typo.starts_with("job.toml:2:12: unknown value `lightcut`; expected `all`, `lightcuts`"), "{typo}");
    }

    #[test]
    fn wrong_kinds_of_values_are_told_in_plain_words() {
        let cases = [
            ("[gather]\nthreshold = 'x'", "job.toml:2:13: wrong kind of value: string \"x\", expected a number"),
            ("[image]\nwidth = -1", "job.toml:2:9: invalid value: integer `-1`, expected a whole number, 0 or more"),
            (
                "[image]\nwidth = 1.5",
                "job.toml:2:9: wrong kind of value: number `1.5`, expected a whole number, 0 or more",
            ),
            ("image = 3", "job.toml:1:9: wrong kind of value: integer `3`, expected a table"),
            ("scene = 3", "job.toml:1:9: wrong kind of value: integer `3`, expected a string"),
            ("search-path = 'a'", "job.toml:1:15: wrong kind of value: string \"a\", expected a list"),
            ("[image\nwidth = 1", "job.toml:1:7: "),
        ];
        for (text, expected) in cases {
            let found = complaint(text);
            assert!(found.starts_with(expected), "{text:?}: {found}");
        }
    }

    #[test]
    fn parameters_are_found_again() {
        let job = JobFile::parse("a", "[image]\nwidth = 0\n[display.local]\nkey = 1\n", Path::new("")).unwrap();
        assert_eq!(job.span_of("image.width"), Some(16..17));
        assert_eq!(job.span_of("image.height"), None);
        assert!(job.span_of("display").is_some());
    }
}
