//! The physical model against closed forms, against itself, and cuts against the sum over all lights.

use super::cluster_tree::ClusterTree;
use super::emission::Origins;
use super::gather::{CutHeap, Receiver};
use super::pass::Counts;
use super::randoms::Randoms;
use super::scene::{Cone, Scene};
use super::vpls::trace_vpls;
use super::{PhysicalRendering, render_physical};
use crate::cpu::Simd;
use crate::monitor::Unwatched;
use crate::settings::{Integrator, Settings, Strategy};
use glam::{Affine3A, Vec3};
use lightcuts_kernel::bsdf::{MATT, lobes_of};
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::lens::lens_ray;
use lightcuts_scene::physical::{
    EmissionDesc, EmitterDesc, EmitterKind, EnvironmentDesc, ImageId, PhysicalCamera, PhysicalObject, PhysicalScene,
    PhysicalShape, PixelImage, Pixels, Scattering, SurfaceDesc, SurfaceId, Tint, View,
};
use lightcuts_scene::{Location, MeshDesc, MeshId, MeshTriangle};
use lightcuts_world::PhysicalWorld;

const PI: f32 = std::f32::consts::PI;

fn object(shape: PhysicalShape, material: u32) -> PhysicalObject {
    PhysicalObject { name: String::new(), shape, material: SurfaceId(material), location: Location::default() }
}

fn rectangle(center: Vec3, normal: Vec3, head: Vec3, width: f32, height: f32, material: u32) -> PhysicalObject {
    object(PhysicalShape::Rectangle { center, normal, head, width, height }, material)
}

fn matt(albedo: Vec3) -> SurfaceDesc {
    SurfaceDesc { scattering: Scattering::Lambert { albedo: albedo.into() }, ..SurfaceDesc::default() }
}

fn light(radiance: Vec3) -> SurfaceDesc {
    let emission = Some(EmissionDesc { radiance, image: None, two_sided: false });
    SurfaceDesc { emission, ..matt(Vec3::ZERO) }
}

fn point(position: Vec3, intensity: Vec3) -> EmitterDesc {
    EmitterDesc { kind: EmitterKind::Point { position, intensity }, location: Location::default() }
}

fn looking(position: Vec3, target: Vec3, degrees: f32) -> PhysicalCamera {
    PhysicalCamera {
        position,
        direction: target - position,
        up: if (target - position).normalize().y.abs() > 0.99 { Vec3::Z } else { Vec3::Y },
        view: View::Perspective { degrees },
        ..PhysicalCamera::default()
    }
}

fn settings(integrator: Integrator, size: u32, samples: u32) -> Settings {
    let mut settings = Settings::for_physical();
    (settings.image.width, settings.image.height) = (size, size);
    settings.physical.integrator = integrator;
    settings.sampling.samples = samples;
    settings
}

fn render(scene: &PhysicalScene, settings: &Settings) -> PhysicalRendering {
    let world = PhysicalWorld::new(scene).expect("the scene is sound");
    render_physical(&world, settings, Simd::Auto, &Unwatched).expect("the settings are sound")
}

/// Mean of a picture's channels.
fn mean(rendering: &PhysicalRendering) -> glam::DVec3 {
    let pixels = rendering.beauty.pixels();
    pixels.iter().map(|&p| Vec3::from(p).as_dvec3()).sum::<glam::DVec3>() / pixels.len() as f64
}

/// A box of two coloured walls with a lamp under its ceiling, and two boxes; `occluded` turns the lamp to the ceiling, behind a
/// shade.
fn room(occluded: bool) -> PhysicalScene {
    let (white, red, green) = (Vec3::splat(0.75), Vec3::new(0.6, 0.1, 0.08), Vec3::new(0.12, 0.5, 0.1));
    let materials = vec![
        matt(white),
        matt(red),
        matt(green),
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
        object(PhysicalShape::Sphere { center: Vec3::new(0.7, 0.2, 0.6), radius: 0.2 }, 4),
    ];
    if occluded {
        objects.push(rectangle(Vec3::new(0.5, lamp - 0.01, 0.5), Vec3::NEG_Y, Vec3::Z, 0.34, 0.34, 0));
    }
    let turned = Affine3A::from_translation(Vec3::new(0.3, 0.0, 0.35)) * Affine3A::from_rotation_y(0.3);
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

/// A box of 0.3 x 0.6 x 0.3, standing on the floor.
fn tall_box() -> MeshDesc {
    let corner = |k: u32| Vec3::new((k & 1) as f32 - 0.5, (k >> 1 & 1) as f32, (k >> 2) as f32 - 0.5);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 4, 6, 2], [1, 3, 7, 5], [2, 6, 7, 3], [0, 1, 5, 4]];
    let triangle = |positions| MeshTriangle { positions, normals: None, texture_coordinates: None, material: None };
    MeshDesc {
        positions: (0..8).map(|k| corner(k) * Vec3::new(0.3, 0.6, 0.3)).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [triangle([a, b, c]), triangle([a, c, d])]).collect(),
        ..MeshDesc::default()
    }
}

