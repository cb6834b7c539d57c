//! Surfaces of many triangles, wherever they lie and however flat one looks along them: nothing goes through, no light is
//! lost, and they end where they end.

use super::scenes::{diffuse, instance, mean, render, settings, sky};
use crate::cpu::{Simd, Tracer};
use crate::settings::Integrator;
use glam::{DAffine3, DVec3, Vec3};
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_kernel::rng::random4;
use lightcuts_scene::physical::{EmitterDesc, EmitterKind, PhysicalCamera, PhysicalScene, View};
use lightcuts_scene::{Location, MeshDesc, MeshTriangle};
use lightcuts_world::PhysicalWorld;
use lightcuts_world::bvh::LANES;

/// A sheet of quads, `across` by `down` of them, from a corner along two edges.
fn sheet(mesh: &mut MeshDesc, corner: Vec3, edges: [Vec3; 2], [across, down]: [u32; 2]) {
    let first = mesh.positions.len() as u32;
    let place = |i: u32, j: u32| corner + edges[0] * (i as f32 / across as f32) + edges[1] * (j as f32 / down as f32);
    mesh.positions.extend((0..=down).flat_map(|j| (0..=across).map(move |i| (i, j))).map(|(i, j)| place(i, j)));
    let vertex = |i: u32, j: u32| first + j * (across + 1) + i;
    let triangle = |positions| MeshTriangle { positions, normals: None, texture_coordinates: None, material: None };
    for (i, j) in (0..down).flat_map(|j| (0..across).map(move |i| (i, j))) {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        mesh.triangles.extend([triangle([a, b, c]), triangle([a, c, d])]);
    }
}

fn floor(quads: [u32; 2]) -> MeshDesc {
    let mut mesh = MeshDesc::default();
    sheet(&mut mesh, Vec3::new(-1.0, 0.0, -1.0), [Vec3::X * 2.0, Vec3::Z * 2.0], quads);
    mesh
}

/// A cube of 2 units about the origin whose sides share corners.
fn cube(quads: u32) -> MeshDesc {
    let mut mesh = MeshDesc::default();
    for axis in 0..3 {
        let [out, a, b] = [0, 1, 2].map(|step| Vec3::AXES[(axis + step) % 3]);
        sheet(&mut mesh, -out - a - b, [a * 2.0, b * 2.0], [quads; 2]);
        sheet(&mut mesh, out - a - b, [a * 2.0, b * 2.0], [quads; 2]);
    }
    mesh
}

fn turn(degrees: f64) -> DAffine3 {
    DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), degrees.to_radians())
}

fn scene(mesh: MeshDesc, placement: DAffine3, albedo: f32) -> PhysicalScene {
    PhysicalScene {
        objects: vec![instance(0, placement, 0)],
        materials: vec![diffuse(Vec3::splat(albedo))],
        meshes: vec![mesh],
        ..PhysicalScene::default()
    }
}

/// Floors of squares, strips and needles, seen from as flat as a hundredth of a degree above: every ray to a place within
/// finds them, those to edges and corners too, alone, in bundles and without SIMD.
#[test]
fn floors_have_no_seams() {
    for (quads, degrees) in [([64, 64], 77.7), ([400, 3], 77.7), ([3, 1000], 50.0), ([64, 64], 0.0), ([7, 5], 12.3)] {
        let placement = turn(degrees);
        let world = PhysicalWorld::new(&scene(floor(quads), placement, 0.0)).expect("the scene is sound");
        let there = |p: Vec3| (placement.transform_point3(p.as_dvec3()) - world.origin).as_vec3();
        let ray = |k: u32| {
            let [u, v, which, slope] = random4(k, 0, 0, 96);
            let [turn, ..] = random4(k / 16, 1, 0, 96);
            // Anywhere, on an edge, at a corner; some way off the border.
            let snapped = |x: f32, n: u32| (x * n as f32).round() / n as f32;
            let u = if which < 0.6 { snapped(u, quads[0]) } else { u };
            let v = if which < 0.3 { snapped(v, quads[1]) } else { v };
            let inside = |x: f32| (2.0 * x - 1.0).clamp(-0.98, 0.98);
            let target = Vec3::new(inside(u), 0.0, inside(v));
            let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
            let away = Vec3::new(cos, 10.0_f32.powf(-3.7 * slope), sin) * 3.0;
            let (origin, target) = (there(target + away), there(target));
            Ray { origin, direction: target - origin, t_min: 0.0, t_max: f32::INFINITY, inside: false }
        };
        for k in 0..4_000 {
            let rays: [Ray; LANES] = std::array::from_fn(|lane| ray(LANES as u32 * k + lane as u32));
            for simd in [Simd::Off, Simd::Auto] {
                let tracer = Tracer::new(world.shapes.geometry(), Rules::Repaired, simd);
                assert_eq!(tracer.occluded8(&rays, 0xff), 0xff, "{quads:?}, {simd:?}, {k}");
                assert!(tracer.closest8(&rays).iter().all(Hit::is_some), "{quads:?}, {simd:?}, {k}");
                let alone = &rays[k as usize % LANES];
                assert!(tracer.closest(alone).is_some() && tracer.occluded(alone), "{quads:?}, {simd:?}, {k}");
            }
        }
    }
}

