//! What a render of the physical model yields.

use super::pass::{PixelSums, SampledTile};
use crate::film::Film;
use crate::stats::Stats;
use glam::Vec3;
use lightcuts_image::{Image, LayerData, Layers, Plane};

/// A picture of the physical model with everything that was learnt on the way. All planes have one size, row 0 at the top.
#[derive(Debug, Clone)]
pub struct PhysicalRendering {
    /// Radiance, linear.
    pub beauty: Image,
    /// Its part that was emitted towards the camera or scattered once.
    pub direct: Image,
    /// Its part that was scattered more often.
    pub indirect: Image,
    /// Colour of the surface seen, mean over the samples.
    pub albedo: Image,
    /// Normal of the surface seen, mean over the samples that hit something.
    pub normal: Image,
    /// Position of the surface seen, in scene units, mean over the samples that hit something.
    pub position: Image,
    /// Distance along the ray, in scene units, mean over the samples that hit; infinite where none did.
    pub depth: Plane<f32>,
    /// Number of the object that the first sample saw, from 1; 0 for none.
    pub object_id: Plane<u32>,
    /// Number of its material, from 1; 0 for none.
    pub material_id: Plane<u32>,
    /// Number of samples.
    pub samples: Plane<f32>,
    /// Variance of the pixel's brightness, (r + g + b) / 3, as an estimate of what endless samples would give.
    pub variance: Plane<f32>,
    /// Mean number of clusters and virtual lights in the cuts of a sample.
    pub cut_size: Plane<f32>,
    /// Mean bound of a sample's cuts' error, as a sum of channels.
    pub error_bound: Plane<f32>,
    /// Counts and times. `stats.complete` tells whether the render ran to its end.
    pub stats: Stats,
}

impl PhysicalRendering {
    /// Beauty and AOVs, ready for an EXR file.
    pub fn layers(&self) -> Layers {
        let mut layers = Layers::new(self.beauty.clone());
        let aovs = [
            ("direct", LayerData::Color(self.direct.clone())),
            ("indirect", LayerData::Color(self.indirect.clone())),
            ("albedo", LayerData::Color(self.albedo.clone())),
            ("normal", LayerData::Vector(self.normal.clone())),
            ("position", LayerData::Vector(self.position.clone())),
            ("depth", LayerData::Depth(self.depth.clone())),
            ("object_id", LayerData::Id(self.object_id.clone())),
            ("material_id", LayerData::Id(self.material_id.clone())),
            ("samples", LayerData::Scalar(self.samples.clone())),
            ("variance", LayerData::Scalar(self.variance.clone())),
            ("cut_size", LayerData::Scalar(self.cut_size.clone())),
            ("error_bound", LayerData::Scalar(self.error_bound.clone())),
        ];
        for (name, data) in aovs {
            layers.push(name, data).expect("all planes have the picture's size and each its own name");
        }
        layers
    }
}

/// Sums of all passes so far.
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    all: Film,
    indirect: Film,
    /// Bottom row first.
    pixels: Vec<PixelSums>,
}

impl Canvas {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self {
            width: width as usize,
            height: height as usize,
            all: Film::new(width, height),
            indirect: Film::new(width, height),
            pixels: vec![PixelSums::default(); width as usize * height as usize],
        }
    }

    pub(crate) fn add(&mut self, tile: &SampledTile) {
        self.all.merge(&tile.all);
        self.indirect.merge(&tile.indirect);
        for ((i, j), sums) in tile.tile.pixels().zip(&tile.pixels) {
            self.pixels[j as usize * self.width + i as usize].add(sums);
        }
    }

    /// Root mean square of the pixels' relative standard errors; of dark pixels relative to a hundredth of the mean.
    pub(crate) fn noise(&self) -> f64 {
        let mean = |p: &PixelSums| p.brightness / f64::from(p.samples.max(1));
        let count = self.pixels.len() as f64;
        let floor = self.pixels.iter().map(mean).sum::<f64>() / count * 0.01;
        let relative_sq = |p: &PixelSums| variance_of_mean(p) / (mean(p).max(floor).powi(2)).max(f64::MIN_POSITIVE);
        (self.pixels.iter().map(relative_sq).sum::<f64>() / count).sqrt()
    }

    /// What the light of each pixel is, as a sum of channels: mean over the pixel's neighbourhood, of reflected light only, for a
    /// light in the picture says nothing of its surroundings.
    pub(crate) fn references(&self) -> Vec<f32> {
        const REACH: usize = 2;
        let (width, height) = (self.width, self.height);
        let mut references = vec![0.0; width * height];
        for j in 0..height {
            for i in 0..width {
                let (mut sum, mut samples) = (0.0, 0.0);
                for row in j.saturating_sub(REACH)..=(j + REACH).min(height - 1) {
                    for pixel in
                        &self.pixels[row * width + i.saturating_sub(REACH)..=row * width + (i + REACH).min(width - 1)]
                    {
                        sum += pixel.reflected;
                        samples += f64::from(pixel.samples);
                    }
                }
                references[j * width + i] = if samples > 0.0 { (sum / samples) as f32 } else { 0.0 };
            }
        }
        references
    }

    pub(crate) fn develop(self, stats: Stats) -> PhysicalRendering {
        let beauty = self.image(|i, j| self.all.mean(i, j));
        let indirect = self.image(|i, j| self.indirect.mean(i, j));
        let direct = self.image(|i, j| self.all.mean(i, j) - self.indirect.mean(i, j));
        let over = |sum: Vec3, count: u32| if count == 0 { Vec3::ZERO } else { sum / count as f32 };
        let mean = |sum: f32, count: u32| if count == 0 { 0.0 } else { sum / count as f32 };
        PhysicalRendering {
            beauty,
            direct,
            indirect,
            albedo: self.image(|i, j| over(self.at(i, j).albedo, self.at(i, j).samples)),
            normal: self.image(|i, j| over(self.at(i, j).normal, self.at(i, j).hits)),
            position: self.image(|i, j| over(self.at(i, j).position, self.at(i, j).hits)),
            depth: self.plane(|p| if p.hits == 0 { f32::INFINITY } else { p.depth / p.hits as f32 }),
            object_id: self.plane(|p| p.object),
            material_id: self.plane(|p| p.material),
            samples: self.plane(|p| p.samples as f32),
            variance: self.plane(|p| variance_of_mean(p) as f32),
            cut_size: self.plane(|p| mean(p.cut, p.samples)),
            error_bound: self.plane(|p| mean(p.bound, p.samples)),
            stats,
        }
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

/// Variance of the mean of a pixel's samples; 0 with fewer than two.
fn variance_of_mean(p: &PixelSums) -> f64 {
    if p.samples < 2 {
        return 0.0;
    }
    let n = f64::from(p.samples);
    ((p.brightness_sq - p.brightness * p.brightness / n) / (n - 1.0)).max(0.0) / n
}
