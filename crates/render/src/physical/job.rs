//! A render of the physical model: passes of one sample per pixel until there are enough, time is up, or noise is low.

use super::cluster_tree::ClusterTree;
use super::emission::Origins;
use super::integrator::Sampler;
use super::lightcuts::Lightcuts;
use super::pass::{Counts, SamplePass, SampledTile};
use super::rendering::{Canvas, PhysicalRendering};
use super::scene::Scene;
use super::vpls::{VplSet, trace_vpls};
use crate::cpu::Simd;
use crate::device::processor_name;
use crate::film::Tile;
use crate::monitor::{Monitor, Stage};
use crate::settings::{Integrator, Settings};
use crate::stats::{PartTime, StationDevice, Stats, timed};
use lightcuts_kernel::rng::stream;
use lightcuts_world::PhysicalWorld;
use rayon::prelude::*;
use std::time::Instant;

/// Edge of a tile in pixels.
const TILE_SIZE: u32 = 16;

/// Purposes of random numbers; each has its own stream.
const SAMPLES: u32 = 16;
const LIGHT_PATHS: u32 = 17;
const REPRESENTATIVES: u32 = 18;
const PILOT: u32 = 19;

/// Light paths by which the number of virtual lights per path is found.
const PILOT_PATHS: u32 = 1024;

/// Passes between two looks at the noise.
const NOISE_INTERVAL: u32 = 4;

/// Renders a physical world.
pub(crate) struct PhysicalJob<'a> {
    scene: Scene<'a>,
    settings: &'a Settings,
    monitor: &'a dyn Monitor,
    origins: Option<Origins>,
    canvas: Canvas,
    stats: Stats,
    counts: Counts,
    started: Instant,
    /// Light paths so far, and the virtual lights that they left.
    paths: u64,
    lights: u64,
}

impl<'a> PhysicalJob<'a> {
    pub(crate) fn new(world: &'a PhysicalWorld, settings: &'a Settings, simd: Simd, monitor: &'a dyn Monitor) -> Self {
        let scene = Scene::new(world, simd);
        Self {
            scene,
            settings,
            monitor,
            origins: Origins::new(&scene),
            canvas: Canvas::new(settings.image.width, settings.image.height),
            stats: Stats::default(),
            counts: Counts::default(),
            started: Instant::now(),
            paths: 0,
            lights: 0,
        }
    }

    pub(crate) fn run(mut self) -> PhysicalRendering {
        let tiles = Tile::cover(self.settings.image.width, self.settings.image.height, TILE_SIZE);
        let physical = &self.settings.physical;
        let steps = Steps::new(physical.time_limit, u64::from(self.settings.sampling.samples) * tiles.len() as u64);
        self.monitor.begin(Stage::Samples, steps.total);
        let mut passes = std::mem::take(&mut self.stats.passes);
        timed(&mut passes, Stage::Samples, || self.run_passes(&tiles, &steps));
        self.stats.passes = passes;
        self.monitor.end();
        self.finish()
    }

    fn run_passes(&mut self, tiles: &[Tile], steps: &Steps) {
        let physical = &self.settings.physical;
        let uses_vpls = physical.integrator == Integrator::Lightcuts;
        let mut pilot = PartTime::default();
        let mut references = pilot.add(|| {
            if !uses_vpls {
                return Vec::new();
            }
            self.measure_lights_per_path();
            self.pilot(tiles)
        });
        self.stats.vpl_work.pilot = pilot;
        self.stats.complete = true;
        for sample in 0..self.settings.sampling.samples {
            let tree = if uses_vpls { self.plant(sample) } else { ClusterTree::default() };
            let sampler = if uses_vpls {
                let clamp = physical.clamp * self.diagonal();
                let strategy = self.settings.gather.strategy;
                Sampler::Lightcuts(Lightcuts { tree, settings: physical, strategy, clamp, references: &references })
            } else {
                Sampler::Path
            };
            let is_whole = self.run_pass(tiles, sample, sampler, steps);
            if !is_whole {
                // Time that was asked for and is up completes a render.
                self.stats.complete = !self.monitor.cancelled();
                return;
            }
            let is_time_to_look = (sample + 1).is_multiple_of(NOISE_INTERVAL);
            if is_time_to_look && physical.noise > 0.0 && self.canvas.noise() <= f64::from(physical.noise) {
                return;
            }
            if uses_vpls {
                references = self.canvas.references();
            }
        }
    }

    fn diagonal(&self) -> f32 {
        let (lower, upper) = self.scene.world.bounds;
        (upper - lower).length()
    }

    fn stream(&self, purpose: u32, pass: u32) -> u32 {
        stream(stream(self.settings.run.seed, purpose), pass)
    }

