use super::*;
use lightcuts_scene::physical::{EmissionDesc, PhysicalObject, Scattering, SurfaceDesc};
use lightcuts_scene::{Location, MeshDesc, MeshId, MeshTriangle};

fn object(shape: PhysicalShape, material: u32) -> PhysicalObject {
    PhysicalObject { name: String::new(), shape, material: SurfaceId(material), location: Location::default() }
}

/// A lit floor: a rectangle, an emissive instance of a mesh, twice, and an emissive sphere.
fn scene() -> PhysicalScene {
    let light = EmissionDesc { radiance: Vec3::ONE, image: None, two_sided: false };
    let instance =
        |placement| PhysicalShape::Mesh { mesh: MeshId(0), placement, smooth: true, override_material: true };
    PhysicalScene {
        meshes: vec![MeshDesc {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            texture_coordinates: vec![[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]],
            triangles: vec![MeshTriangle {
                positions: [0, 1, 2],
                normals: None,
                texture_coordinates: Some([0, 1, 2]),
                material: None,
            }],
            ..MeshDesc::default()
        }],
        materials: vec![
            SurfaceDesc::default(),
            SurfaceDesc {
                scattering: Scattering::Plastic { albedo: Vec3::ONE.into(), ior: 1.5, roughness: 0.5 },
                emission: Some(light),
                ..SurfaceDesc::default()
            },
        ],
        objects: vec![
            object(
                PhysicalShape::Rectangle {
                    center: DVec3::ZERO,
                    normal: Vec3::Z,
                    head: Vec3::Y,
                    width: 4.0,
                    height: 4.0,
                },
                0,
            ),
            object(instance(DAffine3::from_translation(DVec3::Z * 3.0)), 1),
            object(instance(DAffine3::from_scale(DVec3::new(-2.0, 2.0, 2.0))), 1),
            object(PhysicalShape::Sphere { center: DVec3::Z * 9.0, radius: 0.5 }, 1),
        ],
        ..PhysicalScene::default()
    }
}

#[test]
fn instances_and_lights_become_flat() {
    let world = PhysicalWorld::new(&scene()).unwrap();
    assert_eq!(world.validate(), Ok(()));
    assert_eq!((world.shapes.primitives.len(), world.emitters.len(), world.placed_emitters), (4, 3, 3));
    assert_eq!(world.primitive_emitters, [NONE, 0, 1, 2]);
    // A mirrored instance keeps its side, and a larger one has fewer texels per unit.
    assert_eq!([world.faces[0].normal, world.faces[1].normal], [Vec3::Z; 2]);
    assert_eq!([world.faces[0].tangent, world.faces[1].tangent], [Vec3::X, Vec3::NEG_X]);
    assert!((world.faces[0].texture_density - 2.0).abs() < 1e-5);
    assert!((world.faces[1].texture_density + 1.0).abs() < 1e-5, "a mirrored instance shows its texture mirrored");
    assert_eq!([world.emitters[0].area, world.emitters[1].area], [0.5, 2.0]);
    assert_eq!(world.bounds.1, Vec3::new(2.0, 2.0, 9.5));
}

#[test]
fn a_scene_that_breaks_a_rule_is_refused() {
    let mut bad = scene();
    bad.objects[0].material = SurfaceId(7);
    assert!(matches!(PhysicalWorld::new(&bad), Err(WorldError::Scene(_))));
    assert!(PhysicalWorld::new(&PhysicalScene::default()).is_ok(), "nothing is a scene too");
}

#[test]
fn the_lens_shows_the_angle() {
    let mut scene = scene();
    scene.camera.view = View::Perspective { degrees: 90.0 };
    let lens = PhysicalWorld::new(&scene).unwrap().lens(200, 100);
    assert!((lens.half_height - 1.0).abs() < 1e-6);
    assert_eq!((lens.forward, lens.right, lens.up), (Vec3::NEG_Z, Vec3::X, Vec3::Y));
}
