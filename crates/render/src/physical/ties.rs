//! Which of several surfaces in one place is met, where one of them shines or has holes; see
//! [`lightcuts_world::physical::Ties`].

use super::scene::Scene;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::emitter::Emitter;
use lightcuts_kernel::intersect::{SPHERE, SQUARE, intersect_sphere, intersect_square};
use lightcuts_kernel::ray::{Hit, NONE, Ray};
use lightcuts_kernel::surface::surface_at;
use lightcuts_kernel::watertight::{Shear, intersect_watertight};
use lightcuts_world::physical::Tied;

/// How far apart along a ray, relative to the way, hits in one place may be: more than grazing rays draw rounding
/// errors out.
const SPREAD: f32 = 1e-2;

impl Scene<'_> {
    /// Of a hit and those in its place the one that is met: the first that shines towards the ray, else the first in
    /// file order.
    #[inline]
    pub(super) fn first_of_tied(&self, ray: &Ray, hit: Hit) -> Hit {
        match self.world.ties.of(hit.primitive) {
            [] => hit,
            tied => self.first_of(ray, hit, tied),
        }
    }

    fn first_of(&self, ray: &Ray, hit: Hit, tied: &[Tied]) -> Hit {
        let tied = tied.iter().filter_map(|tied| self.meets(ray, &hit, tied));
        tied.chain([hit]).min_by_key(|hit| self.rank(ray, hit)).unwrap_or(hit)
    }

    /// What is met in the place of a hole, if anything.
    pub(super) fn first_behind(&self, ray: &Ray, hole: Hit) -> Option<Hit> {
        let tied = self.world.ties.of(hole.primitive).iter().filter_map(|tied| self.meets(ray, &hole, tied));
        tied.min_by_key(|hit| self.rank(ray, hit))
    }

    fn rank(&self, ray: &Ray, hit: &Hit) -> (bool, u32) {
        (!self.shines(ray, hit), hit.primitive)
    }

    /// Whether light that leaves a place on an emitter in a direction is that emitter's, and of none in its place.
    pub(super) fn is_first_there(&self, emitter: &Emitter, place: Vec3, direction: Vec3) -> bool {
        if emitter.primitive == NONE || self.world.ties.of(emitter.primitive).is_empty() {
            return true;
        }
        // Seen from a little way off; only where it lies on the emitter matters.
        let (lower, upper) = self.world.bounds;
        let distance = (upper - lower).length();
        let origin = place + direction * distance;
        let ray = Ray { origin, direction: -direction, t_min: 0.0, t_max: f32::INFINITY, inside: false };
        let hit = Hit { t: distance, primitive: emitter.primitive, u: 0.0, v: 0.0 };
        self.first_of_tied(&ray, hit).primitive == emitter.primitive
    }

    /// The hit of a primitive in the place of another hit.
    fn meets(&self, ray: &Ray, hit: &Hit, tied: &Tied) -> Option<Hit> {
        let shapes = &self.world.shapes;
        let primitive = &shapes.primitives[tied.primitive as usize];
        let whole = Ray { t_min: hit.t * (1.0 - SPREAD), t_max: hit.t * (1.0 + SPREAD), ..*ray };
        let met = match primitive.kind {
            SPHERE => intersect_sphere(&shapes.spheres[primitive.index as usize], &whole, Rules::Repaired),
            SQUARE => intersect_square(&shapes.squares[primitive.index as usize], &whole),
            _ => intersect_watertight(&tied.corners, tied.primitive, &whole, &Shear::new(whole.direction)),
        }?;
        (!self.world.has_masks || self.is_there(ray, &met)).then_some(met)
    }

    /// Whether what a ray hits shines towards it.
    fn shines(&self, ray: &Ray, hit: &Hit) -> bool {
        let shapes = &self.world.shapes;
        let primitive = &shapes.primitives[hit.primitive as usize];
        let scatter = &self.world.scatters[primitive.material as usize];
        if scatter.radiance == Vec3::ZERO || scatter.two_sided != 0 {
            return scatter.radiance != Vec3::ZERO;
        }
        let normal = match primitive.kind {
            SPHERE | SQUARE => surface_at(&shapes.surfaces(), ray, hit).normal,
            _ => self.world.faces[primitive.index as usize].normal,
        };
        normal.dot(ray.direction) < 0.0
    }
}
