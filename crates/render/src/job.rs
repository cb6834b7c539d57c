//! A render from its first pass to the finished picture: the walk through the stations.

use crate::cpu::CpuDevice;
use crate::crew::Crew;
use crate::device::{Device, Lighting, Pass, Placement, Shifts, TileResult, View, VplLighting, Wants};
use crate::film::Tile;
use crate::light_ratio::LightRatio;
use crate::light_tree::LightTree;
use crate::monitor::{Monitor, Stage};
use crate::occlusion::Occlusion;
use crate::original::OriginalDraws;
use crate::photon_map::{PhotonMap, photon_targets};
use crate::rendering::{Canvas, Rendering};
use crate::sampler::Sampler;
use crate::settings::{Bloom, Settings};
use crate::stations::{Station, Stations};
use crate::stats::{End, Stats, timed};
use crate::{Options, Vpl};
use lightcuts_image::Image;
use lightcuts_kernel::Rules;
use lightcuts_kernel::rng::stream;
use lightcuts_world::World;

/// Edge of a tile in pixels.
const TILE_SIZE: u32 = 16;

/// Purposes of random numbers; each has its own stream.
const SHIFTS: u32 = 1;
const PLACEMENT: u32 = 2;
const OCCLUSION: u32 = 3;

/// A render on its way.
pub(crate) struct Job<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) view: View<'a>,
    given_vpls: Option<&'a [Vpl]>,
    pub(crate) monitor: &'a dyn Monitor,
    pub(crate) crew: Crew<'a>,
    canvas: Canvas,
    stats: Stats,
    /// The original's random numbers, where they are to be reproduced.
    pub(crate) draws: Option<OriginalDraws>,
    cancelled: bool,
}

impl<'a> Job<'a> {
    pub(crate) fn new(
        world: &'a World,
        settings: &'a Settings,
        options: &'a Options,
        stations: &Stations<'a>,
        monitor: &'a dyn Monitor,
    ) -> Self {
        let rules = if settings.run.reproduce { Rules::Original } else { Rules::Repaired };
        let size = settings.image;
        let view = View {
            world,
            camera: world.camera(size.width, size.height),
            rules,
            filter: &settings.filter,
            max_depth: settings.run.max_depth,
        };
        Self {
            settings,
            view,
            given_vpls: options.vpls.as_deref(),
            monitor,
            crew: Crew::new(stations, CpuDevice::new(world, options.simd)),
            canvas: Canvas::new(size.width, size.height),
            stats: Stats::default(),
            draws: settings.run.reproduce.then(OriginalDraws::new),
            cancelled: false,
        }
    }

    /// Walks through the stations; after a cancelled one only the last.
    pub(crate) fn run(mut self) -> Rendering {
        let placed = self.timed(Stage::FirstPass, |job| match job.draws {
            Some(draws) => job.first_pass_original(draws),
            None => job.first_pass(),
        });
        let image = self.settings.image;
        let pixels = f64::from(image.width) * f64::from(image.height);
        self.stats.samples_per_pixel = self.stats.rays.primary as f64 / pixels;
        let vpls = self.given_vpls.map_or(placed, <[Vpl]>::to_vec);
        self.stats.vpl_count = vpls.len() as u64;
        let photons = self.shoot_photons();
        if self.settings.vpl.enabled && !self.cancelled && (!vpls.is_empty() || photons.is_some()) {
            let tree = self.timed(Stage::LightTree, |job| job.build_tree(&vpls));
            self.timed(Stage::SecondPass, |job| job.second_pass(&tree, photons.as_ref()));
        }
        self.finish(vpls)
    }

