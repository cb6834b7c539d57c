//! Rays against a world.

use super::Simd;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_world::bvh::{BvhNode, Geometry, LANES, any_hit, closest_hit};

/// Traces rays through a geometry by the best means that the machine has. Hits are those of the kernel's plain
/// functions, bit for bit, whatever the means.
#[derive(Debug, Clone, Copy)]
pub struct Tracer<'a> {
    pub(crate) geometry: Geometry<'a>,
    pub(crate) rules: Rules,
    /// Whether the machine has AVX2 and it is wanted.
    pub(crate) avx2: bool,
    /// Lower and upper corner of a box around all triangles, and around whatever is not directly under the root.
    pub(crate) mesh: (Vec3, Vec3),
}

/// Eight rays, number by number. None is inside of anything, and each begins at its origin.
pub(crate) struct RayLanes {
    pub(crate) origin: [[f32; LANES]; 3],
    pub(crate) direction: [[f32; LANES]; 3],
    pub(crate) t_max: [f32; LANES],
}

impl RayLanes {
    fn ray(&self, lane: usize) -> Ray {
        let vector = |of: &[[f32; LANES]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        let (origin, direction) = (vector(&self.origin), vector(&self.direction));
        Ray { origin, direction, t_min: 0.0, t_max: self.t_max[lane], inside: false }
    }
}

impl<'a> Tracer<'a> {
    /// A tracer by `rules`.
    pub fn new(geometry: Geometry<'a>, rules: Rules, simd: Simd) -> Self {
        Self { geometry, rules, avx2: simd.has_avx2(), mesh: root_box(&geometry, |root| root.others) }
    }

    /// The nearest hit; of equal hits the first in file order.
    #[allow(unsafe_code)]
    pub fn closest(&self, ray: &Ray) -> Hit {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is set only where the machine has the features.
            return unsafe {
                by_form!(self.geometry.form, CORNERS => super::avx2_trace::closest_hit::<CORNERS>(&self.geometry, ray, self.rules))
            };
        }
        closest_hit(&self.geometry, ray, self.rules)
    }

    /// Whether anything lies between the ray's ends.
    #[allow(unsafe_code)]
    pub fn occluded(&self, ray: &Ray) -> bool {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is set only where the machine has the features.
            return unsafe {
                by_form!(self.geometry.form, CORNERS => {
                    super::avx2_trace::any_hit::<true, CORNERS>(&self.geometry, ray, self.rules, 0)
                })
            };
        }
        any_hit(&self.geometry, ray, self.rules)
    }

    /// The nearest hits of eight rays. Quicker than one by one where they go much the same way, such as those of
    /// neighbouring pixels, and no slower where they do not.
    #[allow(unsafe_code)]
    pub fn closest8(&self, rays: &[Ray; LANES]) -> [Hit; LANES] {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is set only where the machine has the features.
            return unsafe {
                by_form!(self.geometry.form, CORNERS => super::avx2_bundle::closest_hits::<CORNERS>(self, rays))
            };
        }
        rays.map(|ray| self.closest(&ray))
    }

    /// Which of the rays in `asked`, a bit each, something lies between the ends of; the other bits are 0. Quicker than
    /// one by one where they go much the same way, such as those of neighbouring points to one light.
    #[allow(unsafe_code)]
    pub fn occluded8(&self, rays: &[Ray; LANES], asked: u8) -> u8 {
        #[cfg(target_arch = "x86_64")]
        // Packets know neither rays inside of glass nor ends behind the origin.
        if self.avx2 && rays.iter().all(|ray| !ray.inside && ray.t_min >= 0.0) {
            // SAFETY: `avx2` is set only where the machine has the features.
            return unsafe { super::avx2_packet::occluded(self, rays, u32::from(asked)) } as u8;
        }
        let is_hit = |lane: &usize| asked >> lane & 1 == 1 && self.occluded(&rays[*lane]);
        (0..LANES).filter(is_hit).fold(0, |hits, lane| hits | 1 << lane)
    }

    /// [`Tracer::occluded8`] of rays number by number.
    #[allow(unsafe_code)]
    pub(crate) fn occluded_lanes(&self, rays: &RayLanes, asked: u32) -> u32 {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is set only where the machine has the features.
            return unsafe { super::avx2_packet::occluded_lanes(self, rays, asked) };
        }
        let is_hit = |lane: &usize| asked >> lane & 1 == 1 && self.occluded(&rays.ray(*lane));
        (0..LANES).filter(is_hit).fold(0, |hits, lane| hits | 1 << lane)
    }
}

