//! The GPU as a device of the renderer.

use crate::adapter::{AdapterSummary, DeviceChoice, adapters, choose};
use crate::engine::{Engine, EngineOptions};
use crate::governor::GovernorReport;
use crate::records::ProbeRay;
use crate::sabotage::Sabotage;
use lightcuts_image::{Image, ToneMapping};
use lightcuts_kernel::Rules;
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::ray::Hit;
use lightcuts_render::device::{
    Device, DeviceFault, DeviceInfo, LightTree, Pass, PhotonMap, Tile, TileResult, TreeLayout, View,
};
use lightcuts_render::{Caustics, Monitor};
use lightcuts_world::{CompressedHierarchy, World};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Tiles that the first batch has, and most that a later one may have: a million pixels.
const FIRST_BATCH: usize = 64;
const LARGEST_BATCH: usize = 4096;
/// A batch that takes less is followed by a larger one, one that takes more than [`LONG_BATCH`] by a smaller one: so
/// large devices have enough to do, and progress is seen and work is kept on small ones.
const SHORT_BATCH: Duration = Duration::from_millis(300);
const LONG_BATCH: Duration = Duration::from_millis(1500);

/// How a GPU is used.
#[derive(Debug, Clone)]
pub struct GpuOptions {
    /// Duration that no submission is to exceed.
    pub budget: Duration,
    /// Whether the device times its own work where it can; else the clock of this side is used.
    pub has_clock: bool,
    /// Limits the bytes of a buffer further than the device does, so that larger ones are split.
    pub max_binding: Option<u64>,
    /// Nodes of ray trees at once.
    pub capacity: Option<u32>,
    /// Faults on purpose, for tests.
    pub sabotage: Arc<Sabotage>,
}

impl Default for GpuOptions {
    fn default() -> Self {
        Self {
            budget: Duration::from_millis(30),
            has_clock: true,
            max_binding: None,
            capacity: None,
            sabotage: Arc::default(),
        }
    }
}

/// A GPU with a world on it.
pub struct GpuDevice<'w> {
    world: &'w World,
    hierarchy: CompressedHierarchy,
    adapter: AdapterSummary,
    state: Mutex<State>,
}

struct State {
    options: EngineOptions,
    /// Absent after a fault, until revived.
    engine: Option<Engine>,
    /// Of engines that are gone.
    reports: Vec<GovernorReport>,
    /// Whether memory ran out: a revived engine gets along with less.
    is_short_of_memory: bool,
    /// Tiles of the next batch.
    batch: usize,
}

impl<'w> GpuDevice<'w> {
    /// Opens the adapter that a choice takes and brings a world to it; `None` if the choice is the processor.
    pub fn open(choice: &DeviceChoice, world: &'w World, options: &GpuOptions) -> Result<Option<Self>, DeviceFault> {
        if *choice == DeviceChoice::Cpu {
            return Ok(None);
        }
        choose(choice, &adapters())?.map(|place| Self::at(place, world, options)).transpose()
    }

    /// Opens the adapter at a place in the list of [`adapters`] and brings a world to it.
    pub fn at(place: usize, world: &'w World, options: &GpuOptions) -> Result<Self, DeviceFault> {
        let adapter = adapters().into_iter().nth(place);
        let adapter = adapter.ok_or_else(|| DeviceFault::Failed("the adapter is not there any more".to_owned()))?;
        let options = EngineOptions {
            adapter: place,
            budget: options.budget,
            has_clock: options.has_clock,
            max_binding: options.max_binding,
            capacity: options.capacity,
            sabotage: Arc::clone(&options.sabotage),
        };
        let hierarchy = CompressedHierarchy::new(world);
        let engine = Engine::new(world, &hierarchy, &options)?;
        let state =
            State { options, engine: Some(engine), reports: Vec::new(), is_short_of_memory: false, batch: FIRST_BATCH };
        Ok(Self { world, hierarchy, adapter, state: Mutex::new(state) })
    }

