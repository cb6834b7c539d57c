//! The jobs of a plan: every render, in order, references before what is compared with them.

use super::check;
use super::device::Devices;
use super::fault::PlanError;
use super::file::{ExperimentFile, Place, covers};
use super::scene::PlannedScene;
use super::settings::{Tables, resolve};
use crate::hash::Fields;
use crate::record::JobInfo;
use crate::results::Key;
use lightcuts::Settings;
use lightcuts::gpu::DeviceChoice;
use lightcuts::image::metrics::{Metric, MetricOptions};
use std::ops::Range;

/// A render of the experiment.
#[derive(Debug, Clone)]
pub struct PlannedJob {
    /// Hash of everything that decides the picture, the row's comparisons and the conditions of its time; 64
    /// hexadecimal digits. Not of paths, dates, or the program's version.
    pub hash: String,
    /// Number of the scene in the plan.
    pub scene: usize,
    /// Name of the scene.
    pub scene_name: String,
    /// Name of the configuration.
    pub configuration: String,
    /// Point of the swept parameter.
    pub point: Option<String>,
    /// Number of the run, from 1.
    pub run: u32,
    /// What renders it, as it was asked for.
    pub device: DeviceChoice,
    /// Every setting, the seed included.
    pub settings: Settings,
    /// Run 1 of the same job, by its number in the plan; itself if it is that.
    pub first_run: usize,
    /// The jobs whose pictures it is compared with, by their numbers in the plan.
    pub references: Vec<usize>,
}

impl PlannedJob {
    /// Key of its row.
    pub fn key(&self) -> Key<'_> {
        Key {
            scene: &self.scene_name,
            configuration: &self.configuration,
            point: self.point.as_deref(),
            seed: self.settings.run.seed,
            run: self.run,
        }
    }

    /// Its entry in the header.
    pub(super) fn info(&self) -> JobInfo {
        JobInfo {
            job: self.hash.clone(),
            scene: self.scene_name.clone(),
            configuration: self.configuration.clone(),
            point: self.point.clone(),
        }
    }

    /// Scene, configuration, point and seed as a part of file names; the default seed is not named.
    pub fn stem(&self) -> String {
        let mut parts = vec![self.scene_name.clone(), self.configuration.clone()];
        parts.extend(self.point.clone());
        if self.settings.run.seed != Settings::default().run.seed {
            parts.push(format!("seed-{}", self.settings.run.seed));
        }
        parts.join("--")
    }
}

/// What goes into the hash of every job.
pub(super) struct Conditions<'a> {
    pub(super) threads: usize,
    pub(super) metrics: &'a [Metric],
    pub(super) options: &'a MetricOptions,
}

/// All jobs: run 1 of everything, then run 2, ...; in each run scene by scene, what is rendered at the last point
/// alone, then point by point; seed by seed.
pub(super) fn all(
    file: &ExperimentFile,
    scenes: &[PlannedScene],
    devices: &Devices,
    conditions: &Conditions<'_>,
) -> Result<Vec<PlannedJob>, PlanError> {
    let mut jobs = Jobs { file, devices, conditions, list: Vec::new(), at_last_point: 0..0 };
    for (i, scene) in scenes.iter().enumerate() {
        let points = points(file, &scene.name);
        let start = jobs.list.len();
        jobs.add_point(scene, i, points.last().copied().flatten(), Place::LastPoint)?;
        jobs.at_last_point = start..jobs.list.len();
        for point in points {
            jobs.add_point(scene, i, point, Place::EveryPoint)?;
        }
    }
    Ok(repeated(jobs.list, file.document.runs, scenes, conditions))
}

/// Jobs on their way.
struct Jobs<'a> {
    file: &'a ExperimentFile,
    devices: &'a Devices,
    conditions: &'a Conditions<'a>,
    list: Vec<PlannedJob>,
    /// Those of the current scene that are rendered at its last point alone.
    at_last_point: Range<usize>,
}