/// A box around the root's children, without those that are left out, a bit each; an inverted one around nothing.
pub(crate) fn root_box(geometry: &Geometry<'_>, left_out: impl Fn(&BvhNode) -> u32) -> (Vec3, Vec3) {
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let Some(root) = geometry.nodes.first() else { return nothing };
    let children = (0..LANES).filter(|lane| left_out(root) >> lane & 1 == 0).map(|lane| root.child_box(lane));
    children.fold(nothing, |(a, b), (lower, upper)| (a.min(lower), b.max(upper)))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::cpu::{Blocks, Candidates, HalfSpaces, Receiver, evaluate, evaluate_together, select};
    use crate::light_tree::tests::scattered;
    use crate::light_tree::{LightTree, TreeLayout};
    use lightcuts_import::{ImportOptions, load};
    use lightcuts_kernel::rng::random4;
    use lightcuts_testkit::project_root;
    use lightcuts_world::World;
    use lightcuts_world::bvh::{ChildRef, intersect_leaf};

    const RULES: [Rules; 2] = [Rules::Original, Rules::Repaired];

    fn world(scene: &str) -> World {
        let path = project_root().join("scenes").join(scene);
        let imported = load(&path, &ImportOptions::default()).expect("the project's own scene loads");
        World::new(&imported.scene).expect("the scene is sound")
    }

    /// Rays between random points in and around the room, some along the axes.
    fn ray(k: u32) -> Ray {
        let [a, b, c, d] = random4(k, 0, 0, 17);
        let [e, f, g, _] = random4(k, 1, 0, 17);
        let origin = (Vec3::new(a, b, c) - 0.5) * 450.0;
        let towards = match k % 8 {
            0 => Vec3::X,
            1 => Vec3::NEG_Y,
            2 => Vec3::new(0.0, 1.0, -1.0),
            _ => (Vec3::new(e, f, g) - 0.5) * 450.0 - origin,
        };
        let (direction, t_max) = if d < 0.5 { (towards, 1.0) } else { (towards.normalize(), f32::INFINITY) };
        Ray { origin, direction, t_min: 0.001, t_max, inside: k.is_multiple_of(5) }
    }

    /// Every leaf in turn, without the hierarchy.
    pub(crate) fn brute_force(geometry: &Geometry<'_>, ray: &Ray, rules: Rules) -> Hit {
        let mut best = Hit::none(ray.t_max);
        let leaves = (0..geometry.triangles.len() as u32)
            .map(ChildRef::Triangles)
            .chain((0..geometry.spheres.len() as u32).map(ChildRef::Sphere))
            .chain((0..geometry.squares.len() as u32).map(ChildRef::Square));
        for leaf in leaves {
            intersect_leaf(geometry, leaf, ray, rules, &mut |hit| best.take_nearer(hit));
        }
        best
    }

    #[test]
    fn hierarchy_and_simd_find_what_brute_force_finds() {
        for scene in ["thesis/simple.txt", "thesis/statue.txt", "thesis/ship.txt", "gallery/cubes.txt"] {
            let world = world(scene);
            let geometry = world.shapes.geometry();
            let mut hits = 0;
            for k in 0..20_000 {
                let ray = ray(k);
                let rules = RULES[(k / 8 % 2) as usize];
                let expected = brute_force(&geometry, &ray, rules);
                hits += u32::from(expected.is_some());
                for simd in [Simd::Off, Simd::Auto] {
                    let tracer = Tracer::new(geometry, rules, simd);
                    assert_eq!(tracer.closest(&ray), expected, "{scene}, {simd:?}, ray {k}");
                    assert_eq!(tracer.occluded(&ray), expected.is_some(), "{scene}, {simd:?}, ray {k}");
                }
            }
            println!("{scene}: {hits} of 20000 rays hit");
            assert!(hits > 5_000);
        }
    }

    /// Rays of a bundle: all that differs is a little.
    fn bundle(k: u32) -> [Ray; LANES] {
        let first = ray(k);
        let spread = if k.is_multiple_of(3) { 40.0 } else { 2.0 };
        std::array::from_fn(|lane| {
            let [a, b, c, d] = random4(k, 3 + lane as u32, 0, 17);
            let shift = (Vec3::new(a, b, c) - 0.5) * spread;
            let t_max = if k % 4 == 1 { first.t_max * d } else { first.t_max };
            match k % 2 {
                0 => Ray { direction: first.direction + shift * first.direction.length() * 0.01, t_max, ..first },
                _ => Ray { origin: first.origin + shift, t_max, ..first },
            }
        })
    }

    #[test]
    fn eight_rays_find_what_each_finds() {
        for scene in ["thesis/simple.txt", "thesis/statue.txt", "thesis/ship.txt", "gallery/cubes.txt"] {
            let world = world(scene);
            let (mut hits, mut hidden) = (0, 0);
            for k in 0..8_000 {
                let rules = RULES[(k / 8 % 2) as usize];
                let asked = [0xff, 0x81, 0x0f, 0x5a, 0][(k % 5) as usize];
                let rays = if k % 7 == 6 { std::array::from_fn(|lane| ray(k + lane as u32)) } else { bundle(k) };
                let single = Tracer::new(world.shapes.geometry(), rules, Simd::Off);
                let nearest = rays.map(|ray| single.closest(&ray));
                let is_hit = |lane: &usize| asked >> lane & 1 == 1 && nearest[*lane].is_some();
                let expected = (0..LANES).filter(is_hit).fold(0, |hits, lane| hits | 1 << lane);
                for simd in [Simd::Off, Simd::Auto] {
                    let tracer = Tracer::new(world.shapes.geometry(), rules, simd);
                    assert_eq!(tracer.closest8(&rays), nearest, "{scene}, {simd:?}, bundle {k}");
                    assert_eq!(tracer.occluded8(&rays, asked), expected, "{scene}, {simd:?}, bundle {k}");
                }
                hits += nearest.iter().filter(|hit| hit.is_some()).count();
                hidden += expected.count_ones();
            }
            assert!(hits > 10_000 && hidden > 2_000, "{scene}: {hits}, {hidden}");
        }
    }

    #[test]
    fn gathering_is_bit_equal_with_and_without_simd() {
        let tree = LightTree::build(&scattered(203), TreeLayout::Wide);
        let all: Vec<Candidates> = tree.every_block(true).chain(tree.every_block(false)).collect();
        for scene in ["thesis/simple.txt", "thesis/ship.txt", "gallery/cubes.txt", "gallery/area-light.txt"] {
            let world = world(scene);
            let mut lit = 0;
            for k in 0..600 {
                let rules = RULES[(k % 2) as usize];
                let [a, b, c, _] = random4(k, 2, 0, 17);
                let at = Receiver {
                    point: (Vec3::new(a, b, c) - 0.5) * 390.0,
                    normal: (ray(k).direction).normalize(),
                    diffuse: Vec3::new(0.5, 0.2, 0.9),
                    epsilon: 0.01,
                };
                let gather = |simd| {
                    let tracer = Tracer::new(world.shapes.geometry(), rules, simd);
                    let half_spaces = HalfSpaces::new(&tracer, &tree);
                    evaluate(&tracer, &Blocks { vpls: &tree.blocks, half_spaces: &half_spaces }, &all, Some(1e-5), &at)
                };
                let (plain, wide) = (gather(Simd::Off), gather(Simd::Auto));
                assert_eq!(plain, wide, "{scene} at {}", at.point);
                lit += u32::from(plain.color != Vec3::ZERO);
            }
            assert!(lit > 300, "{scene}: {lit}");
        }
    }

    #[test]
    fn points_gather_together_what_each_gathers() {
        let tree = LightTree::build(&scattered(203), TreeLayout::Wide);
        for scene in ["thesis/simple.txt", "thesis/ship.txt", "gallery/cubes.txt", "gallery/area-light.txt"] {
            let world = world(scene);
            let mut chosen = 0;
            for k in 0..200 {
                let tracer = Tracer::new(world.shapes.geometry(), RULES[(k % 2) as usize], Simd::Auto);
                let [a, b, c, _] = random4(k, 2, 0, 17);
                let spread = [300.0, 4.0, 20.0][(k % 3) as usize];
                let receivers: [Receiver; 4 * LANES] = std::array::from_fn(|lane| {
                    let [d, e, f, _] = random4(k, 8 + lane as u32, 0, 17);
                    let turned = if k % 5 < 2 { Vec3::ZERO } else { Vec3::new(d, e, f) * 0.2 };
                    Receiver {
                        point: (Vec3::new(a, b, c) - 0.5) * 390.0 + (Vec3::new(d, e, f) - 0.5) * spread,
                        normal: (ray(k).direction + turned).normalize(),
                        diffuse: Vec3::new(0.5, d, 0.9),
                        epsilon: 0.01 + e * 0.01,
                    }
                });
                for threshold in [None, Some(2e-6), Some(1e-4)] {
                    let lists = receivers.each_ref().map(|at| {
                        let mut list = Vec::new();
                        if let Some(threshold) = threshold {
                            select(&tree, tracer.avx2, (at.point, at.point), threshold, &mut list);
                        } else {
                            list.extend(tree.every_block(true));
                        }
                        list
                    });
                    let count = 2 + (k % 31) as usize;
                    // The same list, or one that is equal.
                    let is_shared = threshold.is_none() && k % 2 == 0;
                    let lists: [&[Candidates]; 4 * LANES] =
                        std::array::from_fn(|lane| &lists[if is_shared { 0 } else { lane }][..]);
                    let half_spaces = HalfSpaces::new(&tracer, &tree);
                    let blocks = &Blocks { vpls: &tree.blocks, half_spaces: &half_spaces };
                    let together = evaluate_together(&tracer, blocks, &lists[..count], threshold, &receivers[..count]);
                    for lane in 0..count {
                        let alone = evaluate(&tracer, blocks, lists[lane], threshold, &receivers[lane]);
                        assert_eq!(together[lane], alone, "{scene}, bundle {k}, {threshold:?}, point {lane}");
                        chosen += alone.chosen;
                    }
                }
            }
            assert!(chosen > 10_000, "{scene}: {chosen}");
        }
    }
}
