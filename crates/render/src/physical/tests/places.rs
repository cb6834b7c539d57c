//! Where a scene and its camera lie, and how large it is, does not change its picture; what is shut in stays there.

use super::scenes::{
    caustic_room, diffuse, direction, instance, looking, mean, moved, object, point, quad, rectangle, render, room,
    scaled, settings, sky, tall_box,
};
use crate::physical::PhysicalRendering;
use crate::settings::{Integrator, Strategy};
use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3};
use lightcuts_kernel::rng::random4;
use lightcuts_scene::MeshDesc;
use lightcuts_scene::physical::{PhysicalCamera, PhysicalObject, PhysicalScene, PhysicalShape, View};

/// The room and its mirrors as far away as 1e6, at 1e-3 to 1e3 of their size: what rounding changes is single paths.
#[test]
fn moved_scenes_look_the_same() {
    for (name, scene) in [("room", room(false)), ("behind a shade", room(true)), ("mirrors", caustic_room())] {
        for integrator in [Integrator::Path, Integrator::Lightcuts] {
            let settings = settings(integrator, 24, 12);
            let here = render(&scene, &settings);
            for k in 0..4 {
                let size = [1.0, 1.0, 1e-3, 1e3][k as usize];
                let shift = direction(k).as_dvec3() * f64::from(size) * 10.0_f64.powi(3 + k as i32);
                let there = render(&moved(&scaled(&scene, size), shift), &settings);
                let ratio = (mean(&there) / mean(&here)).to_array();
                println!("{name}, {integrator:?}, {size} at {shift:.0}: {ratio:.5?}");
                assert!(ratio.iter().all(|r| (r - 1.0).abs() < 0.01), "{name}, {integrator:?}, {shift}: {ratio:?}");
                let is_lit = |p: &[f32; 3]| Vec3::from(*p).max_element() > 0.0;
                let lit = [&here, &there].map(|of| of.beauty.pixels().iter().filter(|p| is_lit(p)).count());
                assert_eq!(lit[0], lit[1], "{name}, {integrator:?}, {shift}: pixels turn black");
            }
        }
    }
}

/// Parallel rays from as far away as 1e7 show the same, and how far that is.
#[test]
fn far_cameras_of_parallel_rays_see_the_same() {
    let towards = Vec3::new(-0.3, -0.5, -0.8).normalize();
    let seen = |distance: f64| {
        let scene = PhysicalScene {
            camera: PhysicalCamera {
                position: DVec3::new(0.5, 0.3, 0.5) - towards.as_dvec3() * distance,
                direction: towards,
                view: View::Orthographic { height: 1.2 },
                near: 0.5,
                ..PhysicalCamera::default()
            },
            objects: vec![
                rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 20.0, 20.0, 0),
                instance(0, DAffine3::from_rotation_y(0.3), 0),
            ],
            materials: vec![diffuse(Vec3::splat(0.5))],
            meshes: vec![tall_box()],
            environment: Some(sky(1.0)),
            ..PhysicalScene::default()
        };
        render(&scene, &settings(Integrator::Path, 32, 32))
    };
    let near = seen(20.0);
    for distance in [1e3, 1e5, 1e7] {
        let far = seen(distance);
        let ratio = mean(&far).y / mean(&near).y;
        println!("{distance:e}: {ratio:.5}");
        assert!((ratio - 1.0).abs() < 1e-3, "{distance:e}: {ratio}");
        let darkest = |of: &PhysicalRendering| of.beauty.pixels().iter().map(|p| p[1]).fold(f32::INFINITY, f32::min);
        assert!(darkest(&far) > 0.8 * darkest(&near), "{distance:e}: {}", darkest(&far));
        for (far, near) in far.aovs().depth.pixels().iter().zip(near.aovs().depth.pixels()) {
            let off = f64::from(*far) - f64::from(*near) - (distance - 20.0);
            assert!(off.abs() < 0.02 + 1e-6 * distance, "{distance:e}: {far} where it was {near}");
        }
    }
}

