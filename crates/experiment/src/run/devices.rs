//! The devices of one scene's jobs: each is opened once, and a card is warmed up before it is timed.

use super::{RunError, Watch};
use crate::plan::{Plan, PlannedJob};
use lightcuts::device::DeviceKind;
use lightcuts::gpu::{Assignment, DeviceChoice, Fleet, GpuOptions};
use lightcuts::{Monitor, Options, PerStation, Simd, World};
use std::collections::BTreeSet;

/// Open devices, with the world of a scene on each.
pub(super) struct Devices<'w> {
    plan: &'w Plan,
    opened: Vec<(DeviceChoice, Fleet<'w>)>,
    /// The configurations that were rendered here, by their names.
    warm: BTreeSet<&'w str>,
}

impl<'w> Devices<'w> {
    pub(super) fn new(plan: &'w Plan) -> Self {
        Self { plan, opened: Vec::new(), warm: BTreeSet::new() }
    }

    /// The device of a job, opened unless it is; and whether it is a card that has not rendered this configuration yet.
    /// Then its driver compiles programs, and the size of the submissions is still to be found.
    pub(super) fn get(
        &mut self,
        job: &'w PlannedJob,
        world: &'w World,
        watch: &dyn Watch,
    ) -> Result<(&Fleet<'w>, bool), RunError> {
        let found = self.opened.iter().position(|(choice, _)| *choice == job.device);
        let place = found.unwrap_or(self.opened.len());
        if found.is_none() {
            self.opened.push((job.device.clone(), self.open(job, world, watch)?));
        }
        let fleet = &self.opened[place].1;
        let is_card = fleet.gpus().any(|gpu| gpu.adapter().kind == DeviceKind::Gpu);
        Ok((fleet, self.warm.insert(&job.configuration) && is_card))
    }

    fn open(&self, job: &PlannedJob, world: &'w World, watch: &dyn Watch) -> Result<Fleet<'w>, RunError> {
        let assignment = Assignment::new(&PerStation::all(job.device.clone()), &self.plan.adapters);
        let options = GpuOptions::default();
        let open = |assignment| Fleet::open(&assignment, world, Simd::Auto, &options, &|text| watch.note(text));
        assignment.and_then(open).map_err(|why| RunError::Device {
            configuration: job.configuration.clone(),
            scene: job.scene_name.clone(),
            why,
        })
    }
}

/// Renders a job for nothing but its effects on the device.
pub(super) fn warm_up(job: &PlannedJob, world: &World, fleet: &Fleet<'_>, watch: &dyn Watch) -> Result<(), RunError> {
    lightcuts::render_on(world, &job.settings, &Options::default(), &fleet.stations(), &Untold(watch))?;
    Ok(())
}

/// Forwards only cancellation and notes.
struct Untold<'a>(&'a dyn Watch);

impl Monitor for Untold<'_> {
    fn note(&self, text: &str) {
        self.0.note(text);
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