/// A white sphere of any material vanishes in front of even light.
#[test]
fn white_furnace() {
    let white: Tint = Vec3::ONE.into();
    let metal = |roughness| Scattering::Conductor { eta: Vec3::splat(0.0), k: Vec3::splat(100.0), roughness };
    let glass = |roughness| Scattering::Dielectric { ior: 1.5, roughness, transmittance: Vec3::ONE };
    let plastic = |roughness| Scattering::Plastic { albedo: white, ior: 1.5, roughness };
    for (name, scattering) in [
        ("lambert", Scattering::Lambert { albedo: white }),
        ("metal", metal(0.0)),
        ("rough metal", metal(0.7)),
        ("glass", glass(0.0)),
        ("rough glass", glass(0.5)),
        ("plastic", plastic(0.0)),
        ("rough plastic", plastic(0.6)),
        ("mirror", Scattering::Mirror { reflectance: white }),
        ("mix", Scattering::Mix { first: SurfaceId(1), second: SurfaceId(2), weight: 0.3, image: None }),
    ] {
        let scene = PhysicalScene {
            camera: looking(Vec3::Z * 4.0, Vec3::ZERO, 20.0),
            objects: vec![object(PhysicalShape::Sphere { center: Vec3::ZERO, radius: 1.0 }, 0)],
            materials: vec![
                SurfaceDesc { scattering, ..SurfaceDesc::default() },
                matt(Vec3::ONE),
                SurfaceDesc {
                    scattering: Scattering::Mix { first: SurfaceId(1), second: SurfaceId(1), weight: 0.5, image: None },
                    ..SurfaceDesc::default()
                },
            ],
            environment: Some(EnvironmentDesc {
                radiance: Vec3::ONE,
                image: None,
                degrees: 30.0,
                location: Location::default(),
            }),
            ..PhysicalScene::default()
        };
        // What passes through rough glass comes by few paths of great weight.
        let samples = if name == "rough glass" { 512 } else { 96 };
        for integrator in [Integrator::Path, Integrator::Lightcuts] {
            let rendering = render(&scene, &settings(integrator, 16, samples));
            let mean = mean(&rendering);
            println!("{name}, {integrator:?}: {:.4}", mean.x);
            assert!((mean.x - 1.0).abs() < 0.005, "{name}, {integrator:?}: {mean}");
        }
    }
}

/// I cos^3 / h^2 rho / pi, without any noise.
#[test]
fn a_point_light_over_a_plane() {
    let scene = PhysicalScene {
        camera: looking(Vec3::new(0.0, 5.0, 0.01), Vec3::ZERO, 40.0),
        objects: vec![rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 50.0, 50.0, 0)],
        materials: vec![matt(Vec3::splat(0.5))],
        lights: vec![point(Vec3::Y * 2.0, Vec3::splat(10.0))],
        ..PhysicalScene::default()
    };
    let rendering = render(&scene, &settings(Integrator::Path, 33, 1));
    for (found, at) in rendering.beauty.pixels().iter().zip(rendering.position.pixels()) {
        let to_light = Vec3::Y * 2.0 - Vec3::from(*at);
        let exact = 10.0 * to_light.normalize().y / to_light.length_squared() * 0.5 / PI;
        assert!((found[0] / exact - 1.0).abs() < 1e-4, "{found:?} {exact}");
    }
}

