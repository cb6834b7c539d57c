//! Batches of rays in a room, as coherent as those of a render and as incoherent as can be.

use super::setup::Setup;
use crate::room::Room;
use glam::Vec3;
use lightcuts::gpu::records::ProbeRay;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::{Ray, shadow_ray};

/// VPLs of the rays from points to lights: about as many as a point can have chosen.
pub(super) const LIGHTS: u32 = 1024;
/// Distance of a shadow ray from both surfaces, in scene units, beyond that of points.
const SPACING: f32 = 0.001;
/// Streams of random numbers.
const STARTS: u32 = 11;
const ENDS: u32 = 12;
pub(super) const VPLS: u32 = 13;

/// Rays of a batch: a power of two that keeps the device busy, and a software driver not too long.
pub(super) fn number(setup: &Setup) -> u32 {
    match (setup.is_software(), setup.is_quick) {
        (false, _) => 1 << 20,
        (true, false) => 1 << 17,
        (true, true) => 1 << 15,
    }
}

/// Batches of rays, each with its name and whether any hit will do.
pub(super) fn batches(room: &Room, number: u32) -> [(&'static str, bool, Vec<ProbeRay>); 3] {
    let (width, height) = picture(number);
    let camera_rays = room.camera_rays(width, height);
    let primary = camera_rays.iter().map(probe).collect();
    let segments = (0..number).map(|k| between(room.point(k, STARTS).position, room.point(k, ENDS).position)).collect();
    // A block of the picture's middle row: points beside each other.
    let points = (number / LIGHTS) as usize;
    let start = camera_rays.len() / 2;
    let points = room.seen(&camera_rays[start..start + points]);
    let lights = room.vpls(LIGHTS, VPLS);
    let to_lights = points.iter().flat_map(|point| lights.iter().map(|vpl| between(point.position, vpl.position)));
    [
        ("primary, nearest", false, primary),
        ("incoherent, any", true, segments),
        ("to lights, any", true, to_lights.collect()),
    ]
}

/// Width and height of a picture of so many pixels, a power of two.
fn picture(pixels: u32) -> (u32, u32) {
    let height = 1 << (pixels.ilog2() / 2);
    (pixels / height, height)
}

/// The ray that asks what is between two points.
fn between(from: Vec3, to: Vec3) -> ProbeRay {
    probe(&shadow_ray(Rules::Repaired, from, to - from, SPACING))
}

fn probe(ray: &Ray) -> ProbeRay {
    ProbeRay { origin: ray.origin, t_min: ray.t_min, direction: ray.direction, t_max: ray.t_max }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_have_their_number_of_rays() {
        let room = Room::new(1_400).unwrap();
        for (title, _, rays) in batches(&room, 1 << 13) {
            assert_eq!(rays.len(), 1 << 13, "{title}");
        }
        assert_eq!((picture(1 << 17), picture(1 << 20)), ((512, 256), (1024, 1024)));
    }

    #[test]
    fn rays_between_points_end_before_both() {
        let ray = between(Vec3::ZERO, Vec3::X * 2.0);
        assert!(ray.t_min > 0.0 && ray.t_max < 1.0 && ray.t_max > 0.99, "{ray:?}");
    }
}
