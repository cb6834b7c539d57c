//! Light straight from the scene's lights: one of them is drawn, and weighed against meeting it by chance.

use super::caustics::{is_focused, spreads};
use super::scene::{Interaction, Scene};
use super::sums::Counts;
use glam::Vec3;
use lightcuts_kernel::bsdf::{DIFFUSE, GLOSSY, lobes_of};
use lightcuts_kernel::emitter::{Emitter, RECTANGLE_LIGHT, SPHERE_LIGHT, TRIANGLE_LIGHT, emitter_pdf, sample_emitter};
use lightcuts_kernel::emitter_tree::{Lit, leaf_probability, sample_emitter_tree};
use lightcuts_kernel::environment::{environment_pdf, environment_radiance, sample_environment};
use lightcuts_kernel::ray::{NONE, Ray};
use lightcuts_kernel::rounding::plane_error;
use lightcuts_kernel::scatter::{TexturePlace, image_at, is_there};
use lightcuts_kernel::texture::sphere_coordinates;

/// Light that arrives from one direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arriving {
    /// Unit vector towards it.
    pub(crate) direction: Vec3,
    /// Radiance over the density of the direction; of lights without extent what arrives across the direction, over the
    /// probability of the light.
    pub(crate) light: Vec3,
    /// Density per steradian with which lights are drawn in this direction; 0 of lights without extent.
    pub(crate) pdf: f32,
    /// What must be free for it to arrive.
    pub(crate) shadow: Ray,
}

/// The balance heuristic with squares (Veach 1997): the weight of a sample that was drawn with density `own`.
fn power_heuristic(own: f32, other: f32) -> f32 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// Where a path came from.
pub(crate) struct PrevVertex {
    pub(crate) at: Interaction,
    /// Density of the direction that it took; 0 of a single direction.
    pub(crate) pdf: f32,
    /// Lights that were drawn there.
    pub(crate) lights: u32,
    /// Whether it took a focused lobe.
    pub(crate) is_focused: bool,
    /// Whether it took a lobe before that spreads light, where photons bring caustics.
    pub(crate) has_diffuse_bounce: bool,
}

impl PrevVertex {
    /// Weight of light that was met by chance, by the density with which it is drawn from where the path was before.
    /// Light that the camera sees, or that comes from a single direction, cannot be drawn; caustics that photons bring
    /// count nothing.
    pub(crate) fn weight(before: Option<&Self>, light_pdf: impl Fn(&Interaction) -> f32) -> f32 {
        match before {
            Some(before) if before.has_diffuse_bounce && before.is_focused => 0.0,
            Some(before) if before.pdf > 0.0 => {
                power_heuristic(before.pdf, light_pdf(&before.at) * before.lights as f32)
            }
            _ => 1.0,
        }
    }

    /// Whether a lobe by which a path goes on is focused, and whether that or an earlier one spread light. What is met
    /// by focused lobes behind one that spreads is a caustic, which photons bring.
    pub(crate) fn classify_bounce(
        before: Option<&Self>,
        at: &Interaction,
        lobe: u32,
        has_photons: bool,
    ) -> (bool, bool) {
        let is_focused = is_focused(at, lobe);
        (is_focused, has_photons && (!is_focused || before.is_some_and(|before| before.has_diffuse_bounce)))
    }
}

/// The light of drawn lights at a place.
pub(crate) struct DirectLight<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) at: &'a Interaction,
    /// Lobes from which the path goes on.
    pub(crate) lobes: u32,
    /// Where the path came from.
    pub(crate) before: Option<&'a PrevVertex>,
}

