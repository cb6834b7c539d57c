//! Station 6: what a render yields.

use crate::device::Device;
use crate::device::TileResult;
use crate::film::Film;
use crate::settings::Display;
use crate::stats::Stats;
use glam::Vec3;
use lightcuts_image::{Image, LayerData, Layers, Plane};
use lightcuts_kernel::light::Vpl;

/// A finished picture with everything that was learnt on the way. All planes have one size, row 0 at the top.
#[derive(Debug, Clone)]
pub struct Rendering {
    /// Both passes together, with bloom, before tone mapping; linear.
    pub beauty: Image,
    /// Light of the scene's lights.
    pub first_pass: Image,
    /// Light of the VPLs, and caustics.
    pub second_pass: Image,
    /// Diffuse colour of the surface seen, mean over the pixel's samples.
    pub albedo: Image,
    /// Normal of the surface seen, mean over the pixel's samples that hit something.
    pub normal: Image,
    /// Distance from the view plane along the ray, in scene units, mean over the samples that hit; infinite where none
    /// did.
    pub depth: Plane<f32>,
    /// Number of the object seen by the first sample that hit one, from 1; 0 for none.
    pub object_id: Plane<u32>,
    /// Mean number of VPLs that lit a shaded hit of the pixel's ray trees.
    pub lights_selected: Plane<f32>,
    /// The VPLs, in order of placement.
    pub vpls: Vec<Vpl>,
    /// Counts and times. `stats.complete` is true if the render ran to its end.
    pub stats: Stats,
}

impl Rendering {
    /// Beauty and AOVs, ready for an EXR file; copies of them. [`into_layers`](Self::into_layers) copies nothing.
    pub fn layers(&self) -> Layers {
        self.clone().into_layers()
    }

    /// Beauty and AOVs, ready for an EXR file.
    pub fn into_layers(self) -> Layers {
        let mut layers = Layers::new(self.beauty);
        let aovs = [
            ("first_pass", LayerData::Color(self.first_pass)),
            ("second_pass", LayerData::Color(self.second_pass)),
            ("albedo", LayerData::Color(self.albedo)),
            ("normal", LayerData::Vector(self.normal)),
            ("depth", LayerData::Depth(self.depth)),
            ("object_id", LayerData::Id(self.object_id)),
            ("lights_selected", LayerData::Scalar(self.lights_selected)),
        ];
        for (name, data) in aovs {
            layers.push(name, data).expect("all planes have the picture's size and each its own name");
        }
        layers
    }

    /// The picture as it is shown: exposed and tone mapped, before the transfer curve.
    pub fn displayed(&self, display: &Display) -> Image {
        display.develop(&self.beauty)
    }

    /// The same by a device; by the CPU if that faults.
    pub fn displayed_on(&self, display: &Display, device: &dyn Device) -> Image {
        let (exposed, operator) = (display.exposure.apply(&self.beauty), display.operator());
        device.tone_map(&exposed, &operator).unwrap_or_else(|_| operator.apply(&exposed))
    }
}

/// Both passes' films and what the camera rays saw, summed over samples, while they grow. Planes have row 0 at the top,
/// as they are to leave.
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    pub(crate) first: Film,
    pub(crate) second: Film,
    /// Number of samples, and of those that hit something.
    samples: Plane<u32>,
    hits: Plane<u32>,
    albedo: Image,
    normal: Image,
    depth: Plane<f32>,
    object: Plane<u32>,
    /// VPLs that lit shaded hits, and the number of these hits.
    selected: Plane<u64>,
    shaded: Plane<u64>,
}

