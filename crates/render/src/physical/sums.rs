//! What the samples of a pass are counted and added up to.

use super::scene::Interaction;
use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::bsdf::{CONDUCTOR, DIELECTRIC, MIRROR, PHONG};
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::fresnel::fresnel_conductor;
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
    pub(crate) depth: f32,
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

/// Radiance, and parts of it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Radiance {
    pub(crate) all: Vec3,
    /// The part that was scattered at least twice.
    pub(crate) indirect: Vec3,
    /// The part that was not scattered at all.
    pub(crate) emitted: Vec3,
}

impl Radiance {
    /// Adds light that met so many surfaces on its way.
    pub(crate) fn add(&mut self, surfaces: u32, light: Vec3) {
        if light.is_finite() {
            self.all += light;
            match surfaces {
                0 => self.emitted += light,
                1 => {}
                _ => self.indirect += light,
            }
        }
    }
}

/// What a camera ray brings.
pub(crate) struct Sampled {
    pub(crate) radiance: Radiance,
    pub(crate) first: Option<FirstHit>,
    pub(crate) cut: f32,
    pub(crate) bound: f32,
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
    /// Of a single sample; `has_cut` if VPLs lit it.
    pub(super) fn of(sampled: &Sampled, has_cut: bool) -> Self {
        let Sampled { radiance, first, cut, bound } = *sampled;
        let emitted = f64::from(light_power(radiance.emitted));
        let reflected = f64::from(light_power(radiance.all)) - emitted;
        let cuts = u32::from(has_cut);
        let gathered = f64::from(cuts) * reflected;
        let mut sums = Self { samples: 1, reflected, emitted, cut, bound, cuts, gathered, ..Self::default() };
        if let Some(first) = first {
            sums.add(&first.into());
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
}

impl From<FirstHit> for PixelSums {
    /// Of what was met alone, without a sample.
    fn from(FirstHit { albedo, normal, position, depth, object, material }: FirstHit) -> Self {
        Self { hits: 1, albedo, normal, position, depth, object, material, ..Self::default() }
    }
}

/// Sums over the samples that a pixel got from one technique, of their brightness (r + g + b) / 3; of probes without
/// light that was not scattered.
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
