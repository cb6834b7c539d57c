//! Scenes of the tests, made in code, and how they are rendered.

use crate::cpu::Simd;
use crate::monitor::Unwatched;
use crate::physical::{PhysicalRendering, render_physical};
use crate::settings::{Integrator, Settings};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use lightcuts_kernel::rng::random4;
use lightcuts_scene::physical::{
    EmissionDesc, EmitterDesc, EmitterKind, EnvironmentDesc, ImageId, PhysicalCamera, PhysicalObject, PhysicalScene,
    PhysicalShape, PixelImage, Pixels, Scattering, SurfaceDesc, SurfaceId, Tint, View,
};
use lightcuts_scene::{Location, MeshDesc, MeshId, MeshTriangle};
use lightcuts_world::PhysicalWorld;

pub(super) fn object(shape: PhysicalShape, material: u32) -> PhysicalObject {
    PhysicalObject { name: String::new(), shape, material: SurfaceId(material), location: Location::default() }
}

pub(super) fn rectangle(
    center: Vec3,
    normal: Vec3,
    head: Vec3,
    width: f32,
    height: f32,
    material: u32,
) -> PhysicalObject {
    object(PhysicalShape::Rectangle { center: center.as_dvec3(), normal, head, width, height }, material)
}

pub(super) fn diffuse(albedo: Vec3) -> SurfaceDesc {
    SurfaceDesc { scattering: Scattering::Lambert { albedo: albedo.into() }, ..SurfaceDesc::default() }
}

pub(super) fn light(radiance: Vec3) -> SurfaceDesc {
    let emission = Some(EmissionDesc { radiance, image: None, two_sided: false });
    SurfaceDesc { emission, ..diffuse(Vec3::ZERO) }
}

pub(super) fn point(position: Vec3, intensity: Vec3) -> EmitterDesc {
    EmitterDesc { kind: EmitterKind::Point { position: position.as_dvec3(), intensity }, location: Location::default() }
}

/// Shines down, evenly within 40 degrees.
pub(super) fn spot_down(position: Vec3, intensity: Vec3) -> EmitterDesc {
    let kind = EmitterKind::Spot {
        position: position.as_dvec3(),
        direction: Vec3::NEG_Y,
        intensity,
        inner_degrees: 40.0,
        outer_degrees: 45.0,
    };
    EmitterDesc { kind, location: Location::default() }
}

pub(super) fn looking(position: Vec3, target: Vec3, degrees: f32) -> PhysicalCamera {
    PhysicalCamera {
        position: position.as_dvec3(),
        direction: target - position,
        up: if (target - position).normalize().y.abs() > 0.99 { Vec3::Z } else { Vec3::Y },
        view: View::Perspective { degrees },
        ..PhysicalCamera::default()
    }
}

pub(super) fn settings(integrator: Integrator, size: u32, samples: u32) -> Settings {
    let mut settings = Settings::for_physical();
    (settings.image.width, settings.image.height) = (size, size);
    settings.physical.integrator = integrator;
    settings.sampling.samples = samples;
    settings
}

pub(super) fn render(scene: &PhysicalScene, settings: &Settings) -> PhysicalRendering {
    let world = PhysicalWorld::new(scene).expect("the scene is sound");
    render_physical(&world, settings, Simd::Auto, &Unwatched).expect("the settings are sound")
}

/// Mean of a picture's channels.
pub(super) fn mean(rendering: &PhysicalRendering) -> glam::DVec3 {
    let pixels = rendering.beauty.pixels();
    pixels.iter().map(|&p| Vec3::from(p).as_dvec3()).sum::<glam::DVec3>() / pixels.len() as f64
}

