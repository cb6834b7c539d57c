//! What a render has so far: sums for each technique, and the picture that they make together.
//!
//! Where several techniques show the same light, each tile weighs them by the inverse of their variances. If a variance came from
//! the samples that it weighs, a rare bright sample would lower its own weight, and pictures would be too dark. So variances come
//! from probes, samples of a few pixels that are not shown.

use super::pass::{Extent, Moments, PROBES_OF_A_GROUP, PixelSums, SampledTile, Task, probed};
use super::rendering::PhysicalRendering;
use crate::film::{Film, Tile};
use crate::stats::Stats;
use glam::{DVec3, Vec3};
use lightcuts_image::{Image, Plane};
use rayon::prelude::*;

/// Edge of a tile in pixels.
pub(crate) const TILE_SIZE: u32 = 16;

/// Most techniques of a render.
const MOST_TECHNIQUES: usize = 4;

/// Degrees of freedom that the whole picture has beside a tile's own in the estimate of a variance.
const PICTURE_FREEDOM: f64 = 256.0;

/// Brightness below which errors count no more, relative to the picture's mean.
const DARK: f64 = 0.8;

/// Techniques with less weight than this are left out: what they would add is less than what a bright speck of theirs, of which
/// the variance did not know, would spoil.
const LEAST_WEIGHT: f64 = 0.1;

/// Variances below this, relative to the pixels' squares, are taken as this.
const LEAST_VARIANCE: f64 = 1e-9;

/// Sums of one technique.
struct Canvas {
    all: Film,
    indirect: Film,
    /// Bottom row first.
    moments: Vec<Moments>,
    /// Of each tile: samples of each of its pixels.
    shown: Vec<u32>,
    /// Of each tile: what probes found at pixels, one group of them after the other.
    probes: Vec<Vec<(usize, Moments)>>,
}

/// What probes tell of a technique's variance, relative to the pixels' squares.
#[derive(Clone, Copy, Default)]
struct Known {
    /// Sum of squared differences of samples from their pixel's mean, and degrees of freedom.
    spread: f64,
    freedom: f64,
}

impl Known {
    fn with(self, other: &Self) -> Self {
        Self { spread: self.spread + other.spread, freedom: self.freedom + other.freedom }
    }

    /// Variance of a sample, where that of the whole picture has a say.
    fn variance(&self, all: &Self) -> Option<f64> {
        let mean = all.spread / all.freedom;
        let variance = (self.spread + mean * PICTURE_FREEDOM) / (self.freedom + PICTURE_FREEDOM);
        (all.freedom > 0.0).then_some(variance.max(LEAST_VARIANCE))
    }
}

/// Sums of all passes so far.
pub(crate) struct Mixture {
    width: usize,
    height: usize,
    tiles: Vec<Tile>,
    /// Bottom row first.
    pixels: Vec<PixelSums>,
    /// By technique; made when they are needed.
    canvases: Vec<Option<Canvas>>,
    /// Of each technique and tile: variance of a sample, relative to the pixel's square; `None` where nothing is known.
    variances: Vec<Vec<Option<f64>>>,
    /// What the light of each pixel is, as a sum of channels. Empty before the first pass.
    references: Vec<f32>,
}

impl Mixture {
    pub(crate) fn new(width: u32, height: u32, techniques: usize) -> Self {
        let tiles = Tile::cover(width, height, TILE_SIZE);
        assert!(techniques <= MOST_TECHNIQUES);
        Self {
            width: width as usize,
            height: height as usize,
            pixels: vec![PixelSums::default(); width as usize * height as usize],
            canvases: (0..techniques).map(|_| None).collect(),
            variances: vec![vec![None; tiles.len()]; techniques],
            references: Vec::new(),
            tiles,
        }
    }

    pub(crate) fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// What the samples of a technique tell of each pixel so far, bottom row first; `None` before the first one.
    pub(crate) fn moments(&self, technique: usize) -> Option<&[Moments]> {
        self.canvases[technique].as_ref().map(|canvas| &canvas.moments[..])
    }

