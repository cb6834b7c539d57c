//! A render of the physical model: passes over the picture until there are enough samples, time is up, or noise is low.

use super::caustics::CausticMap;
use super::cluster_tree::ClusterTree;
use super::develop::Undeveloped;
use super::emission::Origins;
use super::in_order::in_order;
use super::lightcuts::Lightcuts;
use super::mixture::Mixture;
use super::pass::{SamplePass, SampledTile};
use super::placing::Placing;
use super::plan::Plan;
use super::rendering::PhysicalRendering;
use super::scene::Scene;
use super::sketch::Sketch;
use super::sums::Counts;
use super::task::{Extent, Points, Task};
use super::technique::Technique;
use super::watch::Watch;
use crate::cpu::Simd;
use crate::device::processor_name;
use crate::monitor::{Monitor, Stage};
use crate::settings::Settings;
use crate::stats::{End, PartTime, StationDevice, Stats, timed};
use lightcuts_kernel::rng::stream;
use lightcuts_world::PhysicalWorld;
use std::sync::Arc;
use std::time::Instant;

/// Purposes of random numbers; each has its own stream. `placing` has others.
const SAMPLES: u32 = 16;
const PILOT: u32 = 19;
const PHOTONS: u32 = 20;
const PROBES: u32 = 22;

/// Photons of a pass: one for each pixel, within these limits.
const PHOTON_PATHS: [u32; 2] = [1 << 14, 1 << 20];

/// Edge of the sketch's cells: where only a person may break the first pass off, and where time may; in both cases what is sampled
/// for it is a small share of a pass.
const COARSE_CELL: usize = 8;
const TIMED_CELL: usize = 4;

/// The same where cuts go by the sketch, in small pictures and in large ones, from so many pixels on. Measured, with one sample and with
/// four: relMSE is within 1 % of that with cells of one pixel, which took a third of the time of a first pass.
const PILOT_CELLS: [usize; 2] = [2, 4];
const LARGE: usize = 1 << 17;

/// Passes between two looks at the noise.
const NOISE_INTERVAL: u32 = 4;

/// A first pass that would take this many times the time that is left is given up for a finer sketch.
const HOPELESS: f64 = 1.5;

/// Share of the time that is left, and number of tiles for each thread, by which that is judged.
const JUDGING_SHARE: f64 = 0.05;
const JUDGING_TILES: usize = 4;

/// Renders a physical world.
pub(crate) struct PhysicalJob<'a> {
    scene: Scene<'a>,
    settings: &'a Settings,
    watch: Watch<'a>,
    mixture: Mixture,
    /// Until the first pass is whole.
    sketch: Option<Sketch>,
    plan: Plan,
    stats: Stats,
    counts: Counts,
}

impl<'a> PhysicalJob<'a> {
    pub(crate) fn new(world: &'a PhysicalWorld, settings: &'a Settings, simd: Simd, monitor: &'a dyn Monitor) -> Self {
        let techniques = Technique::of(settings);
        let image = settings.image;
        let mixture = Mixture::new(image.width, image.height, techniques.len());
        let tiles = mixture.tiles().len();
        Self {
            scene: Scene::new(world, simd),
            settings,
            watch: Watch::new(monitor, settings, tiles),
            plan: Plan::new(techniques, tiles),
            mixture,
            sketch: Some(Sketch::new(image.width, image.height)),
            stats: Stats::default(),
            counts: Counts::default(),
        }
    }

    pub(crate) fn run(mut self) -> PhysicalRendering {
        self.watch.begin();
        let mut passes = std::mem::take(&mut self.stats.passes);
        let end = timed(&mut passes, Stage::Samples, || self.run_passes());
        self.watch.end();
        self.stats.passes = passes;
        self.stats.end = end;
        self.finish()
    }

    /// Returns why no more samples are taken.
    fn run_passes(&mut self) -> End {
        let origins = Origins::new(&self.scene);
        let uses_vpls = self.plan.techniques().iter().any(|technique| technique.uses_vpls());
        let mut before = PartTime::default();
        let (mut placing, pilot) = before.add(|| {
            let origins = origins.as_ref().filter(|_| uses_vpls);
            let stats = &mut self.stats;
            let placing = origins.map(|of| Placing::new(self.scene, self.settings, of, &self.watch, stats));
            (placing, self.sketch())
        });
        self.stats.vpl_work.pilot = before;
        for pass in 0.. {
            if self.watch.is_over() {
                break;
            }
            let tasks = self.plan.tasks(&self.mixture, pass);
            let tree = if tasks.iter().any(|task| self.plan.techniques()[task.technique].uses_vpls()) {
                self.build_light_tree(pass, placing.as_mut())
            } else {
                None
            };
            let photons = origins.as_ref().and_then(|origins| self.shoot_photons(origins, pass));
            let references = if pass == 0 { pilot.clone() } else { self.mixture.references() };
            if self.watch.is_over() || !self.run_pass(pass, tasks, tree, photons, &references) {
                break;
            }
            if self.watch.has_all() {
                return End::Samples;
            }
            if (pass + 1).is_multiple_of(NOISE_INTERVAL) && self.is_noise_low() {
                return End::Noise;
            }
        }
        if self.watch.is_cancelled() { End::Interrupted } else { End::Time }
    }

