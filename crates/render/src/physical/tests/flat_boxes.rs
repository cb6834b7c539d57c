//! Rays through the hierarchy of a physical world, whose boxes are flat where walls are, against none.

use super::scenes::{diffuse, direction, instance, looking, object, quad, rectangle, turned};
use crate::cpu::{Simd, Tracer, brute_force};
use glam::{DAffine3, DVec3, Vec3};
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::Ray;
use lightcuts_kernel::rng::random4;
use lightcuts_scene::physical::{PhysicalScene, PhysicalShape};
use lightcuts_scene::{MeshDesc, MeshTriangle};
use lightcuts_world::PhysicalWorld;
use lightcuts_world::bvh::LANES;

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
