//! What everything lies in, and how far from spheres rays in it must keep for no rounding to let them hit.

use super::tracer::root_box;
use glam::{DVec3, Vec3};
use lightcuts_kernel::intersect::Sphere;
use lightcuts_world::bvh::Geometry;

/// How far outside of a sphere a hit may be that single precision finds: its squared distance from the centre exceeds
/// that of the radius by this times the square of the greatest distance that a ray begins at, with as much to spare
/// ([`Enclosure::sphere_box`]).
const SPHERE_ROUNDING: f64 = 256.0 * f32::EPSILON as f64;

/// A box.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Enclosure {
    pub(crate) lower: Vec3,
    pub(crate) upper: Vec3,
}

impl Enclosure {
    /// Around everything, with a margin for how points on surfaces are rounded.
    pub(crate) fn around(geometry: &Geometry<'_>) -> Self {
        let (lower, upper) = root_box(geometry, |_| 0);
        let margin = Vec3::splat((upper - lower).max_element() * 1e-3);
        Self { lower: lower - margin, upper: upper + margin }
    }

    pub(crate) fn contains(&self, point: Vec3) -> bool {
        (point.cmpge(self.lower) & point.cmple(self.upper)).all()
    }

    pub(crate) fn diagonal(&self) -> f32 {
        (self.upper - self.lower).length()
    }

    /// The greatest distance along each axis between a point and those of the enclosure.
    pub(crate) fn farthest(&self, from: DVec3) -> DVec3 {
        (from - self.lower.as_dvec3()).abs().max((from - self.upper.as_dvec3()).abs())
    }

    /// A box that no ray hits a sphere outside of, if it begins outside of the box and lies in the enclosure.
    ///
    /// With u half an epsilon and F the greatest distance of a point of the enclosure from the centre, the computed
    /// coefficients of the equation a t^2 + b t + c = 0 are off by few u of |d|^2, |d| F and F^2, and so a root that is
    /// computed leaves less than 100 u F^2 of it: by so much the squared distance of the hit from the centre exceeds
    /// that of the radius. The other root of the repaired equation is c / q: outside of the box c is over 500 u F^2,
    /// and where the line meets the sphere q^2 is then over 400 u a F^2, so that the error of q adds a few u F^2 only.
    pub(crate) fn sphere_box(&self, sphere: &Sphere) -> (Vec3, Vec3) {
        let (center, radius) = (sphere.center.as_dvec3(), DVec3::splat(self.widened(sphere, SPHERE_ROUNDING)));
        ((center - radius).as_vec3(), (center + radius).as_vec3())
    }

    /// How far a line from one place in the enclosure to another must keep from a sphere's centre, so that no ray hits
    /// it that begins up to a distance d from the one and ends at the other, if d is added to it.
    ///
    /// Such a ray's points are no farther than d from the line's. What [`Enclosure::sphere_box`] says of a ray that
    /// begins outside of the box holds outside of the sphere with its margin; this has two, of which one is 512 u F^2,
    /// for what is lost where the line's squared distance is computed: less than 100 u F^2, as all vectors are no
    /// longer than 2 F.
    pub(crate) fn clearance(&self, sphere: &Sphere) -> f64 {
        self.widened(sphere, 2.0 * SPHERE_ROUNDING)
    }

