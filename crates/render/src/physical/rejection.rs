//! Which virtual lights of light paths are kept: those that matter to the camera (Georgiev & Slusallek 2010, "Simple
//! and Robust Iterative Importance Sampling of Virtual Point Lights").
//!
//! A candidate that brings less than the mean to places that the camera sees is kept with a probability of the ratio,
//! and is as much brighter then. The mean comes from earlier passes, so that nothing is biased.

use super::gather::Receiver;
use super::lightcuts::gathered_lobes;
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use super::sums::Counts;
use glam::Vec3;
use lightcuts_kernel::bsdf::{ALL_LOBES, DIFFUSE, SPECULAR, Transport};
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::lens::{Lens, lens_ray};
use lightcuts_kernel::virtual_light::VirtualLight;

/// Places that stand for all that the camera sees.
const PLACES: u32 = 512;

/// Places at which a candidate is judged.
const JUDGES: usize = 8;

/// Every candidate is kept with at least this probability.
const LEAST: f32 = 0.05;

/// Mirrors and panes behind which a place is still looked for.
const MAX_MIRRORS: u32 = 16;

/// Judges candidates.
pub(crate) struct Rejection {
    places: Vec<(Interaction, Vec3)>,
    clamp_sq: f32,
    /// What all candidates so far brought, and their number.
    sum: f64,
    count: u64,
}

/// A candidate that was judged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Judged {
    /// The light, if it is kept.
    pub(crate) light: Option<VirtualLight>,
    /// What it brings to a place, as a sum of channels, if its light path were the only one: paths share the power of
    /// the lights, and passes differ in the number of paths.
    worth: f32,
}

impl Judged {
    /// A light that nobody judges.
    pub(crate) fn kept(light: VirtualLight) -> Self {
        Self { light: Some(light), worth: 0.0 }
    }
}

impl Rejection {
    /// Looks for places through a lens; `clamp` is the distance below which light no longer grows.
    pub(crate) fn new(scene: &Scene<'_>, lens: &Lens, stream: u32, clamp: f32) -> Self {
        let places = (0..PLACES).filter_map(|k| place(scene, lens, &mut Randoms::new(0, k, stream))).collect();
        Self { places, clamp_sq: clamp * clamp, sum: 0.0, count: 0 }
    }

    /// Keeps a candidate, of one of so many light paths, or does not.
    pub(crate) fn judge(&self, scene: &Scene<'_>, light: VirtualLight, paths: u32, random: [f32; 2]) -> Judged {
        let worth = self.worth(scene, &light, random[1]) * paths as f32;
        if self.sum <= 0.0 {
            return Judged { light: Some(light), worth };
        }
        let mean = (self.sum / self.count as f64) as f32;
        let probability = (worth / mean + LEAST).min(1.0);
        let kept = VirtualLight { intensity: light.intensity / probability, ..light };
        Judged { light: (random[0] < probability).then_some(kept), worth }
    }

    /// Learns from the candidates of a pass.
    pub(crate) fn learn(&mut self, judged: &[Judged]) {
        self.sum += judged.iter().map(|one| f64::from(one.worth)).sum::<f64>();
        self.count += judged.len() as u64;
    }

    fn worth(&self, scene: &Scene<'_>, light: &VirtualLight, random: f32) -> f32 {
        if self.places.is_empty() {
            return 0.0;
        }
        let first = (random * self.places.len() as f32) as usize;
        let step = self.places.len().div_ceil(JUDGES);
        let of = |k: usize| {
            let (at, factor) = &self.places[(first + k * step) % self.places.len()];
            let receiver = Receiver::new(scene, at, *factor, Vec3::ZERO, self.clamp_sq);
            light_power(receiver.light(light, &mut Counts::default()))
        };
        (0..JUDGES).map(of).sum::<f32>() / JUDGES as f32
    }
}

/// A diffuse place that the camera sees, perhaps in mirrors or through glass, with the factor on what it sends.
fn place(scene: &Scene<'_>, lens: &Lens, randoms: &mut Randoms) -> Option<(Interaction, Vec3)> {
    let [x, y, u, v] = randoms.next();
    let mut ray = lens_ray(lens, [x * lens.width as f32, y * lens.height as f32], [u, v]);
    let mut factor = Vec3::ONE;
    for _ in 0..MAX_MIRRORS {
        let hit = scene.closest(&ray)?;
        let [u, v, choice, mixed] = randoms.next();
        let at = scene.interaction(&ray, &hit, Cone::NONE, mixed);
        if gathered_lobes(&at.bsdf) & DIFFUSE != 0 {
            return Some((at, factor));
        }
        let sample = at.sample(&scene.world.tables, ALL_LOBES, [u, v, choice], Transport::Radiance)?;
        if sample.lobe != SPECULAR {
            return None;
        }
        factor *= sample.weight;
        ray = at.ray(sample.wi, f32::INFINITY);
    }
    None
}
