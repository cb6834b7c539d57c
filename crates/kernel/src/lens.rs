//! The camera of the physical model: a pinhole, a thin lens, or parallel rays.

use crate::ray::{Ray, normalize_or_zero};
use crate::sampling::sin_cos_turns;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A view. 80 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Lens {
    /// Where rays begin, in scene units: the camera, or a place before it.
    pub position: Vec3,
    /// Half the picture's height: at distance 1, or in scene units for parallel rays.
    pub half_height: f32,
    /// Unit view direction.
    pub forward: Vec3,
    /// Distance from there along `forward` from which on surfaces are seen, in scene units.
    pub near: f32,
    /// Unit vector to the right of the picture.
    pub right: Vec3,
    /// Radius of the lens, in scene units; 0 for a pinhole.
    pub radius: f32,
    /// Unit vector to the top of the picture.
    pub up: Vec3,
    /// Distance of the plane that is sharp, along `forward`, in scene units.
    pub focus: f32,
    /// Whether rays are parallel.
    pub is_orthographic: u32,
    /// Picture width in pixels.
    pub width: u32,
    /// Picture height in pixels.
    pub height: u32,
    /// How far before the camera parallel rays begin, in scene units: where the scene does, if that is far.
    pub ahead: f32,
}

/// The ray through a place of the picture, in pixels from its lower left corner; `random` is the place on the lens.
pub fn lens_ray(lens: &Lens, place: [f32; 2], random: [f32; 2]) -> Ray {
    let pitch = 2.0 * lens.half_height / lens.height as f32;
    let x = (place[0] - lens.width as f32 * 0.5) * pitch;
    let y = (place[1] - lens.height as f32 * 0.5) * pitch;
    let across = lens.right * x + lens.up * y;
    // A direction whose part along the view is 1: the parameter is the distance along the view.
    let (start, slope) =
        if lens.is_orthographic != 0 { (lens.position + across, Vec3::ZERO) } else { (lens.position, across) };
    let (mut origin, mut direction) = (start, lens.forward + slope);
    if lens.radius > 0.0 {
        let (sin, cos) = sin_cos_turns(random[1]);
        let shift = (lens.right * cos + lens.up * sin) * (lens.radius * random[0].sqrt());
        let focus = start + direction * lens.focus;
        origin = start + shift;
        direction = (focus - origin) * (1.0 / lens.focus);
    }
    let length = direction.length();
    Ray {
        origin,
        direction: normalize_or_zero(direction),
        t_min: lens.near * length,
        t_max: f32::INFINITY,
        inside: false,
    }
}

/// Angle of a pixel at the middle of the picture, in radians; 0 for parallel rays.
pub fn pixel_spread(lens: &Lens) -> f32 {
    if lens.is_orthographic != 0 { 0.0 } else { 2.0 * lens.half_height / lens.height as f32 }
}

/// Width of a pixel where rays begin, in scene units: 0 but for parallel rays.
pub fn pixel_width(lens: &Lens) -> f32 {
    if lens.is_orthographic != 0 { 2.0 * lens.half_height / lens.height as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens() -> Lens {
        Lens {
            position: Vec3::new(1.0, 2.0, 3.0),
            half_height: 0.5,
            forward: Vec3::NEG_Z,
            right: Vec3::X,
            up: Vec3::Y,
            focus: 4.0,
            width: 200,
            height: 100,
            ..Lens::zeroed()
        }
    }

    #[test]
    fn the_middle_looks_forward_and_the_corner_sees_the_corner() {
        let middle = lens_ray(&lens(), [100.0, 50.0], [0.0; 2]);
        assert_eq!((middle.origin, middle.direction), (Vec3::new(1.0, 2.0, 3.0), Vec3::NEG_Z));
        let corner = lens_ray(&lens(), [200.0, 100.0], [0.0; 2]).direction;
        assert!((corner / -corner.z - Vec3::new(1.0, 0.5, -1.0)).length() < 1e-6);
    }

    #[test]
    fn every_ray_of_a_lens_meets_the_sharp_plane_at_one_point() {
        let lens = Lens { radius: 0.3, near: 1.0, ..lens() };
        let at = |random| {
            let ray = lens_ray(&lens, [37.0, 81.0], random);
            assert!((ray.t_min * ray.direction.z + 1.0).abs() < 1e-4);
            ray.origin + ray.direction * (-4.0 / ray.direction.z)
        };
        let first = at([0.0, 0.0]);
        for k in 0..16 {
            assert!((at([k as f32 / 16.0, 0.37 * k as f32 % 1.0]) - first).length() < 1e-5);
        }
    }

    #[test]
    fn parallel_rays_start_apart() {
        let lens = Lens { is_orthographic: 1, ..lens() };
        let ray = lens_ray(&lens, [200.0, 0.0], [0.0; 2]);
        assert_eq!((ray.direction, ray.origin), (Vec3::NEG_Z, Vec3::new(2.0, 1.5, 3.0)));
    }
}
