//! Caustics: light that comes by focused lobes (mirrors, smooth glass and metal) onto other surfaces, by photons
//! (Jensen 1996).
//!
//! Paths from the camera meet it by chance only, and that of point lights in mirrors never. Each pass shoots photons
//! anew and counts them in a disk around each point; the disk shrinks from pass to pass, so that the mean of all passes
//! converges (Knaus & Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach"). What photons bring is left
//! out of paths: see `PrevVertex`.

use super::emission::Origins;
use super::light_path::{Arrival, trace_light};
use super::lightcuts::LEAST_GATHERED_ALPHA;
use super::scene::{Interaction, Scene};
use glam::{IVec3, Vec3};
use lightcuts_kernel::bsdf::{CONDUCTOR, DIELECTRIC, DIFFUSE, GLOSSY, SPECULAR, lobes_of};
use lightcuts_kernel::photon_gather::photon_cell;
use lightcuts_kernel::rng::hash4;
use std::f32::consts::PI;

/// Radius of the disk in the first pass, relative to the scene's diagonal.
const FIRST_RADIUS: f32 = 0.008;

/// What a pass leaves of the disk's area: (k + this) / (k + 1) after pass k.
const SHRINKAGE: f32 = 2.0 / 3.0;

/// Least cosine between the normals of a photon and of the point that it lights: edges and thin walls keep light to one
/// side.
const LEAST_AGREEMENT: f32 = 0.7;

/// How far a photon may be above or below the disk, relative to its radius.
const THICKNESS: f32 = 0.3;

/// Light that came by focused lobes.
#[derive(Debug, Clone, Copy)]
struct Photon {
    position: Vec3,
    /// Unit normal of the surface, on the side that is lit.
    normal: Vec3,
    /// Where it came from.
    direction: Vec3,
    /// In W, of all paths together.
    power: Vec3,
}

/// The photons of a pass, in cells as wide as the disk: it reaches two of each axis.
#[derive(Debug, Clone)]
pub(crate) struct CausticMap {
    /// By the number of their cell.
    photons: Vec<Photon>,
    /// First photon of each number, and their end. The length without the end is a power of two.
    starts: Vec<u32>,
    radius: f32,
    rays: u64,
}

/// Radius of the disk in a pass, counted from 0, relative to the scene's diagonal.
fn radius_of(pass: u32) -> f32 {
    let shrink = |area: f32, k: u32| area * (k as f32 + SHRINKAGE) / (k as f32 + 1.0);
    FIRST_RADIUS * (1..=pass).fold(1.0, shrink).sqrt()
}

impl CausticMap {
    /// Shoots a fixed number of photons for a pass. Once `is_over`, they are of no use.
    pub(crate) fn shoot(
        scene: &Scene<'_>,
        origins: &Origins,
        paths: u32,
        stream: u32,
        pass: u32,
        is_over: &(dyn Fn() -> bool + Sync),
    ) -> Self {
        let (lower, upper) = scene.world.bounds;
        let radius = radius_of(pass) * (upper - lower).length();
        let left = trace_light(scene, origins, paths, stream, is_focused, photon, is_over);
        Self { rays: left.rays, ..Self::sort(&left.items, radius) }
    }

    pub(crate) fn rays(&self) -> u64 {
        self.rays
    }

    pub(crate) fn photons(&self) -> usize {
        self.photons.len()
    }

