//! Cuts against the sum over all virtual lights, which is exact for a given set of them.

use super::scenes::{glossy_room, room};
use crate::cpu::Simd;
use crate::physical::cluster_tree::ClusterTree;
use crate::physical::emission::Origins;
use crate::physical::gather::{CutHeap, Receiver};
use crate::physical::lightcuts::gathered_lobes;
use crate::physical::pass::Counts;
use crate::physical::scene::{Cone, Scene};
use crate::physical::vpls::trace_vpls;
use glam::Vec3;
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::lens::lens_ray;
use lightcuts_kernel::virtual_light::VirtualLight;
use lightcuts_world::PhysicalWorld;

/// The distance below which light no longer grows, squared.
const CLAMP_SQ: f32 = 0.0025;

/// Looks at every pixel of a scene that gathers virtual lights; returns how many there are.
fn at_every_pixel(scene: &Scene<'_>, size: u32, mut look: impl FnMut(Receiver<'_>, (u32, u32))) -> u32 {
    let lens = scene.world.lens(size, size);
    let mut pixels = 0;
    for (i, j) in (0..size).flat_map(|j| (0..size).map(move |i| (i, j))) {
        let ray = lens_ray(&lens, [i as f32 + 0.5, j as f32 + 0.5], [0.0; 2]);
        let Some(hit) = scene.closest(&ray) else { continue };
        let at = scene.interaction(&ray, &hit, Cone::NONE, 0.5);
        if gathered_lobes(&at.bsdf) != 0 {
            look(Receiver::new(scene, &at, Vec3::ONE, Vec3::ONE, CLAMP_SQ), (i, j));
            pixels += 1;
        }
    }
    pixels
}

/// The tree over what light paths leave.
fn tree(scene: &Scene<'_>, origins: &Origins, paths: u32, stream: u32) -> ClusterTree {
    ClusterTree::build(&lights(scene, origins, paths, stream), 4)
}

fn lights(scene: &Scene<'_>, origins: &Origins, paths: u32, stream: u32) -> Vec<VirtualLight> {
    let left = trace_vpls(scene, origins, None, paths, stream);
    left.items.iter().filter_map(|judged| judged.light).collect()
}

/// The oracle: at every pixel the sum over a cut is as near to the sum over all lights as it says, and equal for an error of 0.
#[test]
fn every_cut_is_within_its_bound() {
    for (name, room, paths) in [
        ("open", room(false), 280),
        ("occluded", room(true), 280),
        ("glossy", glossy_room(), 280),
        ("open", room(false), 11_500),
        ("glossy", glossy_room(), 11_500),
    ] {
        let world = PhysicalWorld::new(&room).unwrap();
        let scene = Scene::new(&world, Simd::Auto);
        let origins = Origins::new(&scene).unwrap();
        let tree = tree(&scene, &origins, paths, 3);
        let size = if paths > 1000 { 12 } else { 24 };
        let (mut heap, mut counts) = (CutHeap::default(), Counts::default());
        let (mut closest, mut sizes) = (0.0_f32, 0);
        let pixels = at_every_pixel(&scene, size, |receiver, pixel| {
            let all = receiver.all(&tree, &mut counts).light;
            for error in [0.3, 0.02, 0.0] {
                let cut = receiver.cut(&tree, error, u32::MAX, None, &mut heap, &mut counts);
                let difference = (light_power(cut.light) - light_power(all)).abs();
                let rounding = 2e-4 * light_power(all);
                assert!(difference <= cut.bound + rounding, "{name} {pixel:?}: {difference} > {}", cut.bound);
                if error == 0.0 {
                    assert!(difference <= rounding, "{name} {pixel:?}: {difference}");
                    assert!(cut.bound == 0.0);
                } else if cut.bound > 0.0 {
                    closest = closest.max(difference / cut.bound);
                }
                if error == 0.02 {
                    sizes += cut.size;
                }
            }
        });
        println!(
            "{name}, {} lights: {pixels} pixels, {:.0} in a cut of 2 %, the closest reaches {closest:.2} of its bound",
            tree.lights.len(),
            f64::from(sizes) / f64::from(pixels),
        );
        assert!(pixels > 100);
    }
}

/// Lights that differ in nothing but power send, through any cut, what all of them send: each is in one cluster of the cut, with
/// all of its power.
#[test]
fn every_light_is_in_one_cluster_of_a_cut() {
    let world = PhysicalWorld::new(&room(false)).unwrap();
    let scene = Scene::new(&world, Simd::Auto);
    let origins = Origins::new(&scene).unwrap();
    let mut lights = lights(&scene, &origins, 300, 3);
    let first = lights[0];
    for (k, light) in lights.iter_mut().enumerate() {
        *light = VirtualLight { intensity: Vec3::splat(1.0 + (k % 7) as f32), ..first };
    }
    let tree = ClusterTree::build(&lights, 4);
    let (mut heap, mut counts) = (CutHeap::default(), Counts::default());
    let mut lit = 0;
    at_every_pixel(&scene, 12, |receiver, pixel| {
        let all = light_power(receiver.all(&tree, &mut counts).light);
        lit += u32::from(all > 0.0);
        for max_cut in [1, 2, 9, 100, u32::MAX] {
            let cut = receiver.cut(&tree, 0.0, max_cut, None, &mut heap, &mut counts);
            assert!((light_power(cut.light) - all).abs() <= 2e-4 * all, "{pixel:?}, at most {max_cut}");
            assert!(cut.size <= max_cut.max(2));
        }
    });
    assert!(lit > 20);
}