/// A box of two coloured walls with a lamp under its ceiling, and two boxes; `occluded` turns the lamp to the ceiling,
/// behind a shade.
pub(super) fn room(occluded: bool) -> PhysicalScene {
    let (white, red, green) = (Vec3::splat(0.75), Vec3::new(0.6, 0.1, 0.08), Vec3::new(0.12, 0.5, 0.1));
    let materials = vec![
        diffuse(white),
        diffuse(red),
        diffuse(green),
        light(Vec3::new(16.0, 13.0, 9.0)),
        SurfaceDesc {
            scattering: Scattering::Plastic { albedo: Vec3::new(0.2, 0.3, 0.7).into(), ior: 1.5, roughness: 0.5 },
            ..SurfaceDesc::default()
        },
    ];
    let (lamp, lamp_normal) = if occluded { (0.7, Vec3::Y) } else { (0.998, Vec3::NEG_Y) };
    let mut objects = vec![
        rectangle(Vec3::new(0.5, 0.0, 0.5), Vec3::Y, Vec3::Z, 1.0, 1.0, 0),
        rectangle(Vec3::new(0.5, 1.0, 0.5), Vec3::NEG_Y, Vec3::Z, 1.0, 1.0, 0),
        rectangle(Vec3::new(0.5, 0.5, 0.0), Vec3::Z, Vec3::Y, 1.0, 1.0, 0),
        rectangle(Vec3::new(0.0, 0.5, 0.5), Vec3::X, Vec3::Y, 1.0, 1.0, 1),
        rectangle(Vec3::new(1.0, 0.5, 0.5), Vec3::NEG_X, Vec3::Y, 1.0, 1.0, 2),
        rectangle(Vec3::new(0.5, lamp, 0.5), lamp_normal, Vec3::Z, 0.3, 0.3, 3),
        object(PhysicalShape::Sphere { center: DVec3::new(0.7, 0.2, 0.6), radius: 0.2 }, 4),
    ];
    if occluded {
        objects.push(rectangle(Vec3::new(0.5, lamp - 0.01, 0.5), Vec3::NEG_Y, Vec3::Z, 0.34, 0.34, 0));
    }
    let turned = DAffine3::from_translation(DVec3::new(0.3, 0.0, 0.35)) * DAffine3::from_rotation_y(0.3);
    objects.push(object(
        PhysicalShape::Mesh { mesh: MeshId(0), placement: turned, smooth: false, override_material: true },
        0,
    ));
    PhysicalScene {
        camera: looking(Vec3::new(0.5, 0.5, 2.4), Vec3::new(0.5, 0.5, 0.0), 38.0),
        objects,
        materials,
        meshes: vec![tall_box()],
        ..PhysicalScene::default()
    }
}

/// The room with gloss of every kind that is gathered from virtual lights: a floor of rough metal, a Phong wall, a
/// plastic ball.
pub(super) fn glossy_room() -> PhysicalScene {
    let mut scene = room(false);
    let metal = Scattering::Conductor { eta: Vec3::new(0.2, 0.9, 1.2), k: Vec3::new(3.9, 2.4, 2.2), roughness: 0.5 };
    let phong =
        Scattering::Phong { diffuse: Vec3::splat(0.4).into(), specular: Vec3::splat(0.4).into(), exponent: 30.0 };
    for (object, scattering) in [(0, metal), (2, phong)] {
        scene.objects[object].material = SurfaceId(scene.materials.len() as u32);
        scene.materials.push(SurfaceDesc { scattering, ..SurfaceDesc::default() });
    }
    scene
}

/// A box of 0.3 x 0.6 x 0.3, standing on the floor.
pub(super) fn tall_box() -> MeshDesc {
    let corner = |k: u32| Vec3::new((k & 1) as f32 - 0.5, (k >> 1 & 1) as f32, (k >> 2) as f32 - 0.5);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 4, 6, 2], [1, 3, 7, 5], [2, 6, 7, 3], [0, 1, 5, 4]];
    let triangle = |positions| MeshTriangle { positions, normals: None, texture_coordinates: None, material: None };
    MeshDesc {
        positions: (0..8).map(|k| corner(k) * Vec3::new(0.3, 0.6, 0.3)).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [triangle([a, b, c]), triangle([a, c, d])]).collect(),
        ..MeshDesc::default()
    }
}

/// The room with a checkered, uneven wall, glossy things, a sky behind a missing ceiling, or many small lamps in place
/// of one.
pub(super) fn variants() -> Vec<(&'static str, PhysicalScene)> {
    let mut textured = room(false);
    let checker =
        |x: u32, y: u32| if (x / 2 + y / 2).is_multiple_of(2) { [230, 210, 60, 255] } else { [40, 60, 200, 255] };
    let bumps = |x: u32, y: u32| [[100, 150, 240, 255], [150, 110, 240, 255]][((x + y) % 2) as usize];
    let image = |name: &str, of: &dyn Fn(u32, u32) -> [u8; 4], is_color: bool| {
        let pixels = (0..64).map(|k| of(k % 8, k / 8)).collect();
        let pixels = if is_color { Pixels::Srgb(pixels) } else { Pixels::Linear(pixels) };
        PixelImage { name: name.to_owned(), width: 8, height: 8, pixels }
    };
    textured.images = vec![image("checker", &checker, true), image("bumps", &bumps, false)];
    textured.materials[0].scattering =
        Scattering::Lambert { albedo: Tint { color: Vec3::splat(0.9), image: Some(ImageId(0)) } };
    textured.materials[0].normal_map = Some(ImageId(1));

    let mut glossy = room(false);
    glossy.materials[0].scattering =
        Scattering::Phong { diffuse: Vec3::splat(0.5).into(), specular: Vec3::splat(0.3).into(), exponent: 20.0 };
    glossy.materials[4].scattering =
        Scattering::Conductor { eta: Vec3::new(0.2, 0.9, 1.2), k: Vec3::new(3.9, 2.4, 2.2), roughness: 0.6 };

    let mut open = room(false);
    open.objects.remove(5);
    open.objects.remove(1);
    let sky = (0..32).map(|k| [0.2 + (k % 8) as f32 * 0.3, 0.5, 2.0 - (k / 8) as f32 * 0.4]).collect();
    open.images = vec![PixelImage { name: "sky".to_owned(), width: 8, height: 4, pixels: Pixels::Float(sky) }];
    open.environment = Some(EnvironmentDesc {
        radiance: Vec3::ONE,
        image: Some(ImageId(0)),
        degrees: 40.0,
        location: Location::default(),
    });

    let mut many = room(false);
    many.objects.remove(5);
    many.materials[3] = light(Vec3::splat(60.0));
    many.objects.extend((0..60).map(|k| {
        let [x, y, z, _] = random4(k, 0, 0, 4);
        let center = Vec3::new(0.1 + 0.8 * x, 0.65 + 0.3 * y, 0.1 + 0.8 * z);
        object(PhysicalShape::Sphere { center: center.as_dvec3(), radius: 0.012 }, 3)
    }));
    vec![
        ("open", room(false)),
        ("occluded", room(true)),
        ("textured", textured),
        ("glossy", glossy),
        ("sky", open),
        ("many lamps", many),
    ]
}

