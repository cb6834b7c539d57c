//! One tile of a pass over the picture on the CPU: camera rays of every pixel.

use crate::cpu::{HalfSpaces, Tracer};
use crate::device::{Pass, Placement, Seen, Shifts, TileResult, Wants};
use crate::film::{Film, Tile};
use crate::original::effective_probability;
use crate::ray_tree::{RayTree, TreeHit};
use crate::settings::VplPlacement;
use crate::shade::{Found, Shader, TOGETHER};
use crate::stats::{Rays, TreeVisits};
use lightcuts_kernel::camera::{THESIS_SIZE, camera_ray};
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::ray::Ray;
use lightcuts_kernel::rng::random4;
use lightcuts_world::bvh::LANES;

/// Rows and columns of the block of pixels whose camera rays look together, eight neighbours after the other.
const ROWS: u32 = 4;
const WIDTH: u32 = TOGETHER as u32 / ROWS;

/// The place of a pixel, by its column and its row, in the order in which camera rays look.
fn order(i: u32, row: u32) -> (u32, u32, u32) {
    (i / WIDTH, row / 2, i / (LANES as u32 / 2))
}

impl Placement {
    /// `samples` camera rays are to place as many VPLs, on average, as the thesis' picture of one per pixel: VPLs are
    /// not weighted, so their number decides how bright the second pass is.
    pub fn new(settings: &VplPlacement, samples: u64, stream: u32) -> Self {
        let thesis_samples = u64::from(THESIS_SIZE) * u64::from(THESIS_SIZE);
        Self {
            probability: effective_probability(settings.probability) * (thesis_samples as f32 / samples as f32),
            min_illumination: settings.min_illumination,
            attenuation: settings.attenuation,
            stream,
        }
    }

    /// The VPL of a hit, if its light is enough.
    pub fn vpl(&self, hit: &TreeHit) -> Option<Vpl> {
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

impl Pass<'_> {
    /// Renders one tile.
    pub(crate) fn render_tile(&self, tracer: Tracer<'_>, half_spaces: &HalfSpaces, tile: &Tile) -> TileResult {
        let area = (tile.width * tile.height) as usize;
        let mut worker = Worker {
            pass: self,
            shader: Shader::new(self.view.world, tracer, Some(self.lighting), half_spaces),
            tree: RayTree::new(self.view.max_depth),
            shifts: Vec::new(),
            samples: Vec::new(),
            rays: Vec::new(),
            tree_hits: Vec::new(),
            result: TileResult {
                tile: *tile,
                film: Film::around(tile, self.view.filter),
                seen: Vec::with_capacity(area),
                vpls: Vec::new(),
                hits: Vec::with_capacity(if let Wants::SurfacesAndHits = self.wants { area + area / 8 } else { 0 }),
                selections: Vec::new(),
                rays: Rays::default(),
                visits: TreeVisits::default(),
            },
        };
        let pixels: Vec<(u32, u32)> = tile.pixels().collect();
        // Few at a time, for what is kept of them; a tile of one row is cut.
        let together = if tile.height == 1 { 2 * TOGETHER } else { (tile.width * ROWS) as usize };
        pixels.chunks(together).for_each(|pixels| worker.render_rows(pixels));
        TileResult { rays: worker.shader.rays, visits: worker.shader.visits, ..worker.result }
    }
}

/// Renders the pixels of one tile.
struct Worker<'a> {
    pass: &'a Pass<'a>,
    shader: Shader<'a>,
    tree: RayTree,
    shifts: Vec<[f32; 2]>,
    samples: Vec<Sample>,
    rays: Vec<Ray>,
    tree_hits: Vec<TreeHit>,
    result: TileResult,
}

/// Where a camera ray that is to be traced comes from.
struct Sample {
    /// Place of its pixel in its rows.
    place: usize,
    /// Number of the pixel, and of the ray in it.
    number: (u32, u32),
    shift: [f32; 2],
}

