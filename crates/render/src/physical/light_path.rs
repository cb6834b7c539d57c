//! Paths of light from the scene's lights: what leaves virtual lights and photons.

use super::emission::Origins;
use super::path::MAX_VERTICES;
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use glam::Vec3;
use lightcuts_kernel::bsdf::{ALL_LOBES, Transport};
use rayon::prelude::*;

/// Paths that one thread traces at a time.
const CHUNK: u32 = 256;

/// Greatest chance that a light path goes on.
const MOST_SURVIVAL: f32 = 0.95;

/// What light paths left.
#[derive(Debug, Clone)]
pub(crate) struct Deposits<T> {
    pub(crate) items: Vec<T>,
    pub(crate) rays: u64,
}

impl<T> Default for Deposits<T> {
    fn default() -> Self {
        Self { items: Vec::new(), rays: 0 }
    }
}

/// A place that a light path came to.
pub(crate) struct Arrival<'a> {
    pub(crate) at: &'a Interaction,
    /// Where the light came from.
    pub(crate) from: Vec3,
    /// Power that arrives, in W, of all paths together.
    pub(crate) power: Vec3,
    /// Surfaces before this one.
    pub(crate) bounces: u32,
    /// Random numbers for what is left, each in 0..1.
    pub(crate) random: [f32; 2],
}

/// Traces a fixed number of light paths and collects what `leave` makes of each arrival. Their number, never that of
/// what they leave, is what power is divided by. Paths go on from a place by a lobe only where `follows` says so. Once
/// `is_over`, what is left is of no use.
pub(crate) fn trace_light<T: Send>(
    scene: &Scene<'_>,
    origins: &Origins,
    paths: u32,
    stream: u32,
    follows: impl Fn(&Interaction, u32) -> bool + Sync,
    leave: impl Fn(&Arrival<'_>) -> Option<T> + Sync,
    is_over: &(dyn Fn() -> bool + Sync),
) -> Deposits<T> {
    let chunks = paths.div_ceil(CHUNK);
    let parts: Vec<Deposits<T>> = (0..chunks)
        .into_par_iter()
        .map(|chunk| {
            let mut left = Deposits::default();
            if is_over() {
                return left;
            }
            for path in chunk * CHUNK..paths.min((chunk + 1) * CHUNK) {
                let mut randoms = Randoms::new(0, path, stream);
                follow(scene, origins, &mut randoms, 1.0 / paths as f32, &follows, &leave, &mut left);
            }
            left
        })
        .collect();
    let mut all = Deposits { items: Vec::with_capacity(parts.iter().map(|part| part.items.len()).sum()), rays: 0 };
    for part in parts {
        all.items.extend(part.items);
        all.rays += part.rays;
    }
    all
}

fn follow<T>(
    scene: &Scene<'_>,
    origins: &Origins,
    randoms: &mut Randoms,
    share: f32,
    follows: impl Fn(&Interaction, u32) -> bool,
    leave: impl Fn(&Arrival<'_>) -> Option<T>,
    left: &mut Deposits<T>,
) {
    let tables = &scene.world.tables[..];
    let Some(departure) = origins.depart(scene, randoms) else { return };
    let (mut ray, mut power) = (departure.ray, departure.power * share);
    for bounces in 0..MAX_VERTICES {
        left.rays += 1;
        let Some(hit) = scene.closest(&ray) else { return };
        let [u, v, choice, mixed] = randoms.next();
        let at = scene.interaction(&ray, &hit, Cone::NONE, mixed);
        let [survival, r0, r1, _] = randoms.next();
        left.items.extend(leave(&Arrival { at: &at, from: -ray.direction, power, bounces, random: [r0, r1] }));
        let Some(sample) = at.sample(tables, ALL_LOBES, [u, v, choice], Transport::Importance) else { return };
        if !follows(&at, sample.lobe) {
            return;
        }
        let factor = sample.weight * shading_correction(&at, -ray.direction, sample.wi);
        let survives = factor.max_element().min(MOST_SURVIVAL);
        if survival >= survives || !factor.is_finite() {
            return;
        }
        power *= factor / survives;
        ray = at.ray(sample.wi, f32::INFINITY);
    }
}

/// Light paths meet surfaces by their faces and scatter by their shading normals: what a camera path would have as
/// cosines (Veach 1997, section 5.3).
fn shading_correction(at: &Interaction, from: Vec3, to: Vec3) -> f32 {
    let ratio = |direction: Vec3| at.normal.dot(direction).abs() / at.face.dot(direction).abs().max(1e-6);
    ratio(from) / ratio(to).max(1e-6)
}