    /// What the adapter is and can do.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// What was submitted so far: a report per device that was opened.
    pub fn reports(&self) -> Vec<GovernorReport> {
        let state = self.state();
        let now = state.engine.as_ref().map(|engine| engine.dispatcher.governor.report.clone());
        state.reports.iter().cloned().chain(now).collect()
    }

    /// The nearest hits of rays by themselves, or with `any` whether they hit anything at all (the primitive then means
    /// nothing but [`NONE`](lightcuts_kernel::ray::NONE)).
    pub fn trace(&self, rays: &[ProbeRay], rules: Rules, any: bool) -> Result<Vec<Hit>, DeviceFault> {
        self.with(|engine| engine.trace(rays, rules, any))
    }

    /// Bytes that are allocated on the device.
    pub fn allocated_bytes(&self) -> u64 {
        self.state().engine.as_ref().map_or(0, |engine| engine.context.allocated())
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A panic elsewhere leaves an engine whose next call finds out what is wrong.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets the engine work; after a fault it is gone.
    fn with<T>(&self, work: impl FnOnce(&mut Engine) -> Result<T, DeviceFault>) -> Result<T, DeviceFault> {
        let mut state = self.state();
        let Some(engine) = &mut state.engine else { return Err(DeviceFault::Lost("it was not revived".to_owned())) };
        let result = work(engine);
        if let Err(fault) = &result {
            state.is_short_of_memory |= matches!(fault, DeviceFault::OutOfMemory(_));
            let gone = state.engine.take();
            state.reports.extend(gone.map(|engine| engine.dispatcher.governor.report));
        }
        result
    }
}

impl Device for GpuDevice<'_> {
    fn info(&self) -> DeviceInfo {
        DeviceInfo { kind: self.adapter.kind, name: self.adapter.name.clone() }
    }

    fn batch(&self) -> usize {
        self.state().batch
    }

    fn render_tiles(
        &self,
        pass: &Pass<'_>,
        tiles: &[Tile],
        monitor: &dyn Monitor,
    ) -> Result<Vec<Option<TileResult>>, DeviceFault> {
        let start = Instant::now();
        let results = self.with(|engine| engine.render_tiles(pass, tiles, monitor))?;
        let took = start.elapsed();
        let mut state = self.state();
        if took < SHORT_BATCH && tiles.len() == state.batch {
            state.batch = (state.batch * 4).min(LARGEST_BATCH);
        } else if took > LONG_BATCH {
            state.batch = (state.batch / 2).max(1);
        }
        let Some(results) = results else { return Ok(tiles.iter().map(|_| None).collect()) };
        for _ in tiles {
            monitor.advance();
        }
        Ok(results.into_iter().map(Some).collect())
    }

    fn original_shifts(&self, view: &View<'_>) -> Result<Vec<[f32; 2]>, DeviceFault> {
        self.with(|engine| engine.original_shifts(view))
    }

    fn shoot_photons(
        &self,
        view: &View<'_>,
        settings: &Caustics,
        monitor: &dyn Monitor,
    ) -> Result<(PhotonMap, u64), DeviceFault> {
        self.with(|engine| engine.shoot_photons(view, settings, monitor))
    }

    fn preferred_layout(&self) -> TreeLayout {
        TreeLayout::Packed
    }

    fn build_tree(&self, vpls: &[Vpl], _: TreeLayout) -> Result<LightTree, DeviceFault> {
        self.with(|engine| engine.build_tree(vpls))
    }

    fn bloom(&self, image: &Image, radius: f32, weight: f32) -> Result<Image, DeviceFault> {
        self.with(|engine| engine.bloom(image, radius, weight))
    }

    fn tone_map(&self, image: &Image, operator: &ToneMapping) -> Result<Image, DeviceFault> {
        self.with(|engine| engine.tone_map(image, operator))
    }

    fn revive(&self) -> Result<(), DeviceFault> {
        let mut state = self.state();
        if state.is_short_of_memory {
            let before = state.options.capacity.unwrap_or(1 << 18);
            state.options.capacity = Some(before / 4);
        }
        state.engine = None;
        state.engine = Some(Engine::new(self.world, &self.hierarchy, &state.options)?);
        Ok(())
    }
}
