//! One pass over the picture: camera rays of every pixel, tile by tile, in parallel.

use crate::cpu::Tracer;
use crate::film::{Film, Tile};
use crate::monitor::Monitor;
use crate::original::effective_probability;
use crate::ray_tree::{RayTree, TreeHit};
use crate::sampler::Sampler;
use crate::settings::{Filter, VplPlacement};
use crate::shade::{Lighting, Shader};
use crate::stats::{Rays, TreeVisits};
use glam::Vec3;
use lightcuts_kernel::camera::{Camera, THESIS_SIZE, camera_ray};
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::rng::random4;
use lightcuts_world::World;
use rayon::prelude::*;

/// Tiles that are rendered between two looks at the monitor.
const BATCH: usize = 64;

/// What every pass over the picture shares.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) world: &'a World,
    pub(crate) camera: Camera,
    pub(crate) tracer: Tracer<'a>,
    pub(crate) filter: &'a Filter,
    pub(crate) max_depth: u32,
}

/// Where a pass takes its samples from.
#[derive(Clone, Copy)]
pub(crate) enum Shifts<'a> {
    /// A sampler's points.
    Sampler(&'a Sampler),
    /// One given shift per pixel of the whole picture, bottom row first.
    Given(&'a [[f32; 2]]),
}

/// What a pass does at each pixel.
#[derive(Clone, Copy)]
pub(crate) struct Pass<'a> {
    pub(crate) view: View<'a>,
    pub(crate) lighting: Lighting<'a>,
    pub(crate) shifts: Shifts<'a>,
    /// Number of a pixel's first sample in this pass.
    pub(crate) first_sample: u32,
    /// Pixels to render; all where absent.
    pub(crate) mask: Option<&'a [bool]>,
    /// What is wanted besides colours.
    pub(crate) wants: Wants<'a>,
}

/// What a pass reports besides colours.
#[derive(Clone, Copy)]
pub(crate) enum Wants<'a> {
    /// Nothing.
    Colors,
    /// Surfaces seen, and VPLs placed.
    SurfacesAndVpls(Option<&'a Placement>),
    /// Surfaces seen, and every hit in the original's order.
    SurfacesAndHits,
    /// Numbers of VPLs that lit each shaded hit, in order.
    Selections,
}

/// Chooses hits that become VPLs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement {
    probability: f32,
    min_illumination: f32,
    attenuation: f32,
    stream: u32,
}

impl Placement {
    /// `samples` camera rays are to place as many VPLs, on average, as the thesis' picture of one per pixel: VPLs are not
    /// weighted, so their number decides how bright the second pass is.
    pub(crate) fn new(settings: &VplPlacement, samples: u64, stream: u32) -> Self {
        let thesis_samples = u64::from(THESIS_SIZE) * u64::from(THESIS_SIZE);
        Self {
            probability: effective_probability(settings.probability) * (thesis_samples as f32 / samples as f32),
            min_illumination: settings.min_illumination,
            attenuation: settings.attenuation,
            stream,
        }
    }

    /// The VPL of a hit, if its light is enough.
    pub(crate) fn vpl(&self, hit: &TreeHit) -> Option<Vpl> {
        let color = hit.color;
        (color.x + color.y + color.z >= self.min_illumination).then(|| Vpl {
            position: hit.surface.point + hit.surface.normal * hit.epsilon,
            direction: hit.surface.normal,
            diffuse: color,
            attenuation: self.attenuation,
            ..Vpl::default()
        })
    }

    fn chooses(&self, pixel: u32, sample: u32, slot: u32) -> bool {
        random4(pixel, sample, slot, self.stream)[0] < self.probability
    }
}

/// What the camera rays of a pixel saw, summed over its samples.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Seen {
    pub(crate) samples: u32,
    pub(crate) hits: u32,
    pub(crate) albedo: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) depth: f32,
    /// Object of the first sample that hit one.
    pub(crate) object: u32,
    /// VPLs that lit shaded hits, and the number of those.
    pub(crate) selected: u64,
    pub(crate) shaded: u64,
}

/// Everything a tile yields.
pub(crate) struct TileResult {
    pub(crate) tile: Tile,
    pub(crate) film: Film,
    pub(crate) seen: Vec<Seen>,
    pub(crate) vpls: Vec<Vpl>,
    pub(crate) hits: Vec<TreeHit>,
    pub(crate) selections: Vec<u32>,
    pub(crate) rays: Rays,
    pub(crate) visits: TreeVisits,
}

