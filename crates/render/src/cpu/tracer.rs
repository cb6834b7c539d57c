//! Rays against a world.

use super::Simd;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_world::bvh::{Geometry, any_hit, closest_hit};

/// Traces rays through a geometry by the best means that the machine has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tracer<'a> {
    pub(crate) geometry: Geometry<'a>,
    pub(crate) rules: Rules,
    /// Whether the machine has AVX2 and it is wanted.
    pub(crate) avx2: bool,
}

impl<'a> Tracer<'a> {
    pub(crate) fn new(geometry: Geometry<'a>, rules: Rules, simd: Simd) -> Self {
        Self { geometry, rules, avx2: simd.has_avx2() }
    }

    /// The nearest hit; of equal hits the first in file order.
    #[allow(unsafe_code)]
    pub(crate) fn closest(&self, ray: &Ray) -> Hit {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is set only where the machine has the feature.
            return unsafe { super::avx2_trace::closest_hit(&self.geometry, ray, self.rules) };
        }
        closest_hit(&self.geometry, ray, self.rules)
    }

    /// Whether anything lies between the ray's ends.
    #[allow(unsafe_code)]
    pub(crate) fn occluded(&self, ray: &Ray) -> bool {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is set only where the machine has the feature.
            return unsafe { super::avx2_trace::any_hit(&self.geometry, ray, self.rules) };
        }
        any_hit(&self.geometry, ray, self.rules)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{Candidates, PacketStack, Receiver, evaluate};
    use crate::light_tree::tests::scattered;
    use crate::light_tree::{LightTree, TreeLayout};
    use glam::Vec3;
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
    fn brute_force(geometry: &Geometry<'_>, ray: &Ray, rules: Rules) -> Hit {
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

    #[test]
    fn gathering_is_bit_equal_with_and_without_simd() {
        let tree = LightTree::build(&scattered(203), TreeLayout::Wide);
        let all: Vec<Candidates> = tree.every_block(true).chain(tree.every_block(false)).collect();
        for scene in ["thesis/simple.txt", "thesis/ship.txt", "gallery/cubes.txt"] {
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
                let mut stack = PacketStack::new();
                let mut gather = |simd| {
                    evaluate(
                        &Tracer::new(world.shapes.geometry(), rules, simd),
                        &tree.blocks,
                        &all,
                        Some(1e-5),
                        &at,
                        &mut stack,
                    )
                };
                let (plain, wide) = (gather(Simd::Off), gather(Simd::Auto));
                assert_eq!(plain, wide, "{scene} at {}", at.point);
                lit += u32::from(plain.color != Vec3::ZERO);
            }
            assert!(lit > 300, "{scene}: {lit}");
        }
    }
}
