//! Experiment files: TOML, checked as far as that goes without the scenes.

use super::fault::{PlanError, Source};
use super::{check, device, section};
use crate::layout::Section;
use lightcuts::Settings;
use lightcuts::gpu::DeviceChoice;
use lightcuts::rendering::{Model, Scope, TomlFault, keys_of, value_at};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::io::Read;
use std::path::{Path, PathBuf};
use toml::Table;
use toml::de::ValueDeserializer;

/// Longest experiment file in bytes.
const MAX_BYTES: u64 = 1 << 20;

/// An experiment file that was read. Paths in it are relative to its folder.
#[derive(Debug)]
pub struct ExperimentFile {
    pub(super) source: Source,
    /// The folder that the file lies in.
    directory: PathBuf,
    pub(super) document: Document,
    pub(super) sections: Vec<Section>,
}

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct Document {
    pub(super) name: String,
    pub(super) title: Option<String>,
    #[serde(default)]
    pub(super) description: String,
    #[serde(default = "one")]
    pub(super) runs: u32,
    #[serde(default = "seed_one")]
    pub(super) seeds: Vec<u32>,
    #[serde(default = "one")]
    pub(super) threads: u32,
    #[serde(default)]
    search_path: Vec<String>,
    pub(super) metrics: Option<Vec<String>>,
    pub(super) published: Option<PublishedFiles>,
    #[serde(default)]
    pub(super) settings: Table,
    #[serde(default)]
    pub(super) scene: Vec<SceneTable>,
    #[serde(default)]
    pub(super) configuration: Vec<ConfigurationTable>,
    #[serde(default)]
    pub(super) point: Vec<PointTable>,
    /// Read table by table, see [`section`].
    #[serde(default)]
    pub(super) section: Vec<IgnoredAny>,
}

impl Document {
    /// Every table of settings with its place.
    fn settings_tables(&self) -> impl Iterator<Item = (String, &Table)> {
        let scenes = self.scene.iter().enumerate().map(|(i, table)| (format!("scene.{i}.settings"), &table.settings));
        let configurations = self.configuration.iter().enumerate();
        let configurations = configurations.map(|(i, table)| (format!("configuration.{i}.settings"), &table.settings));
        let points = self.point.iter().enumerate().map(|(i, table)| (format!("point.{i}.settings"), &table.settings));
        std::iter::once(("settings".to_owned(), &self.settings)).chain(scenes).chain(configurations).chain(points)
    }
}

/// `published`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PublishedFiles {
    pub(super) source: String,
    pub(super) times: Option<String>,
    pub(super) accelerations: Option<String>,
}

/// A `[[scene]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct SceneTable {
    pub(super) name: String,
    pub(super) title: Option<String>,
    pub(super) file: String,
    pub(super) stand_in: Option<StandIn>,
    #[serde(default)]
    pub(super) settings: Table,
}

/// `stand-in` of a scene.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StandIn {
    pub(super) file: String,
    pub(super) note: String,
}

/// A `[[configuration]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ConfigurationTable {
    pub(super) name: String,
    pub(super) title: Option<String>,
    #[serde(default = "device::cpu", deserialize_with = "device::read")]
    pub(super) device: DeviceChoice,
    #[serde(default)]
    pub(super) scene_values: SceneValues,
    #[serde(default)]
    pub(super) at: Place,
    #[serde(default)]
    pub(super) references: Vec<String>,
    pub(super) scenes: Option<Vec<String>>,
    #[serde(default)]
    pub(super) settings: Table,
}

/// Which of a scene's values hold where it recommends two, one per device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum SceneValues {
    /// Those for a CPU, whatever renders: so devices can be compared.
    #[default]
    Cpu,
    /// Those for a GPU.
    Gpu,
}

/// Where in a sweep a configuration is rendered.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Place {
    /// At every point of its scenes.
    #[default]
    EveryPoint,
    /// At the last point of each of its scenes, as a reference for those at all points.
    LastPoint,
}

/// A `[[point]]` of the swept parameter.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointTable {
    pub(super) name: String,
    pub(super) scenes: Option<Vec<String>>,
    #[serde(default)]
    pub(super) settings: Table,
}

