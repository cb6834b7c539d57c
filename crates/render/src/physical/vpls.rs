//! Station 3: virtual point lights where light paths meet matt surfaces (Keller 1997, "Instant Radiosity").

use super::emission::Origins;
use super::path::MAX_VERTICES;
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use glam::Vec3;
use lightcuts_kernel::bsdf::{ALL_LOBES, MATT, PLASTIC, Transport, energy_at, lobes_of, mean_energy};
use lightcuts_kernel::virtual_light::{VirtualLight, pack_direction, virtual_table};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Paths that one thread traces at a time.
const CHUNK: u32 = 256;

/// Greatest chance that a light path goes on.
const MOST_SURVIVAL: f32 = 0.95;

/// The virtual lights of a pass.
#[derive(Debug, Clone, Default)]
pub(crate) struct VplSet {
    pub(crate) lights: Vec<VirtualLight>,
    pub(crate) rays: u64,
}

/// Traces a fixed number of light paths: their number, never that of the lights that they leave, is what intensities are divided
/// by.
pub(crate) fn trace_vpls(scene: &Scene<'_>, origins: &Origins, paths: u32, stream: u32) -> VplSet {
    let chunks = paths.div_ceil(CHUNK);
    let parts: Vec<VplSet> = (0..chunks)
        .into_par_iter()
        .map(|chunk| {
            let mut set = VplSet::default();
            for path in chunk * CHUNK..paths.min((chunk + 1) * CHUNK) {
                trace_path(scene, origins, &mut Randoms::new(0, path, stream), 1.0 / paths as f32, &mut set);
            }
            set
        })
        .collect();
    parts
        .into_iter()
        .reduce(|mut all, part| {
            all.lights.extend(part.lights);
            all.rays += part.rays;
            all
        })
        .unwrap_or_default()
}

fn trace_path(scene: &Scene<'_>, origins: &Origins, randoms: &mut Randoms, share: f32, set: &mut VplSet) {
    let tables = &scene.world.tables[..];
    let Some(departure) = origins.depart(scene, randoms) else { return };
    let (mut ray, mut power) = (departure.ray, departure.power * share);
    for _ in 0..MAX_VERTICES {
        set.rays += 1;
        let Some(hit) = scene.closest(&ray) else { return };
        let [u, v, choice, mixed] = randoms.next();
        let at = scene.interaction(&ray, &hit, Cone::NONE, mixed);
        if lobes_of(&at.bsdf) & MATT != 0 {
            set.lights.extend(virtual_light(&at, tables, -ray.direction, power));
        }
        let Some(sample) = at.sample(tables, ALL_LOBES, [u, v, choice], Transport::Importance) else { return };
        let factor = sample.weight * shading_correction(&at, -ray.direction, sample.wi);
        let survives = factor.max_element().min(MOST_SURVIVAL);
        let [survival, ..] = randoms.next();
        if survival >= survives || !factor.is_finite() {
            return;
        }
        power *= factor / survives;
        ray = at.ray(sample.wi, f32::INFINITY);
    }
}

/// Light paths meet surfaces by their faces and scatter by their shading normals: what a camera path would have as cosines
/// (Veach 1997, section 5.3).
fn shading_correction(at: &Interaction, from: Vec3, to: Vec3) -> f32 {
    let ratio = |direction: Vec3| at.normal.dot(direction).abs() / at.face.dot(direction).abs().max(1e-6);
    ratio(from) / ratio(to).max(1e-6)
}

/// The virtual light of power that arrives from a direction; `None` if nothing is passed on.
fn virtual_light(at: &Interaction, tables: &[f32], from: Vec3, power: Vec3) -> Option<VirtualLight> {
    let bsdf = &at.bsdf;
    let coat = if bsdf.kind == PLASTIC {
        (1.0 - energy_at(tables, bsdf.table, false, at.wo.z.abs()))
            / (1.0 - mean_energy(tables, bsdf.table, false)).max(1e-4)
    } else {
        1.0
    };
    let ratio = at.normal.dot(from).abs() / at.face.dot(from).abs().max(1e-6);
    let intensity = power * bsdf.diffuse * (coat * ratio / PI);
    let side = 1.0_f32.copysign(at.face.dot(from));
    (intensity.is_finite() && intensity.max_element() > 0.0).then(|| VirtualLight {
        position: at.point + at.face * (side * at.epsilon),
        table: virtual_table(bsdf),
        normal: at.face * side,
        shading: pack_direction(at.normal * side),
        intensity,
        padding: 0,
    })
}
