//! Batches of rays in a room: incoherent ones, those of a camera, and those that ask for light.

use super::methods::Method;
use crate::room::Room;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::{Ray, shadow_ray};

/// Lights that each point asks for.
const LIGHTS: u32 = 16;
/// Distance of a shadow ray from both surfaces, in scene units, beyond that of points.
const SPACING: f32 = 0.001;
/// Width and height of a block of neighbouring pixels: as many as a packet has rays.
const BLOCK: [u32; 2] = [4, 2];
/// Streams of random numbers.
const STARTS: u32 = 41;
const ENDS: u32 = 42;
const VPLS: u32 = 43;

/// Embree's millions of rays per second, for rooms of 1.4, 100 and 1000 thousand triangles.
type Embree = Option<[f64; 3]>;

/// Rays of one kind; every eight that follow each other may be a packet.
pub(super) struct Batch {
    pub(super) title: &'static str,
    pub(super) rays: Vec<Ray>,
    /// Whether any hit will do, or the nearest is wanted.
    pub(super) is_any: bool,
    /// Whether packets are measured too.
    pub(super) has_packets: bool,
    /// Embree's figures of another day for single rays and packets.
    embree: [Embree; 2],
}

impl Batch {
    /// Embree's figure of another day, for a room of about as many triangles.
    pub(super) fn embree(&self, method: Method, triangles: u64) -> Option<f64> {
        let of_method = match method {
            Method::Obvhs | Method::Embree | Method::EmbreePackets => None,
            Method::Single => self.embree[0],
            Method::Packets => self.embree[1],
        };
        let room = match triangles {
            1_000..=2_000 => 0,
            90_000..=110_000 => 1,
            900_000..=1_100_000 => 2,
            _ => return None,
        };
        of_method.map(|rates| rates[room])
    }
}

/// All batches, each of `number` rays, a power of two of at least 2^10.
pub(super) fn batches(room: &Room, number: u32) -> [Batch; 4] {
    let incoherent = (0..number).map(|k| between(room.point(k, STARTS).position, room.point(k, ENDS).position));
    let primary = in_blocks(&room.camera_rays(width(number), number / width(number)), width(number));
    let seen: Vec<Vec3> = room.seen(&primary).iter().map(|point| point.position).collect();
    let lights: Vec<Vec3> = room.vpls(LIGHTS, VPLS).iter().map(|vpl| vpl.position).collect();
    let stride = LIGHTS as usize;
    let to_lights =
        seen.iter().step_by(stride).flat_map(|&point| lights.iter().map(move |&light| between(point, light)));
    let blocks = seen.chunks(8).zip(lights.iter().cycle());
    let to_one = blocks.flat_map(|(points, &light)| points.iter().map(move |&point| between(point, light)));
    let batch = |title, is_any, has_packets, embree, rays| Batch { title, rays, is_any, has_packets, embree };
    let (singles, single16) = (Some([11.1, 5.3, 5.3]), Some([16.4, 7.1, 8.2]));
    [
        batch("incoherent, any", true, false, [singles, None], incoherent.collect()),
        batch("one point to 16 lights, any", true, true, [None, Some([17.0, 6.0, 6.3])], to_lights.collect()),
        batch("8 neighbours to one light, any", true, true, [None; 2], to_one.collect()),
        batch("primary, nearest", false, true, [single16, Some([101.0, 50.0, 48.0])], primary),
    ]
}

/// The width of a picture of so many pixels, a power of two.
fn width(pixels: u32) -> u32 {
    1 << pixels.ilog2().div_ceil(2)
}

/// A picture's rays block by block.
fn in_blocks(rays: &[Ray], width: u32) -> Vec<Ray> {
    let [across, down] = BLOCK;
    let height = rays.len() as u32 / width;
    let corners = (0..height / down).flat_map(|j| (0..width / across).map(move |i| (i * across, j * down)));
    let pixels = corners.flat_map(|(x, y)| (0..across * down).map(move |k| (x + k % across, y + k / across)));
    pixels.map(|(x, y)| rays[(y * width + x) as usize]).collect()
}

/// The ray that asks what is between two points.
fn between(from: Vec3, to: Vec3) -> Ray {
    shadow_ray(Rules::Repaired, from, to - from, SPACING)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_are_whole_packets() {
        let room = Room::new(1_400).unwrap();
        for number in [1 << 10, 1 << 11] {
            assert!(batches(&room, number).iter().all(|batch| batch.rays.len() == number as usize));
        }
    }

    #[test]
    fn blocks_keep_every_ray() {
        let ray = |k: u32| Ray { origin: Vec3::splat(k as f32), ..between(Vec3::ZERO, Vec3::X) };
        let rays: Vec<Ray> = (0..64).map(ray).collect();
        let mut found: Vec<f32> = in_blocks(&rays, 8).iter().map(|ray| ray.origin.x).collect();
        assert_eq!(found[..8], [0.0, 1.0, 2.0, 3.0, 8.0, 9.0, 10.0, 11.0]);
        found.sort_by(f32::total_cmp);
        assert_eq!(found, (0..64).map(|k| k as f32).collect::<Vec<_>>());
    }
}