impl Pass<'_> {
    /// Renders tiles in parallel and hands the results over in order. Returns whether all were rendered.
    pub(crate) fn run(&self, tiles: &[Tile], monitor: &dyn Monitor, mut merge: impl FnMut(TileResult)) -> bool {
        for batch in tiles.chunks(BATCH) {
            let results: Vec<Option<TileResult>> = batch
                .par_iter()
                .map(|tile| (!monitor.cancelled()).then(|| self.render_tile(tile)))
                .inspect(|_| monitor.advance())
                .collect();
            let complete = results.iter().all(Option::is_some);
            results.into_iter().flatten().for_each(&mut merge);
            if !complete {
                return false;
            }
        }
        true
    }

    fn render_tile(&self, tile: &Tile) -> TileResult {
        let mut worker = Worker {
            pass: self,
            shader: Shader::new(self.view.world, self.view.tracer, self.lighting),
            tree: RayTree::new(self.view.max_depth),
            shifts: Vec::new(),
            tree_hits: Vec::new(),
            result: TileResult {
                tile: *tile,
                film: Film::around(tile, self.view.filter),
                seen: Vec::with_capacity((tile.width * tile.height) as usize),
                vpls: Vec::new(),
                hits: Vec::new(),
                selections: Vec::new(),
                rays: Rays::default(),
                visits: TreeVisits::default(),
            },
        };
        for (i, j) in tile.pixels() {
            let seen = worker.render_pixel(i, j);
            worker.result.seen.push(seen);
        }
        TileResult { rays: worker.shader.rays, visits: worker.shader.visits, ..worker.result }
    }
}

/// Renders the pixels of one tile.
struct Worker<'a> {
    pass: &'a Pass<'a>,
    shader: Shader<'a>,
    tree: RayTree,
    shifts: Vec<[f32; 2]>,
    tree_hits: Vec<TreeHit>,
    result: TileResult,
}

impl Worker<'_> {
    fn render_pixel(&mut self, i: u32, j: u32) -> Seen {
        let mut seen = Seen::default();
        let view = &self.pass.view;
        let pixel = j * view.camera.width + i;
        if self.pass.mask.is_some_and(|mask| !mask[pixel as usize]) {
            return seen;
        }
        match self.pass.shifts {
            Shifts::Sampler(sampler) => sampler.fill(pixel, &mut self.shifts),
            Shifts::Given(all) => {
                self.shifts.clear();
                self.shifts.push(all[pixel as usize]);
            }
        }
        for k in 0..self.shifts.len() {
            let shift = self.shifts[k];
            self.shader.place = (pixel, self.pass.first_sample + k as u32);
            self.shader.selected.clear();
            let ray = camera_ray(&view.camera, i, j, shift, view.tracer.rules);
            let color = self.tree.trace(&mut self.shader, ray);
            self.result.film.add(view.filter, i, j, shift, color);
            self.report(&mut seen);
        }
        seen
    }

    /// Takes from the ray tree what the pass wants.
    fn report(&mut self, seen: &mut Seen) {
        match self.pass.wants {
            Wants::Colors => {}
            Wants::Selections => {
                seen.selected += self.shader.selected.iter().map(|&n| u64::from(n)).sum::<u64>();
                seen.shaded += self.shader.selected.len() as u64;
                self.result.selections.extend(&self.shader.selected);
            }
            Wants::SurfacesAndHits => {
                self.see(seen);
                self.tree.hits(&mut self.tree_hits);
                self.result.hits.extend(&self.tree_hits);
            }
            Wants::SurfacesAndVpls(placement) => {
                self.see(seen);
                if let Some(placement) = placement {
                    let (pixel, sample) = self.shader.place;
                    self.tree.hits(&mut self.tree_hits);
                    let chosen = self.tree_hits.iter().filter(|hit| placement.chooses(pixel, sample, hit.slot));
                    self.result.vpls.extend(chosen.filter_map(|hit| placement.vpl(hit)));
                }
            }
        }
    }

    fn see(&self, seen: &mut Seen) {
        seen.samples += 1;
        if let Some(found) = self.tree.first_found() {
            if seen.hits == 0 {
                seen.object = found.surface.object;
            }
            seen.hits += 1;
            seen.albedo += found.material.diffuse;
            seen.normal += found.surface.normal;
            seen.depth += found.hit.t;
        }
    }
}
