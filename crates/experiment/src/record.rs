//! What `results.jsonl` holds: one JSON object per line, never changed once written.
//!
//! The first line is a [`Header`]; each finished render adds a [`Row`]. When an experiment file was edited, a new
//! header is added before its rows, and the last header is the one that counts. Paths are relative to the file's
//! folder.

use crate::layout::Section;
use crate::published::Published;
use lightcuts::Stats;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the format; readers refuse others.
pub const FORMAT: u32 = 1;

/// A line of `results.jsonl`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Record {
    /// What is measured and how it is presented.
    Header(Box<Header>),
    /// A finished render.
    Run(Box<Row>),
}

/// The experiment, as far as a report needs it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`FORMAT`].
    pub format: u32,
    /// Name of the experiment, a word.
    pub name: String,
    /// Title of the report.
    pub title: String,
    /// Text under the title, Markdown.
    pub description: String,
    /// Scenes in the file's order.
    pub scenes: Vec<SceneInfo>,
    /// Configurations in the file's order, those without a device included.
    pub configurations: Vec<ConfigurationInfo>,
    /// Points of the swept parameter in order; empty without a sweep.
    pub points: Vec<String>,
    /// Number of runs of each render.
    pub runs: u32,
    /// Seeds.
    pub seeds: Vec<u32>,
    /// Sections of the report, in order.
    pub sections: Vec<Section>,
    /// Figures of others, to stand beside ours.
    pub published: Published,
    /// The plan's jobs in order. Rows of other jobs are of earlier plans.
    pub jobs: Vec<JobInfo>,
}

/// A job of the plan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct JobInfo {
    /// Hash, as in [`Row::job`].
    pub job: String,
    /// Name of the scene.
    pub scene: String,
    /// Name of the configuration.
    pub configuration: String,
    /// Point of the swept parameter.
    pub point: Option<String>,
}

/// A scene of the experiment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneInfo {
    /// Key of the rows.
    pub name: String,
    /// For people.
    pub title: String,
    /// Said where the stand-in was rendered in place of the scene, because a model of the scene is absent.
    pub stand_in: Option<String>,
}

/// A configuration of the experiment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConfigurationInfo {
    /// Key of the rows.
    pub name: String,
    /// For people.
    pub title: String,
    /// Why it was not rendered: there is no such device. `None` for what was rendered.
    pub absent: Option<String>,
    /// Configurations whose pictures it is compared with.
    pub references: Vec<String>,
}

/// A finished render.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Hash of everything that decides the picture and of the run's number, 64 hexadecimal digits: equal jobs are not
    /// rendered twice.
    pub job: String,
    /// Name of the scene.
    pub scene: String,
    /// Name of the configuration.
    pub configuration: String,
    /// Point of the swept parameter.
    pub point: Option<String>,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Number of the run, from 1: same job, timed again.
    pub run: u32,
    /// Whether the stand-in of the scene was rendered.
    pub stand_in: bool,
    /// When it was finished: UTC, as in `2026-11-22T21:21:32Z`.
    pub finished: String,
    /// Version of the program.
    pub version: String,
    /// Git revision the program was built from, with `-dirty` if that was changed; `unknown` outside a checkout.
    pub revision: String,
    /// What rendered.
    pub device: DeviceInfo,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Times and counts.
    pub stats: Stats,
    /// SHA-256 of the picture's linear values, 64 hexadecimal digits: same job, same picture.
    pub picture: String,
    /// The picture as PNG.
    pub png: String,
    /// The picture as EXR.
    pub exr: String,
    /// Comparison with each reference's picture, by the reference's name; empty for references themselves.
    pub comparisons: BTreeMap<String, ComparisonRow>,
}

/// How a picture differs from a reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparisonRow {
    /// Values by the keys of [`Metric::key`](lightcuts::image::metrics::Metric::key); `null` where a metric has none.
    pub metrics: BTreeMap<String, Option<f64>>,
    /// FLIP map as PNG.
    pub flip_map: String,
}

/// A device.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceInfo {
    /// `cpu`, `gpu`, or `software gpu`: a graphics driver that computes on the processor.
    pub kind: String,
    /// Name of the processor or card.
    pub name: String,
    /// Threads used; 0 for a GPU.
    pub threads: u32,
}