impl Jobs<'_> {
    /// Adds a job for each seed and each configuration that is rendered at `place`; `i` is the scene's number.
    fn add_point(
        &mut self,
        scene: &PlannedScene,
        i: usize,
        point: Option<usize>,
        place: Place,
    ) -> Result<(), PlanError> {
        let configurations = configurations(self.file, self.devices, &scene.name, place);
        for &seed in &self.file.document.seeds {
            self.add(scene, Tables { scene: i, configuration: 0, point }, &configurations, seed)?;
            check::jobs(&self.file.source, self.list.len().saturating_mul(self.file.document.runs as usize))?;
        }
        Ok(())
    }

    /// Adds a job for each of `configurations`.
    fn add(
        &mut self,
        scene: &PlannedScene,
        tables: Tables,
        configurations: &[usize],
        seed: u32,
    ) -> Result<(), PlanError> {
        let start = self.list.len();
        for &configuration in configurations {
            let tables = Tables { configuration, ..tables };
            let settings = resolve(self.file, tables, &scene.description, seed)?;
            let table = &self.file.document.configuration[configuration];
            // A reference without a device has no picture.
            let number = |name: &String| {
                let is = |job: &PlannedJob| job.configuration == *name && job.settings.run.seed == seed;
                (start..self.list.len()).chain(self.at_last_point.clone()).find(|&i| is(&self.list[i]))
            };
            let mut job = PlannedJob {
                hash: String::new(),
                scene: tables.scene,
                scene_name: scene.name.clone(),
                configuration: table.name.clone(),
                point: tables.point.map(|point| self.file.document.point[point].name.clone()),
                run: 1,
                device: table.device.clone(),
                settings,
                first_run: self.list.len(),
                references: table.references.iter().filter_map(number).collect(),
            };
            check_sizes(self.file, configuration, &job, &self.list)?;
            job.hash = hash(&job, &self.list, &scene.hash, self.conditions);
            self.list.push(job);
        }
        Ok(())
    }
}

/// Further runs after all first ones.
fn repeated(
    mut jobs: Vec<PlannedJob>,
    runs: u32,
    scenes: &[PlannedScene],
    conditions: &Conditions<'_>,
) -> Vec<PlannedJob> {
    let firsts = jobs.len();
    for run in 2..=runs {
        for i in 0..firsts {
            let mut job = PlannedJob { run, ..jobs[i].clone() };
            job.hash = hash(&job, &jobs, &scenes[job.scene].hash, conditions);
            jobs.push(job);
        }
    }
    jobs
}

/// The points of a scene by their numbers; one without a number where there are none.
fn points(file: &ExperimentFile, scene: &str) -> Vec<Option<usize>> {
    let points = file.document.point.iter().enumerate();
    let here: Vec<_> = points.filter(|(_, point)| covers(point.scenes.as_ref(), scene)).map(|(i, _)| Some(i)).collect();
    if here.is_empty() { vec![None] } else { here }
}

/// The configurations of a scene at a place that have a device, by their numbers, those without references first.
fn configurations(file: &ExperimentFile, devices: &Devices, scene: &str, place: Place) -> Vec<usize> {
    let all = file.document.configuration.iter().enumerate().filter(|(i, _)| devices.absent(*i).is_none());
    let here = all.filter(|(_, it)| it.at == place && covers(it.scenes.as_ref(), scene));
    let (compared, references): (Vec<_>, Vec<_>) = here.partition(|(_, it)| !it.references.is_empty());
    references.into_iter().chain(compared).map(|(i, _)| i).collect()
}

/// Pictures of two sizes cannot be compared.
fn check_sizes(
    file: &ExperimentFile,
    configuration: usize,
    job: &PlannedJob,
    jobs: &[PlannedJob],
) -> Result<(), PlanError> {
    let size = job.settings.image;
    match job.references.iter().map(|&i| &jobs[i]).find(|reference| reference.settings.image != size) {
        None => Ok(()),
        Some(reference) => {
            let other = reference.settings.image;
            let message = format!(
                "in the scene `{}` the picture has {} x {} pixels, that of the reference `{}` {} x {}",
                job.scene_name, size.width, size.height, reference.configuration, other.width, other.height
            );
            Err(file.source.fault(&format!("configuration.{configuration}.references"), message, "one size"))
        }
    }
}

fn hash(job: &PlannedJob, jobs: &[PlannedJob], scene: &str, conditions: &Conditions<'_>) -> String {
    // A table of plain values cannot fail to become text.
    let settings = toml::to_string(&job.settings).expect("settings are TOML");
    let mut fields = Fields::of("lightcuts job 1")
        .with("scene", scene)
        .with("settings", settings)
        .with("device", job.device.to_string())
        .with("threads", conditions.threads.to_string())
        .with("run", job.run.to_string());
    for &reference in &job.references {
        fields = fields.with("reference", &jobs[reference].configuration).with("its job", &jobs[reference].hash);
    }
    if !job.references.is_empty() {
        let metrics: Vec<&str> = conditions.metrics.iter().map(|metric| metric.key()).collect();
        fields = fields.with("metrics", metrics.join(" ")).with("options", format!("{:?}", conditions.options));
    }
    fields.finish()
}
