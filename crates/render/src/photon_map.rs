//! Photons that mirrors and glass throw onto diffuse surfaces, and their density there.
//!
//! The thesis program means to do this but stores nothing: it forgets the target after the first bounce. Here photons
//! go through a regular grid on the disk of each target's bounding sphere seen from each light, must meet the target
//! first, then follow mirrored and refracted rays to the first surface bright enough to show them.

use crate::cpu::Tracer;
use crate::monitor::Monitor;
use crate::settings::Caustics;
use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::optics::{reflect_at, refract_at};
use lightcuts_kernel::photon::{Photon, PhotonStart, PhotonTarget, photon_start};
use lightcuts_kernel::photon_gather::{gather_photons, photon_cell};
use lightcuts_kernel::ray::{Ray, spawn_epsilon};
use lightcuts_kernel::surface::surface_at;
use lightcuts_world::{ObjectBounds, World};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Most photons in all; a finer step is widened until they suffice.
const MAX_PHOTONS: usize = 1 << 26;

/// Most rays that one photon may split into.
const MAX_BRANCHES: usize = 64;

/// Photons in cells as wide as the gathered radius.
#[derive(Debug, Clone, Default)]
pub struct PhotonMap {
    /// Sorted by cell and then in order of emission.
    pub photons: Vec<Photon>,
    /// Radius of the gathered disk, in scene units.
    pub radius: f32,
    /// Fewest photons in the disk that count.
    pub min_photons: u32,
    id: u64,
}

impl PhotonMap {
    /// Shoots photons from every light at every mirror and glass object; returns the number of rays too. A step of the
    /// monitor is a row of a target. A monitor that cancels gets those shot so far.
    pub(crate) fn shoot(
        world: &World,
        tracer: &Tracer<'_>,
        settings: &Caustics,
        max_depth: u32,
        monitor: &dyn Monitor,
    ) -> (Self, u64) {
        let mut photons = Vec::new();
        let mut rays = 0;
        for target in &photon_targets(world, settings) {
            let rows: Vec<(Vec<Photon>, u64)> = (0..target.side)
                .into_par_iter()
                .filter(|_| !monitor.cancelled())
                .map(|row| {
                    let mut walk = Walk { world, tracer, settings, max_depth, found: Vec::new(), rays: 0 };
                    (0..target.side).for_each(|column| walk.emit(target, row, column));
                    monitor.advance();
                    (walk.found, walk.rays)
                })
                .collect();
            for (found, count) in rows {
                photons.extend(found);
                rays += count;
            }
        }
        (Self::new(photons, settings), rays)
    }

    /// Sorts photons, given in order of emission, into cells.
    pub fn new(mut photons: Vec<Photon>, settings: &Caustics) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        let Caustics { radius, min_photons, .. } = *settings;
        for photon in &mut photons {
            let cell = photon_cell(photon.position, radius);
            (photon.cell_x, photon.cell_y, photon.cell_z) = (cell.x, cell.y, cell.z);
        }
        // Stable: equal cells keep the order of emission, so that sums are reproducible.
        photons.sort_by_key(|photon| [photon.cell_x, photon.cell_y, photon.cell_z]);
        Self { photons, radius, min_photons, id: NEXT.fetch_add(1, Ordering::Relaxed) }
    }

    /// A number that no other map made in this process has, clones apart, so that devices can keep what they uploaded.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Light per area around a point; see [`gather_photons`].
    pub(crate) fn gather(&self, point: Vec3, normal: Vec3) -> Vec3 {
        gather_photons(&self.photons, point, normal, self.radius, self.min_photons)
    }
}

