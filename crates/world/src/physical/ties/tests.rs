use super::*;
use lightcuts_kernel::rng::random4;
use lightcuts_scene::physical::{
    EmissionDesc, PhysicalObject, PhysicalScene, PhysicalShape, Scattering, SurfaceDesc, SurfaceId,
};
use lightcuts_scene::{Location, MeshDesc, MeshId, MeshTriangle};

fn object(shape: PhysicalShape, material: u32) -> PhysicalObject {
    PhysicalObject { name: String::new(), shape, material: SurfaceId(material), location: Location::default() }
}

/// A white material and an emissive one.
fn scene(meshes: Vec<MeshDesc>, objects: Vec<PhysicalObject>) -> PhysicalScene {
    let emission = Some(EmissionDesc { radiance: Vec3::ONE, image: None, two_sided: false });
    let scattering = Scattering::Lambert { albedo: Vec3::ONE.into() };
    let white = SurfaceDesc { scattering, ..SurfaceDesc::default() };
    PhysicalScene {
        meshes,
        objects,
        materials: vec![white.clone(), SurfaceDesc { emission, ..white }],
        ..Default::default()
    }
}

/// A grid of twice `n` times `n` triangles over the unit square, each vertex `height` of its place above it.
fn grid(n: u32, height: impl Fn(f32, f32) -> f32) -> MeshDesc {
    let place = |k: u32| (k as f32 / n as f32).powf(1.3);
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| (place(i), place(j))));
    let corner = |i: u32, j: u32| j * (n + 1) + i;
    let triangle = |positions| MeshTriangle { positions, normals: None, texture_coordinates: None, material: None };
    let cell = |i, j| {
        [[corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)], [corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)]]
    };
    MeshDesc {
        positions: positions.map(|(x, y)| Vec3::new(x, y, height(x, y))).collect(),
        triangles: (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).map(triangle).collect(),
        ..MeshDesc::default()
    }
}

fn instance(placement: glam::DAffine3, material: u32) -> PhysicalObject {
    let shape = PhysicalShape::Mesh { mesh: MeshId(0), placement, smooth: true, override_material: true };
    object(shape, material)
}

fn turn(k: u32) -> glam::DAffine3 {
    let [x, y, z, angle] = random4(k, 0, 0, 92).map(f64::from);
    let axis = (DVec3::new(x, y, z) - 0.5).normalize();
    let place = (DVec3::new(z, x, y) - 0.5) * [0.0, 3.0, 40.0][k as usize % 3];
    glam::DAffine3::from_axis_angle(axis, 6.0 * angle) * glam::DAffine3::from_translation(place)
}

/// However small its triangles are in the scene, flat or bent a little, turned and placed: they reach beyond their
/// edges, but lie in no other one's place.
#[test]
fn neighbours_in_a_mesh_are_not_tied() {
    for k in 0..24 {
        let n = [1, 3, 8, 24][k as usize % 4];
        let bent = [0.0, 1e-4, 0.1][k as usize / 4 % 3];
        let far = object(PhysicalShape::Sphere { center: DVec3::X * 400.0, radius: 1.0 }, 0);
        let mesh = grid(n, |x, y| bent * (x * x + y * y));
        let world = PhysicalWorld::new(&scene(vec![mesh], vec![instance(turn(k), 1), far])).unwrap();
        let tied = world.ties.tied.len();
        assert!(world.ties.is_empty(), "{k}: {tied} ties among {} triangles", 2 * n * n);
    }
}