    /// What the light of each pixel is, as a sum of channels; empty before the first pass.
    pub(crate) fn references(&self) -> &[f32] {
        &self.references
    }

    /// Adds a tile's samples.
    pub(crate) fn add(&mut self, sampled: &SampledTile) {
        let (width, height) = (self.width, self.height);
        let tiles = self.tiles.len();
        let Task { tile, technique, extent } = sampled.task;
        let canvas = self.canvases[technique].get_or_insert_with(|| Canvas {
            all: Film::new(width as u32, height as u32),
            indirect: Film::new(width as u32, height as u32),
            moments: vec![Moments::default(); width * height],
            shown: vec![0; tiles],
            probes: vec![Vec::new(); tiles],
        });
        let samples = match extent {
            Extent::Whole(samples) => samples,
            Extent::Probe(number) => {
                let probes = &mut canvas.probes[tile];
                let pixel = |(i, j): (u32, u32)| j as usize * width + i as usize;
                let group: Vec<_> = probed(&self.tiles[tile], number).collect();
                if number.is_multiple_of(PROBES_OF_A_GROUP) {
                    probes.extend(group.iter().map(|&(_, place)| (pixel(place), Moments::default())));
                }
                let first = probes.len() - group.len();
                for ((place, _), (_, probe)) in group.into_iter().zip(&mut probes[first..]) {
                    probe.add(&sampled.moments[place]);
                }
                return;
            }
        };
        canvas.all.merge(&sampled.all);
        canvas.indirect.merge(&sampled.indirect);
        canvas.shown[tile] += samples;
        let places = self.tiles[tile].pixels().map(|(i, j)| j as usize * width + i as usize);
        for ((place, sums), moments) in places.zip(&sampled.pixels).zip(&sampled.moments) {
            self.pixels[place].add(sums);
            canvas.moments[place].add(moments);
        }
    }

    /// Takes stock of what the light of each pixel is.
    pub(crate) fn learn_light(&mut self) {
        self.references = self.smooth_light();
    }

    /// Takes stock of how much techniques vary, after probes.
    pub(crate) fn learn_variances(&mut self) {
        let dark = self.dark();
        let variances = self.canvases.iter().map(|canvas| self.tile_variances(canvas.as_ref(), dark));
        self.variances = variances.collect();
    }

    /// Variance of a technique's sample in a tile, relative to the pixel's square.
    pub(crate) fn variance_in(&self, technique: usize, tile: usize) -> Option<f64> {
        self.variances[technique][tile]
    }

    /// What the light of each pixel is, as a sum of channels: mean over the pixel's neighbourhood, of reflected light only, for a
    /// light in the picture says nothing of its surroundings.
    fn smooth_light(&self) -> Vec<f32> {
        const REACH: usize = 2;
        let (width, height) = (self.width, self.height);
        let of_row = |j: usize| {
            let rows = j.saturating_sub(REACH)..=(j + REACH).min(height - 1);
            let smooth = move |i: usize| {
                let (mut all, mut cuts) = ((0.0, 0), (0.0, 0));
                for row in rows.clone() {
                    let columns = i.saturating_sub(REACH)..=(i + REACH).min(width - 1);
                    for pixel in &self.pixels[row * width + columns.start()..=row * width + columns.end()] {
                        all = (all.0 + pixel.reflected, all.1 + pixel.samples);
                        cuts = (cuts.0 + pixel.gathered, cuts.1 + pixel.cuts);
                    }
                }
                let (sum, samples) = if cuts.1 > 0 { cuts } else { all };
                (sum / f64::from(samples.max(1))) as f32
            };
            (0..width).map(smooth)
        };
        (0..height).into_par_iter().flat_map_iter(of_row).collect()
    }