/// The room with a glass ball, a mirror and a metal for walls and a floor under a smooth coat.
pub(super) fn caustic_room() -> PhysicalScene {
    let mut scene = room(false);
    scene.materials[4].scattering = Scattering::Dielectric { ior: 1.5, roughness: 0.0, transmittance: Vec3::ONE };
    scene.materials[1].scattering = Scattering::Mirror { reflectance: Vec3::splat(0.8).into() };
    scene.materials.push(SurfaceDesc {
        scattering: Scattering::Plastic { albedo: Vec3::splat(0.6).into(), ior: 1.5, roughness: 0.0 },
        ..SurfaceDesc::default()
    });
    scene.objects[0].material = SurfaceId(5);
    // A metal that is nearly smooth.
    scene.materials.push(SurfaceDesc {
        scattering: Scattering::Conductor { eta: Vec3::splat(0.2), k: Vec3::splat(3.0), roughness: 0.3 },
        ..SurfaceDesc::default()
    });
    scene.objects[4].material = SurfaceId(6);
    scene
}

/// A scene `k` times as large, in every length.
pub(super) fn scaled(scene: &PhysicalScene, k: f32) -> PhysicalScene {
    let mut large = scene.clone();
    let far = f64::from(k);
    large.camera.position *= far;
    for object in &mut large.objects {
        match &mut object.shape {
            PhysicalShape::Sphere { center, radius } => (*center, *radius) = (*center * far, *radius * k),
            PhysicalShape::Rectangle { center, width, height, .. } => {
                (*center, *width, *height) = (*center * far, *width * k, *height * k);
            }
            PhysicalShape::Mesh { placement, .. } => *placement = DAffine3::from_scale(DVec3::splat(far)) * *placement,
        }
    }
    large
}

/// A scene moved as a whole.
pub(super) fn moved(scene: &PhysicalScene, shift: DVec3) -> PhysicalScene {
    let mut far = scene.clone();
    far.camera.position += shift;
    for object in &mut far.objects {
        match &mut object.shape {
            PhysicalShape::Sphere { center, .. } | PhysicalShape::Rectangle { center, .. } => *center += shift,
            PhysicalShape::Mesh { placement, .. } => *placement = DAffine3::from_translation(shift) * *placement,
        }
    }
    for light in &mut far.lights {
        match &mut light.kind {
            EmitterKind::Point { position, .. } | EmitterKind::Spot { position, .. } => *position += shift,
            EmitterKind::Directional { .. } => {}
        }
    }
    far
}

/// A rectangle of two triangles, and its instance.
pub(super) fn quad(center: Vec3, right: Vec3, up: Vec3) -> MeshDesc {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let triangle =
        |of: [u32; 3]| MeshTriangle { positions: of, normals: None, texture_coordinates: Some(of), material: None };
    MeshDesc {
        positions: corners.map(|[u, v]: [f32; 2]| center + right * (u - 0.5) + up * (v - 0.5)).to_vec(),
        texture_coordinates: corners.to_vec(),
        triangles: vec![triangle([0, 1, 2]), triangle([0, 2, 3])],
        ..MeshDesc::default()
    }
}

pub(super) fn instance(mesh: u32, placement: DAffine3, material: u32) -> PhysicalObject {
    object(PhysicalShape::Mesh { mesh: MeshId(mesh), placement, smooth: true, override_material: true }, material)
}

/// A direction, a different one for each number.
pub(super) fn direction(k: u32) -> Vec3 {
    let [x, y, z, _] = random4(k, 0, 0, 61);
    (Vec3::new(x, y, z) - 0.5).normalize()
}

/// Even light from everywhere.
pub(super) fn sky(radiance: f32) -> EnvironmentDesc {
    EnvironmentDesc { radiance: Vec3::splat(radiance), image: None, degrees: 0.0, location: Location::default() }
}

/// A scene turned about a slant axis and moved: coordinates are no round numbers any more.
pub(super) fn turned(scene: &PhysicalScene, k: u32) -> PhysicalScene {
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
