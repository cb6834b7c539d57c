//! Station 6: the picture that a render's sums make, and how far it may be from the truth.

use super::mixture::{Canvas, MOST_TECHNIQUES, Mixture};
use super::rendering::PhysicalRendering;
use super::sketch::{Glimpse, Sketch, Source};
use super::sums::PixelSums;
use crate::film::Film;
use crate::stats::Stats;
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use lightcuts_image::Plane;
use rayon::prelude::*;

/// Pixels of which an error is estimated, about, where nothing hangs on it but a figure.
const JUDGED_PIXELS: usize = 1 << 20;

/// Dark pixels' errors are relative to this, as a share of the picture's mean.
const DARKEST: f64 = 0.01;

/// How techniques count in a tile; `None` without samples.
type Weights = Option<[f64; MOST_TECHNIQUES]>;

/// Sums that are about to become a picture.
struct Darkroom<'a> {
    mixture: &'a Mixture,
    /// Of each tile.
    weights: Vec<Weights>,
    dark: f64,
    /// What pixels without samples show, and where it is, bottom row first.
    sketch: Option<&'a Sketch>,
    sources: Vec<Option<Source>>,
}

/// Sums over pixels: squares of their errors, as far as they are known.
#[derive(Clone, Copy, Default)]
struct Errors {
    /// Of the pixels that tell, with their number, and as if each had a single sample.
    known: f64,
    count: u64,
    of_sample: f64,
    /// One over the number of samples, of the pixels that do not.
    unknown: f64,
    all: u64,
}

impl Errors {
    fn with(self, other: Self) -> Self {
        Self {
            known: self.known + other.known,
            count: self.count + other.count,
            of_sample: self.of_sample + other.of_sample,
            unknown: self.unknown + other.unknown,
            all: self.all + other.all,
        }
    }
}

impl Mixture {
    /// Root mean square of the pixels' relative standard errors; of dark pixels relative to a hundredth of the mean. A pixel of a
    /// single sample is taken to vary as the others do. `None` if no pixel tells.
    pub(crate) fn noise(&self) -> Option<f64> {
        Darkroom::new(self, None).noise(1)
    }

    /// About the same, from a part of the rows of a large picture.
    pub(crate) fn about_noise(&self) -> Option<f64> {
        Darkroom::new(self, None).noise((self.width * self.height).div_ceil(JUDGED_PIXELS))
    }

    /// The picture. Pixels without samples show the sketch; `origin` is where the world lies in the scene.
    pub(crate) fn develop(mut self, sketch: Option<&Sketch>, stats: Stats, origin: DVec3) -> PhysicalRendering {
        let room = Darkroom::new(&self, sketch);
        let beauty = room.plane(|i, j| room.color(i, j, |canvas| &canvas.all, |glimpse| glimpse.all).to_array());
        let indirect =
            room.plane(|i, j| room.color(i, j, |canvas| &canvas.indirect, |glimpse| glimpse.indirect).to_array());
        let top = self.height - 1;
        let direct = room.plane(|i, j| {
            let (all, indirect) = (beauty.get(i, top - j), indirect.get(i, top - j));
            std::array::from_fn(|c| all[c] - indirect[c])
        });
        let variance = room.plane(|i, j| room.variance(i, j).unwrap_or(0.0) as f32);
        // What is not needed any more makes room for the rest.
        let Darkroom { weights, sources, .. } = room;
        self.canvases.clear();
        let room = Darkroom { mixture: &self, weights, dark: 0.0, sketch, sources };
        let over = |sum: Vec3, count: u32| if count == 0 { [0.0; 3] } else { (sum / count as f32).to_array() };
        let mean = |sum: f32, count: u32| if count == 0 { 0.0 } else { sum / count as f32 };
        PhysicalRendering {
            beauty,
            direct,
            indirect,
            albedo: room.of_sums(|p| over(p.albedo, p.samples)),
            normal: room.of_sums(|p| over(p.normal, p.hits)),
            position: room.of_sums(|p| in_scene(p, origin)),
            depth: room.of_sums(|p| if p.hits == 0 { f32::INFINITY } else { p.depth / p.hits as f32 }),
            object_id: room.of_sums(|p| p.object),
            material_id: room.of_sums(|p| p.material),
            samples: room.plane(|i, j| room.samples(i, j) as f32),
            variance,
            cut_size: room.of_sums(|p| mean(p.cut, p.cuts)),
            error_bound: room.of_sums(|p| mean(p.bound, p.cuts)),
            stats,
        }
    }
}

