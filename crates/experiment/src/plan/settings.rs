//! The settings of a job: tables laid over what its scene recommends.

use super::fault::PlanError;
use super::file::{ExperimentFile, SceneValues};
use lightcuts::Settings;
use lightcuts::rendering::{Model, TomlFault, overlay};
use lightcuts::scene::SceneDesc;
use toml::Table;

/// Which tables hold for a job, by their numbers in the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tables {
    pub(super) scene: usize,
    pub(super) configuration: usize,
    pub(super) point: Option<usize>,
}

/// Recommendations of the scene, under `[settings]`, under those of the scene, the configuration and the point, under
/// the seed; checked, so that rendering cannot fail.
pub(super) fn resolve(
    file: &ExperimentFile,
    tables: Tables,
    scene: &SceneDesc,
    seed: u32,
) -> Result<Settings, PlanError> {
    let values = file.document.configuration[tables.configuration].scene_values;
    let unexpected = |message: &str| file.source.fault("settings", message, "settings as in a job file");
    let mut table = Table::try_from(recommended(scene, values)).map_err(|error| unexpected(&error.to_string()))?;
    let layers = layers(file, tables);
    for (_, layer) in &layers {
        overlay(&mut table, layer);
    }
    let mut settings: Settings =
        table.try_into().map_err(|error: toml::de::Error| unexpected(&TomlFault::new(&error).message))?;
    settings.run.seed = seed;
    // No table names another model: that was checked when the file was read.
    settings.validate().and_then(|()| settings.require_model(Model::Thesis)).map_err(|error| {
        let places = layers.iter().rev().map(|(place, _)| format!("{place}.{}", error.name));
        let culprit = places.into_iter().find(|place| file.source.has(place));
        let place = culprit.unwrap_or_else(|| format!("scene.{}.file", tables.scene));
        file.source.fault(&place, format!("{} is {}", error.name, error.value), &error.expected)
    })?;
    Ok(settings)
}

/// What a scene recommends to one kind of device.
fn recommended(scene: &SceneDesc, values: SceneValues) -> Settings {
    let mut settings = Settings::for_scene(scene);
    if values == SceneValues::Gpu {
        if let Some(vpl) = scene.defaults.vpl {
            settings.vpl.probability = vpl.probability.gpu;
            settings.vpl.min_illumination = vpl.min_illumination.gpu;
            settings.vpl.attenuation = vpl.attenuation.gpu;
        }
        if let Some(threshold) = scene.defaults.threshold {
            settings.gather.threshold = threshold.gpu;
        }
    }
    settings
}

/// Each table with its place in the file, the lowest first.
fn layers(file: &ExperimentFile, Tables { scene, configuration, point }: Tables) -> Vec<(String, &Table)> {
    let document = &file.document;
    let mut layers = vec![
        ("settings".to_owned(), &document.settings),
        (format!("scene.{scene}.settings"), &document.scene[scene].settings),
        (format!("configuration.{configuration}.settings"), &document.configuration[configuration].settings),
    ];
    layers.extend(point.map(|point| (format!("point.{point}.settings"), &document.point[point].settings)));
    layers
}