impl Canvas {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let (first, second) = (Film::new(width, height), Film::new(width, height));
        let (width, height) = (width as usize, height as usize);
        Self {
            width,
            height,
            first,
            second,
            samples: Plane::new(width, height),
            hits: Plane::new(width, height),
            albedo: Image::new(width, height),
            normal: Image::new(width, height),
            depth: Plane::new(width, height),
            object: Plane::new(width, height),
            selected: Plane::new(width, height),
            shaded: Plane::new(width, height),
        }
    }

    /// Adds what a tile's camera rays saw.
    pub(crate) fn see(&mut self, result: &TileResult) {
        for ((i, j), seen) in result.tile.pixels().zip(&result.seen) {
            let k = (self.height - 1 - j as usize) * self.width + i as usize;
            if seen.shaded != 0 {
                self.selected.pixels_mut()[k] += seen.selected;
                self.shaded.pixels_mut()[k] += seen.shaded;
            }
            if seen.samples != 0 {
                self.samples.pixels_mut()[k] += seen.samples;
                self.hits.pixels_mut()[k] += seen.hits;
                self.depth.pixels_mut()[k] += seen.depth;
                add(&mut self.albedo.pixels_mut()[k], seen.albedo);
                add(&mut self.normal.pixels_mut()[k], seen.normal);
                let object = &mut self.object.pixels_mut()[k];
                *object = if *object == 0 { seen.object } else { *object };
            }
        }
    }

    /// Pixels that differ from a neighbour by more than a threshold, bottom row first.
    pub(crate) fn edges(&self, film: &Film, threshold: f32) -> Vec<bool> {
        let mut mask = vec![false; self.width * self.height];
        for j in 0..self.height {
            for i in 0..self.width {
                for (x, y) in [(i + 1, j), (i, j + 1)] {
                    if x < self.width && y < self.height {
                        let difference = (film.color(i, j) - film.color(x, y)).abs().max_element();
                        if difference > threshold {
                            mask[j * self.width + i] = true;
                            mask[y * self.width + x] = true;
                        }
                    }
                }
            }
        }
        mask
    }

    /// Turns sums into pictures; `bloom` finishes that of both passes.
    pub(crate) fn develop(mut self, bloom: impl FnOnce(Image) -> Image, vpls: Vec<Vpl>, stats: Stats) -> Rendering {
        let (first_pass, second_pass) = (self.image(&self.first), self.image(&self.second));
        let both = first_pass.pixels().iter().zip(second_pass.pixels());
        let both = both.map(|(&a, &b)| (Vec3::from(a) + Vec3::from(b)).min(Vec3::ONE).to_array()).collect();
        let both = Image::from_pixels(self.width, self.height, both).expect("a sum for each pixel");
        divide(&mut self.albedo, &self.samples);
        divide(&mut self.normal, &self.hits);
        for (depth, &hits) in self.depth.pixels_mut().iter_mut().zip(self.hits.pixels()) {
            *depth = if hits == 0 { f32::INFINITY } else { *depth / hits as f32 };
        }
        let mean = |selected: u64, shaded: u64| if shaded == 0 { 0.0 } else { selected as f32 / shaded as f32 };
        let selected = |x, y| mean(self.selected.get(x, y), self.shaded.get(x, y));
        Rendering {
            beauty: bloom(both),
            first_pass,
            second_pass,
            lights_selected: Plane::from_fn(self.width, self.height, selected),
            albedo: self.albedo,
            normal: self.normal,
            depth: self.depth,
            object_id: self.object,
            vpls,
            stats,
        }
    }

    /// The picture on a film.
    fn image(&self, film: &Film) -> Image {
        Image::from_fn(self.width, self.height, |x, y| film.color(x, self.height - 1 - y).to_array())
    }
}

fn add(sum: &mut [f32; 3], value: Vec3) {
    *sum = (Vec3::from(*sum) + value).to_array();
}

/// Makes sums means; 0 where nothing was summed.
fn divide(sums: &mut Image, counts: &Plane<u32>) {
    for (sum, &count) in sums.pixels_mut().iter_mut().zip(counts.pixels()) {
        // Most often there is one sample.
        if count > 1 {
            *sum = (Vec3::from(*sum) / count as f32).to_array();
        }
    }
}