    /// Sorts photons by the numbers of their cells.
    fn sort(photons: &[Photon], radius: f32) -> Self {
        let numbers = (photons.len() * 2).next_power_of_two();
        let number = |photon: &Photon| number_of(photon_cell(photon.position, 2.0 * radius), numbers);
        let mut starts = vec![0; numbers + 1];
        for photon in photons {
            starts[number(photon) + 1] += 1;
        }
        for k in 0..numbers {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let mut sorted = photons.to_vec();
        for photon in photons {
            let place = &mut next[number(photon)];
            sorted[*place as usize] = *photon;
            *place += 1;
        }
        Self { photons: sorted, starts, radius, rays: 0 }
    }

    /// Light that photons bring to a point; `value` is the BSDF times the cosine for a direction.
    pub(crate) fn gather(&self, at: &Interaction, value: impl Fn(Vec3) -> Vec3) -> Vec3 {
        if self.photons.is_empty() || !spreads(at) {
            return Vec3::ZERO;
        }
        let radius_sq = self.radius * self.radius;
        let mut sum = Vec3::ZERO;
        self.around(at.point, |photon| {
            let offset = photon.position - at.point;
            let is_near = offset.length_squared() <= radius_sq
                && offset.dot(at.face).abs() <= self.radius * THICKNESS
                && photon.normal.dot(at.face).abs() >= LEAST_AGREEMENT;
            if is_near {
                // The disk has counted the cosine to the surface already.
                let cos = at.face.dot(photon.direction).abs().max(1e-3);
                sum += value(photon.direction) * photon.power / cos;
            }
        });
        sum / (PI * radius_sq)
    }

    /// Visits the photons of the cells that the disk around a point may reach, each once.
    fn around(&self, point: Vec3, mut visit: impl FnMut(&Photon)) {
        let numbers = self.starts.len() - 1;
        let cell_of = |place: Vec3| photon_cell(place, 2.0 * self.radius);
        let reach = Vec3::splat(self.radius);
        let (first, last) = (cell_of(point - reach), cell_of(point + reach));
        for x in first.x..=last.x {
            for y in first.y..=last.y {
                for z in first.z..=last.z {
                    let cell = IVec3::new(x, y, z);
                    let number = number_of(cell, numbers);
                    for photon in &self.photons[self.starts[number] as usize..self.starts[number + 1] as usize] {
                        // Cells that share a number are told apart.
                        if cell_of(photon.position) == cell {
                            visit(photon);
                        }
                    }
                }
            }
        }
    }
}

/// The number of a cell, below a power of two.
fn number_of(cell: IVec3, numbers: usize) -> usize {
    let [hash, ..] = hash4([cell.x as u32, cell.y as u32, cell.z as u32, 0]);
    hash as usize & (numbers - 1)
}

/// Whether a surface is a metal or glass that is so smooth that paths would find lights in it by chance.
fn is_smooth(at: &Interaction) -> bool {
    matches!(at.bsdf.kind, CONDUCTOR | DIELECTRIC) && at.bsdf.alpha < LEAST_GATHERED_ALPHA
}

/// Whether a lobe of a surface sends light in a single direction, or nearly so.
pub(crate) fn is_focused(at: &Interaction, lobe: u32) -> bool {
    lobe == SPECULAR || is_smooth(at)
}

/// Whether a surface shows caustics: it has a lobe that is not focused.
pub(crate) fn spreads(at: &Interaction) -> bool {
    lobes_of(&at.bsdf) & (DIFFUSE | GLOSSY) != 0 && !is_smooth(at)
}

/// The photon of light that arrives: it came by focused lobes to a surface that spreads it.
fn photon(arrival: &Arrival<'_>) -> Option<Photon> {
    let Arrival { at, from, power, bounces, .. } = *arrival;
    let side = 1.0_f32.copysign(at.face.dot(from));
    (bounces > 0 && spreads(at) && power.is_finite()).then(|| Photon {
        position: at.point,
        normal: at.face * side,
        direction: from,
        power,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::rng::random4;

    fn photon_at(position: Vec3) -> Photon {
        Photon { position, normal: Vec3::Y, direction: Vec3::Y, power: Vec3::ONE }
    }

    #[test]
    fn every_photon_of_the_disk_is_visited_once() {
        let photons: Vec<Photon> = (0..5000)
            .map(|k| {
                let [x, y, z, _] = random4(k, 0, 0, 3);
                photon_at(Vec3::new(x, y, z) - 0.5)
            })
            .collect();
        let map = CausticMap::sort(&photons, 0.07);
        for k in 0..200 {
            let [x, y, z, _] = random4(k, 1, 0, 3);
            let point = Vec3::new(x, y, z) - 0.5;
            let is_near = |photon: &Photon| photon.position.distance(point) <= 0.07;
            let mut found = 0;
            map.around(point, |photon| found += u32::from(is_near(photon)));
            assert_eq!(found as usize, photons.iter().filter(|photon| is_near(photon)).count());
        }
    }

    #[test]
    fn disks_shrink_as_they_must() {
        // The area falls as the number of passes to the power of -1/3, so that bias vanishes and variance too.
        let area = |pass: u32| (radius_of(pass) / FIRST_RADIUS).powi(2);
        assert_eq!(area(0), 1.0);
        let exponent = (area(8000) / area(1000)).ln() / 8.0_f32.ln();
        assert!((exponent + 1.0 / 3.0).abs() < 0.01, "{exponent}");
    }
}
