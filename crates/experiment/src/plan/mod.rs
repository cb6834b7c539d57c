//! From an experiment file to every render that it asks for.
//!
//! [`ExperimentFile::read`] checks the text; [`Plan::new`] reads the scenes, lays the settings over each other and
//! gives each job its hash. Nothing is rendered or written here.

mod check;
mod device;
mod fault;
mod file;
mod job;
mod scene;
mod section;
mod select;
mod settings;

pub use fault::{PlanError, TextFault};
pub use file::ExperimentFile;
pub use job::PlannedJob;
pub use scene::PlannedScene;
pub use select::UnknownName;

use crate::published::Published;
use crate::record::{ConfigurationInfo, FORMAT, Header, SceneInfo};
use device::Devices;
use file::Document;
use job::Conditions;
use lightcuts::gpu::{AdapterSummary, choose};
use lightcuts::image::metrics::{Metric, MetricOptions};
use std::path::PathBuf;

/// Every render of an experiment, in order.
#[derive(Debug)]
pub struct Plan {
    /// The description of the experiment in the results.
    pub header: Header,
    /// The scenes.
    pub scenes: Vec<PlannedScene>,
    /// The renders; references come before what is compared with them, run 1 before the others.
    pub jobs: Vec<PlannedJob>,
    /// Threads that render.
    pub threads: usize,
    /// The graphics adapters of this machine, if any configuration asks for one.
    pub adapters: Vec<AdapterSummary>,
    /// What is measured against references.
    pub metrics: Vec<Metric>,
    /// How it is measured.
    pub metric_options: MetricOptions,
}

impl Plan {
    /// The plan of an experiment on this machine. Models and textures are searched beside their scenes, then in
    /// `search_paths`.
    pub fn new(file: &ExperimentFile, search_paths: &[PathBuf]) -> Result<Self, PlanError> {
        Self::on(device::adapters(&file.document), file, search_paths)
    }

    /// The same on a machine with these graphics adapters.
    pub fn on(
        adapters: Vec<AdapterSummary>,
        file: &ExperimentFile,
        search_paths: &[PathBuf],
    ) -> Result<Self, PlanError> {
        let document = &file.document;
        let published = published(file)?;
        let scenes = (0..document.scene.len()).map(|i| PlannedScene::load(file, i, search_paths));
        let scenes = scenes.collect::<Result<Vec<_>, _>>()?;
        let metrics = metrics(document);
        let metric_options = MetricOptions::default();
        let threads = threads(document.threads);
        let conditions = Conditions { threads, metrics: &metrics, options: &metric_options };
        let devices = Devices::new(document, &adapters);
        let jobs = job::all(file, &scenes, &devices, &conditions)?;
        let header = header(file, &scenes, &devices, published, &jobs);
        Ok(Self { header, scenes, jobs, threads, adapters, metrics, metric_options })
    }

    /// The adapters that jobs are rendered on, each once, in the order of the configurations.
    pub fn used_adapters(&self) -> Vec<&AdapterSummary> {
        let mut places: Vec<usize> = Vec::new();
        for job in &self.jobs {
            let place = choose(&job.device, &self.adapters).ok().flatten();
            places.extend(place.filter(|place| !places.contains(place)));
        }
        places.into_iter().map(|place| &self.adapters[place]).collect()
    }
}

/// Zero threads are as many as the system offers.
fn threads(asked: u32) -> usize {
    match asked {
        0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        asked => asked as usize,
    }
}

/// The metrics asked for, in the order of reports.
fn metrics(document: &Document) -> Vec<Metric> {
    let asked =
        |metric: &Metric| document.metrics.as_ref().is_none_or(|keys| keys.iter().any(|key| key == metric.key()));
    Metric::ALL.into_iter().filter(asked).collect()
}

fn published(file: &ExperimentFile) -> Result<Published, PlanError> {
    let Some(files) = &file.document.published else { return Ok(Published::default()) };
    let find = |path: &Option<String>| path.as_ref().map(|path| file.find(path));
    let (times, accelerations) = (find(&files.times), find(&files.accelerations));
    Published::read(files.source.clone(), times.as_deref(), accelerations.as_deref())
        .map_err(|error| file.source.fault("published", error.to_string(), "CSV files of published figures"))
}

fn header(
    file: &ExperimentFile,
    scenes: &[PlannedScene],
    devices: &Devices,
    published: Published,
    jobs: &[PlannedJob],
) -> Header {
    let document = &file.document;
    let titled = |title: &Option<String>, name: &str| title.clone().unwrap_or_else(|| name.to_owned());
    let scene_info = |(table, scene): (&file::SceneTable, &PlannedScene)| SceneInfo {
        name: table.name.clone(),
        title: titled(&table.title, &table.name),
        stand_in: table.stand_in.as_ref().filter(|_| !scene.missing.is_empty()).map(|stand_in| stand_in.note.clone()),
    };
    let configuration_info = |(i, table): (usize, &file::ConfigurationTable)| ConfigurationInfo {
        name: table.name.clone(),
        title: titled(&table.title, &table.name),
        absent: devices.absent(i).map(str::to_owned),
        references: table.references.clone(),
    };
    Header {
        format: FORMAT,
        name: document.name.clone(),
        title: titled(&document.title, &document.name),
        description: document.description.clone(),
        scenes: document.scene.iter().zip(scenes).map(scene_info).collect(),
        configurations: document.configuration.iter().enumerate().map(configuration_info).collect(),
        points: points(document),
        runs: document.runs,
        seeds: document.seeds.clone(),
        sections: file.sections.clone(),
        published,
        jobs: jobs.iter().map(PlannedJob::info).collect(),
    }
}

/// The names of all points in order, once each.
fn points(document: &Document) -> Vec<String> {
    let mut points: Vec<String> = Vec::new();
    for point in &document.point {
        if !points.contains(&point.name) {
            points.push(point.name.clone());
        }
    }
    points
}