/// Drawn in a cube of 2 units about the origin: a place within, and one at a corner, on an edge, or on a side.
fn within_cube(k: u32, what: u32) -> (Vec3, Vec3) {
    let [x, y, z, which] = random4(k, what, 0, 96);
    let [a, b, c, _] = random4(k, what + 1, 0, 96);
    let mut target = Vec3::new(x, y, z) * 2.0 - 1.0;
    for axis in 0..[3, 2, 1][(which * 3.0) as usize % 3] {
        target[axis] = target[axis].signum();
    }
    (Vec3::new(a, b, c) * 2.0 - 1.0, target)
}

/// From within a closed cube every ray ends at it, right to its edges and corners too.
#[test]
fn cubes_have_no_seams() {
    for (quads, degrees) in [(1, 37.0), (20, 37.0), (60, 0.0)] {
        let placement = turn(degrees);
        let world = PhysicalWorld::new(&scene(cube(quads), placement, 0.0)).expect("the scene is sound");
        let tracer = Tracer::new(world.shapes.geometry(), Rules::Repaired, Simd::Auto);
        let there = |p: Vec3| (placement.transform_point3(p.as_dvec3()) - world.origin).as_vec3();
        for k in 0..40_000 {
            let (place, target) = within_cube(k, 2);
            let origin = there(place * 0.999);
            let ray =
                Ray { origin, direction: there(target) - origin, t_min: 0.0, t_max: f32::INFINITY, inside: false };
            let hit = tracer.closest(&ray);
            assert!(hit.is_some() && tracer.occluded(&ray), "{quads}, {k}: {ray:?}");
            assert!((hit.t - 1.0).abs() < 0.02, "{quads}, {k}: {} to {target}", hit.t);
        }
    }
}

/// Six sheets of different grids, in files of their own far from the origin of their coordinates, of 32 bits or of seven
/// digits: together they are closed, to their edges and corners.
#[test]
fn sheets_given_far_from_their_origin_join() {
    for (distance, digits) in [(0.0, 9), (80.0, 9), (80.0, 7), (1000.0, 7), (1e5, 9)] {
        let turn = turn(33.3);
        let place = DVec3::new(0.5, -0.7, 0.51) * distance;
        let size = f64::max(0.2, 1e-3 * distance);
        let meshes = (0..6).map(|side: usize| {
            let [out, a, b] = [0, 1, 2].map(|step| Vec3::AXES[(side / 2 + step) % 3]);
            let out = if side.is_multiple_of(2) { out } else { -out };
            let mut mesh = MeshDesc::default();
            sheet(&mut mesh, out - a - b, [a * 2.0, b * 2.0], [3 + side as u32, 9 - side as u32]);
            for position in &mut mesh.positions {
                let there = place + turn.transform_vector3(position.as_dvec3() * size);
                let text = there.to_array().map(|c| format!("{c:.*e}", digits - 1));
                *position = Vec3::from(text.map(|text| text.parse::<f32>().expect("a number")));
            }
            mesh
        });
        let scene = PhysicalScene {
            objects: (0..6).map(|mesh| instance(mesh, DAffine3::IDENTITY, 0)).collect(),
            materials: vec![diffuse(Vec3::ZERO)],
            meshes: meshes.collect(),
            ..PhysicalScene::default()
        };
        let world = PhysicalWorld::new(&scene).expect("the scene is sound");
        let tracer = Tracer::new(world.shapes.geometry(), Rules::Repaired, Simd::Auto);
        let there = |p: Vec3| (place + turn.transform_vector3(p.as_dvec3() * size) - world.origin).as_vec3();
        for k in 0..100_000 {
            let (place, target) = within_cube(k, 5);
            let origin = there(place * 0.98);
            let direction = there(target) - origin;
            let ray = Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, inside: false };
            assert!(tracer.closest(&ray).is_some(), "{distance}, {digits}, {k}: {ray:?}");
        }
    }
}

