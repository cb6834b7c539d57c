//! Points in a room: at random on its surfaces, and where the camera looks; VPLs there.

use crate::room::{HALF, Room, walls};
use glam::Vec3;
use lightcuts::rendering::Vpl;
use lightcuts::world::bvh::closest_hit;
use lightcuts_kernel::Rules;
use lightcuts_kernel::camera::camera_ray;
use lightcuts_kernel::ray::Ray;
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::surface::surface_at;

/// Distance of points from their surface, in scene units.
const OFFSET: f32 = 0.01;

/// A point a little off a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) position: Vec3,
    /// Unit normal, into the room.
    pub(crate) normal: Vec3,
}

impl Point {
    fn off(on: Vec3, normal: Vec3) -> Self {
        Self { position: on + normal * OFFSET, normal }
    }
}

impl Room {
    /// A random point: half of them lie on the walls, half on the body. `stream` tells purposes apart.
    pub(crate) fn point(&self, number: u32, stream: u32) -> Point {
        let [which, a, b, c] = random4(number, 0, 0, stream);
        if which < 0.5 {
            let [inwards, across, along] = walls()[(which * 12.0) as usize];
            let on_wall = across * (2.0 * a - 1.0) + along * (2.0 * b - 1.0) - inwards;
            return Point::off(on_wall * HALF, inwards);
        }
        let [p, q, r] = self.triangles[(c * self.triangles.len() as f32) as usize % self.triangles.len()];
        // The other half of the parallelogram is turned over.
        let (u, v) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        Point::off(p + (q - p) * u + (r - p) * v, (q - p).cross(r - p).normalize_or_zero())
    }

    /// So many VPLs at random points, all together as bright as one of intensity 1.
    pub(crate) fn vpls(&self, count: u32, stream: u32) -> Vec<Vpl> {
        let vpl = |number: u32| {
            let Point { position, normal } = self.point(number, stream);
            let [r, g, b, _] = random4(number, 1, 0, stream);
            let diffuse = Vec3::new(r, g, b) * 0.5 + 0.25;
            Vpl { position, direction: normal, diffuse, attenuation: 1.0 / count as f32, ..Vpl::default() }
        };
        (0..count).map(vpl).collect()
    }

    /// The camera's rays through the middles of all pixels, row by row.
    pub(crate) fn camera_rays(&self, width: u32, height: u32) -> Vec<Ray> {
        let camera = self.world.camera(width, height);
        let ray = |pixel: u32| camera_ray(&camera, pixel % width, pixel / width, [0.5; 2], Rules::Repaired);
        (0..width * height).map(ray).collect()
    }

    /// Where those rays arrive.
    pub(crate) fn seen(&self, rays: &[Ray]) -> Vec<Point> {
        let (geometry, surfaces) = (self.world.shapes.geometry(), self.world.shapes.surfaces());
        let arrive = |ray: &Ray| {
            let hit = closest_hit(&geometry, ray, Rules::Repaired);
            let surface = hit.is_some().then(|| surface_at(&surfaces, ray, &hit))?;
            Some(Point::off(surface.point, surface.normal))
        };
        rays.iter().filter_map(arrive).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_in_the_room_on_walls_and_body() {
        let room = Room::new(1_400).unwrap();
        let points: Vec<Point> = (0..2_000).map(|k| room.point(k, 7)).collect();
        assert!(points.iter().all(|it| it.position.abs().max_element() < HALF && it.normal.is_normalized()));
        let on_walls = points.iter().filter(|it| it.position.abs().max_element() > 99.0).count();
        assert!((900..1_100).contains(&on_walls), "{on_walls}");
    }

    #[test]
    fn the_camera_sees_body_and_walls() {
        let room = Room::new(1_400).unwrap();
        let seen = room.seen(&room.camera_rays(32, 32));
        assert_eq!(seen.len(), 1_024);
        let body = seen.iter().filter(|it| it.position.length() < 50.0).count();
        assert!((200..900).contains(&body), "{body}");
    }
}