impl DirectLight<'_> {
    /// The estimate by a light for each point of random numbers, of which the last one is left; `value` is the BSDF
    /// times the cosine for a direction.
    pub(crate) fn estimate<const N: usize>(
        &self,
        points: [[f32; 4]; N],
        counts: &mut Counts,
        value: impl Fn(Vec3) -> Vec3,
    ) -> Vec3 {
        let is_caustic = !spreads(self.at) && self.before.is_some_and(|before| before.has_diffuse_bounce);
        if self.lobes & lobes_of(&self.at.bsdf) & (DIFFUSE | GLOSSY) == 0 || is_caustic {
            return Vec3::ZERO;
        }
        // Each from its own part of all lights.
        let choices: [f32; N] = std::array::from_fn(|k| (k as f32 + points[k][2]) / N as f32);
        let drawn = self.scene.draw_lights(self.at, choices);
        let mut sum = Vec3::ZERO;
        for ([u, v, ..], drawn) in points.into_iter().zip(drawn) {
            let arriving = drawn.and_then(|(light, chance)| self.scene.light_of(self.at, light, chance, [u, v]));
            sum += arriving.map_or(Vec3::ZERO, |arriving| self.light(&arriving, N, counts, &value));
        }
        sum / N as f32
    }

    /// What one of so many drawn lights brings.
    fn light(&self, arriving: &Arriving, number: usize, counts: &mut Counts, value: &impl Fn(Vec3) -> Vec3) -> Vec3 {
        let value = value(arriving.direction);
        if value == Vec3::ZERO {
            return Vec3::ZERO;
        }
        counts.shadow += 1;
        if !self.scene.is_free(&arriving.shadow) {
            return Vec3::ZERO;
        }
        let weight = if arriving.pdf == 0.0 {
            1.0
        } else {
            let by_chance = self.at.pdf(&self.scene.world.tables, self.lobes, arriving.direction);
            power_heuristic(arriving.pdf * number as f32, by_chance)
        };
        value * arriving.light * weight
    }
}

