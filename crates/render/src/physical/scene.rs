//! Rays against a physical world, and what they find.

use crate::cpu::{RayLanes, Simd, Tracer};
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::bsdf::{Bsdf, BsdfSample, DIELECTRIC, Transport, bsdf_pdf, bsdf_value, sample_bsdf};
use lightcuts_kernel::environment::EnvironmentMap;
use lightcuts_kernel::intersect::{SPHERE, SQUARE, TRIANGLE};
use lightcuts_kernel::ray::{Hit, NONE, Ray};
use lightcuts_kernel::rounding::{
    APPROACH, REACH, onto_plane, onto_sphere, onto_square, plane_error, sphere_slack, square_slack,
};
use lightcuts_kernel::sampling::frame;
use lightcuts_kernel::scatter::{
    Images, TexturePlace, chosen_scatter, is_there, scatter_bsdf, scatter_normal, scatter_radiance,
};
use lightcuts_kernel::surface::{Surface, surface_at};
use lightcuts_kernel::texture::surface_point;
use lightcuts_kernel::virtual_light::LEAST_COSINE;
use lightcuts_world::PhysicalWorld;
use lightcuts_world::bvh::LANES;
use lightcuts_world::physical::Face;

/// Surfaces with holes that a ray may pass through, one behind the other.
const MAX_HOLES: u32 = 1024;

/// A world with the means to trace rays through it.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) world: &'a PhysicalWorld,
    pub(crate) environment: Option<EnvironmentMap<'a>>,
    tracer: Tracer<'a>,
    pub(crate) simd: Simd,
    images: Images<'a>,
}

/// A footprint that grows along a ray.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cone {
    /// Width where the ray begins, in scene units.
    pub(crate) width: f32,
    /// Growth per unit.
    pub(crate) spread: f32,
}

impl Cone {
    /// A ray without width: textures are looked up at points.
    pub(crate) const NONE: Self = Self { width: 0.0, spread: 0.0 };

    /// The cone after some distance.
    pub(crate) fn after(self, distance: f32) -> Self {
        Self { width: self.width + self.spread * distance, ..self }
    }
}

/// A place that a ray came to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interaction {
    pub(crate) point: Vec3,
    /// Unit normal of the surface itself.
    pub(crate) face: Vec3,
    /// Unit normal for shading, on the same side, with its tangents.
    pub(crate) normal: Vec3,
    tangents: (Vec3, Vec3),
    /// Where the ray came from, in the frame of the shading normal.
    pub(crate) wo: Vec3,
    pub(crate) bsdf: Bsdf,
    /// Radiance that is sent out against the ray.
    pub(crate) emitted: Vec3,
    /// Light that the surface is, or [`NONE`].
    pub(crate) emitter: u32,
    pub(crate) object: u32,
    pub(crate) material: u32,
    /// Distance that keeps other rays from their own surface, in scene units.
    pub(crate) epsilon: f32,
    /// From the point to where rays begin that go on the side from which this one came.
    pub(crate) lift: Vec3,
}

/// The surface itself at a hit.
struct Plane {
    /// The point, put back onto the surface.
    point: Vec3,
    /// Unit normal.
    normal: Vec3,
    /// Unit direction in which u grows.
    tangent: Vec3,
    /// Texture coordinates per scene unit; negative where v grows against normal x tangent.
    texture_density: f32,
    /// How far the point may be off the surface, in scene units.
    error: f32,
}

impl<'a> Scene<'a> {
    pub(crate) fn new(world: &'a PhysicalWorld, simd: Simd) -> Self {
        Self {
            world,
            environment: world.environment_map(),
            tracer: Tracer::new(world.shapes.geometry(), Rules::Repaired, simd),
            simd,
            images: world.all_images(),
        }
    }

    /// The nearest hit; holes let rays through.
    pub(crate) fn closest(&self, ray: &Ray) -> Option<Hit> {
        let mut ray = *ray;
        for _ in 0..MAX_HOLES {
            let hit = self.tracer.closest(&ray);
            if !hit.is_some() {
                return None;
            }
            if !self.world.has_masks || self.is_there(&ray, &hit) {
                return Some(self.first_of_tied(&ray, hit));
            }
            // What lies in the place of a hole is no farther away than the hole.
            if let Some(behind) = self.first_behind(&ray, hit) {
                return Some(behind);
            }
            ray.t_min = hit.t;
        }
        None
    }

    /// Whether nothing lies between the ray's ends.
    pub(crate) fn is_free(&self, ray: &Ray) -> bool {
        if self.world.has_masks { self.closest(ray).is_none() } else { !self.tracer.occluded(ray) }
    }

