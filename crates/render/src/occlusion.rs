//! Ambient occlusion (thesis program, first pass), with cosine-distributed rays in place of its angular grid.

use crate::cpu::Tracer;
use crate::settings::AmbientOcclusion;
use crate::shade::Found;
use crate::stats::Rays;
use lightcuts_kernel::ray::Ray;
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::sampling::sample_cosine_cone;

/// Largest number of slots of a ray tree that have random numbers of their own.
pub const SLOTS: u32 = 1 << 12;

/// Parameters made ready for use.
#[derive(Debug, Clone, Copy)]
pub struct Occlusion {
    /// Rays per hit.
    pub rays: u32,
    /// Sine of the half angle of the cone that they fill.
    pub sin_max: f32,
    /// Length of the rays in scene units.
    pub range: f32,
    /// Factor on the share that is open.
    pub factor: f32,
    /// Stream of their random numbers.
    pub stream: u32,
}

impl Occlusion {
    /// Makes settings ready; `stream` is that of the random numbers.
    pub fn new(settings: &AmbientOcclusion, stream: u32) -> Self {
        Self {
            rays: settings.rays(),
            sin_max: settings.angle.to_radians().sin(),
            range: settings.range,
            factor: settings.factor,
            stream,
        }
    }

    /// The factor on a hit's colour: the share of its surroundings that is open. A surface at distance d < range counts
    /// (range - d) / range. `place` is ((pixel, sample), slot of the ray tree).
    pub(crate) fn openness(
        &self,
        tracer: &Tracer<'_>,
        Found { surface, epsilon, .. }: &Found,
        ((pixel, sample), slot): ((u32, u32), u32),
        rays: &mut Rays,
    ) -> f32 {
        let mut occluded = 0.0;
        for k in 0..self.rays {
            let [a, b, ..] = random4(pixel, sample, k * SLOTS + slot, self.stream);
            // Stratified along the first number, so that few rays already cover the cone.
            let stratum = (k as f32 + a) / self.rays as f32;
            let direction = sample_cosine_cone(surface.normal, self.sin_max, [stratum, b]);
            let ray = Ray { origin: surface.point, direction, t_min: *epsilon, t_max: self.range, inside: false };
            let hit = tracer.closest(&ray);
            if hit.is_some() {
                occluded += (self.range - hit.t) / self.range;
            }
        }
        rays.occlusion += u64::from(self.rays);
        let total = self.rays as f32;
        (total - occluded) / total * self.factor
    }
}
