//! Pictures of which every value is known.

use super::scenes::{diffuse, light, looking, mean, object, point, rectangle, render, settings, spot_down};
use crate::settings::{Integrator, Strategy};
use glam::Vec3;
use lightcuts_scene::Location;
use lightcuts_scene::physical::{
    EnvironmentDesc, PhysicalCamera, PhysicalScene, PhysicalShape, Scattering, SurfaceDesc, SurfaceId, Tint, View,
};
use std::f32::consts::PI;

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
            objects: vec![object(PhysicalShape::Sphere { center: glam::DVec3::ZERO, radius: 1.0 }, 0)],
            materials: vec![
                SurfaceDesc { scattering, ..SurfaceDesc::default() },
                diffuse(Vec3::ONE),
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
            let rendering = render(&scene, &settings(integrator, 12, samples));
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
        materials: vec![diffuse(Vec3::splat(0.5))],
        lights: vec![point(Vec3::Y * 2.0, Vec3::splat(10.0))],
        ..PhysicalScene::default()
    };
    let rendering = render(&scene, &settings(Integrator::Path, 33, 1));
    for (found, at) in rendering.beauty.pixels().iter().zip(rendering.aovs().position.pixels()) {
        let to_light = Vec3::Y * 2.0 - Vec3::from(*at);
        let exact = 10.0 * to_light.normalize().y / to_light.length_squared() * 0.5 / PI;
        assert!((found[0] / exact - 1.0).abs() < 1e-4, "{found:?} {exact}");
    }
}

/// A spot above a mirror lights a ceiling as its mirror image would; paths never find it, photons do.
#[test]
fn a_mirrored_spot() {
    let scene = PhysicalScene {
        camera: looking(Vec3::new(0.0, 0.9, 0.01), Vec3::Y * 2.0, 40.0),
        objects: vec![
            rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 20.0, 20.0, 1),
            // Dark, for the mirror sends its own light back to it.
            rectangle(Vec3::Y * 2.0, Vec3::NEG_Y, Vec3::Z, 20.0, 20.0, 0),
        ],
        materials: vec![
            diffuse(Vec3::splat(0.01)),
            SurfaceDesc {
                scattering: Scattering::Mirror { reflectance: Vec3::splat(0.9).into() },
                ..SurfaceDesc::default()
            },
        ],
        lights: vec![spot_down(Vec3::Y, Vec3::splat(10.0))],
        ..PhysicalScene::default()
    };
    let mut settings = settings(Integrator::Path, 16, 64);
    let dark = mean(&render(&scene, &settings));
    settings.caustics.enabled = true;
    let rendering = render(&scene, &settings);
    let of = |at: &[f32; 3]| {
        let to_light = Vec3::NEG_Y - Vec3::from(*at);
        10.0 * 0.9 * -to_light.normalize().y / to_light.length_squared() * 0.01 / PI
    };
    let exact: f32 = rendering.aovs().position.pixels().iter().map(of).sum::<f32>() / 256.0;
    let ratio = mean(&rendering).x as f32 / exact;
    println!("without photons {:.4}, with them {ratio:.4} of {exact}", dark.x as f32 / exact);
    assert!(dark.x == 0.0 && (ratio - 1.0).abs() < 0.02, "{dark} {ratio}");
}

/// What leaves one plate for the other is the form factor of two parallel unit squares at distance 1: 0.19982.
#[test]
fn two_parallel_plates() {
    let scene = PhysicalScene {
        camera: PhysicalCamera {
            // From above the lamp, which does not hide what is behind it: rays begin below it.
            position: glam::DVec3::Y * 2.0,
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
        materials: vec![diffuse(Vec3::splat(0.5)), light(Vec3::ONE)],
        ..PhysicalScene::default()
    };
    let rendering = render(&scene, &settings(Integrator::Path, 32, 64));
    // The mean irradiance is pi times the form factor; half of it is reflected.
    let found = mean(&rendering).x;
    let exact = 0.199_825 * 0.5;
    assert!((found / exact - 1.0).abs() < 2e-3, "{found} {exact}");
}

/// A point light in the middle of a diffuse sphere: I / r^2 rho / pi, and all that is reflected again: over 1 - rho.
#[test]
fn a_light_in_a_diffuse_sphere() {
    let albedo = 0.6;
    let scene = PhysicalScene {
        camera: looking(Vec3::new(0.0, 0.0, 0.5), Vec3::new(0.0, 0.3, -2.0), 60.0),
        objects: vec![object(PhysicalShape::Sphere { center: glam::DVec3::ZERO, radius: 2.0 }, 0)],
        materials: vec![diffuse(Vec3::splat(albedo))],
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
