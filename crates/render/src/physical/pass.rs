//! One pass over the picture: samples of its tiles.

use super::caustics::CausticMap;
use super::lightcuts::Lightcuts;
use super::path::Radiance;
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use super::sketch::Glimpse;
use super::technique::Technique;
use crate::film::{Film, Tile};
use crate::settings::Filter;
use bytemuck::Zeroable;
use cpu_time::ThreadTime;
use glam::Vec3;
use lightcuts_kernel::bsdf::{CONDUCTOR, DIELECTRIC, MIRROR, PHONG};
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::fresnel::fresnel_conductor;
use lightcuts_kernel::lens::{Lens, lens_ray, pixel_spread, pixel_width};
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_kernel::rng::random4;
use lightcuts_world::bvh::LANES;
use std::time::Instant;

/// Rays by kind, and what was gathered.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) primary: u64,
    pub(crate) bounces: u64,
    pub(crate) shadow: u64,
    /// Points that VPLs lit.
    pub(crate) gathered: u64,
    /// Clusters and VPLs in their cuts.
    pub(crate) cut: u64,
    /// Bounds that were computed for it.
    pub(crate) bounds: u64,
}

impl Counts {
    pub(crate) fn add(&mut self, other: &Self) {
        self.primary += other.primary;
        self.bounces += other.bounces;
        self.shadow += other.shadow;
        self.gathered += other.gathered;
        self.cut += other.cut;
        self.bounds += other.bounds;
    }
}

/// What a camera ray met first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FirstHit {
    albedo: Vec3,
    normal: Vec3,
    position: Vec3,
    depth: f32,
    object: u32,
    material: u32,
}

impl FirstHit {
    pub(crate) fn new(at: &Interaction, ray: &Ray, distance: f32) -> Self {
        let bsdf = &at.bsdf;
        let albedo = match bsdf.kind {
            PHONG => bsdf.diffuse + bsdf.specular,
            CONDUCTOR => fresnel_conductor(1.0, bsdf.specular, bsdf.absorption),
            DIELECTRIC | MIRROR => bsdf.specular,
            _ => bsdf.diffuse,
        };
        let normal = if at.normal.dot(ray.direction) > 0.0 { -at.normal } else { at.normal };
        Self { albedo, normal, position: at.point, depth: distance, object: at.object, material: at.material + 1 }
    }
}

/// Sums over the samples of a pixel, of what is the same for all techniques. Zeros are a pixel without samples.
#[derive(Debug, Clone, Copy, Default, Zeroable)]
pub(crate) struct PixelSums {
    pub(crate) samples: u32,
    /// Samples that hit something.
    pub(crate) hits: u32,
    /// Of what was scattered at least once, as sums of channels.
    pub(crate) reflected: f64,
    /// Of what was not, as sums of channels.
    pub(crate) emitted: f64,
    pub(crate) albedo: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) position: Vec3,
    pub(crate) depth: f32,
    /// Of the first sample that hit one, from 1; 0 for none.
    pub(crate) object: u32,
    pub(crate) material: u32,
    /// Of the cuts: sizes, and bounds of their errors.
    pub(crate) cut: f32,
    pub(crate) bound: f32,
    /// Samples that have a cut, and what was scattered at least once of them.
    pub(crate) cuts: u32,
    pub(crate) gathered: f64,
}

impl PixelSums {
    /// Of a single sample by a technique.
    fn of(sampled: &Sampled, technique: Technique) -> Self {
        let Sampled { radiance, first, cut, bound } = *sampled;
        let emitted = f64::from(light_power(radiance.emitted));
        let reflected = f64::from(light_power(radiance.all)) - emitted;
        let cuts = u32::from(technique.uses_vpls());
        let gathered = f64::from(cuts) * reflected;
        let mut sums = Self { samples: 1, reflected, emitted, cut, bound, cuts, gathered, ..Self::default() };
        if let Some(first) = &first {
            sums.see(first);
        }
        sums
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.hits += other.hits;
        self.reflected += other.reflected;
        self.emitted += other.emitted;
        self.albedo += other.albedo;
        self.normal += other.normal;
        self.position += other.position;
        self.depth += other.depth;
        if self.object == 0 {
            (self.object, self.material) = (other.object, other.material);
        }
        self.cut += other.cut;
        self.bound += other.bound;
        self.cuts += other.cuts;
        self.gathered += other.gathered;
    }

    fn see(&mut self, first: &FirstHit) {
        self.hits += 1;
        self.albedo += first.albedo;
        self.normal += first.normal;
        self.position += first.position;
        self.depth += first.depth;
        if self.object == 0 {
            (self.object, self.material) = (first.object, first.material);
        }
    }
}

/// Sums over the samples that a pixel got from one technique, of their brightness (r + g + b) / 3; of probes without light that
/// was not scattered.
#[derive(Debug, Clone, Copy, Default, Zeroable)]
pub(crate) struct Moments {
    pub(crate) samples: u32,
    pub(crate) sum: f64,
    pub(crate) sum_sq: f64,
}