    /// Square of the brightness below which errors count no more.
    fn dark(&self) -> f64 {
        let sum: f64 = self.references.iter().map(|&light| f64::from(light)).sum();
        let mean = sum / (3.0 * self.references.len().max(1) as f64);
        (mean * DARK).powi(2).max(f64::MIN_POSITIVE)
    }

    /// What a pixel's errors are measured by: the square of its brightness.
    fn scale_sq(&self, pixel: usize, dark: f64) -> f64 {
        let sums = &self.pixels[pixel];
        let emitted = sums.emitted / f64::from(sums.samples.max(1));
        let smooth = f64::from(self.references.get(pixel).copied().unwrap_or(0.0));
        let own = sums.reflected / f64::from(sums.samples.max(1));
        let brightness = (smooth.max(own) + emitted) / 3.0;
        brightness * brightness + dark
    }

    /// Variances of a technique in all tiles.
    fn tile_variances(&self, canvas: Option<&Canvas>, dark: f64) -> Vec<Option<f64>> {
        let Some(canvas) = canvas else { return vec![None; self.tiles.len()] };
        let of_tile = |probes: &Vec<(usize, Moments)>| {
            probes.iter().fold(Known::default(), |known, &(pixel, moments)| {
                let spread = moments.spread() / self.scale_sq(pixel, dark);
                known.with(&Known { spread, freedom: f64::from(moments.samples.saturating_sub(1)) })
            })
        };
        let own: Vec<Known> = canvas.probes.iter().map(of_tile).collect();
        let all = own.iter().fold(Known::default(), Known::with);
        own.iter().map(|own| own.variance(&all)).collect()
    }

    fn tile_of(&self, i: usize, j: usize) -> usize {
        let size = TILE_SIZE as usize;
        j / size * self.width.div_ceil(size) + i / size
    }

    /// Weights of the techniques in a tile. They sum to 1 if it has a sample.
    fn weights(&self, tile: usize) -> [f64; MOST_TECHNIQUES] {
        let shown =
            |technique: usize| self.canvases[technique].as_ref().map_or(0.0, |canvas| f64::from(canvas.shown[tile]));
        let known = |technique| self.variance_in(technique, tile).map_or(0.0, |variance| shown(technique) / variance);
        let techniques = self.canvases.len();
        // Before anything is known, samples count alike.
        let is_known = (0..techniques).any(|technique| known(technique) > 0.0);
        let weight = |technique| if is_known { known(technique) } else { shown(technique) };
        let all: f64 = (0..techniques).map(weight).sum();
        let kept = |technique| Some(weight(technique)).filter(|&weight| weight > 0.0 && weight >= LEAST_WEIGHT * all);
        let sum: f64 = (0..techniques).filter_map(kept).sum();
        std::array::from_fn(|technique| {
            if technique < techniques { kept(technique).map_or(0.0, |weight| weight / sum) } else { 0.0 }
        })
    }

    /// Variance of a pixel's brightness.
    fn variance(&self, i: usize, j: usize, dark: f64) -> f64 {
        let (pixel, tile) = (j * self.width + i, self.tile_of(i, j));
        let weights = self.weights(tile);
        let of = |(part, (technique, weight)): (&Option<Canvas>, (usize, f64))| {
            let part = part.as_ref().filter(|_| weight > 0.0)?;
            let moments = part.moments[pixel];
            let of_sample = match moments.samples {
                // A single sample says nothing: its tile does.
                0 | 1 => self.variances[technique][tile].map_or(0.0, |v| v * self.scale_sq(pixel, dark)),
                n => moments.variance_of_mean() * f64::from(n),
            };
            Some(weight * weight * of_sample / f64::from(part.shown[tile].max(1)))
        };
        self.canvases.iter().zip(weights.into_iter().enumerate()).filter_map(of).sum()
    }

