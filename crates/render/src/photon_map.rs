//! Photons that mirrors and glass throw onto matt surfaces, and their density there.
//!
//! The thesis program means to do this but stores nothing: it forgets the target after the first bounce. Here photons go
//! through a regular grid on the disk of each target's bounding sphere seen from each light, must meet the target first,
//! then follow mirrored and refracted rays to the first surface bright enough to show them.

use crate::cpu::Tracer;
use crate::monitor::{Monitor, Stage};
use crate::settings::Caustics;
use crate::stats::Rays;
use glam::{IVec3, Vec3};
use lightcuts_kernel::light::{DIRECTIONAL, HEMISPHERE, Light};
use lightcuts_kernel::optics::{reflect, refract};
use lightcuts_kernel::ray::{Ray, normalize, spawn_epsilon};
use lightcuts_kernel::sampling::frame;
use lightcuts_kernel::surface::surface_at;
use lightcuts_world::{ObjectBounds, World};
use rayon::prelude::*;

/// Most photons in all; a finer step is widened until they suffice.
const MAX_PHOTONS: usize = 1 << 26;

/// Most rays that one photon may split into.
const MAX_BRANCHES: usize = 64;

/// Light that fell on a point.
#[derive(Debug, Clone, Copy)]
struct Photon {
    position: Vec3,
    normal: Vec3,
    /// Colour times the area, in square scene units, that the photon stands for.
    power: Vec3,
}

/// Photons in cells as wide as the gathered radius.
#[derive(Debug, Default)]
pub(crate) struct PhotonMap {
    /// Cell and photon, sorted by cell and then in order of emission.
    photons: Vec<(IVec3, Photon)>,
    radius: f32,
    min_photons: u32,
}

fn cell_key(cell: &IVec3) -> [i32; 3] {
    cell.to_array()
}

impl PhotonMap {
    /// Shoots photons from every light at every mirror and glass object. A monitor that cancels gets those shot so far.
    pub(crate) fn shoot(
        world: &World,
        tracer: &Tracer<'_>,
        settings: &Caustics,
        max_depth: u32,
        rays: &mut Rays,
        monitor: &dyn Monitor,
    ) -> Self {
        let worth =
            |b: &ObjectBounds| b.reflection >= settings.min_reflection || b.refraction >= settings.min_refraction;
        let objects: Vec<(usize, &ObjectBounds)> =
            world.object_bounds.iter().enumerate().filter(|(_, bounds)| worth(bounds)).collect();
        let pairs = world.lights.len() * objects.len();
        let most_per_side = (MAX_PHOTONS / pairs.max(1)).isqrt().max(1) as u32;
        let step = settings.step;
        let targets: Vec<Target<'_>> = world
            .lights
            .iter()
            .flat_map(|light| objects.iter().map(move |&(object, bounds)| (light, object, bounds)))
            .map(|(light, object, bounds)| Target {
                light,
                bounds,
                object: object as u32 + 1,
                side: ((2.0 * bounds.radius / step).ceil().max(1.0) as u32).min(most_per_side),
            })
            .collect();
        monitor.begin(Stage::Photons, targets.iter().map(|target| u64::from(target.side)).sum());
        let mut photons = Vec::new();
        for target in &targets {
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
                rays.photon += count;
            }
        }
        monitor.end();
        Self::new(photons, settings.radius, settings.min_photons)
    }

    fn new(photons: Vec<Photon>, radius: f32, min_photons: u32) -> Self {
        let mut photons: Vec<(IVec3, Photon)> =
            photons.into_iter().map(|photon| ((photon.position / radius).floor().as_ivec3(), photon)).collect();
        // Stable: equal cells keep the order of emission, so that sums are reproducible.
        photons.sort_by_key(|(cell, _)| cell_key(cell));
        Self { photons, radius, min_photons }
    }

    pub(crate) fn len(&self) -> usize {
        self.photons.len()
    }

    /// Light per area around a point on a surface with this normal, relative to the unfocused light; zero with too few
    /// photons.
    pub(crate) fn gather(&self, point: Vec3, normal: Vec3) -> Vec3 {
        let cell = (point / self.radius).floor().as_ivec3();
        let mut sum = Vec3::ZERO;
        let mut count = 0;
        for x in -1..=1 {
            for y in -1..=1 {
                for z in -1..=1 {
                    let key = cell_key(&IVec3::new(
                        cell.x.saturating_add(x),
                        cell.y.saturating_add(y),
                        cell.z.saturating_add(z),
                    ));
                    let start = self.photons.partition_point(|(c, _)| cell_key(c) < key);
                    for (_, photon) in self.photons[start..].iter().take_while(|(c, _)| cell_key(c) == key) {
                        let near = (photon.position - point).length_squared() <= self.radius * self.radius;
                        // Photons on the other side of an edge or of a thin wall do not light this side.
                        if near && photon.normal.dot(normal) > 0.5 {
                            sum += photon.power;
                            count += 1;
                        }
                    }
                }
            }
        }
        let area = std::f32::consts::PI * self.radius * self.radius;
        if count < self.min_photons { Vec3::ZERO } else { sum / area }
    }
}