/// What leaves one plate for the other is the form factor of two parallel unit squares at distance 1: 0.19982.
#[test]
fn two_parallel_plates() {
    let scene = PhysicalScene {
        camera: PhysicalCamera {
            // From above the lamp, which does not hide what is behind it: rays begin below it.
            position: Vec3::Y * 2.0,
            direction: Vec3::NEG_Y,
            up: Vec3::Z,
            view: View::Orthographic { height: 1.0 },
            near: 1.5,
            ..PhysicalCamera::default()
        },
        objects: vec![
            rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 1.0, 1.0, 0),
            rectangle(Vec3::Y, Vec3::NEG_Y, Vec3::Z, 1.0, 1.0, 1),
        ],
        materials: vec![matt(Vec3::splat(0.5)), light(Vec3::ONE)],
        ..PhysicalScene::default()
    };
    let rendering = render(&scene, &settings(Integrator::Path, 32, 64));
    // The mean irradiance is pi times the form factor; half of it is reflected.
    let found = mean(&rendering).x;
    let exact = 0.199_825 * 0.5;
    assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
}

/// A point light in the middle of a matt sphere: I / r^2 rho / pi, and all that is reflected again: over 1 - rho.
#[test]
fn a_light_in_a_matt_sphere() {
    let albedo = 0.6;
    let scene = PhysicalScene {
        camera: looking(Vec3::new(0.0, 0.0, 0.5), Vec3::new(0.0, 0.3, -2.0), 60.0),
        objects: vec![object(PhysicalShape::Sphere { center: Vec3::ZERO, radius: 2.0 }, 0)],
        materials: vec![matt(Vec3::splat(albedo))],
        lights: vec![point(Vec3::ZERO, Vec3::ONE)],
        ..PhysicalScene::default()
    };
    let exact = f64::from(albedo / PI / 4.0 / (1.0 - albedo));
    for (integrator, gather) in [
        (Integrator::Path, Strategy::All),
        (Integrator::Lightcuts, Strategy::All),
        (Integrator::Lightcuts, Strategy::Lightcuts),
        (Integrator::Lightcuts, Strategy::Stochastic),
    ] {
        let mut settings = settings(integrator, 24, 48);
        settings.gather.strategy = gather;
        settings.physical.vpls = 400;
        let found = mean(&render(&scene, &settings)).x;
        println!("{integrator:?}, {gather:?}: {found:.5} of {exact:.5}");
        assert!((found / exact - 1.0).abs() < 0.01, "{integrator:?} {gather:?}: {found} {exact}");
    }
}