    /// A sphere's radius whose square is greater by some times the square of the greatest distance from its centre in
    /// the enclosure.
    fn widened(&self, sphere: &Sphere, by: f64) -> f64 {
        (f64::from(sphere.radius).powi(2) + by * self.farthest(sphere.center.as_dvec3()).length_squared()).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::Rules;
    use lightcuts_kernel::intersect::intersect_sphere;
    use lightcuts_kernel::ray::{shadow_ray, spawn_epsilon};
    use lightcuts_kernel::rng::random4;

    const ENCLOSURE: Enclosure = Enclosure { lower: Vec3::splat(-200.0), upper: Vec3::splat(200.0) };

    fn sphere(k: u32) -> Sphere {
        let (center, radius) = if k.is_multiple_of(2) {
            (Vec3::new(-80.0, -100.0, 70.0), 60.0)
        } else {
            (Vec3::new(120.0, 3.0, -60.0), 0.2)
        };
        Sphere { center, radius, primitive: 0, padding: [0; 3] }
    }

    fn is_hit(sphere: &Sphere, from: Vec3, to: Vec3, rules: Rules) -> bool {
        let ray = shadow_ray(rules, from, to - from, spawn_epsilon(rules, from, 300.0));
        intersect_sphere(sphere, &ray, rules).is_some()
    }

    #[test]
    fn no_ray_beyond_a_face_of_its_box_hits_a_sphere() {
        let (mut claimed, mut hits) = (0, 0);
        for k in 0..400_000 {
            let sphere = sphere(k);
            let (lower, upper) = ENCLOSURE.sphere_box(&sphere);
            // Both ends close to where a line touches the sphere at its farthest, a little before the face or behind
            // it.
            let axis = (k / 2 % 3) as usize;
            let off = [0.0, 1e-3, 1e-5, -1e-4, -0.2, -4.0, -40.0, 30.0];
            let end = |salt: u32| {
                let [a, b, c, _] = random4(k, salt, 0, 3);
                let reach = [1.0, 300.0][(k / 6 % 2) as usize];
                let mut point = sphere.center + (Vec3::new(a, b, c) - 0.5) * reach;
                point[axis] = upper[axis] + off[(c * 8.0) as usize % 8] * (0.5 + b);
                point.clamp(ENCLOSURE.lower, ENCLOSURE.upper)
            };
            let (from, to) = (end(0), end(1));
            let is_beyond = (from.cmple(lower) & to.cmple(lower) | from.cmpge(upper) & to.cmpge(upper)).any();
            for rules in [Rules::Original, Rules::Repaired] {
                let hit = is_hit(&sphere, from, to, rules);
                assert!(!hit || !is_beyond, "{sphere:?} between {from} and {to}");
                claimed += u32::from(is_beyond);
                hits += u32::from(hit);
            }
        }
        println!("{claimed} of 800000 need no test, {hits} are hit");
        assert!(claimed > 100_000 && hits > 10_000);
    }

    /// Lines that touch a sphere or pass it close by, and rays from places around their beginnings.
    #[test]
    fn no_ray_near_a_line_with_clearance_hits_a_sphere() {
        let (mut claimed, mut close, mut hits) = (0, 0, 0);
        for k in 0..400_000 {
            let sphere = sphere(k);
            let vector = |salt: u32| Vec3::from_slice(&random4(k, salt, 0, 5)) * 2.0 - 1.0;
            let spread = [0.0, 1e-3, 0.4, 30.0][(k / 2 % 4) as usize];
            let begin = vector(0) * 200.0;
            let origin = (begin + vector(1).normalize() * spread).clamp(ENCLOSURE.lower, ENCLOSURE.upper);
            let distance = f64::from((origin - begin).length()) * (1.0 + 1e-6);
            let clearance = ENCLOSURE.clearance(&sphere) + distance;
            // Past the side on which the origin is, at the distance that counts or at a little more or less.
            let share = [1.0, 1.0 + 1e-6, 1.0 - 1e-6, 1.0 - 1e-3, 0.9, 0.4, 1.1, 2.0][(k / 8 % 8) as usize];
            let to_center = sphere.center - begin;
            let side = if k / 64 % 2 == 0 { begin - origin } else { vector(2) };
            let aside = side.reject_from(to_center).normalize_or_zero() * (clearance * share) as f32;
            let end = (begin + (to_center + aside) * (1.0 + vector(3).x.abs())).clamp(ENCLOSURE.lower, ENCLOSURE.upper);
            let (from, way) = (to_center.as_dvec3(), (end - begin).as_dvec3());
            let nearest = from - way * (from.dot(way) / way.length_squared()).clamp(0.0, 1.0);
            let is_clear = nearest.length() > clearance;
            for rules in [Rules::Original, Rules::Repaired] {
                let hit = is_hit(&sphere, origin, end, rules);
                assert!(!hit || !is_clear, "{sphere:?} between {origin}, near {begin}, and {end}");
                claimed += u32::from(is_clear);
                close += u32::from(is_clear && nearest.length() < clearance * 1.01);
                hits += u32::from(hit);
            }
        }
        println!("{claimed} of 800000 are clear, {close} of them narrowly, {hits} are hit");
        assert!(claimed > 100_000 && close > 1_000 && hits > 100_000);
    }
}
