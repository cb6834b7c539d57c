//! The environment's image with the sums by which directions are drawn.

use super::images::linear;
use glam::Vec3;
use lightcuts_kernel::environment::{Environment, EnvironmentMap};
use lightcuts_scene::physical::{EnvironmentDesc, PixelImage, Pixels};

/// Width and height of the image of an environment that has none.
const PLAIN_SIZE: (u32, u32) = (2, 1);

/// An environment; see [`EnvironmentMap`].
#[derive(Debug, Clone, PartialEq)]
pub struct StoredEnvironment {
    record: Environment,
    pixels: Vec<[f32; 3]>,
    rows: Vec<f32>,
    columns: Vec<f32>,
    /// Mean radiance over all directions.
    pub mean: Vec3,
}

impl StoredEnvironment {
    /// `None` where no light comes from it: a share of all samples would go there for nothing.
    pub(super) fn new(desc: &EnvironmentDesc, images: &[PixelImage]) -> Option<Self> {
        let image = desc.image.map(|image| &images[image.0 as usize]);
        let (width, height) = image.map_or(PLAIN_SIZE, |image| (image.width, image.height));
        let pixels = image.map_or_else(|| vec![[1.0; 3]; (width * height) as usize], radiances);
        let angle = desc.degrees.to_radians();
        let record =
            Environment { radiance: desc.radiance, cos: angle.cos(), sin: angle.sin(), width, height, padding: 0 };
        let weights = weights(&pixels, width as usize, height as usize);
        let mut rows = Vec::with_capacity(height as usize);
        let mut columns = Vec::with_capacity((width as usize + 1) * height as usize);
        for row in weights.chunks(width as usize) {
            rows.push(row.iter().sum());
            push_sums(row, &mut columns);
        }
        let mut of_rows = Vec::with_capacity(rows.len() + 1);
        push_sums(&rows, &mut of_rows);
        let mean = mean(&pixels, width as usize, height as usize) * desc.radiance;
        (mean != Vec3::ZERO).then_some(Self { record, pixels, rows: of_rows, columns, mean })
    }

    /// For the kernel.
    pub fn map(&self) -> EnvironmentMap<'_> {
        EnvironmentMap { record: self.record, pixels: &self.pixels, rows: &self.rows, columns: &self.columns }
    }
}

fn radiances(image: &PixelImage) -> Vec<[f32; 3]> {
    match &image.pixels {
        Pixels::Float(pixels) => pixels.clone(),
        Pixels::Srgb(pixels) => pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(linear)).collect(),
        Pixels::Linear(pixels) => pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(|v| f32::from(v) / 255.0)).collect(),
    }
}

/// Sine of the angle to +y at the middle of a row.
fn sine(row: usize, height: usize) -> f64 {
    ((row as f64 + 0.5) / height as f64 * std::f64::consts::PI).sin()
}

/// What a pixel is drawn by: the brightest of it and its neighbours, because light is looked up between them; times its solid
/// angle. Nothing that shines has a weight of 0.
fn weights(pixels: &[[f32; 3]], width: usize, height: usize) -> Vec<f64> {
    let light = |x: usize, y: usize| pixels[y * width + x].iter().map(|&c| f64::from(c)).sum::<f64>();
    let mut weights = Vec::with_capacity(pixels.len());
    for y in 0..height {
        for x in 0..width {
            let columns = [(x + width - 1) % width, x, (x + 1) % width];
            let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
            let brightest = rows.flat_map(|y| columns.map(|x| light(x, y))).fold(0.0, f64::max);
            weights.push((0.5 * brightest + 0.5 * light(x, y)) * sine(y, height));
        }
    }
    weights
}

/// Sums from 0 to 1; even ones where nothing shines.
fn push_sums(weights: &[f64], sums: &mut Vec<f32>) {
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    sums.push(0.0);
    for (k, weight) in weights.iter().enumerate() {
        sum += weight;
        let even = (k + 1) as f64 / weights.len() as f64;
        let share = if total > 0.0 { sum / total } else { even };
        sums.push(if k + 1 == weights.len() { 1.0 } else { share as f32 });
    }
}

fn mean(pixels: &[[f32; 3]], width: usize, height: usize) -> Vec3 {
    let (mut sum, mut area) = (glam::DVec3::ZERO, 0.0);
    for (y, row) in pixels.chunks(width).enumerate() {
        let of_row = sine(y, height);
        sum += row.iter().map(|&p| Vec3::from(p).as_dvec3()).sum::<glam::DVec3>() * of_row;
        area += of_row * width as f64;
    }
    (sum / area).as_vec3()
}