    fn is_noise_low(&self) -> bool {
        let wanted = f64::from(self.settings.physical.noise);
        if wanted <= 0.0 {
            return false;
        }
        let Some(noise) = self.mixture.noise() else { return false };
        self.watch.expect(noise, wanted);
        noise <= wanted
    }

    /// Makes the sketch; returns what pixels are about as bright as, if cuts of the first pass go by it. A first pass of path
    /// tracing brings that by itself.
    fn sketch(&mut self) -> Arc<Vec<f32>> {
        let is_pilot = self.plan.techniques()[0].uses_vpls();
        let pixels = self.mixture.width * self.mixture.height;
        let cell = match self.watch.left() {
            _ if is_pilot => {
                if pixels < LARGE {
                    PILOT_CELLS[0]
                } else {
                    PILOT_CELLS[1]
                }
            }
            None => COARSE_CELL,
            Some(_) => TIMED_CELL,
        };
        self.refine(cell);
        let light = self.sketch.as_ref().filter(|_| is_pilot).map(Sketch::smooth_light);
        Arc::new(light.unwrap_or_default())
    }

    /// Refines the sketch until its cells are as small as that, or time is up.
    fn refine(&mut self, cell: usize) {
        let pass = self.sample_pass(None, None);
        let (stream, watch) = (stream(self.settings.run.seed, PILOT), &self.watch);
        let Some(sketch) = &mut self.sketch else { return };
        while sketch.cell() > cell && sketch.refine(&pass, stream, || watch.is_over()) {}
    }

    /// Virtual lights of a pass under their tree, if there is time for it.
    fn build_light_tree(&mut self, pass: u32, placing: Option<&mut Placing<'_>>) -> Option<ClusterTree> {
        // What cuts go by.
        if pass > 0 {
            self.mixture.learn_light();
        }
        // Where nothing shines there are no lights.
        let Some(placing) = placing else { return Some(ClusterTree::default()) };
        let seconds = |stats: &Stats| stats.vpl_work.placing.cpu_s + stats.vpl_work.tree.cpu_s;
        let before = seconds(&self.stats);
        let tree = placing.build_light_tree(pass, &self.watch, &mut self.stats);
        let image = self.settings.image;
        self.plan.learn_vpls(seconds(&self.stats) - before, image.width as usize * image.height as usize);
        tree
    }

    /// The photons of a pass, where caustics are asked for.
    fn shoot_photons(&mut self, origins: &Origins, pass: u32) -> Option<CausticMap> {
        if !self.settings.caustics.enabled {
            return None;
        }
        let image = self.settings.image;
        let paths = image.width.saturating_mul(image.height).clamp(PHOTON_PATHS[0], PHOTON_PATHS[1]);
        let stream = stream(stream(self.settings.run.seed, PHOTONS), pass);
        let map = CausticMap::shoot(&self.scene, origins, paths, stream, pass, &|| self.watch.is_over());
        self.stats.rays.photon += map.rays();
        self.stats.photons_stored += map.photons() as u64;
        Some(map)
    }

    /// One pass; returns whether it came to its end.
    fn run_pass(
        &mut self,
        pass: u32,
        mut tasks: Vec<Task>,
        tree: Option<ClusterTree>,
        caustics: Option<CausticMap>,
        references: &[f32],
    ) -> bool {
        let (lower, upper) = self.scene.world.bounds;
        let clamp = self.settings.physical.clamp * (upper - lower).length();
        let vpls = tree.map(|tree| Lightcuts { tree, settings: &self.settings.physical, clamp, references });
        let sample_pass = self.sample_pass(vpls, caustics);
        let has_probes = tasks.iter().any(|task| task.extent.samples() == 0);
        let may_fail = pass == 0 && self.watch.left().is_some();
        if may_fail {
            scatter(&mut tasks);
        }
        let mut left = self.run_tasks(&sample_pass, tasks, may_fail);
        if may_fail && !left.is_empty() && !self.watch.is_over() {
            self.refine(1);
            left = self.run_tasks(&sample_pass, left, false);
        }
        if pass == 0 && left.is_empty() {
            self.sketch = None;
        }
        if has_probes {
            self.mixture.learn_variances();
        }
        left.is_empty()
    }