fn one() -> u32 {
    1
}

fn seed_one() -> Vec<u32> {
    vec![1]
}

/// Whether a list of scenes, where there is one, names `scene`.
pub(super) fn covers(scenes: Option<&Vec<String>>, scene: &str) -> bool {
    scenes.is_none_or(|scenes| scenes.iter().any(|name| name == scene))
}

impl ExperimentFile {
    /// Reads an experiment file.
    pub fn read(path: &Path) -> Result<Self, PlanError> {
        let text = read_text(path).map_err(|reason| PlanError::Unreadable { path: path.to_owned(), reason })?;
        Self::parse(&path.display().to_string(), &text, path.parent().unwrap_or(Path::new("")))
    }

    /// An experiment of a TOML text, as if it were the file `name` in `directory`.
    pub fn parse(name: &str, text: &str, directory: &Path) -> Result<Self, PlanError> {
        let source = Source { file: name.to_owned(), text: text.to_owned() };
        let refuse = |error: toml::de::Error| source.toml(TomlFault::new(&error));
        let document: Document = toml::from_str(text).map_err(refuse)?;
        check::size(&source, &document)?;
        check_settings(&source, &document)?;
        check::document(&source, &document)?;
        let sections = (0..document.section.len()).map(|i| section::read(&source, i));
        let sections: Vec<Section> = sections.collect::<Result<_, _>>()?;
        section::check(&source, &document, &sections)?;
        Ok(Self { source, directory: directory.to_owned(), document, sections })
    }

    /// The name of the experiment.
    pub fn name(&self) -> &str {
        &self.document.name
    }

    /// Its own folders to search for models and textures.
    pub fn search_path(&self) -> Vec<PathBuf> {
        self.document.search_path.iter().map(|folder| self.find(folder)).collect()
    }

    /// What a path in the file means.
    pub(super) fn find(&self, path: &str) -> PathBuf {
        self.directory.join(path)
    }
}

/// Checks keys and kinds of values of every table of settings; ranges hold or not for all tables together.
fn check_settings(source: &Source, document: &Document) -> Result<(), PlanError> {
    for (place, table) in document.settings_tables() {
        let Some(value) = value_at(&source.text, &place) else { continue };
        let read = Settings::deserialize(ValueDeserializer::from(value));
        let run = read.map_err(|error| source.toml(TomlFault::new(&error)))?.run;
        check_model(source, &place, table, run.model)?;
        let (seed, path) = (run.seed, format!("{place}.run.seed"));
        // Every render is made with each of the seeds; another one here would be without effect.
        if source.has(&path) && document.seeds != [seed] {
            return Err(source.fault(&path, format!("run.seed is {seed}"), &format!("`seeds = [{seed}]` at the top")));
        }
    }
    Ok(())
}

/// Fails if the table of settings at `place` asks for another model of light than the thesis', or sets what that lacks:
/// nothing of it would come to pass.
fn check_model(source: &Source, place: &str, table: &Table, model: Model) -> Result<(), PlanError> {
    if model != Model::Thesis {
        let message = format!("run.model is {}, but experiments render the thesis' model only", model.name());
        return Err(source.fault(&format!("{place}.run.model"), message, "no run.model, or `thesis`"));
    }
    let is_foreign = |key: &&String| Scope::of(key).is_some_and(|scope| !scope.includes(Model::Thesis));
    match keys_of(table).iter().find(is_foreign) {
        None => Ok(()),
        Some(key) => {
            let message = format!("`{key}` has no meaning here: experiments render the thesis' model only");
            Err(source.fault(&format!("{place}.{key}"), message, "settings of the thesis' model"))
        }
    }
}

fn read_text(path: &Path) -> Result<String, String> {
    let told = |error: std::io::Error| error.to_string();
    // A pipe would be waited for without end.
    if !std::fs::metadata(path).map_err(told)?.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(told)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(told)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err("it is longer than 1 MiB".to_owned());
    }
    String::from_utf8(bytes).map_err(|_| "it is not UTF-8 text".to_owned())
}
