//! Records with plausible values.

use crate::functions::case::Case;
use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::camera::Camera;
use lightcuts_kernel::filter::PixelFilter;
use lightcuts_kernel::intersect::{Sphere, Square, Triangle};
use lightcuts_kernel::light::{Light, Vpl};
use lightcuts_kernel::light_tree::LightCluster;
use lightcuts_kernel::material::Material;
use lightcuts_kernel::packed_tree::{empty_cluster, unpack_axis, vpl_cluster};
use lightcuts_kernel::photon::PhotonTarget;
use lightcuts_kernel::ray::{Hit, Ray};

impl Case<'_> {
    /// A ray that passes a point, or its neighbourhood, with either end before or behind it.
    pub(crate) fn ray_to(&self, target: Vec3) -> Ray {
        self.take(|| {
            let origin = if self.choice(8) == 0 { target } else { self.raw_point() };
            let off = if self.choice(2) == 0 { 1e-5 } else { 0.1 };
            let miss = (Vec3::new(self.random(), self.random(), self.random()) - 0.5) * off;
            let direction = match self.choice(8) {
                0 => self.raw_direction(),
                1 => target - origin,
                _ => target + miss * (target - origin).length() - origin,
            };
            let t_min = [0.0, 0.001, 2e-5, 0.5 * self.random()][self.choice(4)];
            let t_max = [1.0, 2.0, f32::MAX, self.random()][self.choice(4)];
            Ray { origin, direction, t_min, t_max, inside: self.choice(2) == 0 }
        })
    }

    pub(crate) fn hit(&self) -> Hit {
        let t = self.positive();
        Hit { t, primitive: self.below(6), u: self.fraction(), v: self.fraction() }
    }

    pub(crate) fn triangle(&self) -> Triangle {
        self.take(|| {
            let (corner, primitive) = (self.raw_point(), self.choice(1000) as u32);
            let (edge1, edge2) = (self.raw_point(), self.raw_point());
            Triangle { corner, primitive, edge1, edge2, ..Triangle::zeroed() }
        })
    }

    pub(crate) fn sphere(&self) -> Sphere {
        self.take(|| {
            let radius = [self.random(), 1.0, 10.0 * self.random(), 0.01][self.choice(4)];
            Sphere { center: self.raw_point(), radius, primitive: self.choice(1000) as u32, padding: [0; 3] }
        })
    }

    pub(crate) fn square(&self) -> Square {
        self.take(|| {
            let (normal, side) = (self.raw_direction(), self.raw_direction());
            let across = side.cross(normal).normalize_or(Vec3::X);
            let [half_height, half_width] = [0; 2].map(|_| [self.random(), 1.0, 5.0][self.choice(3)]);
            let (center, along) = (self.raw_point(), normal.cross(across));
            Square { center, half_height, normal, half_width, along, primitive: 7, across, padding: 0 }
        })
    }

    pub(crate) fn camera(&self) -> Camera {
        self.take(|| {
            let (view, up) = (self.raw_direction(), self.raw_direction());
            let right = view.cross(up).normalize_or(Vec3::X);
            let pitch = [0.01, 0.02, 0.01 * self.random()][self.choice(3)];
            let eye_distance = [0.0, 10.0, 5.0 * self.random()][self.choice(3)];
            let [width, height] = [0; 2].map(|_| 1 + self.choice(4096) as u32);
            Camera { center: self.raw_point(), pitch, view, eye_distance, right, width, up: right.cross(view), height }
        })
    }

    pub(crate) fn light(&self) -> Light {
        self.take(|| Light {
            position: self.raw_point(),
            kind: self.choice(3) as u32,
            direction: self.raw_direction(),
            attenuation: self.random(),
            specular: self.raw_color(),
            diffuse: self.raw_color(),
            ambient: self.raw_color(),
            ..Light::zeroed()
        })
    }

    pub(crate) fn vpl(&self) -> Vpl {
        self.take(|| self.raw_vpl())
    }

    fn raw_vpl(&self) -> Vpl {
        let (position, direction) = (self.raw_point(), self.raw_direction());
        Vpl { position, direction, attenuation: self.random(), diffuse: self.raw_color(), ..Vpl::zeroed() }
    }

    pub(crate) fn material(&self) -> Material {
        self.take(|| Material {
            specular: self.raw_color(),
            exponent: [0.0, 1.0, 20.0, 200.0 * self.random()][self.choice(4)],
            diffuse: self.raw_color(),
            ambient: self.raw_color(),
            ..Material::zeroed()
        })
    }

    pub(crate) fn cluster(&self) -> LightCluster {
        self.take(|| self.raw_cluster())
    }

    /// A cluster of one VPL, of a box of them, or of none.
    pub(crate) fn raw_cluster(&self) -> LightCluster {
        let one = vpl_cluster(&self.raw_vpl());
        match self.choice(16) {
            0 => return empty_cluster(),
            1..4 => return one,
            _ => {}
        }
        let other = self.raw_point();
        let cos_spread: f32 = [1.0, -1.0, 2.0 * self.random() - 1.0][self.choice(3)];
        LightCluster {
            lower: one.lower.min(other),
            upper: one.upper.max(other),
            axis: if self.choice(16) == 0 { Vec3::ZERO } else { unpack_axis(self.choice(1 << 23) as u32 * 509) },
            cos_spread,
            sin_spread: (1.0 - cos_spread * cos_spread).max(0.0).sqrt(),
            min_intensity: one.max_intensity * self.random(),
            ..one
        }
    }

    pub(crate) fn pixel_filter(&self) -> PixelFilter {
        self.take(|| PixelFilter {
            kind: self.choice(4) as u32,
            radius: [0.5, 1.0, 2.0, 3.0 * self.random() + 0.1][self.choice(4)],
            alpha: [2.0, 5.0 * self.random()][self.choice(2)],
            mitchell_b: [1.0 / 3.0, self.random()][self.choice(2)],
            mitchell_c: [1.0 / 3.0, self.random()][self.choice(2)],
            padding: [0; 3],
        })
    }

    pub(crate) fn photon_target(&self) -> PhotonTarget {
        self.take(|| {
            let radius = [1.0, 10.0 * self.random() + 1e-3][self.choice(2)];
            let side = 1 + self.choice(1000) as u32;
            PhotonTarget { center: self.raw_point(), radius, light: 0, object: 1, side, padding: 0 }
        })
    }
}
