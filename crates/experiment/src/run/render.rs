//! One job, from its world to its row.

use super::comparison::with_reference;
use super::pictures::{self, Names};
use super::{RunError, Texts, Watch, machine};
use crate::hash;
use crate::plan::{Plan, PlannedJob};
use crate::record::{ComparisonRow, Row};
use lightcuts::image::Image;
use lightcuts::{Options, Rendering, World};
use rayon::ThreadPool;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Where jobs are rendered: the threads, the world of the scene that was rendered last, and who watches.
pub(super) struct Studio<'a> {
    pub(super) plan: &'a Plan,
    pub(super) directory: PathBuf,
    pub(super) pool: ThreadPool,
    pub(super) texts: &'a Texts<'a>,
    pub(super) watch: &'a dyn Watch,
    pub(super) world: Option<(usize, World)>,
}

/// A job's picture in the experiment's folder.
struct Stored {
    names: Names,
    comparisons: BTreeMap<String, ComparisonRow>,
}

impl Studio<'_> {
    /// Renders job number `i` and writes its pictures; `None` if the watch stopped it. `rows` are those that are finished.
    pub(super) fn render(&mut self, i: usize, rows: &[Option<Row>]) -> Result<Option<Row>, RunError> {
        if self.watch.cancelled() {
            return Ok(None);
        }
        let job = &self.plan.jobs[i];
        self.prepare(job)?;
        let world = &self.world.as_ref().expect("it is prepared").1;
        let rendering =
            self.pool.install(|| lightcuts::render(world, &job.settings, &Options::default(), self.watch))?;
        if !rendering.stats.complete {
            return Ok(None);
        }
        let picture = hash::of_picture(&rendering.beauty);
        let first = rows[job.first_run].as_ref().filter(|_| i != job.first_run);
        let stored = match first {
            Some(first) => repeated(job, first, &picture)?,
            None => self.store(job, rendering.beauty.clone(), &picture, rows)?,
        };
        Ok(Some(self.row(job, &rendering, picture, stored)))
    }

    /// Makes the world of the job's scene unless it is there.
    fn prepare(&mut self, job: &PlannedJob) -> Result<(), RunError> {
        if self.world.as_ref().is_none_or(|(scene, _)| *scene != job.scene) {
            let scene = &self.plan.scenes[job.scene];
            let failed = |source| RunError::World { scene: scene.name.clone(), source: Box::new(source) };
            self.world = Some((job.scene, World::new(&scene.description).map_err(failed)?));
        }
        Ok(())
    }

    /// Writes the picture and compares it with those of its references.
    fn store(&self, job: &PlannedJob, linear: Image, hash: &str, rows: &[Option<Row>]) -> Result<Stored, RunError> {
        let names = Names::of(job);
        let picture = pictures::developed(linear, &job.settings.display)?;
        pictures::write_displayed(&self.directory.join(&names.png), &picture, job, self.texts)?;
        let mut comparisons = BTreeMap::new();
        for &reference in &job.references {
            let reference_job = &self.plan.jobs[reference];
            let Some(row) = &rows[reference] else { continue };
            let row = with_reference(self.plan, &self.directory, job, &picture, (reference_job, row), self.watch)?;
            comparisons.insert(reference_job.configuration.clone(), row);
        }
        pictures::write_light(&self.directory.join(&names.exr), picture.linear().clone(), hash, job, self.texts)?;
        Ok(Stored { names, comparisons })
    }

    fn row(&self, job: &PlannedJob, rendering: &Rendering, picture: String, stored: Stored) -> Row {
        Row {
            job: job.hash.clone(),
            scene: job.scene_name.clone(),
            configuration: job.configuration.clone(),
            point: job.point.clone(),
            seed: job.settings.run.seed,
            run: job.run,
            stand_in: !self.plan.scenes[job.scene].missing.is_empty(),
            finished: machine::now(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            revision: machine::revision().to_owned(),
            device: machine::cpu(self.plan.threads),
            width: job.settings.image.width,
            height: job.settings.image.height,
            stats: rendering.stats.clone(),
            picture,
            png: stored.names.png,
            exr: stored.names.exr,
            comparisons: stored.comparisons,
        }
    }
}

/// The files and comparisons of run 1, which must have given the same picture.
fn repeated(job: &PlannedJob, first: &Row, picture: &str) -> Result<Stored, RunError> {
    if first.picture != picture {
        return Err(RunError::NotReproducible {
            job: job.stem(),
            run: job.run,
            first_revision: first.revision.clone(),
            revision: machine::revision(),
        });
    }
    let names = Names { png: first.png.clone(), exr: first.exr.clone() };
    Ok(Stored { names, comparisons: first.comparisons.clone() })
}