    fn finish(self, vpls: Vec<Vpl>) -> Rendering {
        let Self { settings, canvas, mut crew, mut stats, cancelled, monitor, .. } = self;
        monitor.begin(Stage::Develop, 1);
        let bloom = |sum| bloom(&mut crew, &settings.bloom, sum, monitor);
        let mut passes = std::mem::take(&mut stats.passes);
        let mut rendering = timed(&mut passes, Stage::Develop, || canvas.develop(bloom, vpls, stats));
        monitor.end();
        let stats = &mut rendering.stats;
        stats.total_wall_s = passes.iter().map(|p| p.wall_s).sum();
        stats.total_cpu_s = passes.iter().map(|p| p.cpu_s).sum();
        stats.passes = passes;
        stats.complete = !cancelled;
        stats.end = if cancelled { End::Interrupted } else { End::Samples };
        stats.samples_wanted = Some(u64::from(settings.sampling.samples));
        (stats.devices, stats.device_faults) = (crew.record(), crew.faults);
        let tree = &mut stats.tree;
        tree.visits_per_hit = (tree.nodes + tree.lights) as f64 / tree.shaded_hits.max(1) as f64;
        rendering
    }

    /// Runs a stage, recording its time.
    fn timed<T>(&mut self, stage: Stage, work: impl FnOnce(&mut Self) -> T) -> T {
        let mut passes = std::mem::take(&mut self.stats.passes);
        let result = timed(&mut passes, stage, || work(self));
        self.stats.passes = passes;
        result
    }

    /// Station 3: the picture of the scene's own lights; hits become VPLs.
    fn first_pass(&mut self) -> Vec<Vpl> {
        let settings = self.settings;
        let occlusion = self.occlusion();
        let lighting = Lighting::Scene { occlusion: occlusion.as_ref() };
        let wanted = self.given_vpls.is_none();
        let size = settings.image;
        let camera_rays = u64::from(size.width) * u64::from(size.height) * u64::from(settings.sampling.samples);
        let stream = stream(settings.run.seed, PLACEMENT);
        let placement = wanted.then(|| Placement::new(&settings.vpl, camera_rays, stream));
        let sampler = self.sampler(0, settings.sampling.samples);
        let mut vpls = Vec::new();
        let pass = self.pass(lighting, Shifts::Sampler(&sampler), Wants::SurfacesAndVpls(placement.as_ref()));
        self.run_pass(Stage::FirstPass, &pass, |canvas, result| {
            canvas.first.merge(&result.film);
            vpls.extend(result.vpls);
        });
        self.refine(Stage::FirstPass, lighting);
        vpls
    }

    /// Station 4, in the layout that the second pass wants.
    fn build_tree(&mut self, vpls: &[Vpl]) -> LightTree {
        self.skip_tree_draws(vpls.len());
        let wanted = self.crew.at(Station::Gather).preferred_layout();
        self.crew.run(Station::Tree, self.monitor, |device, _| device.build_tree(vpls, wanted))
    }

    fn shoot_photons(&mut self) -> Option<PhotonMap> {
        let (settings, view) = (self.settings, self.view);
        let caustics = &settings.caustics;
        // Without a second pass nothing would gather them.
        if !caustics.enabled || !settings.vpl.enabled || self.cancelled {
            return None;
        }
        self.timed(Stage::Photons, |job| {
            let rows = photon_targets(view.world, caustics).iter().map(|target| u64::from(target.side)).sum();
            job.monitor.begin(Stage::Photons, rows);
            let shoot = |device: &dyn Device, monitor: &dyn Monitor| device.shoot_photons(&view, caustics, monitor);
            let (map, rays) = job.crew.run(Station::Photons, job.monitor, shoot);
            job.monitor.end();
            job.stats.rays.photon += rays;
            job.stats.photons_stored = map.photons.len() as u64;
            job.cancelled |= job.monitor.cancelled();
            Some(map)
        })
    }

    /// Station 5: light of the VPLs.
    fn second_pass(&mut self, tree: &LightTree, photons: Option<&PhotonMap>) {
        let settings = self.settings;
        let lighting = Lighting::Vpls(VplLighting {
            tree,
            strategy: settings.gather.strategy,
            threshold: settings.gather.threshold,
            photons,
        });
        let mut ratio = LightRatio::new(tree.vpl_count(), self.draws.is_some());
        let mut merge = |canvas: &mut Canvas, result: TileResult| {
            canvas.second.merge(&result.film);
            ratio.add(&result);
        };
        if let Some(draws) = &mut self.draws {
            let (width, height) = (self.view.camera.width, self.view.camera.height);
            let shifts: Vec<[f32; 2]> = (0..height).flat_map(|_| draws.row(width)).collect();
            let pass = self.pass(lighting, Shifts::Given(&shifts), Wants::Selections);
            self.run_pass(Stage::SecondPass, &pass, merge);
        } else {
            let sampler = self.sampler(0, settings.sampling.samples);
            let pass = self.pass(lighting, Shifts::Sampler(&sampler), Wants::SelectedSums);
            self.run_pass(Stage::SecondPass, &pass, &mut merge);
            self.refine(Stage::SecondPass, lighting);
        }
        self.stats.light_ratio_percent = ratio.percent();
    }