/// Every mirror and glass object to shoot at from every light, in the order of emission.
pub fn photon_targets(world: &World, settings: &Caustics) -> Vec<PhotonTarget> {
    let worth = |b: &ObjectBounds| b.reflection >= settings.min_reflection || b.refraction >= settings.min_refraction;
    let objects: Vec<(usize, &ObjectBounds)> =
        world.object_bounds.iter().enumerate().filter(|(_, bounds)| worth(bounds)).collect();
    let pairs = world.lights.len() * objects.len();
    let most_per_side = (MAX_PHOTONS / pairs.max(1)).isqrt().max(1) as u32;
    (0..world.lights.len() as u32)
        .flat_map(|light| objects.iter().map(move |&(object, bounds)| (light, object, bounds)))
        .map(|(light, object, bounds)| PhotonTarget {
            center: bounds.center,
            radius: bounds.radius,
            light,
            object: object as u32 + 1,
            side: ((2.0 * bounds.radius / settings.step).ceil().max(1.0) as u32).min(most_per_side),
            padding: 0,
        })
        .collect()
}

/// Follows photons.
struct Walk<'a> {
    world: &'a World,
    tracer: &'a Tracer<'a>,
    settings: &'a Caustics,
    max_depth: u32,
    found: Vec<Photon>,
    rays: u64,
}

impl Walk<'_> {
    fn emit(&mut self, target: &PhotonTarget, row: u32, column: u32) {
        let light = &self.world.lights[target.light as usize];
        let PhotonStart { ray, area } = photon_start(light, target, row, column);
        if area == 0.0 {
            return;
        }
        let power = light.diffuse * (light.attenuation * area);
        let mut open = [(ray, power, 0_u32); MAX_BRANCHES];
        let mut size = 1;
        while size > 0 {
            size -= 1;
            let (ray, power, bounces) = open[size];
            self.rays += 1;
            let hit = self.tracer.closest(&ray);
            if !hit.is_some() {
                continue;
            }
            let surface = surface_at(&self.world.shapes.surfaces(), &ray, &hit);
            if bounces == 0 && surface.object != target.object {
                continue;
            }
            let material = &self.world.materials[surface.material as usize];
            if bounces > 0 && !ray.inside && material.diffuse.element_sum() >= self.settings.min_diffuse {
                self.found.push(Photon { position: surface.point, normal: surface.normal, power, ..Photon::zeroed() });
                continue;
            }
            if bounces + 1 >= self.max_depth || size + 2 > MAX_BRANCHES {
                continue;
            }
            let t_min = spawn_epsilon(self.tracer.rules, surface.point, hit.t);
            let next =
                |direction, inside| Ray { origin: surface.point, direction, t_min, t_max: f32::INFINITY, inside };
            if material.reflection > 0.0 {
                let mirrored = next(reflect_at(ray.direction, surface.normal), ray.inside);
                open[size] = (mirrored, power * material.reflection, bounces + 1);
                size += 1;
            }
            let ratio = material.refraction_ratio;
            let bent = refract_at(ray.direction, surface.normal, ratio, self.tracer.rules);
            if let Some(direction) = bent.filter(|_| material.refraction > 0.0) {
                open[size] = (next(direction, !ray.inside), power * material.refraction, bounces + 1);
                size += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_sheet_of_photons_has_unit_density() {
        let sheet: Vec<Photon> = (0..100)
            .flat_map(|x| (0..100).map(move |y| Vec3::new(x as f32, y as f32, 0.0)))
            .map(|position| Photon { position, normal: Vec3::Z, power: Vec3::ONE, ..Photon::zeroed() })
            .collect();
        let map = PhotonMap::new(sheet, &Caustics { radius: 6.0, ..Caustics::default() });
        let density = map.gather(Vec3::new(50.3, 49.8, 0.0), Vec3::Z);
        assert!((density.x - 1.0).abs() < 0.05, "{density}");
        assert_eq!(map.gather(Vec3::new(50.0, 50.0, 0.0), Vec3::X), Vec3::ZERO);
        assert_eq!(map.gather(Vec3::new(500.0, 50.0, 0.0), Vec3::Z), Vec3::ZERO);
    }

    #[test]
    fn too_few_photons_show_nothing() {
        let few = vec![Photon { normal: Vec3::Z, power: Vec3::ONE, ..Photon::zeroed() }; 9];
        assert_eq!(PhotonMap::new(few, &Caustics::default()).gather(Vec3::ZERO, Vec3::Z), Vec3::ZERO);
    }
}