impl Moments {
    pub(crate) fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.sum += other.sum;
        self.sum_sq += other.sum_sq;
    }

    pub(crate) fn mean(&self) -> f64 {
        self.sum / f64::from(self.samples.max(1))
    }

    /// Sum of squared differences from the mean.
    pub(crate) fn spread(&self) -> f64 {
        (self.sum_sq - self.sum * self.mean()).max(0.0)
    }

    /// Variance of the mean, as if samples were independent; 0 with fewer than two.
    pub(crate) fn variance_of_mean(&self) -> f64 {
        let n = f64::from(self.samples);
        if self.samples < 2 { 0.0 } else { self.spread() / (n * (n - 1.0)) }
    }
}

/// What a tile is to get in a pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task {
    /// Number of the tile.
    pub(crate) tile: usize,
    /// Number of the technique.
    pub(crate) technique: usize,
    pub(crate) extent: Extent,
}

/// How many samples a tile gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// So many of every pixel.
    Whole(u32),
    /// One of each of a few pixels, to learn how a technique does; with the number of the probe.
    Probe(u32),
}

impl Extent {
    /// Samples of every pixel.
    pub(crate) fn samples(self) -> u32 {
        match self {
            Self::Whole(samples) => samples,
            Self::Probe(_) => 0,
        }
    }
}

/// Parts of a tile, side by side, of each of which a probe sees a square of two by two pixels: neighbours, as techniques are
/// quickest with them.
const PROBED_PARTS: u32 = 2;

/// Probes of the same pixels, so that their samples can be compared; the next ones see others.
pub(crate) const PROBES_OF_A_GROUP: u32 = 4;

/// What a pass is: everything that its samples share.
pub(crate) struct SamplePass<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) lens: Lens,
    pub(crate) filter: &'a Filter,
    pub(crate) vpls: Option<Lightcuts<'a>>,
    /// Photons, if they are to bring caustics.
    pub(crate) caustics: Option<CausticMap>,
}

/// Which random numbers a task gets: those of samples from a number on, in a stream.
#[derive(Clone, Copy)]
pub(crate) struct Points {
    pub(crate) first: u32,
    pub(crate) stream: u32,
}

/// A pixel of a tile: its place there, and its column and row in the picture.
type Place = (usize, (u32, u32));

/// What a task yields.
pub(crate) struct SampledTile {
    pub(crate) task: Task,
    pub(crate) all: Film,
    pub(crate) indirect: Film,
    /// Bottom row first.
    pub(crate) pixels: Vec<PixelSums>,
    pub(crate) moments: Vec<Moments>,
    pub(crate) counts: Counts,
    /// Processor time that it took.
    pub(crate) seconds: f64,
}

/// A sample that is to be taken.
pub(crate) struct Start {
    /// Its place among those that are taken together.
    pub(crate) slot: usize,
    pub(crate) pixel: u32,
    pub(crate) ray: Ray,
    pub(crate) cone: Cone,
    /// What the ray hits.
    pub(crate) hit: Option<Hit>,
    pub(crate) randoms: Randoms,
}

/// What a camera ray brings.
pub(crate) struct Sampled {
    pub(crate) radiance: Radiance,
    pub(crate) first: Option<FirstHit>,
    pub(crate) cut: f32,
    pub(crate) bound: f32,
}