    /// The nearest hits of rays that go much the same way; holes let rays through.
    pub(crate) fn closest8(&self, rays: &[Ray; LANES]) -> [Option<Hit>; LANES] {
        if self.world.has_masks {
            return rays.map(|ray| self.closest(&ray));
        }
        let mut hits = self.tracer.closest8(rays);
        if !self.world.ties.is_empty() {
            for (hit, ray) in hits.iter_mut().zip(rays).filter(|(hit, _)| hit.is_some()) {
                *hit = self.first_of_tied(ray, *hit);
            }
        }
        hits.map(|hit| hit.is_some().then_some(hit))
    }

    /// Which of the rays in `asked`, a bit each, something lies between the ends of. Holes are not looked at.
    pub(crate) fn occluded_lanes(&self, rays: &RayLanes, asked: u32) -> u32 {
        self.tracer.occluded_lanes(rays, asked)
    }

    pub(super) fn is_there(&self, ray: &Ray, hit: &Hit) -> bool {
        let surfaces = self.world.shapes.surfaces();
        let scatter = &self.world.scatters[surfaces.primitives[hit.primitive as usize].material as usize];
        if scatter.mask_image == NONE {
            return true;
        }
        let uv = self.texture_coordinates(hit, &surface_at(&surfaces, ray, hit));
        is_there(scatter, &self.images, &TexturePlace { uv, width: 0.0 })
    }

    /// What is at a hit. `random` decides which of its materials a mix is there.
    pub(crate) fn interaction(&self, ray: &Ray, hit: &Hit, cone: Cone, random: f32) -> Interaction {
        let surfaces = self.world.shapes.surfaces();
        let surface = surface_at(&surfaces, ray, hit);
        let Plane { point, normal: face, tangent, texture_density, error } = self.plane(hit, &surface);
        let toward = -ray.direction;
        let place = if self.world.textured[surface.material as usize] {
            // A footprint that is stretched by a grazing view is taken as round: narrow enough not to blur across.
            let cos = face.dot(toward).abs().max(0.2);
            let width = cone.after(hit.t).width * texture_density.abs() / cos;
            TexturePlace { uv: self.texture_coordinates(hit, &surface), width }
        } else {
            TexturePlace { uv: [0.0; 2], width: 0.0 }
        };
        let index = chosen_scatter(&self.world.scatters, &self.images, surface.material, &place, random);
        let scatter = &self.world.scatters[index as usize];
        let own = &self.world.scatters[surface.material as usize];
        let mut normal = if surface.normal.dot(face) < 0.0 { -surface.normal } else { surface.normal };
        if normal == Vec3::ZERO {
            normal = face;
        }
        let bent = scatter_normal(scatter, &self.images, &place);
        if bent != Vec3::Z {
            let along = (tangent - normal * normal.dot(tangent)).normalize_or_zero();
            let up = normal.cross(along) * 1.0_f32.copysign(texture_density);
            normal = (along * bent.x + up * bent.y + normal * bent.z).normalize_or(normal);
        }
        // A normal that turns a surface away from who sees it says nothing.
        if normal.dot(toward) * face.dot(toward) <= 0.0 {
            normal = face;
        }
        let tangents = frame(normal);
        let wo = to_local(tangents, normal, toward);
        let epsilon = error.max(self.world.ties.slack(hit.primitive));
        // A little back along the ray too, by more than its end may be off: at an edge it keeps to its side of what else ends there.
        let back = 0.5 * epsilon + (hit.t * APPROACH).min(8.0 * epsilon);
        let lift = face * epsilon.copysign(face.dot(toward)) + toward * back;
        Interaction {
            point,
            face,
            normal,
            tangents,
            wo,
            bsdf: scatter_bsdf(scatter, &self.images, &place),
            emitted: scatter_radiance(own, &self.images, &place, face.dot(toward) > 0.0),
            emitter: self.world.primitive_emitters[hit.primitive as usize],
            object: surface.object,
            material: surface.material,
            epsilon,
            lift,
        }
    }

    /// The surface itself at a hit.
    fn plane(&self, hit: &Hit, surface: &Surface) -> Plane {
        let shapes = &self.world.shapes;
        let primitive = shapes.primitives[hit.primitive as usize];
        let index = primitive.index as usize;
        match primitive.kind {
            TRIANGLE => {
                let face = &self.world.faces[index];
                let point = onto_plane(surface.point, face.normal, face.offset);
                let error = plane_error(point, face.normal, shapes.corners[index].slack);
                let Face { normal, tangent, texture_density, .. } = *face;
                Plane { point, normal, tangent, texture_density, error }
            }
            SPHERE => {
                let sphere = &shapes.spheres[index];
                let (point, normal) = (onto_sphere(surface.point, sphere), surface.normal);
                let tangent = Vec3::Y.cross(normal).normalize_or_zero();
                let texture_density = 1.0 / (sphere.radius * std::f32::consts::PI * std::f32::consts::SQRT_2);
                let error = plane_error(point, normal, sphere_slack(sphere.radius));
                Plane { point, normal, tangent, texture_density, error }
            }
            _ => {
                let square = &shapes.squares[index];
                let point = onto_square(surface.point, square);
                let error = plane_error(point, square.normal, square_slack(point, square));
                let texture_density = 0.5 / (square.half_width * square.half_height).sqrt();
                Plane { point, normal: square.normal, tangent: square.across, texture_density, error }
            }
        }
    }