impl Scene<'_> {
    /// Lights that are infinitely far away.
    fn far_lights(&self) -> u32 {
        self.world.emitters.len() as u32 - self.world.placed_emitters + u32::from(self.environment.is_some())
    }

    /// Probability that one of those is drawn: all of them and the placed ones together have equal chances.
    fn far_probability(&self) -> f32 {
        let far = self.far_lights() as f32;
        if far == 0.0 { 0.0 } else { far / (far + f32::from(u8::from(self.world.placed_emitters > 0))) }
    }

    /// Draws a light for each random number, with its probability; `None` where none can shine. The environment has the
    /// number behind all emitters.
    fn draw_lights<const N: usize>(&self, at: &Interaction, randoms: [f32; N]) -> [Option<(u32, f32)>; N] {
        let far = self.far_probability();
        if far == 0.0 {
            return sample_emitter_tree(&self.world.emitter_nodes, &lit(at), randoms);
        }
        let each = far / self.far_lights() as f32;
        randoms.map(|random| {
            if random < far {
                let number = ((random / each) as u32).min(self.far_lights() - 1);
                return Some((number + self.world.placed_emitters, each));
            }
            let rest = ((random - far) / (1.0 - far)).min(1.0 - f32::EPSILON);
            let placed = sample_emitter_tree(&self.world.emitter_nodes, &lit(at), [rest])[0];
            placed.map(|(number, probability)| (number, probability * (1.0 - far)))
        })
    }

    /// Light that may arrive from a light that was drawn; `None` if none can.
    fn light_of(&self, at: &Interaction, number: u32, chance: f32, random: [f32; 2]) -> Option<Arriving> {
        let Some(emitter) = self.world.emitters.get(number as usize) else {
            return self.light_of_environment(at, chance, random);
        };
        let sample = sample_emitter(emitter, at.point, random);
        let has_extent = matches!(emitter.kind, TRIANGLE_LIGHT | RECTANGLE_LIGHT | SPHERE_LIGHT);
        if sample.color == Vec3::ZERO || (has_extent && sample.pdf <= 0.0) {
            return None;
        }
        let (color, shadow) = if sample.distance.is_infinite() {
            (sample.color, at.ray(sample.direction, f32::INFINITY))
        } else {
            let target = at.point + sample.direction * sample.distance;
            let image = self.emitter_texture(emitter, target, sample.place)?;
            if !self.is_first_there(emitter, target, -sample.direction) {
                return None;
            }
            let normal = emitter_normal(emitter, target, -sample.direction);
            let lift = normal * plane_error(target, normal, emitter.slack);
            (sample.color * image, at.ray_to(target + lift, normal))
        };
        let pdf = sample.pdf * chance;
        let light = color / if has_extent { pdf } else { chance };
        Some(Arriving { direction: sample.direction, light, pdf, shadow })
    }

    /// Factor of a light's texture at a place on it; `None` where it has a hole.
    pub(crate) fn emitter_texture(&self, emitter: &Emitter, target: Vec3, place: [f32; 2]) -> Option<Vec3> {
        if emitter.primitive == NONE {
            return Some(Vec3::ONE);
        }
        let shapes = &self.world.shapes;
        let primitive = &shapes.primitives[emitter.primitive as usize];
        let scatter = &self.world.scatters[primitive.material as usize];
        if emitter.image == NONE && scatter.mask_image == NONE {
            return Some(Vec3::ONE);
        }
        let uv = match emitter.kind {
            TRIANGLE_LIGHT => {
                let [a, b, c] = shapes.corners[primitive.index as usize].texture_coordinates;
                let at = |k: usize| a[k] * (1.0 - place[0] - place[1]) + b[k] * place[0] + c[k] * place[1];
                [at(0), at(1)]
            }
            SPHERE_LIGHT => sphere_coordinates(((target - emitter.position) / emitter.radius).normalize_or_zero()),
            _ => place,
        };
        let place = TexturePlace { uv, width: 0.0 };
        is_there(scatter, self.images(), &place).then(|| image_at(self.images(), emitter.image, &place).truncate())
    }

    fn light_of_environment(&self, at: &Interaction, chance: f32, random: [f32; 2]) -> Option<Arriving> {
        let map = self.environment.as_ref()?;
        let (direction, density) = sample_environment(map, random);
        let pdf = density * chance;
        let light = environment_radiance(map, direction) / pdf;
        let shadow = at.ray(direction, f32::INFINITY);
        (pdf > 0.0 && light != Vec3::ZERO).then_some(Arriving { direction, light, pdf, shadow })
    }

    /// Radiance of the environment in a direction, and the density with which [`Scene::draw_lights`] draws it.
    pub(crate) fn environment_light(&self, direction: Vec3) -> (Vec3, f32) {
        self.environment.as_ref().map_or((Vec3::ZERO, 0.0), |map| {
            let chance = self.far_probability() / self.far_lights() as f32;
            (environment_radiance(map, direction), environment_pdf(map, direction) * chance)
        })
    }

    /// The density with which [`Scene::draw_lights`], from one place, draws the direction in which another one shines.
    pub(crate) fn light_pdf(&self, from: &Interaction, light: &Interaction, direction: Vec3, distance: f32) -> f32 {
        if light.emitter == NONE {
            return 0.0;
        }
        let emitter = &self.world.emitters[light.emitter as usize];
        let leaf = self.world.emitter_leaves[light.emitter as usize];
        let chance = leaf_probability(&self.world.emitter_nodes, leaf, &lit(from)) * (1.0 - self.far_probability());
        emitter_pdf(emitter, from.point, direction, distance) * chance
    }
}

/// Unit normal of an emitter's surface, on the side of a direction; zero without a surface.
fn emitter_normal(emitter: &Emitter, place: Vec3, direction: Vec3) -> Vec3 {
    let normal = match emitter.kind {
        SPHERE_LIGHT => (place - emitter.position).normalize_or_zero(),
        TRIANGLE_LIGHT | RECTANGLE_LIGHT => emitter.direction,
        _ => Vec3::ZERO,
    };
    if normal.dot(direction) < 0.0 { -normal } else { normal }
}

fn lit(at: &Interaction) -> Lit {
    let normal = if at.wo.z < 0.0 { -at.normal } else { at.normal };
    Lit { point: at.point, normal, both_sides: at.is_transparent() }
}
