//! A render of the physical model: passes over the picture until there are enough samples, time is up, or noise is low.

use super::caustics::CausticMap;
use super::cluster_tree::ClusterTree;
use super::emission::Origins;
use super::lightcuts::Lightcuts;
use super::mixture::Mixture;
use super::pass::{Counts, Extent, SamplePass, SampledTile, Task};
use super::plan::Plan;
use super::rejection::Rejection;
use super::rendering::PhysicalRendering;
use super::scene::Scene;
use super::technique::Technique;
use super::vpls::trace_vpls;
use crate::cpu::Simd;
use crate::device::processor_name;
use crate::monitor::{Monitor, Stage};
use crate::settings::Settings;
use crate::stats::{PartTime, StationDevice, Stats, timed};
use lightcuts_kernel::rng::stream;
use lightcuts_kernel::virtual_light::VirtualLight;
use lightcuts_world::PhysicalWorld;
use rayon::prelude::*;
use std::time::Instant;

/// Purposes of random numbers; each has its own stream.
const SAMPLES: u32 = 16;
const LIGHT_PATHS: u32 = 17;
const REPRESENTATIVES: u32 = 18;
const PILOT: u32 = 19;
const PHOTONS: u32 = 20;
const PLACES: u32 = 21;
const PROBES: u32 = 22;

