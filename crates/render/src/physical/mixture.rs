//! What a render has so far: sums for each technique, and how they count together.
//!
//! Where several techniques show the same light, each tile weighs them by the inverse of their variances. If a variance
//! came from the samples that it weighs, a rare bright sample would lower its own weight, and pictures would be too
//! dark. So variances come from probes, samples of a few pixels that are not shown.

use super::pass::SampledTile;
use super::sums::{Moments, PixelSums};
use super::task::{Extent, PROBES_OF_A_GROUP, Task, probed};
use crate::film::{Film, Tile};
use rayon::prelude::*;
use std::sync::Arc;

/// Edge of a tile in pixels.
pub(crate) const TILE_SIZE: u32 = 16;

/// Most techniques of a render.
pub(super) const MOST_TECHNIQUES: usize = 4;

/// Degrees of freedom that the whole picture has beside a tile's own in the estimate of a variance.
const PICTURE_FREEDOM: f64 = 256.0;

/// Brightness below which errors count no more, relative to the picture's mean.
const DARK: f64 = 0.8;

/// Techniques with less weight than this are left out: what they would add is less than what a bright speck of theirs,
/// of which the variance did not know, would spoil.
const LEAST_WEIGHT: f64 = 0.1;

/// Variances below this, relative to the pixels' squares, are taken as this.
const LEAST_VARIANCE: f64 = 1e-9;

/// Sums of one technique.
pub(super) struct Canvas {
    pub(super) all: Film,
    pub(super) indirect: Film,
    /// Bottom row first.
    pub(super) moments: Vec<Moments>,
    /// Of each tile: samples of each of its pixels.
    pub(super) shown: Vec<u32>,
    /// Of each tile: what probes found.
    probes: Vec<Probes>,
}

/// What probes found at the pixels of a tile, one group of them after the other.
#[derive(Default, Clone)]
struct Probes {
    /// Number of the last group, and its first entry.
    last: Option<(u32, usize)>,
    pixels: Vec<(usize, Moments)>,
}

impl Probes {
    /// Adds a probe of a group, which has these pixels. Groups need not be complete: a pass may have been broken off.
    fn add(&mut self, group: u32, probed: impl Iterator<Item = (usize, Moments)>) {
        let first = match self.last {
            Some((last, first)) if last == group => first,
            _ => self.pixels.len(),
        };
        self.last = Some((group, first));
        for (k, (pixel, moments)) in probed.enumerate() {
            if first + k == self.pixels.len() {
                self.pixels.push((pixel, Moments::default()));
            }
            self.pixels[first + k].1.add(&moments);
        }
    }
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

    /// Variance of a sample, shrunk towards the picture's variance.
    fn variance(&self, all: &Self) -> Option<f64> {
        let mean = all.spread / all.freedom;
        let variance = (self.spread + mean * PICTURE_FREEDOM) / (self.freedom + PICTURE_FREEDOM);
        (all.freedom > 0.0).then_some(variance.max(LEAST_VARIANCE))
    }
}

/// Sums of all passes so far.
pub(crate) struct Mixture {
    pub(super) width: usize,
    pub(super) height: usize,
    tiles: Arc<[Tile]>,
    /// Bottom row first.
    pub(super) pixels: Vec<PixelSums>,
    /// By technique; made when they are needed.
    pub(super) canvases: Vec<Option<Canvas>>,
    /// Of each technique and tile: variance of a sample, relative to the pixel's square; `None` where nothing is known.
    pub(super) variances: Vec<Vec<Option<f64>>>,
    /// What the light of each pixel is, as a sum of channels. Empty before the first pass.
    references: Arc<Vec<f32>>,
}

impl Mixture {
    pub(crate) fn new(width: u32, height: u32, techniques: usize) -> Self {
        let tiles = Tile::cover(width, height, TILE_SIZE);
        assert!(techniques <= MOST_TECHNIQUES);
        Self {
            width: width as usize,
            height: height as usize,
            // Zeros of the system, as everything here that has a value for each pixel: what gets no sample is never
            // touched.
            pixels: bytemuck::zeroed_vec(width as usize * height as usize),
            canvases: (0..techniques).map(|_| None).collect(),
            variances: vec![vec![None; tiles.len()]; techniques],
            references: Arc::default(),
            tiles: tiles.into(),
        }
    }

    pub(crate) fn tiles(&self) -> Arc<[Tile]> {
        self.tiles.clone()
    }

    /// How many samples of a technique the pixels of a tile show.
    pub(crate) fn shown(&self, technique: usize, tile: usize) -> u32 {
        self.canvases[technique].as_ref().map_or(0, |canvas| canvas.shown[tile])
    }

    /// What the light of each pixel is, as a sum of channels; empty before the first pass.
    pub(crate) fn references(&self) -> Arc<Vec<f32>> {
        self.references.clone()
    }