impl Worker<'_> {
    /// Renders a few rows of pixels: camera rays are traced together with their neighbours, and each continues alone,
    /// in the order of the pixels.
    fn render_rows(&mut self, pixels: &[(u32, u32)]) {
        self.samples.clear();
        self.rays.clear();
        for (place, &(i, j)) in pixels.iter().enumerate() {
            self.add_samples(place, i, j);
        }
        let samples = std::mem::take(&mut self.samples);
        let mut looking: Vec<usize> = (0..samples.len()).collect();
        let bottom = pixels[0].1;
        looking.sort_by_key(|&k| {
            let (i, j) = pixels[samples[k].place];
            order(i, j - bottom)
        });
        self.shader.trace_primary(&self.rays, &looking);
        let seen = self.result.seen.len();
        self.result.seen.resize(seen + pixels.len(), Seen::default());
        for (k, sample) in samples.iter().enumerate() {
            let (i, j) = pixels[sample.place];
            self.shader.make_current(k, sample.number);
            let color = self.tree.trace(&mut self.shader, self.rays[k]);
            self.result.film.add(i, j, sample.shift, color);
            self.report(seen + sample.place);
        }
        self.samples = samples;
    }

    /// The camera rays of a pixel; none where the pass leaves it out.
    fn add_samples(&mut self, place: usize, i: u32, j: u32) {
        let view = &self.pass.view;
        let pixel = j * view.camera.width + i;
        if self.pass.mask.is_some_and(|mask| !mask[pixel as usize]) {
            return;
        }
        match self.pass.shifts {
            Shifts::Sampler(sampler) => sampler.fill(pixel, &mut self.shifts),
            Shifts::Given(all) => {
                self.shifts.clear();
                self.shifts.push(all[pixel as usize]);
            }
        }
        let first = self.pass.first_sample;
        for (number, &shift) in (first..).zip(&self.shifts) {
            self.rays.push(camera_ray(&view.camera, i, j, shift, view.rules));
            self.samples.push(Sample { place, number: (pixel, number), shift });
        }
    }

    /// Takes from the ray tree what the pass wants, for the pixel that is seen at a place.
    fn report(&mut self, pixel: usize) {
        let seen = &mut self.result.seen[pixel];
        match self.pass.wants {
            Wants::Colors => {}
            Wants::SelectedSums => sum_selected(seen, &self.shader.selected),
            Wants::Selections => {
                sum_selected(seen, &self.shader.selected);
                self.result.selections.extend(&self.shader.selected);
            }
            Wants::SurfacesAndHits => {
                see(seen, &self.shader, self.tree.first_found());
                self.tree.hits(&mut self.tree_hits);
                self.result.hits.extend(&self.tree_hits);
            }
            Wants::SurfacesAndVpls(placement) => {
                see(seen, &self.shader, self.tree.first_found());
                if let Some(placement) = placement {
                    let (pixel, sample) = self.shader.place;
                    self.tree.hits(&mut self.tree_hits);
                    let chosen = self.tree_hits.iter().filter(|hit| placement.chooses(pixel, sample, hit.slot));
                    self.result.vpls.extend(chosen.filter_map(|hit| placement.vpl(hit)));
                }
            }
        }
    }
}

fn sum_selected(seen: &mut Seen, selected: &[u32]) {
    seen.selected += selected.iter().map(|&n| u64::from(n)).sum::<u64>();
    seen.shaded += selected.len() as u64;
}

fn see(seen: &mut Seen, shader: &Shader<'_>, found: Option<&Found>) {
    seen.samples += 1;
    if let Some(found) = found {
        if seen.hits == 0 {
            seen.object = found.surface.object;
        }
        seen.hits += 1;
        seen.albedo += shader.material(found).diffuse;
        seen.normal += found.surface.normal;
        seen.depth += found.hit.t;
    }
}
