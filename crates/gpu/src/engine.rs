//! A device at work: its memory by name, its programs, and work in parts that fit the governor's plan.

use crate::buffers::Split;
use crate::context::{Buffer, Context, Kernel};
use crate::dispatcher::Dispatcher;
use crate::governor::StageName;
use crate::programs::program;
use crate::sabotage::Sabotage;
use crate::wave::Capacity;
use crate::world_buffers::WorldBuffers;
use lightcuts_render::Monitor;
use lightcuts_render::device::{DeviceFault, DeviceKind};
use lightcuts_world::{CompressedHierarchy, World};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// Fewest items of a dispatch: a workgroup, which no device splits.
const FEWEST_ITEMS: u32 = 64;

/// Items that a dispatch should have before its other dimension is enlarged, so that all units of a device have work.
const ENOUGH_ITEMS: u32 = 4096;

/// Rounds of all loops together after which a software driver ends the loops of an invocation, without a word: Mesa's
/// llvmpipe allows 65,535 (its `LP_MAX_TGSI_LOOP_ITERATIONS`). Work is bounded so that invocations stay below.
const SOFTWARE_ROUNDS: u64 = 60_000;

/// Rounds that a ray may take through the hierarchy, with the seven rays beside it that run in step: measured are 50 to
/// 100 among a million triangles.
const ROUNDS_OF_RAY: u64 = 230;

/// Buffers that some programs name although a pass may not need them.
const OPTIONAL: [(&str, u64); 12] = [
    ("vpls", 48),
    ("light_nodes", 64),
    ("photons", 48),
    ("placed", 48),
    ("pairs_in", 8),
    ("pairs_out", 8),
    ("picture", 16),
    ("bloomed", 16),
    ("tone_pairs", 8),
    ("plane_in", 4),
    ("plane_out", 4),
    ("blur_weights", 4),
];

/// How an engine is set up.
#[derive(Debug, Clone)]
pub(crate) struct EngineOptions {
    pub(crate) adapter: usize,
    pub(crate) budget: Duration,
    /// Whether timestamps are used where they are offered.
    pub(crate) has_clock: bool,
    /// Limits the bytes of a buffer further than the device does.
    pub(crate) max_binding: Option<u64>,
    /// Nodes of ray trees at once; less where memory is short.
    pub(crate) capacity: Option<u32>,
    pub(crate) sabotage: Arc<Sabotage>,
}

/// A part of two-dimensional work: items x lights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Part {
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) first_light: u32,
    pub(crate) light_count: u32,
}

/// An open device with a world on it.
pub(crate) struct Engine {
    pub(crate) context: Context,
    pub(crate) dispatcher: Dispatcher,
    world: WorldBuffers,
    kernels: BTreeMap<&'static str, Arc<Kernel>>,
    buffers: BTreeMap<&'static str, Buffer>,
    pub(crate) capacity: Capacity,
    /// Whether any ray can be mirrored or refracted.
    pub(crate) has_children: bool,
    /// The light tree and the photon map that are on the device, by their numbers.
    pub(crate) tree: Option<u64>,
    pub(crate) photons: Option<u64>,
}

impl Engine {
    pub(crate) fn new(
        world: &World,
        hierarchy: &CompressedHierarchy,
        options: &EngineOptions,
    ) -> Result<Self, DeviceFault> {
        let context = Context::open(options.adapter, options.has_clock, &options.sabotage)?;
        let dispatcher = Dispatcher::new(&context, options.budget)?;
        let capacity = Capacity::new(options.capacity, context.kind);
        let mut engine = Self {
            world: WorldBuffers::upload(&context, world, hierarchy, options.max_binding)?,
            context,
            dispatcher,
            kernels: BTreeMap::new(),
            buffers: BTreeMap::new(),
            capacity,
            has_children: world.materials.iter().any(|m| m.reflection > 0.0 || m.refraction > 0.0),
            tree: None,
            photons: None,
        };
        for (name, bytes) in OPTIONAL {
            engine.allocate(name, bytes)?;
        }
        engine.allocate_wave()?;
        Ok(engine)
    }

    /// A buffer by its name; large ones of the world have several parts and are not found.
    pub(crate) fn buffer(&self, name: &str) -> Buffer {
        self.buffers.get(name).cloned().expect("buffers are allocated before they are named")
    }

