//! The thesis' camera: a view plane with a fixed pixel pitch, rays that start on it.

use crate::Rules;
use crate::ray::{ORIGINAL_EPSILON, Ray, normalize_or_zero};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Pixel pitch on the view plane at the thesis' size of 512 x 512, in scene units.
pub const PIXEL_PITCH: f32 = 0.01;

/// Pixels across the thesis' view plane.
pub const THESIS_SIZE: u32 = 512;

/// The view. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Camera {
    /// Centre of the view plane, in scene units.
    pub center: Vec3,
    /// Pixel pitch on the view plane, in scene units.
    pub pitch: f32,
    /// Unit view direction.
    pub view: Vec3,
    /// Distance of the eye behind the plane in scene units; 0 for parallel rays.
    pub eye_distance: f32,
    /// Unit vector to the right of the picture: view x up.
    pub right: Vec3,
    /// Picture width in pixels.
    pub width: u32,
    /// Unit vector to the top of the picture.
    pub up: Vec3,
    /// Picture height in pixels.
    pub height: u32,
}

/// The ray through pixel (i, j), j counted from the bottom, moved by `shift` pixels to the right and up.
pub fn camera_ray(camera: &Camera, i: u32, j: u32, shift: [f32; 2], rules: Rules) -> Ray {
    let on_plane = |index: u32, size: u32| (index as f32 - size as f32 / 2.0) * camera.pitch;
    let pixel = camera.center + camera.right * on_plane(i, camera.width) + camera.up * on_plane(j, camera.height);
    let origin = pixel + camera.right * (shift[0] * camera.pitch) + camera.up * (shift[1] * camera.pitch);
    let direction = if camera.eye_distance > 0.0 {
        normalize_or_zero(origin - (camera.center - camera.view * camera.eye_distance))
    } else {
        camera.view
    };
    let t_min = match rules {
        Rules::Original => ORIGINAL_EPSILON,
        Rules::Repaired => 0.0,
    };
    Ray { origin, direction, t_min, t_max: f32::INFINITY, inside: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(eye_distance: f32) -> Camera {
        Camera {
            center: Vec3::new(0.0, 0.0, 960.0),
            pitch: PIXEL_PITCH,
            view: Vec3::NEG_Z,
            eye_distance,
            right: Vec3::X,
            width: 512,
            up: Vec3::Y,
            height: 512,
        }
    }

    #[test]
    fn the_field_of_view_is_the_thesis() {
        let left = camera_ray(&camera(10.0), 0, 256, [0.0; 2], Rules::Repaired);
        let degrees = 2.0 * (-left.direction.x / -left.direction.z).atan().to_degrees();
        assert!((degrees - 28.72).abs() < 0.01, "{degrees}");
        assert_eq!(left.origin, Vec3::new(-2.56, 0.0, 960.0));
    }

    #[test]
    fn parallel_rays_share_their_direction() {
        let ray = camera_ray(&camera(0.0), 511, 0, [0.5, -0.5], Rules::Repaired);
        assert_eq!(ray.direction, Vec3::NEG_Z);
        assert!((ray.origin - Vec3::new(2.555, -2.565, 960.0)).length() < 1e-5);
    }
}