/// The room with a checkered, uneven wall, glossy things, a sky behind a missing ceiling, or many small lamps in place of one.
fn variants() -> Vec<(&'static str, PhysicalScene)> {
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
        let [x, y, z, _] = lightcuts_kernel::rng::random4(k, 0, 0, 4);
        let center = Vec3::new(0.1 + 0.8 * x, 0.65 + 0.3 * y, 0.1 + 0.8 * z);
        object(PhysicalShape::Sphere { center, radius: 0.012 }, 3)
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

/// Every strategy shows what path tracing shows, at every pixel, as far as the noise of both tells: the greatest of all normal
/// deviates is not above what chance gives in a thousand (Sidak's correction).
#[test]
fn every_pixel_agrees_with_path_tracing() {
    for (name, scene) in variants() {
        let reference = render(&scene, &settings(Integrator::Path, 16, 1024));
        for strategy in [Strategy::All, Strategy::Lightcuts, Strategy::Stochastic] {
            let mut settings = settings(Integrator::Lightcuts, 16, 96);
            settings.gather.strategy = strategy;
            settings.physical.vpls = 300;
            settings.physical.cut_error = 0.1;
            let rendering = render(&scene, &settings);
            let brightness =
                |r: &PhysicalRendering, k: usize| f64::from(r.beauty.pixels()[k].iter().sum::<f32>()) / 3.0;
            let mut deviates: Vec<f64> = Vec::new();
            for k in 0..256 {
                let variance = f64::from(reference.variance.pixels()[k] + rendering.variance.pixels()[k]);
                if variance > 0.0 {
                    deviates.push((brightness(&rendering, k) - brightness(&reference, k)) / variance.sqrt());
                }
            }
            let greatest = deviates.iter().map(|z| z.abs()).fold(0.0, f64::max);
            let mean_sq = deviates.iter().map(|z| z * z).sum::<f64>() / deviates.len() as f64;
            println!("{name}, {strategy:?}: greatest |z| {greatest:.2}, mean z^2 {mean_sq:.2} of {}", deviates.len());
            // 1 - (1 - 0.001)^(1 / 256) on both sides is 4.6 deviations.
            assert!(greatest < 4.6 && mean_sq < 1.5, "{name}, {strategy:?}: {greatest} {mean_sq}");
        }
    }
}

/// The oracle: at every pixel the sum over a cut is as near to the sum over all lights as it says, and equal for an error of 0.
#[test]
fn every_cut_is_within_its_bound() {
    for (occluded, vpls) in [(false, 500), (true, 500), (false, 20_000)] {
        let world = PhysicalWorld::new(&room(occluded)).unwrap();
        let scene = Scene::new(&world, Simd::Auto);
        let origins = Origins::new(&scene).unwrap();
        let set = trace_vpls(&scene, &origins, vpls, 3);
        let tree = ClusterTree::build(&set.lights, 4);
        let size = if vpls > 1000 { 12 } else { 24 };
        let lens = world.lens(size, size);
        let (mut heap, mut counts) = (CutHeap::default(), Counts::default());
        let (mut closest, mut pixels, mut sizes) = (0.0_f32, 0, 0);
        for j in 0..size {
            for i in 0..size {
                let ray = lens_ray(&lens, [i as f32 + 0.5, j as f32 + 0.5], [0.0; 2]);
                let Some(hit) = scene.closest(&ray) else { continue };
                let at = scene.interaction(&ray, &hit, Cone::NONE, 0.5);
                if lobes_of(&at.bsdf) & MATT == 0 {
                    continue;
                }
                let receiver = Receiver::new(&scene, &at, Vec3::ONE, Vec3::ONE, 0.0025);
                let all = receiver.all(&tree, &mut counts).light;
                for error in [0.3, 0.02, 0.0] {
                    let cut = receiver.cut(&tree, error, u32::MAX, None, &mut heap, &mut counts);
                    let difference = (light_power(cut.light) - light_power(all)).abs();
                    let rounding = 2e-4 * light_power(all);
                    assert!(difference <= cut.bound + rounding, "({i}, {j}): {difference} > {}", cut.bound);
                    if error == 0.0 {
                        assert!(difference <= rounding, "({i}, {j}): {difference}");
                        assert!(cut.bound == 0.0);
                    } else if cut.bound > 0.0 {
                        closest = closest.max(difference / cut.bound);
                    }
                    if error == 0.02 {
                        sizes += cut.size;
                    }
                }
                pixels += 1;
            }
        }
        println!(
            "occluded {occluded}, {} lights: {pixels} pixels, {:.0} in a cut of 2 %, the closest reaches {closest:.2} of its bound",
            tree.lights.len(),
            f64::from(sizes) / f64::from(pixels),
        );
        assert!(pixels > 100);
    }
}

/// A scene `k` times as large, in every length.
fn scaled(scene: &PhysicalScene, k: f32) -> PhysicalScene {
    let mut large = scene.clone();
    large.camera.position *= k;
    for object in &mut large.objects {
        match &mut object.shape {
            PhysicalShape::Sphere { center, radius } => (*center, *radius) = (*center * k, *radius * k),
            PhysicalShape::Rectangle { center, width, height, .. } => {
                (*center, *width, *height) = (*center * k, *width * k, *height * k);
            }
            PhysicalShape::Mesh { placement, .. } => *placement = Affine3A::from_scale(Vec3::splat(k)) * *placement,
        }
    }
    large
}

/// Light per area and angle knows no unit of length: a power of two changes no bit, and a factor of 1,000 only what rounding
/// does to single paths.
#[test]
fn a_thousand_times_as_large() {
    let scene = room(false);
    for integrator in [Integrator::Path, Integrator::Lightcuts] {
        let settings = settings(integrator, 24, 8);
        let small = render(&scene, &settings);
        assert_eq!(render(&scaled(&scene, 1024.0), &settings).beauty.pixels(), small.beauty.pixels());
        let ratio = mean(&render(&scaled(&scene, 1000.0), &settings)) / mean(&small);
        println!("{integrator:?}: {ratio:.5}");
        assert!((ratio - 1.0).abs().max_element() < 0.01, "{integrator:?}: {ratio}");
    }
}

/// The same numbers on any number of threads, with and without vector instructions.
#[test]
fn the_same_picture_bit_for_bit() {
    let world = PhysicalWorld::new(&room(true)).unwrap();
    let settings = settings(Integrator::Lightcuts, 20, 3);
    let on = |threads, simd| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render_physical(&world, &settings, simd, &Unwatched).unwrap().beauty)
    };
    let expected = on(1, Simd::Off);
    assert_eq!(on(3, Simd::Auto).pixels(), expected.pixels());
    assert_eq!(Randoms::new(1, 2, 3).next(), Randoms::new(1, 2, 3).next());
}
