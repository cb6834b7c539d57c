//! Rows: rays, hits, the camera, and nodes of the hierarchy.

use crate::functions::case::Case;
use crate::functions::table::{Row, twin};
use glam::Vec3;
use lightcuts_kernel::camera::camera_ray;
use lightcuts_kernel::cwbvh::{CompressedNode, LeafItem, enter_children, intersect_item, octant_order};
use lightcuts_kernel::intersect::{
    ORIGINAL_MIN_DETERMINANT, intersect_sphere, intersect_square, intersect_triangle, min_determinant,
};
use lightcuts_kernel::ray::{Hit, Ray, normalize_or_zero, safe_component, safe_reciprocal, shadow_ray, spawn_epsilon};

/// The rows.
pub(crate) const ROWS: [Row; 15] = [
    twin("no_hit", |c| c.put(Hit::none(c.positive()))),
    twin("take_nearer", |c| {
        let mut best = c.hit();
        best.take_nearer(c.hit());
        c.put(best);
    }),
    twin("spawn_epsilon", |c| c.put(spawn_epsilon(c.rules(), c.point(), c.positive()))),
    twin("shadow_ray", |c| c.put(shadow_ray(c.rules(), c.point(), c.point(), c.positive()))),
    twin("safe_component", |c| c.put(safe_component(c.float()))),
    twin("safe_reciprocal", |c| c.put(safe_reciprocal(c.point()))),
    twin("normalize_or_zero", |c| c.put(normalize_or_zero(c.point()))),
    twin("min_determinant", |c| c.put(min_determinant(c.rules()))),
    twin("intersect_triangle", |c| {
        let triangle = c.triangle();
        let at = triangle.edge1 * c.raw_fraction() + triangle.edge2 * c.raw_fraction();
        let ray = c.ray_to(triangle.corner + at);
        let least = c.take(|| [ORIGINAL_MIN_DETERMINANT, f32::MIN_POSITIVE][c.choice(2)]);
        let hit = intersect_triangle(&triangle, &ray, least);
        c.put(hit.unwrap_or(Hit::none(ray.t_max)));
    }),
    twin("intersect_sphere", |c| {
        let sphere = c.sphere();
        let ray = c.ray_to(sphere.center + c.raw_direction() * (sphere.radius * 1.2 * c.raw_fraction()));
        c.put(intersect_sphere(&sphere, &ray, c.rules()).unwrap_or(Hit::none(ray.t_max)));
    }),
    twin("intersect_square", |c| {
        let square = c.square();
        let (x, y) = (2.2 * c.raw_fraction() - 1.1, 2.2 * c.raw_fraction() - 1.1);
        let at = square.across * (square.half_width * x) + square.along * (square.half_height * y);
        let ray = c.ray_to(square.center + at);
        c.put(intersect_square(&square, &ray).unwrap_or(Hit::none(ray.t_max)));
    }),
    twin("intersect_item", |c| {
        let item = item(c);
        let ray = c.ray_to(item.a + (item.b + item.c) * c.raw_fraction());
        c.put(intersect_item(&item, &c.tables.world.shapes.squares, &ray, c.rules()));
    }),
    twin("octant_order", |c| c.put(octant_order(c.point()))),
    twin("enter_children", |c| {
        let node = c.take(|| node(c));
        let ray = c.ray_to(inside(&node, c));
        let (reciprocal, order) = (c.take(|| safe_reciprocal(ray.direction)), c.below(8));
        c.put(enter_children(&node, &ray, reciprocal, order, c.take(|| ray.t_max)));
    }),
    twin("camera_ray", |c| {
        let (camera, i, j) = (c.camera(), c.below(4096), c.below(4096));
        let ray = camera_ray(&camera, i, j, [c.float(), c.float()], c.rules());
        // What is as far as infinity is as far as the largest number on devices.
        c.put(Ray { t_max: f32::MAX, ..ray });
    }),
];

/// A primitive under a leaf.
fn item(c: &Case<'_>) -> LeafItem {
    c.take(|| {
        let squares = c.tables.world.shapes.squares.len();
        let (a, c1, c2) = (c.raw_point(), c.raw_point(), c.raw_point());
        let kind = c.choice(if squares == 0 { 2 } else { 3 }) as u32;
        LeafItem { a, primitive: 9, b: c1, kind, c: c2, index: c.choice(squares.max(1)) as u32 }
    })
}

/// A node with children of every kind.
fn node(c: &Case<'_>) -> CompressedNode {
    let mut words = [[0; 4]; 5];
    let origin = c.raw_point();
    // Eight bits of places with steps of 2^-12 to 2^2.
    let exponent = || 127 - 12 + c.choice(15) as u32;
    words[0][..3].copy_from_slice(&origin.to_array().map(f32::to_bits));
    words[0][3] = exponent() | exponent() << 8 | exponent() << 16 | (c.choice(256) as u32) << 24;
    words[1][..2].copy_from_slice(&[c.choice(1000) as u32, c.choice(1000) as u32]);
    for slot in 0..8 {
        let (half, shift) = (slot / 4, slot % 4 * 8);
        let leaf = ([1, 3, 7][c.choice(3)] << 5) | c.choice(22);
        words[1][2 + half] |= ([0, 0x38 | slot, leaf][c.choice(3)] as u32) << shift;
        for axis in 0..3 {
            let [a, b] = [c.choice(256) as u32, c.choice(256) as u32];
            words[2 + axis][half] |= a.min(b) << shift;
            words[2 + axis][2 + half] |= a.max(b) << shift;
        }
    }
    CompressedNode { words }
}

/// A point in the box of a node.
fn inside(node: &CompressedNode, c: &Case<'_>) -> Vec3 {
    let [x, y, z, exponents] = node.words[0];
    let step = |axis: u32| f32::from_bits((exponents >> (8 * axis) & 0xff) << 23);
    let place = || 256.0 * c.raw_fraction();
    let origin = Vec3::new(f32::from_bits(x), f32::from_bits(y), f32::from_bits(z));
    origin + Vec3::new(step(0) * place(), step(1) * place(), step(2) * place())
}
