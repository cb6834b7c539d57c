//! A closed room with a body in it, of as many triangles as wanted: a world whose every ray hits something.

use anyhow::Result;
use glam::Vec3;
use lightcuts::World;
use lightcuts::scene::{
    CameraDesc, MaterialDesc, MaterialId, MeshDesc, MeshId, MeshTriangle, ObjectDesc, Projection, SceneDesc, ShapeDesc,
    Transform,
};

/// Half the edge of the room, in scene units.
pub(crate) const HALF: f32 = 100.0;
/// Mean radius of the body.
const RADIUS: f32 = 38.0;
/// Share of the radius by which its surface goes up and down.
const AMPLITUDE: f32 = 0.15;
/// Triangles of the body per square of the number of squares along an edge: six sides of two triangles per square.
const TRIANGLES_PER_SQUARE: u32 = 12;

/// A room that is ready for rays.
pub(crate) struct Room {
    pub(crate) world: World,
    /// Corners of the body's triangles, anticlockwise from outside.
    pub(crate) triangles: Vec<[Vec3; 3]>,
}

impl Room {
    /// The room whose body has about so many triangles. There is no light in it: VPLs are given to a render.
    pub(crate) fn new(triangles: u32) -> Result<Self> {
        let squares = (f64::from(triangles) / f64::from(TRIANGLES_PER_SQUARE)).sqrt().round() as u32;
        let mesh = body(squares.max(1));
        let triangles = mesh.triangles.iter().map(|it| it.positions.map(|i| mesh.positions[i as usize])).collect();
        Ok(Self { world: World::new(&scene(mesh))?, triangles })
    }

    /// Number of triangles.
    pub(crate) fn size(&self) -> u64 {
        self.triangles.len() as u64
    }
}

fn scene(mesh: MeshDesc) -> SceneDesc {
    let body =
        ShapeDesc::Mesh { mesh: MeshId(0), transform: Transform::default(), smooth: false, override_material: false };
    let object = |shape| ObjectDesc {
        name: String::new(),
        shape,
        material: MaterialId(0),
        location: lightcuts::scene::Location::default(),
    };
    SceneDesc {
        name: "room".to_owned(),
        camera: CameraDesc {
            center: Vec3::new(0.0, 20.0, 88.0),
            view: Vec3::new(0.0, -0.2, -1.0),
            projection: Projection::Perspective { distance: 4.0 },
            ..CameraDesc::default()
        },
        objects: walls()
            .map(|[inwards, along, _]| wall(inwards, along))
            .into_iter()
            .chain([body])
            .map(object)
            .collect(),
        materials: vec![MaterialDesc::default()],
        meshes: vec![mesh],
        ..SceneDesc::default()
    }
}

/// Of each wall its normal and the directions of its edges.
pub(crate) fn walls() -> [[Vec3; 3]; 6] {
    [1.0, -1.0]
        .map(|side| [0, 1, 2].map(|axis| [Vec3::AXES[axis] * side, next(axis, 1), next(axis, 2)]))
        .concat()
        .try_into()
        .expect("two sides of three axes")
}

fn next(axis: usize, steps: usize) -> Vec3 {
    Vec3::AXES[(axis + steps) % 3]
}

fn wall(inwards: Vec3, along: Vec3) -> ShapeDesc {
    ShapeDesc::Square { center: inwards * -HALF, normal: inwards, head: along, width: 2.0 * HALF, height: 2.0 * HALF }
}

/// A sphere with bumps: each side of a cube as a grid of squares, blown up.
fn body(squares: u32) -> MeshDesc {
    let mut mesh = MeshDesc { name: "body".to_owned(), ..MeshDesc::default() };
    for [outwards, across, along] in walls() {
        // The edges and the side's direction are to be right-handed.
        let across = if across.cross(along).dot(outwards) > 0.0 { across } else { -across };
        let first = mesh.positions.len() as u32;
        let place = |i: u32| 2.0 * i as f32 / squares as f32 - 1.0;
        let points = (0..=squares).flat_map(|j| (0..=squares).map(move |i| (i, j)));
        mesh.positions.extend(points.map(|(i, j)| blown_up(outwards + across * place(i) + along * place(j))));
        for (i, j) in (0..squares).flat_map(|j| (0..squares).map(move |i| (i, j))) {
            let corner = |i: u32, j: u32| first + j * (squares + 1) + i;
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]].map(triangle));
        }
    }
    mesh
}

fn triangle(positions: [u32; 3]) -> MeshTriangle {
    MeshTriangle { positions, normals: None, texture_coordinates: None, material: None }
}

/// The point of the body in a direction. Bumps are Chebyshev polynomials of degree 8, which need no library function: the
/// body is the same on every machine.
fn blown_up(direction: Vec3) -> Vec3 {
    let unit = direction.normalize();
    let doubled = |t: f32| 2.0 * t * t - 1.0;
    let bump = unit.to_array().map(|t| doubled(doubled(doubled(t)))).iter().sum::<f32>() / 3.0;
    unit * (RADIUS * (1.0 + AMPLITUDE * bump))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts::world::bvh::closest_hit;
    use lightcuts_kernel::Rules;
    use lightcuts_kernel::ray::Ray;
    use lightcuts_kernel::rng::random4;

    #[test]
    fn rooms_have_about_as_many_triangles_as_wanted() {
        assert_eq!([1_400, 20_000].map(|wanted| Room::new(wanted).unwrap().size()), [1_452, 20_172]);
    }

    #[test]
    fn every_triangle_faces_outwards() {
        for [a, b, c] in Room::new(5_000).unwrap().triangles {
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }

    #[test]
    fn every_ray_hits_something() {
        let room = Room::new(1_400).unwrap();
        for k in 0..2_000 {
            let [a, b, c, _] = random4(k, 0, 0, 1);
            let direction = Vec3::new(a, b, c) - 0.5;
            let ray = Ray { origin: Vec3::splat(90.0), direction, t_min: 0.0, t_max: f32::INFINITY, inside: false };
            assert!(closest_hit(&room.world.shapes.geometry(), &ray, Rules::Repaired).is_some());
        }
    }
}