/// A sun over strips, one over another only where it shines along them: all of its light comes back.
#[test]
fn strips_lose_no_light() {
    for strips in [300, 10_000] {
        let placement = turn(50.0);
        let at = |v: Vec3| placement.transform_vector3(v.as_dvec3());
        let sun = Vec3::new(1.0, -0.1, 0.0).normalize();
        let mut scene = scene(floor([strips, 1]), placement, 0.8);
        let (position, direction) = (at(Vec3::Y * 5.0), at(Vec3::NEG_Y).as_vec3());
        let view = View::Orthographic { height: 1.2 };
        scene.camera =
            PhysicalCamera { position, direction, up: at(Vec3::X).as_vec3(), view, ..PhysicalCamera::default() };
        let kind = EmitterKind::Directional { direction: at(sun).as_vec3(), irradiance: Vec3::splat(1e4) };
        scene.lights = vec![EmitterDesc { kind, location: Location::default() }];
        let expected = 0.8 * std::f64::consts::FRAC_1_PI * 1e4 * f64::from(-sun.y);
        for integrator in [Integrator::Path, Integrator::Lightcuts] {
            let came = mean(&render(&scene, &settings(integrator, 32, 8))).y;
            println!("{strips} strips, {integrator:?}: {came:.2}, right {expected:.2}");
            // Corners rounded to 32 bits tilt a strip by as much as 3e-4.
            assert!((came / expected - 1.0).abs() < 2e-3, "{strips}, {integrator:?}: {came}, not {expected}");
        }
    }
}

/// Long triangles end at the border of their mesh.
#[test]
fn strips_end_at_their_border() {
    let world = PhysicalWorld::new(&scene(floor([100, 1]), DAffine3::IDENTITY, 0.0)).expect("the scene is sound");
    let tracer = Tracer::new(world.shapes.geometry(), Rules::Repaired, Simd::Auto);
    for k in 0..10_000 {
        let [x, side, ..] = random4(k, 4, 0, 96);
        let hits = |beyond: f32| {
            let z = (1.0 + beyond) * (side - 0.5).signum();
            let origin = Vec3::new(1.9 * x - 0.95, 3.0, z) - world.origin.as_vec3();
            tracer.occluded(&Ray { origin, direction: Vec3::NEG_Y, t_min: 0.0, t_max: 10.0, inside: false })
        };
        assert!(hits(-1e-5) && !hits(2e-5), "{k}");
    }
}

/// Bright light around a closed cube of many triangles: nothing of it is seen within.
#[test]
fn tessellated_cubes_are_dark() {
    let mut scene = scene(cube(24), turn(37.123), 0.8);
    scene.camera = PhysicalCamera {
        position: DVec3::new(0.124, 0.337, -0.13),
        direction: Vec3::new(0.3, -1.0, 0.2),
        view: View::Perspective { degrees: 120.0 },
        ..PhysicalCamera::default()
    };
    scene.environment = Some(sky(1e8));
    for integrator in [Integrator::Path, Integrator::Lightcuts] {
        let rendering = render(&scene, &settings(integrator, 48, 16));
        let brightest = rendering.beauty.pixels().iter().flatten().copied().fold(0.0, f32::max);
        assert_eq!(brightest, 0.0, "{integrator:?}");
    }
}
