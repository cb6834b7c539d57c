//! One pass over the picture: a sample of every pixel.

use super::integrator::Sampler;
use super::path::Radiance;
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use crate::film::{Film, Tile};
use crate::settings::Filter;
use glam::Vec3;
use lightcuts_kernel::bsdf::{CONDUCTOR, DIELECTRIC, MIRROR, PHONG};
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::fresnel::fresnel_conductor;
use lightcuts_kernel::lens::{Lens, lens_ray, pixel_spread, pixel_width};
use lightcuts_kernel::ray::Ray;

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

/// Sums over the samples of a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PixelSums {
    pub(crate) samples: u32,
    /// Samples that hit something.
    pub(crate) hits: u32,
    /// Of the brightness (r + g + b) / 3 and of its square.
    pub(crate) brightness: f64,
    pub(crate) brightness_sq: f64,
    /// Of what was scattered at least once, as sums of channels.
    pub(crate) reflected: f64,
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
}

impl PixelSums {
    pub(crate) fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.hits += other.hits;
        self.brightness += other.brightness;
        self.brightness_sq += other.brightness_sq;
        self.reflected += other.reflected;
        self.albedo += other.albedo;
        self.normal += other.normal;
        self.position += other.position;
        self.depth += other.depth;
        if self.object == 0 {
            (self.object, self.material) = (other.object, other.material);
        }
        self.cut += other.cut;
        self.bound += other.bound;
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

/// What a pass is: everything that its samples share.
pub(crate) struct SamplePass<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) lens: Lens,
    pub(crate) filter: &'a Filter,
    pub(crate) stream: u32,
    /// Number of the sample that every pixel gets.
    pub(crate) sample: u32,
    pub(crate) sampler: Sampler<'a>,
}

/// What a tile of a pass yields.
pub(crate) struct SampledTile {
    pub(crate) tile: Tile,
    pub(crate) all: Film,
    pub(crate) indirect: Film,
    /// Bottom row first.
    pub(crate) pixels: Vec<PixelSums>,
    pub(crate) counts: Counts,
}

/// What a camera ray brings.
pub(crate) struct Sampled {
    pub(crate) radiance: Radiance,
    pub(crate) first: Option<FirstHit>,
    pub(crate) cut: f32,
    pub(crate) bound: f32,
}

impl SamplePass<'_> {
    pub(crate) fn render(&self, tile: &Tile) -> SampledTile {
        let film = Film::around(tile, self.filter);
        let mut result = SampledTile {
            tile: *tile,
            all: film.clone(),
            indirect: film,
            pixels: Vec::with_capacity((tile.width * tile.height) as usize),
            counts: Counts::default(),
        };
        for (i, j) in tile.pixels() {
            let sums = self.sample_pixel(i, j, &mut result);
            result.pixels.push(sums);
        }
        result
    }

    fn sample_pixel(&self, i: u32, j: u32, result: &mut SampledTile) -> PixelSums {
        let pixel = j * self.lens.width + i;
        let mut randoms = Randoms::new(pixel, self.sample, self.stream);
        let [x, y, u, v] = randoms.next();
        let place = [i as f32 + x, j as f32 + y];
        let ray = lens_ray(&self.lens, place, [u, v]);
        let cone = Cone { width: pixel_width(&self.lens), spread: pixel_spread(&self.lens) };
        result.counts.primary += 1;
        let sampled = self.sampler.sample(&self.scene, ray, cone, pixel, &mut randoms, &mut result.counts);
        let Sampled { radiance, first, cut, bound } = sampled;
        let shift = [x - 0.5, y - 0.5];
        result.all.add(self.filter, i, j, shift, radiance.all);
        result.indirect.add(self.filter, i, j, shift, radiance.indirect);
        let brightness = f64::from(radiance.all.x + radiance.all.y + radiance.all.z) / 3.0;
        let mut sums = PixelSums {
            samples: 1,
            brightness,
            brightness_sq: brightness * brightness,
            reflected: f64::from(light_power(radiance.all - radiance.emitted)),
            cut,
            bound,
            ..PixelSums::default()
        };
        if let Some(first) = &first {
            sums.see(first);
        }
        sums
    }
}
