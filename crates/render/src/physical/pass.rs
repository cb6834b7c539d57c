//! One pass over the picture: samples of its tiles.

use super::caustics::CausticMap;
use super::lightcuts::Lightcuts;
use super::randoms::Randoms;
use super::scene::{Cone, Scene};
use super::sketch::Glimpse;
use super::sums::{Counts, Moments, PixelSums, Sampled};
use super::task::{Extent, Place, Points, Task, blocks, probed};
use super::technique::Technique;
use crate::film::{Film, Tile};
use crate::settings::Filter;
use cpu_time::ThreadTime;
use lightcuts_kernel::lens::{Lens, lens_ray, pixel_spread, pixel_width};
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_world::bvh::LANES;
use std::time::Instant;

/// What a pass is: everything that its samples share.
pub(crate) struct SamplePass<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) lens: Lens,
    pub(crate) filter: &'a Filter,
    pub(crate) vpls: Option<Lightcuts<'a>>,
    /// Photons, if they are to bring caustics.
    pub(crate) caustics: Option<CausticMap>,
}

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
            sums: PixelSums::of(sampled, false),
            all: sampled.radiance.all,
            indirect: sampled.radiance.indirect,
        };
        sampled.iter().map(glimpse).collect()
    }

    /// Takes a sample, which has a number, of each of up to eight pixels; returns how far they are from the pixels'
    /// centres too.
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
        for first in sampled.iter_mut().filter_map(|sampled| sampled.first.as_mut()) {
            first.depth += self.lens.ahead;
        }
        (sampled, shifts)
    }
}

impl SampledTile {
    /// Adds a sample of a pixel, which has its place.
    fn add(&mut self, k: usize, (i, j): (u32, u32), shift: [f32; 2], sampled: &Sampled, technique: Technique) {
        self.all.add(i, j, shift, sampled.radiance.all);
        self.indirect.add(i, j, shift, sampled.radiance.indirect);
        let sums = PixelSums::of(sampled, technique.uses_vpls());
        // Lights in the picture are the same to all techniques, and pixels on their edges vary more than all others.
        let is_probe = self.task.extent.samples() == 0;
        let brightness = if is_probe { sums.reflected } else { sums.reflected + sums.emitted } / 3.0;
        self.moments[k].add(&Moments { samples: 1, sum: brightness, sum_sq: brightness * brightness });
        self.pixels[k].add(&sums);
    }
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