    /// Allocates a buffer under a name, in place of the one before.
    pub(crate) fn allocate(&mut self, name: &'static str, bytes: u64) -> Result<(), DeviceFault> {
        self.buffers.remove(name);
        self.buffers.insert(name, self.context.allocate(name, bytes)?);
        Ok(())
    }

    /// Puts a buffer under a name, in place of the one before.
    pub(crate) fn rename(&mut self, name: &'static str, buffer: Buffer) {
        self.buffers.insert(name, buffer);
    }

    /// Makes sure that a buffer has some size.
    pub(crate) fn reserve(&mut self, name: &'static str, bytes: u64) -> Result<(), DeviceFault> {
        if self.buffers.get(name).is_none_or(|buffer| buffer.raw.size() < bytes) {
            self.allocate(name, bytes.next_power_of_two())?;
        }
        Ok(())
    }

    /// Uploads a content under a name, in a buffer of just its size.
    pub(crate) fn upload<T: bytemuck::NoUninit>(
        &mut self,
        name: &'static str,
        content: &[T],
    ) -> Result<(), DeviceFault> {
        self.buffers.remove(name);
        self.buffers.insert(name, self.context.upload(name, content)?);
        Ok(())
    }

    /// Writes a content to the start of a buffer, before the dispatches that are pending.
    pub(crate) fn write<T: bytemuck::NoUninit>(&self, name: &str, content: &[T]) {
        if !content.is_empty() {
            self.context.queue.write_buffer(&self.buffer(name).raw, 0, bytemuck::cast_slice(content));
        }
    }

    /// The first elements of some buffers, once everything pending is done.
    pub(crate) fn read(&mut self, wanted: &[(&str, u64)]) -> Result<Vec<Vec<u8>>, DeviceFault> {
        let buffers: Vec<(Buffer, u64)> = wanted.iter().map(|&(name, bytes)| (self.buffer(name), bytes)).collect();
        let wanted: Vec<(&Buffer, u64)> = buffers.iter().map(|(buffer, bytes)| (buffer, *bytes)).collect();
        self.dispatcher.read(&self.context, &wanted)
    }