/// Where a pixel's samples hit something, in the scene; `origin` is where the world lies in it.
fn in_scene(sums: &PixelSums, origin: DVec3) -> [f32; 3] {
    let PixelSums { position, hits, .. } = *sums;
    if hits == 0 { [0.0; 3] } else { (position.as_dvec3() / f64::from(hits) + origin).as_vec3().to_array() }
}

impl<'a> Darkroom<'a> {
    fn new(mixture: &'a Mixture, sketch: Option<&'a Sketch>) -> Self {
        let weights_of =
            |tile| Some(mixture.weights(tile)).filter(|weights| weights.iter().any(|&weight| weight > 0.0));
        let weights = (0..mixture.tiles().len()).map(weights_of).collect();
        let mut room = Self { mixture, weights, dark: mixture.dark(), sketch, sources: Vec::new() };
        if let Some(sketch) = sketch {
            let mut sources: Vec<Option<Source>> = vec![None; mixture.width * mixture.height];
            sources.par_chunks_mut(mixture.width).enumerate().for_each(|(j, row)| {
                let unsampled = row.iter_mut().enumerate().filter(|(i, _)| room.weights(*i, j).is_none());
                unsampled.for_each(|(i, source)| *source = sketch.nearest(i, j));
            });
            room.sources = sources;
        }
        room
    }

    fn weights(&self, i: usize, j: usize) -> Option<&[f64; MOST_TECHNIQUES]> {
        self.weights[self.mixture.tile_of(i, j)].as_ref()
    }

    /// A pixel's colour on the films of all canvases together, or of the sketch.
    fn color(&self, i: usize, j: usize, film: impl Fn(&Canvas) -> &Film, sketched: impl Fn(&Glimpse) -> Vec3) -> Vec3 {
        let Some(weights) = self.weights(i, j) else {
            return self.glimpse(i, j).map_or(Vec3::ZERO, sketched);
        };
        let of = |(canvas, &weight): (&Option<Canvas>, &f64)| {
            canvas.as_ref().filter(|_| weight > 0.0).map(|canvas| film(canvas).mean(i, j) * weight as f32)
        };
        self.mixture.canvases.iter().zip(weights).filter_map(of).sum()
    }

    fn source(&self, i: usize, j: usize) -> Option<Source> {
        *self.sources.get(j * self.mixture.width + i)?
    }

    fn glimpse(&self, i: usize, j: usize) -> Option<&Glimpse> {
        Some(self.sketch?.glimpse(self.source(i, j)?))
    }

    /// What a pixel's samples saw, or the nearest sample of the sketch.
    fn sums(&self, i: usize, j: usize) -> &PixelSums {
        let own = &self.mixture.pixels[j * self.mixture.width + i];
        if self.weights(i, j).is_some() { own } else { self.glimpse(i, j).map_or(own, |glimpse| &glimpse.sums) }
    }

    /// Number of the pixel's own samples.
    fn samples(&self, i: usize, j: usize) -> u32 {
        if self.weights(i, j).is_some() {
            return self.mixture.pixels[j * self.mixture.width + i].samples;
        }
        let is_own = |(sketch, source): (&Sketch, Source)| sketch.is_at(source, i, j);
        u32::from(self.sketch.zip(self.source(i, j)).is_some_and(is_own))
    }