/// Ground of albedo 1/2 under even light is half as bright, whatever its radius; the ball on it darkens what is near.
#[test]
fn large_spheres_have_no_bands() {
    for radius in [1e2_f32, 1e3, 1e4, 1e5] {
        let ball = |height: f64, radius| object(PhysicalShape::Sphere { center: DVec3::Y * height, radius }, 0);
        let scene = PhysicalScene {
            camera: looking(Vec3::new(0.0, 2.0, 6.0), Vec3::new(0.0, 0.5, 0.0), 35.0),
            objects: vec![ball(-f64::from(radius), radius), ball(0.5, 0.5)],
            materials: vec![diffuse(Vec3::splat(0.5))],
            environment: Some(sky(0.5)),
            ..PhysicalScene::default()
        };
        let rendering = render(&scene, &settings(Integrator::Path, 48, 32));
        let green: Vec<f32> = rendering.beauty.pixels().iter().map(|p| p[1]).collect();
        let darkest = green.iter().copied().fold(f32::INFINITY, f32::min);
        let near = green[48 * 44..].iter().sum::<f32>() / (48.0 * 4.0);
        println!("radius {radius}: darkest {darkest:.4}, away from the ball {near:.4}");
        assert!(darkest > 0.03 && (near - 0.25).abs() < 0.004, "radius {radius}: {darkest}, {near}");
    }
}

/// Light that is shut in is seen by nobody: boxes of six rectangles and of twelve triangles, turned, thin and far away.
#[test]
fn closed_boxes_leak_nothing() {
    for k in 0..8 {
        let [a, b, c, d] = random4(k, 0, 0, 62);
        let turn = DQuat::from_euler(EulerRot::XYZ, f64::from(a) * 6.0, f64::from(b) * 6.0, f64::from(c) * 6.0);
        let size = DVec3::new(2.0, 0.4 + 1.6 * f64::from(d), 2.0);
        let placement = DAffine3::from_scale_rotation_translation(size, turn, DVec3::Y * 1.5);
        let mut scene = PhysicalScene {
            camera: looking(Vec3::new(4.0, 3.0, 4.0), Vec3::ZERO, 45.0),
            objects: vec![rectangle(Vec3::NEG_Y, Vec3::Y, Vec3::Z, 20.0, 20.0, 0)],
            lights: vec![point(Vec3::Y * 1.5, Vec3::splat(100.0))],
            materials: vec![diffuse(Vec3::splat(0.8))],
            ..PhysicalScene::default()
        };
        for side in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            scene.objects.push(wall(&mut scene.meshes, placement, size, side, k.is_multiple_of(2)));
        }
        let far = moved(&scene, direction(k).as_dvec3() * [0.0, 1e3, 1e5][k as usize % 3]);
        for strategy in [Strategy::Lightcuts, Strategy::All] {
            let mut settings = settings(Integrator::Lightcuts, 24, 24);
            settings.gather.strategy = strategy;
            settings.physical.vpls = if strategy == Strategy::All { 200 } else { 2000 };
            let brightest = render(&far, &settings).beauty.pixels().iter().flatten().copied().fold(0.0, f32::max);
            assert_eq!(brightest, 0.0, "box {k}, {strategy:?}");
        }
    }
}

/// A side of the unit cube, placed: a rectangle, or two triangles.
fn wall(meshes: &mut Vec<MeshDesc>, placement: DAffine3, size: DVec3, side: Vec3, is_mesh: bool) -> PhysicalObject {
    let up = if side.y == 0.0 { Vec3::Y } else { Vec3::Z };
    let right = up.cross(side);
    if is_mesh {
        meshes.push(quad(side * 0.5, right, up));
        return instance(meshes.len() as u32 - 1, placement, 0);
    }
    let turned = |v: Vec3| placement.transform_vector3(v.as_dvec3()).normalize().as_vec3();
    let (width, height) = (size.dot(right.abs().as_dvec3()) as f32, size.dot(up.abs().as_dvec3()) as f32);
    let center = placement.transform_point3(side.as_dvec3() * 0.5);
    object(PhysicalShape::Rectangle { center, normal: turned(side), head: turned(up), width, height }, 0)
}