    /// Adaptive anti-aliasing: more samples where neighbouring pixels of this pass differ.
    fn refine(&mut self, stage: Stage, lighting: Lighting<'_>) {
        let extra = self.settings.adaptive_extra();
        if extra == 0 || self.cancelled {
            return;
        }
        let film = if stage == Stage::FirstPass { &self.canvas.first } else { &self.canvas.second };
        let mask = self.canvas.edges(film, self.settings.sampling.adaptive_threshold);
        self.stats.adaptive_pixels += mask.iter().filter(|&&m| m).count() as u64;
        let first_sample = self.settings.sampling.samples;
        let sampler = self.sampler(first_sample, extra);
        let pass =
            Pass { first_sample, mask: Some(&mask), ..self.pass(lighting, Shifts::Sampler(&sampler), Wants::Colors) };
        self.run_pass(stage, &pass, |canvas, result| {
            let film = if stage == Stage::FirstPass { &mut canvas.first } else { &mut canvas.second };
            film.merge(&result.film);
        });
    }

    pub(crate) fn occlusion(&self) -> Option<Occlusion> {
        let settings = &self.settings.ambient_occlusion;
        settings.enabled.then(|| Occlusion::new(settings, stream(self.settings.run.seed, OCCLUSION)))
    }

    fn sampler(&self, first: u32, count: u32) -> Sampler {
        Sampler::new(self.settings.sampling.sampler, stream(self.settings.run.seed, SHIFTS), first, count)
    }

    pub(crate) fn pass<'p>(&self, lighting: Lighting<'p>, shifts: Shifts<'p>, wants: Wants<'p>) -> Pass<'p>
    where
        'a: 'p,
    {
        Pass { view: self.view, lighting, shifts, first_sample: 0, mask: None, wants }
    }

    /// Runs a pass over the whole picture as a stage of its own.
    pub(crate) fn run_pass(&mut self, stage: Stage, pass: &Pass<'_>, merge: impl FnMut(&mut Canvas, TileResult)) {
        let tiles = self.tiles();
        let station = if stage == Stage::FirstPass { Station::Place } else { Station::Gather };
        self.monitor.begin(stage, tiles.len() as u64);
        self.merge_tiles(station, pass, &tiles, merge);
        self.monitor.end();
    }

    /// With the original's draws, tiles are rows, so that its running sums come in its order.
    pub(crate) fn tiles(&self) -> Vec<Tile> {
        let (width, height) = (self.view.camera.width, self.view.camera.height);
        if self.draws.is_some() {
            (0..height).map(|j| Tile { i: 0, j, width, height: 1 }).collect()
        } else {
            Tile::cover(width, height, TILE_SIZE)
        }
    }

    pub(crate) fn merge_tiles(
        &mut self,
        station: Station,
        pass: &Pass<'_>,
        tiles: &[Tile],
        mut merge: impl FnMut(&mut Canvas, TileResult),
    ) -> bool {
        let (canvas, stats) = (&mut self.canvas, &mut self.stats);
        let complete = self.crew.render_tiles(station, pass, tiles, self.monitor, |result| {
            canvas.see(&result);
            stats.rays.add(&result.rays);
            stats.tree.add(&result.visits);
            merge(canvas, result);
        });
        self.cancelled |= !complete;
        complete
    }
}

/// What devices do at station 6: bloom over both passes together, if it is wanted.
fn bloom(crew: &mut Crew<'_>, bloom: &Bloom, sum: Image, monitor: &dyn Monitor) -> Image {
    let Bloom { enabled, radius, weight } = *bloom;
    if enabled { crew.run(Station::Develop, monitor, |device, _| device.bloom(&sum, radius, weight)) } else { sum }
}
