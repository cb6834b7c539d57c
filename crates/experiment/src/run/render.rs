//! One job, from its world to its row.

use super::comparison::with_reference;
use super::devices::{Devices, warm_up};
use super::pictures::{self, Names};
use super::{RunError, Texts, Watch, machine};
use crate::hash;
use crate::plan::{Plan, PlannedJob};
use crate::record::{ComparisonRow, DeviceInfo, Row};
use lightcuts::image::Image;
use lightcuts::{Options, Rendering, World, render_on};
use rayon::ThreadPool;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Where the jobs of one scene are rendered: the threads, the scene's world, made when it is needed, the devices, and
/// who watches.
pub(super) struct Studio<'a, 'w> {
    pub(super) plan: &'w Plan,
    pub(super) directory: PathBuf,
    pub(super) pool: &'a ThreadPool,
    pub(super) texts: &'a Texts<'a>,
    pub(super) watch: &'a dyn Watch,
    pub(super) world: &'w OnceCell<World>,
    pub(super) devices: Devices<'w>,
}

/// A job's picture in the experiment's folder.
struct Stored {
    names: Names,
    comparisons: BTreeMap<String, ComparisonRow>,
}

impl<'w> Studio<'_, 'w> {
    /// Renders job number `i` and writes its pictures; `None` if the watch stopped it. `rows` are those that are
    /// finished.
    pub(super) fn render(&mut self, i: usize, rows: &[Option<Row>]) -> Result<Option<Row>, RunError> {
        if self.watch.cancelled() {
            return Ok(None);
        }
        let job = &self.plan.jobs[i];
        let (rendering, device) = self.rendering(job)?;
        if !rendering.stats.complete {
            return Ok(None);
        }
        let picture = hash::of_picture(&rendering.beauty);
        let first = rows[job.first_run].as_ref().filter(|_| i != job.first_run);
        let stored = match first {
            Some(first) => repeated(job, first, &picture, &device)?,
            None => self.store(job, rendering.beauty.clone(), &picture, rows)?,
        };
        Ok(Some(self.row(job, &rendering, device, picture, stored)))
    }

    /// Renders a job on its device.
    fn rendering(&mut self, job: &'w PlannedJob) -> Result<(Rendering, DeviceInfo), RunError> {
        let world = self.world(job)?;
        let watch = self.watch;
        let (fleet, is_cold) = self.devices.get(job, world, watch)?;
        let render = || {
            if is_cold {
                warm_up(job, world, fleet, watch)?;
            }
            Ok::<_, RunError>(render_on(world, &job.settings, &Options::default(), &fleet.stations(), watch)?)
        };
        Ok((self.pool.install(render)?, machine::device(fleet, self.plan.threads)))
    }

    /// The world of the job's scene, made unless it is there.
    fn world(&self, job: &PlannedJob) -> Result<&'w World, RunError> {
        if let Some(world) = self.world.get() {
            return Ok(world);
        }
        let scene = &self.plan.scenes[job.scene];
        let failed = |source| RunError::World { scene: scene.name.clone(), source: Box::new(source) };
        let world = World::new(&scene.description).map_err(failed)?;
        Ok(self.world.get_or_init(|| world))
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

    fn row(&self, job: &PlannedJob, rendering: &Rendering, device: DeviceInfo, picture: String, stored: Stored) -> Row {
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
            device,
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
fn repeated(job: &PlannedJob, first: &Row, picture: &str, device: &DeviceInfo) -> Result<Stored, RunError> {
    if first.picture != picture {
        return Err(RunError::NotReproducible {
            job: job.stem(),
            run: job.run,
            first_revision: first.revision.clone(),
            first_device: first.device.name.clone(),
            revision: machine::revision(),
            device: device.name.clone(),
        });
    }
    let names = Names { png: first.png.clone(), exr: first.exr.clone() };
    Ok(Stored { names, comparisons: first.comparisons.clone() })
}