    /// The first `count` elements of a buffer.
    pub(crate) fn read_as<T: bytemuck::Pod>(&mut self, name: &str, count: usize) -> Result<Vec<T>, DeviceFault> {
        let bytes = self.read(&[(name, (count * size_of::<T>()) as u64)])?.remove(0);
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    /// Dispatches a program.
    pub(crate) fn run<P: bytemuck::NoUninit>(
        &mut self,
        entry: &'static str,
        params: &P,
        items: u32,
        units: f64,
    ) -> Result<(), DeviceFault> {
        self.run_with(entry, params, items, units, &[])
    }

    /// Dispatches a program with other buffers under some names.
    pub(crate) fn run_with<P: bytemuck::NoUninit>(
        &mut self,
        entry: &'static str,
        params: &P,
        items: u32,
        units: f64,
        others: &[(&str, &Buffer)],
    ) -> Result<(), DeviceFault> {
        let (kernel, is_new) = self.kernel(entry)?;
        let Self { context, dispatcher, world, buffers, .. } = self;
        let find = |name: &str| {
            let other = others.iter().find(|(of, _)| *of == name).map(|(_, buffer)| std::slice::from_ref(*buffer));
            other
                .or_else(|| world.find(name))
                .or_else(|| buffers.get(name).map(std::slice::from_ref))
                .expect("every buffer of a program is allocated when the engine is made")
        };
        if is_new {
            dispatcher.warm_up(context, &kernel, &find)?;
        }
        dispatcher.dispatch(context, &kernel, params, &find, items, units)
    }

    /// Lights, VPLs or rays that an invocation may loop over.
    pub(crate) fn rays_at_once(&self) -> u32 {
        if self.is_software() { (SOFTWARE_ROUNDS / ROUNDS_OF_RAY) as u32 / 64 * 64 } else { u32::MAX }
    }

    /// Fails if an invocation would loop more often than the driver does.
    pub(crate) fn require_rounds(&self, rounds: u64, what: &str) -> Result<(), DeviceFault> {
        if self.is_software() && rounds > SOFTWARE_ROUNDS {
            return Err(DeviceFault::Failed(format!("{what} would take loops longer than a software driver permits")));
        }
        Ok(())
    }

    /// The same for invocations that follow whole ray trees of some depth.
    pub(crate) fn require_rounds_of_trees(&self, max_depth: u32, what: &str) -> Result<(), DeviceFault> {
        let rays = if self.has_children { 1 << max_depth } else { 1 };
        self.require_rounds(rays * ROUNDS_OF_RAY, what)
    }

    fn is_software(&self) -> bool {
        self.context.kind == DeviceKind::SoftwareGpu
    }

    /// The compiled entry point, and whether it was compiled just now.
    fn kernel(&mut self, entry: &'static str) -> Result<(Arc<Kernel>, bool), DeviceFault> {
        if let Some(kernel) = self.kernels.get(entry) {
            return Ok((Arc::clone(kernel), false));
        }
        let world = &self.world;
        let split = |name: &str| -> Split { world.split(name) };
        let kernel = Arc::new(self.context.compile(entry, program(entry), split)?);
        self.kernels.insert(entry, Arc::clone(&kernel));
        Ok((kernel, true))
    }

    /// Splits `total` items, each `units` units of work, into dispatches that fit the plan.
    pub(crate) fn over(
        &mut self,
        stage: StageName,
        total: u32,
        units: f64,
        mut dispatch: impl FnMut(&mut Self, u32, u32) -> Result<(), DeviceFault>,
    ) -> Result<(), DeviceFault> {
        let mut first = 0;
        while first < total {
            let room = (self.dispatcher.governor.allowance(stage) / units).min(f64::from(total)) as u32;
            let count = (room / FEWEST_ITEMS * FEWEST_ITEMS).max(FEWEST_ITEMS).min(total - first);
            dispatch(self, first, count)?;
            first += count;
            if first < total {
                self.dispatcher.flush(&self.context)?;
            }
        }
        Ok(())
    }

    /// Splits `total` items x `lights` lights, at most `at_once` of these in a dispatch. All lights come to some items
    /// in order, so that sums do not depend on how the work was split. With `aligned`, `lights` and `at_once` are
    /// powers of two and so are the ranges, at multiples of their length. A monitor that cancels ends it early.
    pub(crate) fn over_lights(
        &mut self,
        stage: StageName,
        (total, lights, at_once): (u32, u32, u32),
        aligned: bool,
        monitor: &dyn Monitor,
        mut dispatch: impl FnMut(&mut Self, Part) -> Result<(), DeviceFault>,
    ) -> Result<(), DeviceFault> {
        let mut first = 0;
        while first < total && lights > 0 {
            let room = self.dispatcher.governor.allowance(stage);
            let fitting = (room / f64::from(lights)).min(f64::from(total)) as u32;
            let wanted = fitting.max(ENOUGH_ITEMS.min(room as u32)).max(FEWEST_ITEMS);
            let count = (wanted / FEWEST_ITEMS * FEWEST_ITEMS).min(total - first);
            let mut first_light = 0;
            while first_light < lights && !monitor.cancelled() {
                let room = (self.dispatcher.governor.allowance(stage) / f64::from(count)).min(f64::from(at_once));
                let light_count = range_of_lights(room, first_light, lights, aligned);
                dispatch(self, Part { first, count, first_light, light_count })?;
                first_light += light_count;
                if first_light < lights || first + count < total {
                    self.dispatcher.flush(&self.context)?;
                }
            }
            first += count;
        }
        Ok(())
    }
}

/// Lights of the next range, if so many fit.
fn range_of_lights(room: f64, first: u32, lights: u32, aligned: bool) -> u32 {
    let room = room.clamp(1.0, f64::from(lights)) as u32;
    if !aligned {
        return room.min(lights - first);
    }
    let alignment = if first == 0 { lights } else { 1 << first.trailing_zeros() };
    (1 << room.ilog2()).min(alignment)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aligned_ranges_are_subtrees() {
        for rooms in [[1.0, 5.0], [3.0, 100.0], [0.1, 64.0], [7.9, 7.9]] {
            let mut first = 0;
            let mut k = 0;
            while first < 64 {
                let count = range_of_lights(rooms[k % 2], first, 64, true);
                assert!(count.is_power_of_two() && first % count == 0, "{first} {count}");
                first += count;
                k += 1;
            }
            assert_eq!(first, 64);
        }
        assert_eq!(range_of_lights(1e9, 10, 37, false), 27);
    }
}
