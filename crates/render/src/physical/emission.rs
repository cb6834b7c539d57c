//! Where light paths begin: at a light drawn by its power.

use super::randoms::Randoms;
use super::scene::Scene;
use glam::Vec3;
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::emitter::{
    Emitter, PARALLEL, POINT, RECTANGLE_LIGHT, SPHERE_LIGHT, SPOT, TRIANGLE_LIGHT, emitter_power, spot_falloff,
};
use lightcuts_kernel::environment::{environment_radiance, interval_of, sample_environment};
use lightcuts_kernel::ray::{NONE, Ray};
use lightcuts_kernel::rounding::plane_error;
use lightcuts_kernel::sampling::{frame, sample_cosine_cone, sin_cos_turns};
use std::f32::consts::PI;

/// How lights are drawn as origins of light paths.
pub(crate) struct Origins {
    /// Sums of the lights' shares, from 0 to 1: each emitter, and the environment after them.
    sums: Vec<f32>,
    center: Vec3,
    /// Radius of a sphere around the scene.
    radius: f32,
}

/// The first piece of a light path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Departure {
    pub(crate) ray: Ray,
    /// Power that it carries, over the density of all choices, in W.
    pub(crate) power: Vec3,
}

impl Origins {
    /// `None` if nothing shines.
    pub(crate) fn new(scene: &Scene<'_>) -> Option<Self> {
        let world = scene.world;
        let (lower, upper) = world.bounds;
        let radius = (upper - lower).length() * 0.5 * (1.0 + 1e-4);
        let disk = PI * radius * radius;
        let of_emitter = |emitter: &Emitter| {
            let power = light_power(emitter_power(emitter) * scene.mean_texture(emitter.image));
            f64::from(if emitter.kind == PARALLEL { power * disk } else { power })
        };
        let environment = world.environment.as_ref().map(|of| f64::from(light_power(of.mean) * 4.0 * PI * disk));
        let powers: Vec<f64> = world.emitters.iter().map(of_emitter).chain(environment).collect();
        let total: f64 = powers.iter().sum();
        if total <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        sums.extend(powers.iter().map(|power| {
            sum += power / total;
            sum as f32
        }));
        *sums.last_mut()? = 1.0;
        Some(Self { sums, center: (lower + upper) * 0.5, radius })
    }

    /// Draws the beginning of a path.
    pub(crate) fn depart(&self, scene: &Scene<'_>, randoms: &mut Randoms) -> Option<Departure> {
        let [u, v, s, t] = randoms.next();
        let [choice, side, ..] = randoms.next();
        let (number, _) = interval_of(&self.sums, choice);
        let chance = self.sums[number as usize + 1] - self.sums[number as usize];
        let departure = match scene.world.emitters.get(number as usize) {
            Some(emitter) => self.leave_emitter(scene, emitter, [u, v], [s, t], side)?,
            None => self.leave_environment(scene, [u, v], [s, t])?,
        };
        (chance > 0.0 && departure.power != Vec3::ZERO)
            .then(|| Departure { power: departure.power / chance, ..departure })
    }

    fn leave_emitter(
        &self,
        scene: &Scene<'_>,
        emitter: &Emitter,
        place: [f32; 2],
        turn: [f32; 2],
        side: f32,
    ) -> Option<Departure> {
        match emitter.kind {
            PARALLEL => Some(self.arrive(emitter.direction, emitter.color, place)),
            POINT | SPOT => {
                let (axis, least) =
                    if emitter.kind == SPOT { (emitter.direction, emitter.cos_outer) } else { (Vec3::Z, -1.0) };
                let cos = 1.0 - place[0] * (1.0 - least);
                let direction = around(axis, cos, place[1]);
                let falloff = if emitter.kind == SPOT { spot_falloff(emitter, cos) } else { 1.0 };
                let power = emitter.color * (falloff * 2.0 * PI * (1.0 - least));
                Some(Departure { ray: ray(emitter.position, direction), power })
            }
            _ => {
                let (target, normal, place) = surface_place(emitter, place);
                let image = scene.emitter_texture(emitter, target, place)?;
                let turned = emitter.two_sided != 0 && side < 0.5;
                let normal = if turned { -normal } else { normal };
                let direction = sample_cosine_cone(normal, 1.0, turn);
                if !scene.is_first_there(emitter, target, direction) {
                    return None;
                }
                let epsilon = plane_error(target, normal, emitter.slack);
                let power = emitter_power(emitter) * image;
                Some(Departure { ray: ray(target + normal * epsilon, direction), power })
            }
        }
    }

    fn leave_environment(&self, scene: &Scene<'_>, turn: [f32; 2], place: [f32; 2]) -> Option<Departure> {
        let map = scene.environment.as_ref()?;
        let (towards, pdf) = sample_environment(map, turn);
        (pdf > 0.0).then(|| self.arrive(-towards, environment_radiance(map, towards) / pdf, place))
    }

    /// Directional light of some irradiance through a disk that covers the scene.
    fn arrive(&self, direction: Vec3, irradiance: Vec3, place: [f32; 2]) -> Departure {
        let (tangent, bitangent) = frame(direction);
        let (sin, cos) = sin_cos_turns(place[1]);
        let shift = (tangent * cos + bitangent * sin) * (self.radius * place[0].sqrt());
        let origin = self.center + shift - direction * self.radius;
        Departure { ray: ray(origin, direction), power: irradiance * (PI * self.radius * self.radius) }
    }
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, inside: false }
}

/// The direction at an angle to an axis.
fn around(axis: Vec3, cos: f32, turn: f32) -> Vec3 {
    let (tangent, bitangent) = frame(axis);
    let (s, c) = sin_cos_turns(turn);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    (tangent * (sin * c) + bitangent * (sin * s) + axis * cos).normalize_or_zero()
}

/// A place on an emissive surface, uniform, with the normal there and its coordinates along the edges.
fn surface_place(emitter: &Emitter, random: [f32; 2]) -> (Vec3, Vec3, [f32; 2]) {
    match emitter.kind {
        SPHERE_LIGHT => {
            let normal = around(Vec3::Z, 1.0 - 2.0 * random[0], random[1]);
            (emitter.position + normal * emitter.radius, normal, [0.0; 2])
        }
        kind => {
            let place = if kind == TRIANGLE_LIGHT {
                let root = random[0].sqrt();
                [root * (1.0 - random[1]), root * random[1]]
            } else {
                debug_assert_eq!(kind, RECTANGLE_LIGHT);
                random
            };
            let target = emitter.position + emitter.edge1 * place[0] + emitter.edge2 * place[1];
            (target, emitter.direction, place)
        }
    }
}

impl Scene<'_> {
    /// The mean of a texture; white where there is none.
    fn mean_texture(&self, image: u32) -> Vec3 {
        if image == NONE {
            return Vec3::ONE;
        }
        let images = self.images();
        let image = &images.images[image as usize];
        lightcuts_kernel::mip::mip_bilinear(images.words, image, image.levels - 1, [0.5; 2]).truncate()
    }
}