    /// Texture coordinates at a hit: on a rectangle u grows to the right and v up, seen from the normal's side with the head up.
    pub(super) fn texture_coordinates(&self, hit: &Hit, surface: &Surface) -> [f32; 2] {
        let surfaces = self.world.shapes.surfaces();
        let [u, v] = surface_point(&surfaces, hit, surface).uv;
        // The thesis' squares show their pictures mirrored.
        if surfaces.primitives[hit.primitive as usize].kind == SQUARE { [1.0 - u, v] } else { [u, v] }
    }

    /// Images of the world.
    pub(crate) fn images(&self) -> &Images<'a> {
        &self.images
    }
}

fn to_local((tangent, bitangent): (Vec3, Vec3), normal: Vec3, direction: Vec3) -> Vec3 {
    Vec3::new(tangent.dot(direction), bitangent.dot(direction), normal.dot(direction))
}

impl Interaction {
    /// A direction in the frame of the shading normal.
    pub(crate) fn local(&self, direction: Vec3) -> Vec3 {
        to_local(self.tangents, self.normal, direction)
    }

    /// Where the ray came from.
    pub(crate) fn toward(&self) -> Vec3 {
        self.in_scene(self.wo)
    }

    fn in_scene(&self, local: Vec3) -> Vec3 {
        self.tangents.0 * local.x + self.tangents.1 * local.y + self.normal * local.z
    }

    /// Whether both normals have a direction on one side: else light would leak through the surface.
    fn is_sound(&self, direction: Vec3, local: Vec3) -> bool {
        let (of_face, cos) = (self.face.dot(direction), local.z);
        of_face * cos > 0.0 && of_face.abs().min(cos.abs()) > LEAST_COSINE
    }

    /// BSDF times cosine of some lobes.
    pub(crate) fn scattered(&self, tables: &[f32], lobes: u32, direction: Vec3, transport: Transport) -> Vec3 {
        let wi = self.local(direction);
        if !self.is_sound(direction, wi) {
            return Vec3::ZERO;
        }
        bsdf_value(&self.bsdf, tables, lobes, self.wo, wi, transport) * wi.z.abs()
    }

    /// Density of [`Interaction::sample`] over some lobes.
    pub(crate) fn pdf(&self, tables: &[f32], lobes: u32, direction: Vec3) -> f32 {
        bsdf_pdf(&self.bsdf, tables, lobes, self.wo, self.local(direction))
    }

    /// A direction drawn from some lobes, in the scene's frame.
    pub(crate) fn sample(
        &self,
        tables: &[f32],
        lobes: u32,
        random: [f32; 3],
        transport: Transport,
    ) -> Option<BsdfSample> {
        let sample = sample_bsdf(&self.bsdf, tables, lobes, self.wo, random, transport)?;
        let direction = self.in_scene(sample.wi).normalize_or_zero();
        self.is_sound(direction, sample.wi).then_some(BsdfSample { wi: direction, ..sample })
    }

    /// Whether light from behind matters too.
    pub(crate) fn is_transparent(&self) -> bool {
        self.bsdf.kind == DIELECTRIC
    }

    /// Where a ray begins that goes in a direction: off the surface, on the side that it goes to.
    fn start(&self, direction: Vec3) -> Vec3 {
        if (self.face.dot(direction) < 0.0) == (self.face.dot(self.lift) < 0.0) {
            return self.point + self.lift;
        }
        self.point + self.face * self.epsilon.copysign(self.face.dot(direction))
    }

    /// The ray in a direction up to a distance.
    pub(crate) fn ray(&self, direction: Vec3, distance: f32) -> Ray {
        Ray { origin: self.start(direction), direction, t_min: 0.0, t_max: distance, inside: false }
    }

    /// The ray to a place that must be free for the place to be seen. The place is off its own surface already, on the side of
    /// `normal`; without a surface that is zero.
    pub(crate) fn ray_to(&self, place: Vec3, normal: Vec3) -> Ray {
        let way = place - self.point;
        let origin = self.start(way);
        let direction = place + normal * (way.length() * APPROACH) - origin;
        Ray { origin, direction, t_min: 0.0, t_max: REACH, inside: false }
    }
}