/// Photons of a pass: one for each pixel, within these limits.
const PHOTON_PATHS: [u32; 2] = [1 << 14, 1 << 20];

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
    rejection: Option<Rejection>,
    mixture: Mixture,
    plan: Plan,
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
        let techniques = Technique::of(settings);
        let mixture = Mixture::new(settings.image.width, settings.image.height, techniques.len());
        Self {
            scene,
            settings,
            monitor,
            origins: Origins::new(&scene),
            rejection: None,
            plan: Plan::new(techniques, mixture.tiles().len()),
            mixture,
            stats: Stats::default(),
            counts: Counts::default(),
            started: Instant::now(),
            paths: 0,
            lights: 0,
        }
    }

    pub(crate) fn run(mut self) -> PhysicalRendering {
        let tiles = self.mixture.tiles().len() as u64;
        let steps = Steps::new(self.settings.physical.time_limit, u64::from(self.settings.sampling.samples) * tiles);
        self.monitor.begin(Stage::Samples, steps.total);
        let mut passes = std::mem::take(&mut self.stats.passes);
        timed(&mut passes, Stage::Samples, || self.run_passes(&steps));
        self.stats.passes = passes;
        self.monitor.end();
        self.finish()
    }

    fn run_passes(&mut self, steps: &Steps) {
        let uses_vpls = self.plan.techniques().iter().any(|technique| technique.uses_vpls());
        let mut before = PartTime::default();
        let pilot = before.add(|| {
            if uses_vpls {
                self.prepare_vpls();
            }
            // What cuts go by until there is a pass; a first pass of path tracing brings it by itself.
            if self.plan.techniques()[0].uses_vpls() { self.pilot() } else { Vec::new() }
        });
        self.stats.vpl_work.pilot = before;
        self.stats.complete = true;
        let wanted = u64::from(self.settings.sampling.samples) * self.mixture.tiles().len() as u64;
        let mut taken = 0;
        for pass in 0.. {
            let tasks = self.plan.tasks(&self.mixture, pass);
            taken += tasks.iter().map(|task| u64::from(task.extent.samples())).sum::<u64>();
            if !self.run_pass(pass, &tasks, &pilot, steps) {
                // Time that was asked for and is up completes a render.
                self.stats.complete = !self.monitor.cancelled();
                return;
            }
            if taken >= wanted {
                return;
            }
            let noise = self.settings.physical.noise;
            let is_time_to_look = (pass + 1).is_multiple_of(NOISE_INTERVAL);
            if is_time_to_look && noise > 0.0 && self.mixture.noise() <= f64::from(noise) {
                return;
            }
        }
    }

    /// Distance below which a virtual light's contribution no longer grows, in scene units.
    fn clamp(&self) -> f32 {
        let (lower, upper) = self.scene.world.bounds;
        self.settings.physical.clamp * (upper - lower).length()
    }

    fn stream(&self, purpose: u32, pass: u32) -> u32 {
        stream(stream(self.settings.run.seed, purpose), pass)
    }

    /// One pass; returns whether it came to its end.
    fn run_pass(&mut self, pass: u32, tasks: &[Task], pilot: &[f32], steps: &Steps) -> bool {
        let techniques = self.plan.techniques().to_vec();
        let tree = tasks.iter().any(|task| techniques[task.technique].uses_vpls()).then(|| {
            // What cuts go by.
            if pass > 0 {
                self.mixture.learn_light();
            }
            self.plant(pass)
        });
        let caustics = self.shoot_photons(pass);
        let references = if pass == 0 { pilot } else { self.mixture.references() };
        let clamp = self.clamp();
        let vpls = tree.map(|tree| Lightcuts { tree, settings: &self.settings.physical, clamp, references });
        let samples = stream(self.settings.run.seed, SAMPLES);
        let probes = stream(self.settings.run.seed, PROBES);
        let sample_pass = self.sample_pass(vpls, caustics);
        let (monitor, started, mixture) = (self.monitor, self.started, &self.mixture);
        let limit = self.settings.physical.time_limit;
        // The first pass is finished whatever time it takes: a picture has no holes.
        let is_up = || pass > 0 && limit > 0.0 && started.elapsed().as_secs_f32() >= limit;
        let results: Vec<Option<SampledTile>> = tasks
            .par_iter()
            .map(|&task| {
                let (technique, before) = (techniques[task.technique], mixture.moments(task.technique));
                let tile = &mixture.tiles()[task.tile];
                let stream = match task.extent {
                    Extent::Whole(_) if task.technique == 0 => samples,
                    Extent::Whole(_) => stream(samples, task.technique as u32),
                    Extent::Probe(_) => probes,
                };
                let rendered = (!monitor.cancelled() && !is_up())
                    .then(|| sample_pass.render(task, tile, technique, before, stream));
                (0..task.extent.samples()).for_each(|_| steps.advance(monitor, started));
                rendered
            })
            .collect();
        let is_whole = results.iter().all(Option::is_some);
        for sampled in results.iter().flatten() {
            self.mixture.add(sampled);
            self.plan.learn(sampled);
            self.counts.add(&sampled.counts);
        }
        if tasks.iter().any(|task| task.extent.samples() == 0) {
            self.mixture.learn_variances();
        }
        is_whole
    }

    fn sample_pass<'b>(&'b self, vpls: Option<Lightcuts<'b>>, caustics: Option<CausticMap>) -> SamplePass<'b> {
        let image = self.settings.image;
        SamplePass {
            scene: self.scene,
            lens: self.scene.world.lens(image.width, image.height),
            filter: &self.settings.filter,
            vpls,
            caustics,
        }
    }

    /// The photons of a pass, where caustics are asked for.
    fn shoot_photons(&mut self, pass: u32) -> Option<CausticMap> {
        let origins = self.origins.as_ref().filter(|_| self.settings.caustics.enabled)?;
        let image = self.settings.image;
        let paths = image.width.saturating_mul(image.height).clamp(PHOTON_PATHS[0], PHOTON_PATHS[1]);
        let map = CausticMap::shoot(&self.scene, origins, paths, self.stream(PHOTONS, pass), pass);
        self.stats.rays.photon += map.rays();
        self.stats.photons_stored += map.photons() as u64;
        Some(map)
    }

    /// What pixels are about as bright as, before the first pass: a traced path for each, over blocks.
    fn pilot(&self) -> Vec<f32> {
        let image = self.settings.image;
        let mut mixture = Mixture::new(image.width, image.height, 1);
        let pass = self.sample_pass(None, None);
        let stream = stream(self.settings.run.seed, PILOT);
        let monitor = self.monitor;
        let results: Vec<Option<SampledTile>> = (0..mixture.tiles().len())
            .into_par_iter()
            .map(|tile| {
                let task = Task { tile, technique: 0, extent: Extent::Whole(1) };
                let tile = &mixture.tiles()[tile];
                (!monitor.cancelled()).then(|| pass.render(task, tile, Technique::Path, None, stream))
            })
            .collect();
        results.iter().flatten().for_each(|sampled| mixture.add(sampled));
        mixture.learn_light();
        mixture.references().to_vec()
    }

    /// What light paths leave, before any pass: how many virtual lights, and how much they bring.
    fn prepare_vpls(&mut self) {
        let Some(origins) = &self.origins else { return };
        let image = self.settings.image;
        if self.settings.physical.rejection {
            let lens = self.scene.world.lens(image.width, image.height);
            let clamp = self.clamp();
            self.rejection = Some(Rejection::new(&self.scene, &lens, self.stream(PLACES, 0), clamp));
        }
        let stream = stream(self.settings.run.seed, LIGHT_PATHS);
        // Twice: the second time lights are kept as they will be.
        for _ in 0..2 {
            let left = trace_vpls(&self.scene, origins, self.rejection.as_ref(), PILOT_PATHS, stream);
            self.paths = u64::from(PILOT_PATHS);
            self.lights = left.items.iter().filter(|judged| judged.light.is_some()).count() as u64;
            self.stats.rays.photon += left.rays;
            if let Some(rejection) = &mut self.rejection {
                rejection.learn(&left.items);
            }
        }
    }

    /// Virtual lights of a pass under their tree.
    fn plant(&mut self, pass: u32) -> ClusterTree {
        let mut work = self.stats.vpl_work;
        let before = work.placing.cpu_s + work.tree.cpu_s;
        let lights = work.placing.add(|| self.trace_vpls(pass));
        let tree = work.tree.add(|| ClusterTree::build(&lights, self.stream(REPRESENTATIVES, pass)));
        let bytes = size_of_val(&tree.lights[..]) + size_of_val(&tree.nodes[..]);
        work.bytes = work.bytes.max(bytes as u64);
        self.stats.vpl_work = work;
        let image = self.settings.image;
        self.plan
            .learn_vpls(work.placing.cpu_s + work.tree.cpu_s - before, image.width as usize * image.height as usize);
        tree
    }

    /// Virtual lights of a pass. Their number is about what is wanted, by the experience of earlier passes; the number of paths
    /// is fixed before they are traced.
    fn trace_vpls(&mut self, sample: u32) -> Vec<VirtualLight> {
        let Some(origins) = &self.origins else { return Vec::new() };
        let lights_per_path = self.lights as f64 / self.paths.max(1) as f64;
        let wanted = f64::from(self.settings.physical.vpls) / lights_per_path.max(1e-3);
        let paths = (wanted as u32).clamp(1, self.settings.physical.vpls.saturating_mul(8));
        let stream = self.stream(LIGHT_PATHS, sample);
        let left = trace_vpls(&self.scene, origins, self.rejection.as_ref(), paths, stream);
        let lights: Vec<VirtualLight> = left.items.iter().filter_map(|judged| judged.light).collect();
        if let Some(rejection) = &mut self.rejection {
            rejection.learn(&left.items);
        }
        self.paths += u64::from(paths);
        self.lights += lights.len() as u64;
        self.stats.rays.photon += left.rays;
        self.stats.vpl_count = lights.len() as u64;
        lights
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
        self.mixture.develop(self.stats, self.scene.world.origin)
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
