//! Surfaces in one place with others: lamps shine once, holes show what is behind, in any order and turn.

use super::scenes::{diffuse, instance, light, mean, object, quad, rectangle, render, settings, sky, turned};
use crate::settings::Integrator;
use glam::{DAffine3, DVec3, Vec3};
use lightcuts_scene::physical::{
    AlphaMask, ImageId, PhysicalCamera, PhysicalScene, PhysicalShape, PixelImage, Pixels, SurfaceDesc, View,
};

const BOTH: [Integrator; 2] = [Integrator::Path, Integrator::Lightcuts];

/// Light of a square lamp of edge 2 and radiance 4, 2 above a floor of albedo 1/2, right below its middle.
fn closed_form() -> f64 {
    let n = 400;
    let step = 2.0 / f64::from(n);
    let of = |i: i32, j: i32| {
        let (x, y) = ((f64::from(i) + 0.5) * step - 1.0, (f64::from(j) + 0.5) * step - 1.0);
        // Cosines 2 / d at both ends, over d^2.
        4.0 / (x * x + y * y + 4.0).powi(2)
    };
    let sum: f64 = (0..n).flat_map(|i| (0..n).map(move |j| of(i, j))).sum();
    4.0 * 0.5 / std::f64::consts::PI * sum * step * step
}

/// Seen from between: only the floor.
fn camera() -> PhysicalCamera {
    PhysicalCamera {
        position: DVec3::Y,
        direction: Vec3::NEG_Y,
        up: Vec3::NEG_Z,
        view: View::Orthographic { height: 0.02 },
        ..PhysicalCamera::default()
    }
}

/// A lamp in one plane with other surfaces shines as if it were alone, of all integrators, in every order, form and
/// turn.
#[test]
fn lamps_in_one_plane_with_others_shine_once() {
    const FLOOR: u32 = 0;
    const BLACK: u32 = 1;
    const LAMP: u32 = 2;
    let exact = closed_form();
    let ceiling = |is_mesh: bool, meshes: &mut Vec<_>, size: f32, material| {
        if is_mesh {
            meshes.push(quad(Vec3::Y * 2.0, Vec3::X * size, Vec3::Z * size));
            return instance(meshes.len() as u32 - 1, DAffine3::IDENTITY, material);
        }
        rectangle(Vec3::Y * 2.0, Vec3::NEG_Y, Vec3::Z, size, size, material)
    };
    for k in 0..32 {
        let mut meshes = Vec::new();
        let mut objects = vec![rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 0.5, 0.5, FLOOR)];
        let mut others = vec![
            ceiling(k & 1 != 0, &mut meshes, 2.0, LAMP),
            ceiling(
                k & 2 != 0,
                &mut meshes,
                if k & 16 != 0 { 2.0 } else { 6.0 },
                if k & 4 != 0 { LAMP } else { BLACK },
            ),
        ];
        if k & 4 != 0 && k & 16 == 0 {
            // Both shine, one as large as the other.
            others[1] = ceiling(k & 2 != 0, &mut meshes, 2.0, LAMP);
        }
        if k & 8 != 0 {
            others.reverse();
        }
        objects.extend(others);
        let scene = PhysicalScene {
            camera: camera(),
            objects,
            meshes,
            materials: vec![diffuse(Vec3::splat(0.5)), diffuse(Vec3::ZERO), light(Vec3::splat(4.0))],
            ..PhysicalScene::default()
        };
        let turned = turned(&scene, k);
        for integrator in BOTH {
            let seen = mean(&render(&turned, &settings(integrator, 8, 64))).x;
            assert!((seen / exact - 1.0).abs() < 0.02, "{k}, {integrator:?}: {seen:.4} of {exact:.4}");
        }
    }
}

/// Two lamps back to back in one plane shine one to each side.
#[test]
fn lamps_back_to_back_shine_to_both_sides() {
    for order in 0..2 {
        let lamp = |normal| rectangle(Vec3::Y * 2.0, normal, Vec3::Z, 2.0, 2.0, 1);
        let mut lamps = vec![lamp(Vec3::Y), lamp(Vec3::NEG_Y)];
        if order == 1 {
            lamps.reverse();
        }
        lamps.push(rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 0.5, 0.5, 0));
        let scene = PhysicalScene {
            camera: camera(),
            objects: lamps,
            materials: vec![diffuse(Vec3::splat(0.5)), light(Vec3::splat(4.0))],
            ..PhysicalScene::default()
        };
        for integrator in BOTH {
            let seen = mean(&render(&scene, &settings(integrator, 8, 64))).x;
            assert!((seen / closed_form() - 1.0).abs() < 0.02, "{order}, {integrator:?}: {seen}");
        }
    }
}

/// The same emissive sphere twice is one.
#[test]
fn a_sphere_that_is_there_twice_shines_once() {
    let sphere = || object(PhysicalShape::Sphere { center: DVec3::Y * 2.0, radius: 0.5 }, 1);
    let floor = rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 0.5, 0.5, 0);
    let scene = |objects| PhysicalScene {
        camera: camera(),
        objects,
        materials: vec![diffuse(Vec3::splat(0.5)), light(Vec3::splat(4.0))],
        ..PhysicalScene::default()
    };
    // pi sin^2 of the half angle, times radiance and albedo over pi.
    let exact = 4.0 * 0.5 * 0.0625;
    for objects in [vec![floor.clone(), sphere()], vec![sphere(), floor.clone(), sphere()]] {
        for integrator in BOTH {
            let seen = mean(&render(&scene(objects.clone()), &settings(integrator, 8, 64))).x;
            assert!((seen / exact - 1.0).abs() < 0.02, "{integrator:?}: {seen} of {exact}");
        }
    }
}

/// A decal with holes in one plane with a wall shows the wall where it has them, and itself elsewhere, in either order.
#[test]
fn holes_show_what_lies_in_their_place() {
    let pixels = (0..16).map(|k| [200, 20, 20, if k % 4 < 2 { 255 } else { 0 }]).collect();
    let mask = PixelImage { name: "half".to_owned(), width: 4, height: 4, pixels: Pixels::Srgb(pixels) };
    let decal = SurfaceDesc {
        alpha: Some(AlphaMask { image: ImageId(0), threshold: 0.5 }),
        ..diffuse(Vec3::new(0.8, 0.0, 0.0))
    };
    for k in 0..8 {
        let center = Vec3::new(0.1, 0.2, -0.3) * k as f32;
        let mut objects =
            vec![rectangle(center, Vec3::Z, Vec3::Y, 1.0, 1.0, 0), rectangle(center, Vec3::Z, Vec3::Y, 4.0, 4.0, 1)];
        let is_below = k % 2 == 1;
        if is_below {
            objects.reverse();
        }
        let scene = PhysicalScene {
            camera: PhysicalCamera {
                position: (center + Vec3::Z).as_dvec3(),
                view: View::Orthographic { height: 0.8 },
                ..PhysicalCamera::default()
            },
            objects,
            images: vec![mask.clone()],
            materials: vec![decal.clone(), diffuse(Vec3::new(0.0, 0.8, 0.0))],
            environment: Some(sky(1.0)),
            ..PhysicalScene::default()
        };
        let picture = render(&turned(&scene, k), &settings(Integrator::Path, 8, 4)).beauty;
        for (n, &[red, green, _]) in picture.pixels().iter().enumerate() {
            let is_decal = n % 8 < 4 && !is_below;
            let (seen, hidden) = if is_decal { (red, green) } else { (green, red) };
            assert!(seen > 0.5 && hidden == 0.0, "{k}, pixel {n}: {red} {green}");
        }
    }
}
