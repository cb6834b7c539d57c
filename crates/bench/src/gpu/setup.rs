//! What every section needs: the device, the CPU beside it, and renders on either.

use super::log::{Stages, merged, since};
use crate::measure::middle;
use anyhow::{Context as _, Result, ensure};
use lightcuts::device::DeviceKind;
use lightcuts::gpu::{self, AdapterSummary, DeviceChoice, GpuDevice, GpuOptions, NoDevice};
use lightcuts::rendering::PassTime;
use lightcuts::{Monitor, Options, Settings, Stage, Stations, Stats, World};
use std::path::PathBuf;
use std::str::FromStr as _;

/// Threads of the CPU's renderer: those of the machine that the project's figures come from.
pub(super) const CPU_THREADS: usize = 2;

/// The device and how it is measured.
pub(super) struct Setup {
    choice: DeviceChoice,
    pub(super) adapter: AdapterSummary,
    pub(super) models: PathBuf,
    pub(super) is_quick: bool,
    cpu: rayon::ThreadPool,
}

/// A render on the device.
#[derive(Debug, Clone)]
pub(super) struct Render {
    pub(super) stats: Stats,
    /// What programs took.
    pub(super) stages: Stages,
}

/// Tells at once what a device did not return; the render is of no use then.
struct Notes;

impl Monitor for Notes {
    fn note(&self, text: &str) {
        eprintln!("note: {text}");
    }
}

impl Setup {
    pub(super) fn new(device: &str, models: PathBuf, is_quick: bool) -> Result<Self> {
        let Ok(choice) = DeviceChoice::from_str(device);
        let adapters = gpu::adapters();
        let place = gpu::choose(&choice, &adapters).map_err(NoDevice::from)?;
        let place =
            place.with_context(|| format!("`--device {device}` is no GPU here; `gpu` takes software drivers"))?;
        let cpu = rayon::ThreadPoolBuilder::new().num_threads(CPU_THREADS).build().context("cannot start threads")?;
        Ok(Self { choice, adapter: adapters[place].clone(), models, is_quick, cpu })
    }

    /// The device as the heading of an entry names it.
    pub(super) fn title(&self) -> String {
        format!("{} ({})", self.adapter.name, self.adapter.kind.name())
    }

    /// How the figures came about.
    pub(super) fn conditions(&self) -> String {
        let runs = if self.is_quick { "one run of each (`--quick`)" } else { "the middle one of three runs of each" };
        let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
        let load = load.split(' ').next().filter(|load| !load.is_empty());
        let load = load.map(|load| format!(" Load average of the machine before: {load}.")).unwrap_or_default();
        format!("`cargo xtask bench gpu`, {runs}, after one that does not count.{load}\n")
    }

    /// Whether the device is a processor that pretends to be a GPU.
    pub(super) fn is_software(&self) -> bool {
        self.adapter.kind == DeviceKind::SoftwareGpu
    }

    /// Runs of a measurement: an odd number, so that one is in the middle.
    pub(super) fn runs(&self) -> usize {
        if self.is_quick { 1 } else { 3 }
    }

    /// A world on the device.
    pub(super) fn open<'w>(&self, world: &'w World) -> Result<GpuDevice<'w>> {
        GpuDevice::open(&self.choice, world, &GpuOptions::default())?.context("the adapter went away")
    }

    /// Renders on the device. Fails if the CPU had to do a part of it.
    #[expect(clippy::unused_self, reason = "it belongs to the set-up as `middle_render` does")]
    pub(super) fn render(
        &self,
        gpu: &GpuDevice<'_>,
        world: &World,
        settings: &Settings,
        options: &Options,
    ) -> Result<Render> {
        let before = merged(&gpu.reports());
        let rendering = lightcuts::render_on(world, settings, options, &Stations::all(gpu), &Notes)?;
        let faults = rendering.stats.device_faults;
        ensure!(faults == 0, "the device did not return a result ({faults} times), so the CPU did a part of its work");
        eprintln!("  GPU: {:.2} s", rendering.stats.total_wall_s);
        Ok(Render { stats: rendering.stats, stages: since(&before, &merged(&gpu.reports())) })
    }

    /// The render with the middle figure of some, after one with `before` that compiles the programs.
    pub(super) fn middle_render(
        &self,
        gpu: &GpuDevice<'_>,
        world: &World,
        [before, settings]: [&Settings; 2],
        options: &Options,
        figure: impl Fn(&Render) -> f64,
    ) -> Result<Render> {
        self.render(gpu, world, before, options)?;
        let runs = (0..self.runs()).map(|_| self.render(gpu, world, settings, options));
        Ok(middle(runs.collect::<Result<_>>()?, figure))
    }

    /// Renders on the CPU.
    pub(super) fn render_on_cpu(&self, world: &World, settings: &Settings, options: &Options) -> Result<Stats> {
        let rendering = self.cpu.install(|| lightcuts::render(world, settings, options, &Notes))?;
        eprintln!("  CPU: {:.2} s", rendering.stats.total_wall_s);
        Ok(rendering.stats)
    }
}

/// Wall seconds of a render's stage; 0 if it did not run.
pub(super) fn stage_s(stats: &Stats, stage: Stage) -> f64 {
    let is_it = |pass: &&PassTime| pass.name == stage.name();
    stats.passes.iter().find(is_it).map_or(0.0, |pass| pass.wall_s)
}
