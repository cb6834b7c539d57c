//! Rows: what reads buffers: textures, surfaces, photons, and whole traversals.

use crate::functions::case::Case;
use crate::functions::table::{Row, twin};
use crate::functions::tables::{PHOTON_EXTENT, PHOTON_RADIUS, image};
use glam::{IVec3, Vec3};
use lightcuts_kernel::cwbvh::{CompressedGeometry, any_hit, closest_hit, traverse};
use lightcuts_kernel::photon_gather::{cell_before, first_photon, gather_photons, photon_cell};
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_kernel::surface::{Surface, surface_at};
use lightcuts_kernel::texture::{
    SurfacePoint, arctangent, place_on_axis, sample_texture, sphere_coordinates, surface_point, texel_index,
};

/// The rows.
pub(crate) const ROWS: [Row; 12] = [
    twin("arctangent", |c| c.put(arctangent(c.float(), c.float()))),
    twin("sphere_coordinates", |c| c.put(sphere_coordinates(c.direction()))),
    twin("place_on_axis", |c| c.put(place_on_axis(c.float(), c.positive(), c.positive(), c.below(3)))),
    twin("texel_index", |c| {
        c.put(texel_index(c.take(|| 1000.0 * c.random() - 500.0), c.take(|| 1 + c.choice(100) as u32), c.below(3)));
    }),
    twin("texel_index", |c| c.put(texel_index(c.float(), c.take(|| 1 + c.choice(100) as u32), c.below(3)))),
    twin("sample_texture", |c| {
        let texture = c.take(|| image(c.choice(100) as u32));
        let (mode, at) = (c.below(3), c.take(|| textured(c)));
        c.put(sample_texture(&c.tables.texels, &texture, mode, &at, c.rules()));
    }),
    twin("surface_point", |c| {
        let hit = hit(c);
        let surface = Surface { point: c.point(), normal: c.direction(), material: c.word(), object: c.word() };
        c.put(surface_point(&c.tables.world.shapes.surfaces(), &hit, &surface));
    }),
    twin("surface_at", |c| {
        let ray = c.ray_to(c.raw_point());
        c.put(surface_at(&c.tables.world.shapes.surfaces(), &ray, &hit(c)));
    }),
    twin("photon_cell", |c| {
        c.put(photon_cell(c.point(), c.take(|| [1.0, 0.1, 1e-6, 5.0 * c.random() + 1e-3][c.choice(4)])));
    }),
    twin("cell_before", |c| c.put(cell_before(cell(c), cell(c)))),
    twin("first_photon", |c| c.put(first_photon(&c.tables.photons, cell(c)))),
    twin("gather_photons", |c| {
        let point = c.take(|| (Vec3::new(c.random(), c.random(), c.random()) - 0.5) * (1.2 * PHOTON_EXTENT));
        let (normal, radius) = (c.direction(), c.take(|| PHOTON_RADIUS));
        c.put(gather_photons(&c.tables.photons, point, normal, radius, c.below(5)));
    }),
];

/// The rows that depend on the scene.
pub(crate) const TRAVERSALS: [Row; 3] = [
    twin("closest_hit", |c| {
        let ray = far_ray(c);
        c.put(closest_hit(&geometry(c), &ray, c.rules()));
    }),
    twin("any_hit", |c| {
        let ray = far_ray(c);
        c.put(any_hit(&geometry(c), &ray, c.rules()));
    }),
    twin("traverse", |c| {
        let ray = far_ray(c);
        c.put(traverse(&geometry(c), &ray, c.rules(), c.flag()));
    }),
];

fn geometry<'t>(c: &Case<'t>) -> CompressedGeometry<'t> {
    c.tables.hierarchy.geometry(&c.tables.world.shapes.squares)
}

/// A ray between the corners of a thesis scene or out of it, some along axes.
fn far_ray(c: &Case<'_>) -> Ray {
    const EXTENT: f32 = 450.0;
    c.take(|| {
        let [origin, target] = [0; 2].map(|_| (Vec3::new(c.random(), c.random(), c.random()) - 0.5) * EXTENT);
        let direction = match c.number % 8 {
            5 => Vec3::NEG_Y,
            6 => [Vec3::X, Vec3::new(0.0, 1.0, -1.0)][c.choice(2)],
            _ => target - origin,
        };
        let (t_min, t_max) = ([0.0, 0.001][c.choice(2)], [1.0, f32::MAX][c.choice(2)]);
        Ray { origin, direction, t_min, t_max, inside: c.choice(5) == 0 }
    })
}

/// A hit of any primitive of the world.
fn hit(c: &Case<'_>) -> Hit {
    c.take(|| {
        let u = c.raw_fraction();
        let primitive = c.choice(c.tables.world.shapes.primitives.len()) as u32;
        Hit { t: 10.0 * c.random(), primitive, u, v: (1.0 - u) * c.raw_fraction() }
    })
}

/// A point in or around an image.
fn textured(c: &Case<'_>) -> SurfacePoint {
    let size = [0.0, 4.0, 100.0 * c.random()][c.choice(3)];
    let uv = || [c.raw_fraction(), 3.0 * c.raw_fraction() - 1.0][c.choice(2)];
    SurfacePoint { uv: [uv(), uv()], size: [size, size * 0.5] }
}

/// A cell among those of the photons, or beside them.
fn cell(c: &Case<'_>) -> IVec3 {
    c.take(|| IVec3::new(c.choice(12) as i32 - 6, c.choice(12) as i32 - 6, c.choice(12) as i32 - 6))
}