    /// Does tasks and adds what they bring, until time is up; returns those that are left. Gives up before that, if asked to, where
    /// most of the tasks would be left.
    fn run_tasks(&mut self, pass: &SamplePass<'_>, tasks: Vec<Task>, gives_up: bool) -> Vec<Task> {
        let Self { watch, mixture, plan, counts, .. } = self;
        let watch = &*watch;
        let tiles = mixture.tiles();
        let techniques = plan.techniques().to_vec();
        let seed = self.settings.run.seed;
        let points: Vec<Points> = tasks.iter().map(|task| points_of(task, mixture, seed)).collect();
        let (began, available) = (Instant::now(), watch.left().filter(|_| gives_up));
        let is_hopeless = |done: usize| {
            available.is_some_and(|available| {
                let (spent, available) = (began.elapsed().as_secs_f64(), available.as_secs_f64());
                done >= JUDGING_TILES * rayon::current_num_threads()
                    && spent > JUDGING_SHARE * available
                    && spent / done as f64 * tasks.len() as f64 > HOPELESS * available
            })
        };
        let mut is_done = vec![false; tasks.len()];
        let work = |k: usize| {
            let Task { tile, technique, .. } = tasks[k];
            pass.render(tasks[k], &tiles[tile], techniques[technique], points[k], || watch.is_over())
        };
        in_order(tasks.len(), work, |k, sampled: Option<SampledTile>| {
            let Some(sampled) = sampled else { return false };
            mixture.add(&sampled);
            plan.learn(&sampled);
            counts.add(&sampled.counts);
            watch.take(tasks[k].extent.samples());
            is_done[k] = true;
            !is_hopeless(k + 1)
        });
        tasks.into_iter().zip(is_done).filter_map(|(task, is_done)| (!is_done).then_some(task)).collect()
    }

    fn sample_pass<'b>(&self, vpls: Option<Lightcuts<'b>>, caustics: Option<CausticMap>) -> SamplePass<'b>
    where
        'a: 'b,
    {
        let image = self.settings.image;
        let lens = self.scene.world.lens(image.width, image.height);
        SamplePass { scene: self.scene, lens, filter: &self.settings.filter, vpls, caustics }
    }

    fn finish(self) -> PhysicalRendering {
        let origin = self.scene.world.origin;
        let Self { mixture, sketch, mut stats, counts, settings, .. } = self;
        stats.complete = stats.end != End::Interrupted;
        stats.samples_wanted = Some(u64::from(settings.sampling.samples)).filter(|&samples| samples > 0);
        stats.relative_error = mixture.about_noise();
        stats.rays.primary = counts.primary;
        stats.rays.secondary = counts.bounces;
        stats.rays.shadow = counts.shadow;
        stats.tree.shaded_hits = counts.gathered;
        stats.tree.nodes = counts.bounds;
        stats.tree.selected = counts.cut;
        stats.tree.visits_per_hit = counts.bounds as f64 / counts.gathered.max(1) as f64;
        stats.devices =
            vec![StationDevice { station: "gather".to_owned(), kind: "cpu".to_owned(), name: processor_name() }];
        let undeveloped = Undeveloped { mixture, sketch, origin };
        let mut passes = std::mem::take(&mut stats.passes);
        let beauty = timed(&mut passes, Stage::Develop, || undeveloped.beauty());
        (stats.samples_per_pixel, stats.unsampled_pixels) = undeveloped.samples();
        stats.total_wall_s = passes.iter().map(|pass| pass.wall_s).sum();
        stats.total_cpu_s = passes.iter().map(|pass| pass.cpu_s).sum();
        stats.passes = passes;
        PhysicalRendering::new(beauty, stats, undeveloped)
    }
}

/// The random numbers of a task: those that come after its tile's samples so far. Techniques are compared by the same ones: what
/// any of them would see counts for all.
fn points_of(task: &Task, mixture: &Mixture, seed: u32) -> Points {
    let samples = stream(seed, SAMPLES);
    match task.extent {
        Extent::Probe(number) => Points { first: number, stream: stream(seed, PROBES) },
        Extent::Whole(_) => Points {
            first: mixture.shown(task.technique, task.tile),
            stream: if task.technique == 0 { samples } else { stream(samples, task.technique as u32) },
        },
    }
}

/// Brings tasks into an order in which neighbours are far apart: the first ones tell of the whole picture.
fn scatter(tasks: &mut [Task]) {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let count = tasks.len();
    let is_coprime = |step: &usize| {
        let (mut a, mut b) = (count, *step);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a == 1
    };
    let first = (count as f64 * GOLDEN) as usize;
    let Some(step) = (first.max(1)..=count).find(is_coprime) else { return };
    let scattered: Vec<Task> = (0..count).map(|k| tasks[k * step % count]).collect();
    tasks.copy_from_slice(&scattered);
}