    /// One sample of every pixel; returns whether it came to its end.
    fn run_pass(&mut self, tiles: &[Tile], sample: u32, sampler: Sampler<'_>, steps: &Steps) -> bool {
        let image = self.settings.image;
        let pass = SamplePass {
            scene: self.scene,
            lens: self.scene.world.lens(image.width, image.height),
            filter: &self.settings.filter,
            stream: stream(self.settings.run.seed, SAMPLES),
            sample,
            sampler,
        };
        let (monitor, started) = (self.monitor, self.started);
        let limit = self.settings.physical.time_limit;
        // The first pass is finished whatever time it takes: a picture has no holes.
        let is_up = || sample > 0 && limit > 0.0 && started.elapsed().as_secs_f32() >= limit;
        let results: Vec<Option<SampledTile>> = tiles
            .par_iter()
            .map(|tile| {
                let rendered = (!monitor.cancelled() && !is_up()).then(|| pass.render(tile));
                steps.advance(monitor, started);
                rendered
            })
            .collect();
        let is_whole = results.iter().all(Option::is_some);
        for tile in results.iter().flatten() {
            self.canvas.add(tile);
            self.counts.add(&tile.counts);
        }
        is_whole
    }

    /// What pixels are about as bright as, before the first pass: a traced path for each, over blocks.
    fn pilot(&self, tiles: &[Tile]) -> Vec<f32> {
        let image = self.settings.image;
        let pass = SamplePass {
            scene: self.scene,
            lens: self.scene.world.lens(image.width, image.height),
            filter: &self.settings.filter,
            stream: stream(self.settings.run.seed, PILOT),
            sample: 0,
            sampler: Sampler::Path,
        };
        let mut canvas = Canvas::new(image.width, image.height);
        let monitor = self.monitor;
        let results: Vec<Option<SampledTile>> =
            tiles.par_iter().map(|tile| (!monitor.cancelled()).then(|| pass.render(tile))).collect();
        results.iter().flatten().for_each(|tile| canvas.add(tile));
        canvas.references()
    }

    fn measure_lights_per_path(&mut self) {
        if let Some(origins) = &self.origins {
            let set = trace_vpls(&self.scene, origins, PILOT_PATHS, stream(self.settings.run.seed, LIGHT_PATHS));
            self.count_lights(PILOT_PATHS, &set);
        }
    }

    fn count_lights(&mut self, paths: u32, set: &VplSet) {
        self.paths += u64::from(paths);
        self.lights += set.lights.len() as u64;
        self.stats.rays.photon += set.rays;
    }

    /// Virtual lights of a pass under their tree.
    fn plant(&mut self, sample: u32) -> ClusterTree {
        let mut work = self.stats.vpl_work;
        let set = work.placing.add(|| self.trace_vpls(sample));
        let tree = work.tree.add(|| ClusterTree::build(&set.lights, self.stream(REPRESENTATIVES, sample)));
        let bytes = size_of_val(&tree.lights[..]) + size_of_val(&tree.nodes[..]);
        work.bytes = work.bytes.max(bytes as u64);
        self.stats.vpl_work = work;
        tree
    }

    /// Virtual lights of a pass. Their number is about what is wanted, by the experience of earlier passes; the number of paths
    /// is fixed before they are traced.
    fn trace_vpls(&mut self, sample: u32) -> VplSet {
        let Some(origins) = &self.origins else { return VplSet::default() };
        let lights_per_path = self.lights as f64 / self.paths.max(1) as f64;
        let wanted = f64::from(self.settings.physical.vpls) / lights_per_path.max(1e-3);
        let paths = (wanted as u32).clamp(1, self.settings.physical.vpls.saturating_mul(8));
        let set = trace_vpls(&self.scene, origins, paths, self.stream(LIGHT_PATHS, sample));
        self.stats.vpl_count = set.lights.len() as u64;
        self.count_lights(paths, &set);
        set
    }

    fn finish(mut self) -> PhysicalRendering {
        let stats = &mut self.stats;
        stats.rays.primary = self.counts.primary;
        stats.rays.secondary = self.counts.bounces;
        stats.rays.shadow = self.counts.shadow;
        stats.tree.shaded_hits = self.counts.gathered;
        stats.tree.nodes = self.counts.bounds;
        stats.tree.selected = self.counts.cut;
        stats.tree.visits_per_hit = self.counts.bounds as f64 / self.counts.gathered.max(1) as f64;
        stats.total_wall_s = stats.passes.iter().map(|pass| pass.wall_s).sum();
        stats.total_cpu_s = stats.passes.iter().map(|pass| pass.cpu_s).sum();
        stats.devices =
            vec![StationDevice { station: "gather".to_owned(), kind: "cpu".to_owned(), name: processor_name() }];
        self.canvas.develop(self.stats)
    }
}

/// Steps of the whole render: tiles, or tenths of a second where time is limited.
struct Steps {
    total: u64,
    told: std::sync::atomic::AtomicU64,
    is_timed: bool,
}

impl Steps {
    fn new(time_limit: f32, tiles: u64) -> Self {
        let is_timed = time_limit > 0.0;
        let total = if is_timed { (f64::from(time_limit) * 10.0).ceil() as u64 } else { tiles };
        Self { total, told: std::sync::atomic::AtomicU64::new(0), is_timed }
    }

    /// Tells of a tile that was rendered.
    fn advance(&self, monitor: &dyn Monitor, started: Instant) {
        use std::sync::atomic::Ordering::Relaxed;
        if !self.is_timed {
            monitor.advance();
            return;
        }
        let due = ((started.elapsed().as_secs_f64() * 10.0) as u64).min(self.total);
        let before = self.told.fetch_max(due, Relaxed);
        for _ in before..due {
            monitor.advance();
        }
    }
}
