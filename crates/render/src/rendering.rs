//! Station 6: what a render yields.

use crate::device::Device;
use crate::device::{Seen, TileResult};
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
    /// Counts and times. `stats.complete` tells whether the render ran to its end.
    pub stats: Stats,
}

impl Rendering {
    /// Beauty and AOVs, ready for an EXR file.
    pub fn layers(&self) -> Layers {
        let mut layers = Layers::new(self.beauty.clone());
        let aovs = [
            ("first_pass", LayerData::Color(self.first_pass.clone())),
            ("second_pass", LayerData::Color(self.second_pass.clone())),
            ("albedo", LayerData::Color(self.albedo.clone())),
            ("normal", LayerData::Vector(self.normal.clone())),
            ("depth", LayerData::Depth(self.depth.clone())),
            ("object_id", LayerData::Id(self.object_id.clone())),
            ("lights_selected", LayerData::Scalar(self.lights_selected.clone())),
        ];
        for (name, data) in aovs {
            layers.push(name, data).expect("all planes have the picture's size and each its own name");
        }
        layers
    }

    /// The picture as it is shown: tone mapped, before the transfer curve.
    pub fn displayed(&self, display: &Display) -> Image {
        display.operator().apply(&self.beauty)
    }

    /// The same by a device; by this one where that faults.
    pub fn displayed_on(&self, display: &Display, device: &dyn Device) -> Image {
        device.tone_map(&self.beauty, &display.operator()).unwrap_or_else(|_| self.displayed(display))
    }
}

/// Both passes' films and what the camera rays saw, while they grow.
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    pub(crate) first: Film,
    pub(crate) second: Film,
    seen: Vec<Seen>,
}

impl Canvas {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self {
            width: width as usize,
            height: height as usize,
            first: Film::new(width, height),
            second: Film::new(width, height),
            seen: vec![Seen::default(); width as usize * height as usize],
        }
    }

    /// Adds what a tile's camera rays saw.
    pub(crate) fn see(&mut self, result: &TileResult) {
        for ((i, j), seen) in result.tile.pixels().zip(&result.seen) {
            let sum = &mut self.seen[j as usize * self.width + i as usize];
            sum.samples += seen.samples;
            sum.hits += seen.hits;
            sum.albedo += seen.albedo;
            sum.normal += seen.normal;
            sum.depth += seen.depth;
            sum.object = if sum.object == 0 { seen.object } else { sum.object };
            sum.selected += seen.selected;
            sum.shaded += seen.shaded;
        }
    }

    /// Pixels that differ from a neighbour by more than a threshold, bottom row first.
    pub(crate) fn edges(&self, film: &Film, threshold: f32) -> Vec<bool> {
        let mut mask = vec![false; self.seen.len()];
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
    pub(crate) fn develop(self, bloom: impl FnOnce(Image) -> Image, vpls: Vec<Vpl>, stats: Stats) -> Rendering {
        let first_pass = self.image(|i, j| self.first.color(i, j));
        let second_pass = self.image(|i, j| self.second.color(i, j));
        let sum = self.image(|i, j| (self.first.color(i, j) + self.second.color(i, j)).min(Vec3::ONE));
        let mean = |sum: Vec3, count: u32| if count == 0 { Vec3::ZERO } else { sum / count as f32 };
        Rendering {
            beauty: bloom(sum),
            first_pass,
            second_pass,
            albedo: self.image(|i, j| mean(self.at(i, j).albedo, self.at(i, j).samples)),
            normal: self.image(|i, j| mean(self.at(i, j).normal, self.at(i, j).hits)),
            depth: self.plane(|s| if s.hits == 0 { f32::INFINITY } else { s.depth / s.hits as f32 }),
            object_id: self.plane(|s| s.object),
            lights_selected: self.plane(|s| if s.shaded == 0 { 0.0 } else { s.selected as f32 / s.shaded as f32 }),
            vpls,
            stats,
        }
    }

    fn at(&self, i: usize, j: usize) -> &Seen {
        &self.seen[j * self.width + i]
    }

    /// A picture from a function of (i, j), j from the bottom.
    fn image(&self, color: impl Fn(usize, usize) -> Vec3) -> Image {
        Image::from_fn(self.width, self.height, |x, y| color(x, self.height - 1 - y).to_array())
    }

    fn plane<T: Copy>(&self, value: impl Fn(&Seen) -> T) -> Plane<T> {
        Plane::from_fn(self.width, self.height, |x, y| value(self.at(x, self.height - 1 - y)))
    }
}