    /// Root mean square of the pixels' relative standard errors; of dark pixels relative to a hundredth of the mean.
    pub(crate) fn noise(&self) -> f64 {
        let count = self.pixels.len() as f64;
        let brightness = |i, j| f64::from(self.mean(i, j, |canvas| &canvas.all).element_sum()) / 3.0;
        let places = || (0..self.height).flat_map(|j| (0..self.width).map(move |i| (i, j)));
        let floor = places().map(|(i, j)| brightness(i, j)).sum::<f64>() / count * 0.01;
        let dark = self.dark();
        let relative_sq = |(i, j)| {
            let least = brightness(i, j).max(floor).powi(2).max(f64::MIN_POSITIVE);
            self.variance(i, j, dark) / least
        };
        (places().map(relative_sq).sum::<f64>() / count).sqrt()
    }

    /// A pixel's colour on the films of all canvases together.
    fn mean(&self, i: usize, j: usize, film: impl Fn(&Canvas) -> &Film) -> Vec3 {
        let weights = self.weights(self.tile_of(i, j));
        let of = |(canvas, weight): (&Option<Canvas>, f64)| {
            canvas.as_ref().filter(|_| weight > 0.0).map(|canvas| film(canvas).mean(i, j) * weight as f32)
        };
        self.canvases.iter().zip(weights).filter_map(of).sum()
    }

    /// The picture; `origin` is where the world lies in the scene.
    pub(crate) fn develop(self, stats: Stats, origin: DVec3) -> PhysicalRendering {
        let beauty = self.image(|i, j| self.mean(i, j, |canvas| &canvas.all));
        let indirect = self.image(|i, j| self.mean(i, j, |canvas| &canvas.indirect));
        let direct =
            self.image(|i, j| self.mean(i, j, |canvas| &canvas.all) - self.mean(i, j, |canvas| &canvas.indirect));
        let over = |sum: Vec3, count: u32| if count == 0 { Vec3::ZERO } else { sum / count as f32 };
        let mean = |sum: f32, count: u32| if count == 0 { 0.0 } else { sum / count as f32 };
        let dark = self.dark();
        PhysicalRendering {
            beauty,
            direct,
            indirect,
            albedo: self.image(|i, j| over(self.at(i, j).albedo, self.at(i, j).samples)),
            normal: self.image(|i, j| over(self.at(i, j).normal, self.at(i, j).hits)),
            position: self.image(|i, j| self.position(i, j, origin)),
            depth: self.plane(|p| if p.hits == 0 { f32::INFINITY } else { p.depth / p.hits as f32 }),
            object_id: self.plane(|p| p.object),
            material_id: self.plane(|p| p.material),
            samples: self.plane(|p| p.samples as f32),
            variance: Plane::from_fn(self.width, self.height, |x, y| {
                self.variance(x, self.height - 1 - y, dark) as f32
            }),
            cut_size: self.plane(|p| mean(p.cut, p.cuts)),
            error_bound: self.plane(|p| mean(p.bound, p.cuts)),
            stats,
        }
    }

    /// Where a pixel's samples hit something, in the scene.
    fn position(&self, i: usize, j: usize, origin: DVec3) -> Vec3 {
        let PixelSums { position, hits, .. } = *self.at(i, j);
        if hits == 0 { Vec3::ZERO } else { (position.as_dvec3() / f64::from(hits) + origin).as_vec3() }
    }

    fn at(&self, i: usize, j: usize) -> &PixelSums {
        &self.pixels[j * self.width + i]
    }

    /// A picture from a function of (i, j), j from the bottom.
    fn image(&self, color: impl Fn(usize, usize) -> Vec3) -> Image {
        Image::from_fn(self.width, self.height, |x, y| color(x, self.height - 1 - y).to_array())
    }

    fn plane<T: Copy>(&self, value: impl Fn(&PixelSums) -> T) -> Plane<T> {
        Plane::from_fn(self.width, self.height, |x, y| value(self.at(x, self.height - 1 - y)))
    }
}