/// A face that is there twice, and a square lamp in a ceiling: each is in the other's place.
#[test]
fn what_shares_an_area_is_tied_both_ways() {
    for k in 0..12 {
        let twice = vec![instance(turn(k), 1), instance(turn(k), 0)];
        let world = PhysicalWorld::new(&scene(vec![grid(1, |_, _| 0.0)], twice)).unwrap();
        // Each triangle and its copy, and no triangle with the copy of the other.
        let tied = |of: u32| world.ties.of(of).iter().map(|tied| tied.primitive).collect::<Vec<_>>();
        assert_eq!([0, 1, 2, 3].map(tied), [vec![2], vec![3], vec![0], vec![1]], "{k}");
        let turn = turn(k);
        let rectangle = |size: f32, material| {
            let [normal, head] = [DVec3::Z, DVec3::Y].map(|v| turn.transform_vector3(v).as_vec3());
            let center = turn.transform_point3(DVec3::ZERO);
            object(PhysicalShape::Rectangle { center, normal, head, width: size, height: size }, material)
        };
        let world = PhysicalWorld::new(&scene(vec![], vec![rectangle(8.0, 0), rectangle(1.0, 1)])).unwrap();
        assert_eq!([world.ties.of(0)[0].primitive, world.ties.of(1)[0].primitive], [1, 0], "{k}");
        // Rays begin beyond both, by twice the tolerance of the emissive one, whose diagonal is the root of 2.
        let slack = world.ties.slack(1);
        assert!((2e-5 * 1.414..1e-4).contains(&slack) && world.emitters[0].slack >= slack, "{k}: {slack}");
    }
}

/// Two triangles, one shifted by a share of its edge: the areas in both by hand.
#[test]
fn shared_areas_are_those_of_geometry() {
    let triangle = |x: f64| [DVec2::new(x, 0.0), DVec2::new(x + 1.0, 0.0), DVec2::new(x, 1.0)];
    for k in -12..=12 {
        let shift = f64::from(k) / 10.0;
        let shared = (1.0 - shift.abs()).max(0.0).powi(2);
        let [first, mut second] = [triangle(0.0), triangle(shift)];
        assert!((area(&clipped(&first, &second)) - shared).abs() < 1e-12, "{shift}");
        second.reverse();
        assert!((area(&clipped(&first, &second)) - shared).abs() < 1e-12, "{shift}, clockwise");
    }
}

/// A lamp flush with a ceiling, both meshes with their own grids, turned, with coordinates of 32 bits or of seven digits far
/// from the origin of their file: each triangle of the lamp is tied to some of the ceiling.
#[test]
fn meshes_given_far_from_their_origin_are_tied() {
    for k in 0..40 {
        let distance = [30.0, 100.0, 1000.0, 1e5][k as usize % 4];
        let digits = [9, 7][k as usize / 4 % 2];
        let [x, y, z, angle] = random4(k, 1, 0, 92).map(f64::from);
        let turn = glam::DQuat::from_axis_angle((DVec3::new(x, y, z) - 0.5).normalize(), 6.0 * angle);
        let place = (DVec3::new(y, z, x) - 0.5).normalize() * distance;
        let given = |mut mesh: MeshDesc, corner: DVec3, size: f64| {
            for position in &mut mesh.positions {
                let there = place + turn * (corner + position.as_dvec3() * size);
                let text = there.to_array().map(|c| format!("{c:.*e}", digits - 1));
                *position = Vec3::from(text.map(|text| text.parse::<f32>().expect("a number")));
            }
            mesh
        };
        let size = 0.02 * distance.max(100.0);
        let ceiling = given(grid(3, |_, _| 0.0), DVec3::ZERO, size);
        let lamp = given(grid(4, |_, _| 0.0), DVec3::new(0.3, 0.2, 0.0) * size, 0.4 * size);
        let objects = [0, 1].map(|mesh| {
            let placement = glam::DAffine3::IDENTITY;
            let shape = PhysicalShape::Mesh { mesh: MeshId(mesh), placement, smooth: false, override_material: true };
            object(shape, mesh)
        });
        let world = PhysicalWorld::new(&scene(vec![ceiling, lamp], objects.into())).expect("the scene is sound");
        for primitive in 18..50 {
            let tied = world.ties.of(primitive);
            assert!(!tied.is_empty() && tied.iter().all(|tied| tied.primitive < 18), "{k}, {primitive}: {tied:?}");
        }
    }
}
