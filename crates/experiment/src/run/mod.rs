//! Running a plan: renders what is not finished, a line of results for each.

mod comparison;
mod devices;
mod machine;
mod pace;
mod pictures;
mod render;

pub use machine::revision;

use crate::plan::{Plan, PlannedJob};
use crate::record::{Record, Row};
use crate::results::{FILE_NAME, Results, ResultsError, ResultsFile};
use devices::Devices;
use lightcuts::gpu::NoDevice;
use lightcuts::image::ImageError;
use lightcuts::image::metrics::Metric;
use lightcuts::{Monitor, SettingsError, Unwatched, WorldError};
use pace::Pace;
use rayon::ThreadPoolBuilder;
use render::Studio;
use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The folder of pictures in an experiment's folder.
const IMAGES: &str = "images";

/// Texts that go into the pictures of a job, such as the job itself, with their names.
pub type Texts<'t> = dyn Fn(&PlannedJob, &Path) -> Vec<(&'static str, String)> + 't;

/// Watches an experiment; as a [`Monitor`] it watches the current render and may stop everything.
pub trait Watch: Monitor {
    /// A job begins.
    fn job_begins(&self, _job: &PlannedJob, _standing: &Standing) {}
    /// A metric of the current job is measured against the picture of `reference`.
    fn compares(&self, _reference: &str, _metric: Metric) {}
    /// A job is finished and its row is on the disk.
    fn job_ends(&self, _row: &Row) {}
}

impl Watch for Unwatched {}

/// How far an experiment is when a job begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Standing {
    /// Number of this job among those that are rendered now, from 1.
    pub number: usize,
    /// How many are rendered now.
    pub of: usize,
    /// Time that this job will probably take; unknown before the first job.
    pub this: Option<Duration>,
    /// Time that those after it will probably take.
    pub later: Option<Duration>,
}

/// What became of the jobs that were asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outcome {
    /// Jobs that were rendered.
    pub rendered: usize,
    /// Jobs that were finished before.
    pub skipped: usize,
    /// Whether it was stopped before the last one.
    pub interrupted: bool,
}

/// Why an experiment cannot continue. Finished rows are kept.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The results cannot be read or written.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A folder cannot be made.
    #[error("cannot make the folder {}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
    /// A picture cannot be written, read or compared.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A scene cannot be rendered.
    #[error("the scene `{scene}` cannot be rendered: {source}")]
    World {
        /// Its name.
        scene: String,
        /// Why not.
        source: Box<WorldError>,
    },
    /// A device that was there when the plan was made cannot be used.
    #[error("the device of `{configuration}` cannot be used for the scene `{scene}`: {why}")]
    Device {
        /// Name of the configuration.
        configuration: String,
        /// Name of the scene.
        scene: String,
        /// What is wrong.
        why: NoDevice,
    },
    /// Settings are out of range; the plan has checked them.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Threads cannot be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Two runs of a job gave two pictures.
    #[error(
        "run {run} of `{job}` gives another picture than run 1, though the same job always gives the same picture; \
         run 1 is of revision {first_revision} on {first_device}, this of {revision} on {device}"
    )]
    NotReproducible {
        /// Scene, configuration, ...
        job: String,
        /// The run that differs.
        run: u32,
        /// What rendered run 1.
        first_revision: String,
        /// Its device.
        first_device: String,
        /// What renders now.
        revision: &'static str,
        /// On which device.
        device: String,
    },
}

/// An experiment in its folder, locked against other processes.
#[derive(Debug)]
pub struct Runner<'a> {
    plan: &'a Plan,
    directory: PathBuf,
    file: ResultsFile,
    /// The finished rows by the numbers of their jobs.
    rows: Vec<Option<Row>>,
}

/// Which jobs of a plan the results in `directory` have finished, with their rows.
///
/// Finished is a job whose last row has its hash, whose files are there and hold the row's picture, and whose first run
/// and references are finished too.
pub fn finished(plan: &Plan, directory: &Path, results: &Results) -> Vec<Option<Row>> {
    let current = results.current();
    let mut rows: Vec<Option<Row>> = Vec::new();
    for (i, job) in plan.jobs.iter().enumerate() {
        let fits = |row: &&Row| {
            let first = rows.get(job.first_run).and_then(Option::as_ref);
            row.job == job.hash
                && (i == job.first_run || first.is_some_and(|first| first.picture == row.picture))
                && job.references.iter().all(|&reference| rows[reference].is_some())
                && pictures::are_of(directory, row)
        };
        let row = current.get(&job.key()).copied().filter(fits).cloned();
        rows.push(row);
    }
    rows
}

impl<'a> Runner<'a> {
    /// Opens `directory`, made if absent, locks its results, and adds the plan's header unless it is the last one
    /// there.
    pub fn open(plan: &'a Plan, directory: &Path) -> Result<Self, RunError> {
        let images = directory.join(IMAGES);
        std::fs::create_dir_all(&images).map_err(|source| RunError::Folder { path: images, source })?;
        let (mut file, results) = ResultsFile::open(&directory.join(FILE_NAME))?;
        if results.header.as_ref() != Some(&plan.header) {
            file.append(&Record::Header(Box::new(plan.header.clone())))?;
        }
        let rows = finished(plan, directory, &results);
        Ok(Self { plan, directory: directory.to_owned(), file, rows })
    }

    /// Renders those of the jobs `selection`, in the plan's order, that are not finished. Every reference of a job must
    /// be finished or selected.
    pub fn run(&mut self, selection: &[usize], texts: &Texts<'_>, watch: &dyn Watch) -> Result<Outcome, RunError> {
        let plan = self.plan;
        let todo: Vec<usize> = selection.iter().copied().filter(|&i| self.rows[i].is_none()).collect();
        let mut outcome = Outcome { rendered: 0, skipped: selection.len() - todo.len(), interrupted: false };
        let pool = ThreadPoolBuilder::new().num_threads(plan.threads).build()?;
        let mut pace = Pace::of(self.rows.iter().flatten());
        for jobs in todo.chunk_by(|&a, &b| plan.jobs[a].scene == plan.jobs[b].scene) {
            let (directory, world) = (self.directory.clone(), OnceCell::new());
            let mut studio =
                Studio { plan, directory, pool: &pool, texts, watch, world: &world, devices: Devices::new(plan) };
            for &i in jobs {
                let start = Instant::now();
                if !watch.cancelled() {
                    watch.job_begins(&plan.jobs[i], &pace.standing(plan, &todo, outcome.rendered));
                }
                let Some(row) = studio.render(i, &self.rows)? else {
                    return Ok(Outcome { interrupted: true, ..outcome });
                };
                pace.add(&row, start.elapsed());
                self.keep(i, row, watch)?;
                outcome.rendered += 1;
            }
        }
        Ok(outcome)
    }

    /// Puts the row of a job on the disk.
    fn keep(&mut self, i: usize, row: Row, watch: &dyn Watch) -> Result<(), RunError> {
        self.file.append(&Record::Run(Box::new(row.clone())))?;
        watch.job_ends(&row);
        self.rows[i] = Some(row);
        Ok(())
    }
}
