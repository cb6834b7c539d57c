//! Where a scene lies, how large it is and what its surfaces share with others does not change its picture.

use super::scenes::{
    caustic_room, diffuse, instance, light, looking, mean, moved, object, point, quad, rectangle, render, room, scaled,
    settings, tall_box,
};
use crate::cpu::tracer::tests::brute_force;
use crate::cpu::{Simd, Tracer};
use crate::physical::PhysicalRendering;
use crate::settings::{Integrator, Strategy};
use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3};
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::Ray;
use lightcuts_kernel::rng::random4;
use lightcuts_scene::physical::{
    AlphaMask, EnvironmentDesc, ImageId, PhysicalCamera, PhysicalObject, PhysicalScene, PhysicalShape, PixelImage,
    Pixels, SurfaceDesc, View,
};
use lightcuts_scene::{Location, MeshDesc, MeshTriangle};
use lightcuts_world::PhysicalWorld;
use lightcuts_world::bvh::LANES;

const BOTH: [Integrator; 2] = [Integrator::Path, Integrator::Lightcuts];

fn direction(k: u32) -> Vec3 {
    let [x, y, z, _] = random4(k, 0, 0, 61);
    (Vec3::new(x, y, z) - 0.5).normalize()
}

/// The room and its mirrors as far away as 1e6, at 1e-3 to 1e3 of their size: what rounding changes is single paths.
#[test]
fn moved_scenes_look_the_same() {
    for (name, scene) in [("room", room(false)), ("behind a shade", room(true)), ("mirrors", caustic_room())] {
        for integrator in BOTH {
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

fn sky(radiance: f32) -> EnvironmentDesc {
    EnvironmentDesc { radiance: Vec3::splat(radiance), image: None, degrees: 0.0, location: Location::default() }
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
fn wall(
    meshes: &mut Vec<lightcuts_scene::MeshDesc>,
    placement: DAffine3,
    size: DVec3,
    side: Vec3,
    is_mesh: bool,
) -> PhysicalObject {
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

/// A scene turned about a slant axis and moved: coordinates are no round numbers any more.
fn turned(scene: &PhysicalScene, k: u32) -> PhysicalScene {
    let placement = DAffine3::from_rotation_translation(
        DQuat::from_axis_angle(direction(k).as_dvec3(), f64::from(k)),
        direction(k + 100).as_dvec3() * [0.0, 3.0, 1e3, 1e5][k as usize % 4],
    );
    let vector = |v: Vec3| placement.transform_vector3(v.as_dvec3()).as_vec3();
    let mut turned = scene.clone();
    let camera = &mut turned.camera;
    camera.position = placement.transform_point3(camera.position);
    (camera.direction, camera.up) = (vector(camera.direction), vector(camera.up));
    for object in &mut turned.objects {
        match &mut object.shape {
            PhysicalShape::Sphere { center, .. } => *center = placement.transform_point3(*center),
            PhysicalShape::Rectangle { center, normal, head, .. } => {
                *center = placement.transform_point3(*center);
                (*normal, *head) = (vector(*normal), vector(*head));
            }
            PhysicalShape::Mesh { placement: own, .. } => *own = placement * *own,
        }
    }
    turned
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

/// Half the edges of a hall about the origin.
const HALL: Vec3 = Vec3::new(3.0, 1.3, 5.0);

/// A place on a wall of the hall, and the direction into it.
fn on_a_wall(k: u32) -> (Vec3, Vec3) {
    let [u, v, wall, _] = random4(k, 0, 0, 67);
    let wall = (wall * 6.0) as usize;
    let inwards = Vec3::AXES[wall / 2] * if wall.is_multiple_of(2) { 1.0 } else { -1.0 };
    let [a, b] = [1, 2].map(|step| Vec3::AXES[(wall / 2 + step) % 3]);
    ((a * (2.0 * u - 1.0) + b * (2.0 * v - 1.0) - inwards) * HALL, inwards)
}

/// The hall: every wall of many triangles, and once more as a rectangle in the same place; a ball and a slab.
fn tiled_hall() -> PhysicalScene {
    const TILES: u32 = 9;
    let mut mesh = MeshDesc::default();
    let mut objects = Vec::new();
    for wall in 0..6 {
        let inwards = Vec3::AXES[wall / 2] * if wall.is_multiple_of(2) { 1.0 } else { -1.0 };
        let [a, b] = [1, 2].map(|step| Vec3::AXES[(wall / 2 + step) % 3]);
        let size = [a, b].map(|axis| 2.0 * axis.dot(HALL));
        objects.push(rectangle(-inwards * HALL, inwards, b, size[0], size[1], 0));
        let tile = (a / TILES as f32 * HALL, b / TILES as f32 * HALL);
        for (i, j) in (0..TILES).flat_map(|j| (0..TILES).map(move |i| (i, j))) {
            let place = |k: u32| (2 * k + 1) as f32 / TILES as f32 - 1.0;
            let quad = quad((a * place(i) + b * place(j) - inwards) * HALL, tile.0, tile.1);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(&quad.positions);
            mesh.triangles.extend(quad.triangles.iter().map(|triangle| MeshTriangle {
                positions: triangle.positions.map(|k| k + first),
                texture_coordinates: None,
                ..*triangle
            }));
        }
    }
    objects.push(instance(0, DAffine3::IDENTITY, 0));
    objects.push(object(PhysicalShape::Sphere { center: DVec3::new(1.0, -0.8, 2.0), radius: 0.5 }, 0));
    objects.push(rectangle(Vec3::new(-1.0, -0.9, 0.0), Vec3::Y, Vec3::Z, 1.0, 2.0, 0));
    PhysicalScene {
        camera: looking(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 40.0),
        objects,
        materials: vec![diffuse(Vec3::splat(0.5))],
        meshes: vec![mesh],
        ..PhysicalScene::default()
    }
}

/// Boxes of walls are flat: rays from next to them, along them and to them still find what they find without boxes, and of
/// what is in one place the same.
#[test]
fn flat_boxes_lose_no_hit() {
    let hall = tiled_hall();
    for (name, scene) in [("straight", hall.clone()), ("turned", turned(&hall, 1)), ("far away", turned(&hall, 3))] {
        let world = PhysicalWorld::new(&scene).expect("the scene is sound");
        let geometry = world.shapes.geometry();
        let is_flat = |(lower, upper): (Vec3, Vec3)| (lower.cmpeq(upper)).any();
        let boxes = geometry.nodes.iter().flat_map(|node| (0..LANES).map(|lane| node.child_box(lane)));
        assert_eq!(boxes.filter(|&of| is_flat(of)).count() > 50, name == "straight", "{name}");
        let placement = scene.objects[6].shape;
        let PhysicalShape::Mesh { placement, .. } = placement else { panic!("the hall's mesh is its seventh object") };
        let there = |p: Vec3| (placement.transform_point3(p.as_dvec3()) - world.origin).as_vec3();
        let ray = |k: u32| {
            let (from, inwards) = on_a_wall(2 * k);
            let (to, _) = on_a_wall(2 * k + 1);
            let [near, far, ..] = random4(k, 1, 0, 67);
            // Not so flat to a wall that rounding makes up where it is met.
            let lift = inwards * 10.0_f32.powf(-3.0 * near);
            let (from, to) = match k % 4 {
                0 => (from + inwards * 1e-5, to + lift),
                1 => (from + lift, to),
                2 => (from, from + inwards),
                _ => (direction(k) * 10.0_f32.powf(4.0 * far), to),
            };
            let (origin, end) = (there(from), there(to));
            let t_max = if k.is_multiple_of(3) { 1.0 } else { f32::INFINITY };
            Ray { origin, direction: end - origin, t_min: 0.0, t_max, inside: false }
        };
        let mut hits = 0;
        for k in 0..5_000 {
            let rays: [Ray; LANES] = std::array::from_fn(|lane| ray(LANES as u32 * (k / 2) + lane as u32 * (k % 2)));
            let expected = rays.map(|ray| brute_force(&geometry, &ray, Rules::Repaired));
            for simd in [Simd::Off, Simd::Auto] {
                let tracer = Tracer::new(geometry, Rules::Repaired, simd);
                assert_eq!(tracer.closest8(&rays), expected, "{name}, {simd:?}, {k}");
                for (ray, expected) in rays.iter().zip(&expected).skip(k as usize % LANES).take(1) {
                    assert_eq!(tracer.closest(ray), *expected, "{name}, {simd:?}, {k}: {ray:?}");
                    assert_eq!(tracer.occluded(ray), expected.is_some(), "{name}, {simd:?}, {k}: {ray:?}");
                }
            }
            hits += expected.iter().filter(|hit| hit.is_some()).count();
        }
        println!("{name}: {hits} of 40000 rays hit");
        assert!(hits > 20_000, "{name}: {hits}");
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