    /// Variance of a pixel's brightness; `None` if its samples do not tell.
    fn variance(&self, i: usize, j: usize) -> Option<f64> {
        let (weights, mixture) = (self.weights(i, j)?, self.mixture);
        let (pixel, tile) = (j * mixture.width + i, mixture.tile_of(i, j));
        let (mut sum, mut is_known) = (0.0, false);
        for (technique, (canvas, &weight)) in mixture.canvases.iter().zip(weights).enumerate() {
            let Some(canvas) = canvas.as_ref().filter(|_| weight > 0.0) else { continue };
            let moments = canvas.moments[pixel];
            let of_sample = match moments.samples {
                // A single sample says nothing: its tile does.
                0 | 1 => mixture.variances[technique][tile].map(|v| v * mixture.scale_sq(pixel, self.dark)),
                n => Some(moments.variance_of_mean() * f64::from(n)),
            };
            is_known |= of_sample.is_some();
            sum += weight * weight * of_sample.unwrap_or(0.0) / f64::from(canvas.shown[tile].max(1));
        }
        is_known.then_some(sum)
    }

    /// See [`Mixture::noise`]; of every so manieth row.
    fn noise(&self, step: usize) -> Option<f64> {
        let Mixture { width, height, .. } = *self.mixture;
        let is_telling = |tile: usize| {
            let of = |k: usize| self.mixture.shown(k, tile) > 1 || self.mixture.variance_in(k, tile).is_some();
            (0..self.mixture.canvases.len()).any(of)
        };
        if !(0..self.weights.len()).any(is_telling) {
            return None;
        }
        let rows: Vec<usize> = (0..height).step_by(step).collect();
        let brightness = |i, j| f64::from(self.color(i, j, |canvas| &canvas.all, |_| Vec3::ZERO).element_sum()) / 3.0;
        let of_rows: Vec<f64> = rows.par_iter().map(|&j| (0..width).map(|i| brightness(i, j)).sum::<f64>()).collect();
        let floor = of_rows.iter().sum::<f64>() / (rows.len() * width) as f64 * DARKEST;
        let of_pixel = |i, j| {
            let samples = f64::from(self.samples(i, j).max(1));
            let Some(variance) = self.variance(i, j) else {
                return Errors { unknown: 1.0 / samples, all: 1, ..Errors::default() };
            };
            let error = variance / brightness(i, j).max(floor).powi(2).max(f64::MIN_POSITIVE);
            Errors { known: error, count: 1, of_sample: error * samples, unknown: 0.0, all: 1 }
        };
        let of_row = |&j: &usize| (0..width).map(|i| of_pixel(i, j)).fold(Errors::default(), Errors::with);
        let of_rows: Vec<Errors> = rows.par_iter().map(of_row).collect();
        let Errors { known, count, of_sample, unknown, all } =
            of_rows.into_iter().fold(Errors::default(), Errors::with);
        (count > 0).then(|| ((known + unknown * of_sample / count as f64) / all as f64).sqrt())
    }

    fn of_sums<T: Copy + Send + Zeroable>(&self, value: impl Fn(&PixelSums) -> T + Sync) -> Plane<T> {
        self.plane(|i, j| value(self.sums(i, j)))
    }

    /// A picture from a function of (i, j), j from the bottom. All threads write it: most of the time goes into memory that is
    /// touched for the first time.
    fn plane<T: Copy + Send + Zeroable>(&self, value: impl Fn(usize, usize) -> T + Sync) -> Plane<T> {
        let Mixture { width, height, .. } = *self.mixture;
        let mut pixels: Vec<T> = bytemuck::zeroed_vec(width * height);
        pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            row.iter_mut().enumerate().for_each(|(i, pixel)| *pixel = value(i, height - 1 - y));
        });
        Plane::from_pixels(width, height, pixels).expect("a value for each pixel")
    }
}