/// A light and an object to shoot at.
struct Target<'a> {
    light: &'a Light,
    bounds: &'a ObjectBounds,
    object: u32,
    /// Photons across the disk.
    side: u32,
}

impl Target<'_> {
    /// The ray through a point of the grid, and the area of disk that it stands for, if the light shines there.
    fn ray(&self, row: u32, column: u32) -> Option<(Ray, f32)> {
        let spacing = 2.0 * self.bounds.radius / self.side as f32;
        let axis = match self.light.kind {
            DIRECTIONAL => self.light.direction,
            _ => normalize(self.bounds.center - self.light.position),
        };
        let (right, up) = frame(axis);
        let at = |index: u32| (index as f32 + 0.5) * spacing - self.bounds.radius;
        let (x, y) = (at(column), at(row));
        if x * x + y * y > self.bounds.radius * self.bounds.radius || axis == Vec3::ZERO {
            return None;
        }
        let on_disk = self.bounds.center + right * x + up * y;
        let (origin, direction) = match self.light.kind {
            DIRECTIONAL => (on_disk - axis * FAR_SIDE * self.bounds.radius.max(on_disk.abs().max_element()), axis),
            _ => (self.light.position, normalize(on_disk - self.light.position)),
        };
        let cosine = if self.light.kind == HEMISPHERE { self.light.direction.dot(direction) } else { 1.0 };
        let ray = Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, inside: false };
        (cosine > 0.0).then_some((ray, spacing * spacing * cosine))
    }
}

/// How many times the larger of a target's radius and distance from the origin parallel light starts before it.
const FAR_SIDE: f32 = 4.0;

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
    fn emit(&mut self, target: &Target<'_>, row: u32, column: u32) {
        let Some((ray, area)) = target.ray(row, column) else { return };
        let power = target.light.diffuse * (target.light.attenuation * area);
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
            let surface = surface_at(&self.world.surfaces(), &ray, &hit);
            if bounces == 0 && surface.object != target.object {
                continue;
            }
            let material = &self.world.materials[surface.material as usize];
            if bounces > 0 && !ray.inside && material.diffuse.element_sum() >= self.settings.min_diffuse {
                self.found.push(Photon { position: surface.point, normal: surface.normal, power });
                continue;
            }
            if bounces + 1 >= self.max_depth || size + 2 > MAX_BRANCHES {
                continue;
            }
            let t_min = spawn_epsilon(self.tracer.rules, surface.point, hit.t);
            let next =
                |direction, inside| Ray { origin: surface.point, direction, t_min, t_max: f32::INFINITY, inside };
            if material.reflection > 0.0 {
                let mirrored = next(reflect(ray.direction, surface.normal), ray.inside);
                open[size] = (mirrored, power * material.reflection, bounces + 1);
                size += 1;
            }
            let ratio = material.refraction_ratio;
            let bent = refract(ray.direction, surface.normal, ratio, self.tracer.rules);
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
            .map(|position| Photon { position, normal: Vec3::Z, power: Vec3::ONE })
            .collect();
        let map = PhotonMap::new(sheet, 6.0, 10);
        let density = map.gather(Vec3::new(50.3, 49.8, 0.0), Vec3::Z);
        assert!((density.x - 1.0).abs() < 0.05, "{density}");
        assert_eq!(map.gather(Vec3::new(50.0, 50.0, 0.0), Vec3::X), Vec3::ZERO);
        assert_eq!(map.gather(Vec3::new(500.0, 50.0, 0.0), Vec3::Z), Vec3::ZERO);
    }

    #[test]
    fn too_few_photons_show_nothing() {
        let few = vec![Photon { position: Vec3::ZERO, normal: Vec3::Z, power: Vec3::ONE }; 9];
        assert_eq!(PhotonMap::new(few, 4.0, 10).gather(Vec3::ZERO, Vec3::Z), Vec3::ZERO);
    }
}
