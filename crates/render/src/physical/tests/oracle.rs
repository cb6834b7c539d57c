//! Cuts against the sum over all virtual lights, which is exact for a given set of them.

use super::scenes::{glossy_room, room};
use crate::cpu::Simd;
use crate::physical::bundle::{Bundle, Clusters, Cutting, Fineness};
use crate::physical::cluster_tree::ClusterTree;
use crate::physical::emission::Origins;
use crate::physical::gather::{CutHeap, Gathered, Receiver};
use crate::physical::lightcuts::gathered_lobes;
use crate::physical::scene::{Cone, Interaction, Scene};
use crate::physical::sums::Counts;
use crate::physical::vpls::trace_vpls;
use glam::Vec3;
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::lens::lens_ray;
use lightcuts_kernel::virtual_light::VirtualLight;
use lightcuts_world::PhysicalWorld;
use lightcuts_world::bvh::LANES;

/// The distance below which light no longer grows, squared.
const CLAMP_SQ: f32 = 0.0025;

/// What every pixel of a scene shows that gathers virtual lights.
fn every_pixel(scene: &Scene<'_>, size: u32) -> Vec<((u32, u32), Interaction)> {
    let lens = scene.world.lens(size, size);
    let see = |(i, j): (u32, u32)| {
        let ray = lens_ray(&lens, [i as f32 + 0.5, j as f32 + 0.5], [0.0; 2]);
        let at = scene.interaction(&ray, &scene.closest(&ray)?, Cone::NONE, 0.5);
        (gathered_lobes(&at.bsdf) != 0).then_some(((i, j), at))
    };
    (0..size).flat_map(|j| (0..size).map(move |i| (i, j))).filter_map(see).collect()
}

fn receiver<'a>(scene: &'a Scene<'a>, at: &'a Interaction) -> Receiver<'a> {
    Receiver::new(scene, at, Vec3::ONE, Vec3::ONE, CLAMP_SQ)
}

fn fineness(error: f32) -> Fineness {
    Fineness { error, max_cut: u32::MAX }
}

/// Checks a cut against all lights, by the definition of its bound.
fn check(all: Vec3, cut: &Gathered, error: f32, what: &str) {
    let difference = (light_power(cut.light) - light_power(all)).abs();
    let rounding = 2e-4 * light_power(all);
    assert!(difference <= cut.bound + rounding, "{what}: {difference} > {}", cut.bound);
    if error == 0.0 {
        assert!(difference <= rounding, "{what}: {difference}");
        assert_eq!(cut.bound, 0.0, "{what}");
    }
}

/// The tree over what light paths leave.
fn tree(scene: &Scene<'_>, origins: &Origins, paths: u32, stream: u32) -> ClusterTree {
    ClusterTree::build(&lights(scene, origins, paths, stream), 4, &|| false)
}

fn lights(scene: &Scene<'_>, origins: &Origins, paths: u32, stream: u32) -> Vec<VirtualLight> {
    let left = trace_vpls(scene, origins, None, paths, stream, &|| false);
    left.items.iter().filter_map(|judged| judged.light).collect()
}

/// The oracle: at every pixel the sum over a cut is as near to the sum over all lights as it says, and equal for an
/// error of 0.
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
        let points = every_pixel(&scene, size);
        for (pixel, at) in &points {
            let receiver = receiver(&scene, at);
            let all = receiver.all(&tree, &mut counts).light;
            for error in [0.3, 0.02, 0.0] {
                let cut = receiver.cut(&tree, fineness(error), None, &mut heap, &mut counts);
                check(all, &cut, error, &format!("{name} {pixel:?}"));
                if cut.bound > 0.0 {
                    closest = closest.max((light_power(cut.light) - light_power(all)).abs() / cut.bound);
                }
                if error == 0.02 {
                    sizes += cut.size;
                }
            }
        }
        let pixels = points.len();
        println!(
            "{name}, {} lights: {pixels} pixels, {:.0} in a cut of 2 %, the closest reaches {closest:.2} of its bound",
            tree.lights.len(),
            f64::from(sizes) / pixels as f64,
        );
        assert!(pixels > 100);
    }
}

/// Lights that differ in nothing but power send, through any cut, what all of them send: each is in one cluster of the
/// cut, with all of its power.
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
    let tree = ClusterTree::build(&lights, 4, &|| false);
    let (mut heap, mut counts) = (CutHeap::default(), Counts::default());
    let mut lit = 0;
    for (pixel, at) in every_pixel(&scene, 12) {
        let receiver = receiver(&scene, &at);
        let all = light_power(receiver.all(&tree, &mut counts).light);
        lit += u32::from(all > 0.0);
        for max_cut in [1, 2, 9, 100, u32::MAX] {
            let fineness = Fineness { error: 0.0, max_cut };
            let cut = receiver.cut(&tree, fineness, None, &mut heap, &mut counts);
            assert!((light_power(cut.light) - all).abs() <= 2e-4 * all, "{pixel:?}, at most {max_cut}");
            assert!(cut.size <= max_cut.max(2));
        }
    }
    assert!(lit > 20);
}

/// Eight points at once: the sum over all lights is that of each point, cuts are within their bounds, and instructions
/// for eight numbers change no bit.
#[test]
fn points_that_are_lit_together_are_lit_as_each_is() {
    for (name, room, paths) in
        [("open", room(false), 280), ("occluded", room(true), 280), ("glossy", glossy_room(), 280)]
    {
        let world = PhysicalWorld::new(&room).unwrap();
        let scenes = [Simd::Auto, Simd::Off].map(|simd| Scene::new(&world, simd));
        let origins = Origins::new(&scenes[0]).unwrap();
        let tree = tree(&scenes[0], &origins, paths, 3);
        let (mut clusters, mut counts) = (Clusters::default(), Counts::default());
        let points = every_pixel(&scenes[0], 22);
        for (number, points) in points.chunks(LANES).enumerate() {
            let bundles = scenes.each_ref().map(|scene| {
                let receivers: Vec<_> = points.iter().map(|(_, at)| receiver(scene, at)).collect();
                Bundle::new(&receivers)
            });
            let [wide, plain] = [0, 1].map(|k| bundles[k].all(&tree, &mut counts));
            assert_eq!(wide, plain, "{name} {number}");
            let each: Vec<Vec3> =
                points.iter().map(|(_, at)| receiver(&scenes[0], at).all(&tree, &mut counts).light).collect();
            for (lane, &all) in each.iter().enumerate() {
                let difference = (wide[lane].light - all).abs().max_element();
                assert!(difference <= 2e-5 * all.max_element(), "{name} {number} {lane}: {difference}");
            }
            let known: [f32; LANES] = std::array::from_fn(|lane| light_power(each[lane.min(each.len() - 1)]));
            let most = u32::MAX;
            for (error, max_cut, references) in [
                (0.3, most, None),
                (0.02, most, None),
                (0.02, most, Some(known)),
                (0.02, 60, Some(known)),
                (0.0, most, None),
                (0.0, most, Some(known)),
            ] {
                let cutting = Cutting { tree: &tree, fineness: Fineness { error, max_cut }, references };
                let [wide, plain] = [0, 1].map(|k| bundles[k].cut(&cutting, &mut clusters, &mut counts));
                assert_eq!(wide, plain, "{name} {number}");
                for (lane, &all) in each.iter().enumerate() {
                    check(all, &wide[lane], error, &format!("{name} {number} {lane}"));
                }
            }
        }
    }
}