    /// Adds a tile's samples. A pass need not bring those of all tiles.
    pub(crate) fn add(&mut self, sampled: &SampledTile) {
        let (width, height) = (self.width, self.height);
        let tiles = self.tiles.len();
        let Task { tile, technique, extent } = sampled.task;
        let is_first = (0..self.canvases.len()).all(|technique| self.shown(technique, tile) == 0);
        let canvas = self.canvases[technique].get_or_insert_with(|| Canvas {
            all: Film::new(width as u32, height as u32),
            indirect: Film::new(width as u32, height as u32),
            moments: bytemuck::zeroed_vec(width * height),
            shown: vec![0; tiles],
            probes: vec![Probes::default(); tiles],
        });
        let pixel = |(i, j): (u32, u32)| j as usize * width + i as usize;
        let samples = match extent {
            Extent::Whole(samples) => samples,
            Extent::Probe(number) => {
                let found = probed(&self.tiles[tile], number).map(|(k, place)| (pixel(place), sampled.moments[k]));
                canvas.probes[tile].add(number / PROBES_OF_A_GROUP, found);
                return;
            }
        };
        canvas.all.merge(&sampled.all);
        canvas.indirect.merge(&sampled.indirect);
        canvas.shown[tile] += samples;
        let places = self.tiles[tile].pixels().map(pixel);
        for ((place, sums), moments) in places.zip(&sampled.pixels).zip(&sampled.moments) {
            if is_first {
                // The system's zeros cost twice where they are read before they are written to.
                self.pixels[place] = PixelSums::default();
            }
            self.pixels[place].add(sums);
            canvas.moments[place].add(moments);
        }
    }

    /// Updates the reference brightness of each pixel.
    pub(crate) fn learn_light(&mut self) {
        self.references = Arc::new(self.smooth_light());
    }

    /// Updates the variances of the techniques, after probes.
    pub(crate) fn learn_variances(&mut self) {
        let dark = self.dark();
        let variances = self.canvases.iter().map(|canvas| self.tile_variances(canvas.as_ref(), dark));
        self.variances = variances.collect();
    }

    /// Variance of a technique's sample in a tile, relative to the pixel's square.
    pub(crate) fn variance_in(&self, technique: usize, tile: usize) -> Option<f64> {
        self.variances[technique][tile]
    }

    /// What the light of each pixel is, as a sum of channels: mean over the pixel's neighbourhood, of reflected light
    /// only, for a light in the picture says nothing of its surroundings.
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
    pub(super) fn dark(&self) -> f64 {
        let sum: f64 = self.references.iter().map(|&light| f64::from(light)).sum();
        let mean = sum / (3.0 * self.references.len().max(1) as f64);
        (mean * DARK).powi(2).max(f64::MIN_POSITIVE)
    }

    /// What a pixel's errors are measured by: the square of its brightness.
    pub(super) fn scale_sq(&self, pixel: usize, dark: f64) -> f64 {
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
        let of_tile = |probes: &Probes| {
            probes.pixels.iter().fold(Known::default(), |known, &(pixel, moments)| {
                let spread = moments.spread() / self.scale_sq(pixel, dark);
                known.with(&Known { spread, freedom: f64::from(moments.samples.saturating_sub(1)) })
            })
        };
        let own: Vec<Known> = canvas.probes.iter().map(of_tile).collect();
        let all = own.iter().fold(Known::default(), Known::with);
        own.iter().map(|own| own.variance(&all)).collect()
    }

    pub(super) fn tile_of(&self, i: usize, j: usize) -> usize {
        let size = TILE_SIZE as usize;
        j / size * self.width.div_ceil(size) + i / size
    }

    /// Weights of the techniques in a tile. They sum to 1 if it has a sample.
    pub(super) fn weights(&self, tile: usize) -> [f64; MOST_TECHNIQUES] {
        let shown = |technique: usize| f64::from(self.shown(technique, tile));
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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probe(value: f64) -> Moments {
        Moments { samples: 1, sum: value, sum_sq: value * value }
    }

    /// Passes that were broken off leave gaps in the groups of a tile; what is there stays with its own pixels.
    #[test]
    fn probes_find_their_group_whatever_is_missing() {
        let mut probes = Probes::default();
        // Of the first group the last two, of the second none, of the third its second and fourth.
        for (group, pixels) in [(0, [3, 4]), (0, [3, 4]), (2, [7, 8]), (2, [7, 8])] {
            probes.add(group, pixels.into_iter().map(|pixel| (pixel, probe(pixel as f64))));
        }
        let found: Vec<_> =
            probes.pixels.iter().map(|(pixel, moments)| (*pixel, moments.samples, moments.sum)).collect();
        assert_eq!(found, [(3, 2, 6.0), (4, 2, 8.0), (7, 2, 14.0), (8, 2, 16.0)]);
    }
}