impl SamplePass<'_> {
    /// Takes the samples of a task; `None` if it has to stop before their end.
    pub(crate) fn render(
        &self,
        task: Task,
        tile: &Tile,
        technique: Technique,
        points: Points,
        is_over: impl Fn() -> bool,
    ) -> Option<SampledTile> {
        let clock = ThreadClock::start();
        let film = Film::around(tile, self.filter);
        let area = (tile.width * tile.height) as usize;
        let mut result = SampledTile {
            task,
            all: film.clone(),
            indirect: film,
            pixels: vec![PixelSums::default(); area],
            moments: vec![Moments::default(); area],
            counts: Counts::default(),
            seconds: 0.0,
        };
        match task.extent {
            Extent::Whole(samples) => {
                for block in blocks(tile) {
                    for _ in 0..samples {
                        if is_over() {
                            return None;
                        }
                        self.sample_pixels(&block, technique, points, &mut result);
                    }
                }
            }
            Extent::Probe(_) if is_over() => return None,
            Extent::Probe(number) => {
                self.sample_pixels(&probed(tile, number).collect::<Vec<_>>(), technique, points, &mut result);
            }
        }
        result.seconds = clock.seconds();
        Some(result)
    }

    /// Takes a sample of each of up to eight pixels of a tile.
    fn sample_pixels(&self, pixels: &[Place], technique: Technique, points: Points, result: &mut SampledTile) {
        let (sampled, shifts) = {
            let SampledTile { moments, counts, .. } = &mut *result;
            let numbered = pixels.iter().map(|&(k, place)| (place, points.first + moments[k].samples));
            self.take(numbered, technique, points.stream, counts)
        };
        for ((&(k, place), shift), sampled) in pixels.iter().zip(shifts).zip(&sampled) {
            result.add(k, place, shift, sampled, technique);
        }
    }

    /// Takes a sample by path tracing of each of up to eight pixels.
    pub(crate) fn glimpse(&self, pixels: &[(u32, u32)], stream: u32) -> Vec<Glimpse> {
        let numbered = pixels.iter().map(|&place| (place, 0));
        let (sampled, _) = self.take(numbered, Technique::Path, stream, &mut Counts::default());
        let glimpse = |sampled: &Sampled| Glimpse {
            sums: PixelSums::of(sampled, Technique::Path),
            all: sampled.radiance.all,
            indirect: sampled.radiance.indirect,
        };
        sampled.iter().map(glimpse).collect()
    }

    /// Takes a sample, which has a number, of each of up to eight pixels; returns how far they are from the pixels' centres too.
    fn take(
        &self,
        pixels: impl Iterator<Item = ((u32, u32), u32)>,
        technique: Technique,
        stream: u32,
        counts: &mut Counts,
    ) -> (Vec<Sampled>, [[f32; 2]; LANES]) {
        let cone = Cone { width: pixel_width(&self.lens), spread: pixel_spread(&self.lens) };
        let mut starts = Vec::with_capacity(LANES);
        let mut shifts = [[0.0; 2]; LANES];
        for (slot, ((i, j), number)) in pixels.enumerate() {
            let pixel = j * self.lens.width + i;
            let mut randoms = Randoms::new(pixel, number, stream);
            let [x, y, u, v] = randoms.next();
            let ray = lens_ray(&self.lens, [i as f32 + x, j as f32 + y], [u, v]);
            shifts[slot] = [x - 0.5, y - 0.5];
            starts.push(Start { slot, pixel, ray, cone, hit: None, randoms });
        }
        let hits = self.scene.closest8(&std::array::from_fn(|lane| starts[lane.min(starts.len() - 1)].ray));
        counts.primary += starts.len() as u64;
        let mut pending = Vec::new();
        let mut sample = |(start, hit)| technique.sample(self, Start { hit, ..start }, &mut pending, counts);
        let mut sampled: Vec<Sampled> = starts.into_iter().zip(hits).map(&mut sample).collect();
        technique.gather(self, &mut pending, &mut sampled, counts);
        (sampled, shifts)
    }
}

impl SampledTile {
    /// Adds a sample of a pixel, which has its place.
    fn add(&mut self, k: usize, (i, j): (u32, u32), shift: [f32; 2], sampled: &Sampled, technique: Technique) {
        self.all.add(i, j, shift, sampled.radiance.all);
        self.indirect.add(i, j, shift, sampled.radiance.indirect);
        let sums = PixelSums::of(sampled, technique);
        // Lights in the picture are the same to all techniques, and pixels on their edges vary more than all others.
        let is_probe = self.task.extent.samples() == 0;
        let brightness = if is_probe { sums.reflected } else { sums.reflected + sums.emitted } / 3.0;
        self.moments[k].add(&Moments { samples: 1, sum: brightness, sum_sq: brightness * brightness });
        self.pixels[k].add(&sums);
    }
}

/// A tile's pixels in blocks of up to eight neighbours, each with its place in the tile.
fn blocks(tile: &Tile) -> impl Iterator<Item = Vec<Place>> {
    const SIZE: [u32; 2] = [4, 2];
    let Tile { i, j, width, height } = *tile;
    let corners = (0..height)
        .step_by(SIZE[1] as usize)
        .flat_map(move |y| (0..width).step_by(SIZE[0] as usize).map(move |x| (x, y)));
    corners.map(move |(left, bottom)| {
        let rows = bottom..(bottom + SIZE[1]).min(height);
        let columns = left..(left + SIZE[0]).min(width);
        rows.flat_map(|y| columns.clone().map(move |x| ((y * width + x) as usize, (i + x, j + y)))).collect()
    })
}

/// The pixels of a probe, each with its place in the tile.
pub(crate) fn probed(tile: &Tile, number: u32) -> impl Iterator<Item = Place> {
    let Tile { i, j, width, height } = *tile;
    (0..PROBED_PARTS).flat_map(move |part| {
        let [u, v, ..] = random4(part, number / PROBES_OF_A_GROUP, i, j);
        let (first, end) = (width * part / PROBED_PARTS, width * (part + 1) / PROBED_PARTS);
        let place = |places: u32, random: f32| (places.saturating_sub(1) as f32 * random) as u32;
        let (left, bottom) = (first + place(end - first, u), place(height, v));
        let rows = bottom..(bottom + 2).min(height);
        let columns = left..(left + 2).min(end);
        rows.flat_map(move |y| columns.clone().map(move |x| ((y * width + x) as usize, (i + x, j + y))))
    })
}

/// A clock of the thread's own time, which other threads and programs do not stretch.
struct ThreadClock {
    own: Option<ThreadTime>,
    elapsed: Instant,
}

impl ThreadClock {
    fn start() -> Self {
        Self { own: ThreadTime::try_now().ok(), elapsed: Instant::now() }
    }

    fn seconds(&self) -> f64 {
        let own = self.own.and_then(|start| start.try_elapsed().ok());
        own.unwrap_or_else(|| self.elapsed.elapsed()).as_secs_f64()
    }
}
