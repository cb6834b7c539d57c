//! Scenes whose picture is known.

use glam::Vec3;
use lightcuts_render::{Options, Rendering, Settings, Unwatched, Vpl, render};
use lightcuts_scene::{
    CameraDesc, LightDesc, LightKind, Location, MaterialDesc, MaterialId, ObjectDesc, Projection, SceneDesc, ShapeDesc,
};
use lightcuts_world::World;

fn object(shape: ShapeDesc, material: u32) -> ObjectDesc {
    ObjectDesc { name: String::new(), shape, material: MaterialId(material), location: Location::default() }
}

fn light(kind: LightKind) -> LightDesc {
    LightDesc {
        kind,
        attenuation: 1.0,
        specular: Vec3::ONE,
        diffuse: Vec3::ONE,
        ambient: Vec3::ONE,
        location: Location::default(),
    }
}

/// A wide floor in the plane y = 0, seen from above with parallel rays: the picture spans 5.12 x 5.12 units around the
/// origin, +x to the right, -z up.
fn floor(scale: f32) -> SceneDesc {
    let grey = MaterialDesc { diffuse: Vec3::splat(0.5), ..MaterialDesc::default() };
    let square = |size: f32| ShapeDesc::Square {
        center: Vec3::ZERO,
        normal: Vec3::Y,
        head: Vec3::NEG_Z,
        width: size,
        height: size,
    };
    SceneDesc {
        camera: CameraDesc {
            projection: Projection::Orthographic,
            center: Vec3::Y * 50.0 * scale,
            view: Vec3::NEG_Y,
            up: Vec3::NEG_Z,
            ..CameraDesc::default()
        },
        materials: vec![grey],
        objects: vec![object(square(1000.0 * scale), 0)],
        ..SceneDesc::default()
    }
}

fn settings() -> Settings {
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (32, 32);
    settings.vpl.enabled = false;
    settings
}

fn picture(scene: &SceneDesc, settings: &Settings, vpls: Option<Vec<Vpl>>) -> Rendering {
    let world = World::new(scene).expect("the scene is sound");
    let options = Options { vpls, ..Options::default() };
    render(&world, settings, &options, &Unwatched).expect("the settings are valid")
}

/// The middle of the 32 x 32 picture looks at the origin.
fn middle(rendering: &Rendering) -> f32 {
    rendering.beauty.get(16, 16)[0]
}

#[test]
fn a_point_light_over_a_plane() {
    let mut scene = floor(1.0);
    scene.lights.push(light(LightKind::Omni { position: Vec3::new(3.0, 4.0, 0.0) }));
    let rendering = picture(&scene, &settings(), None);
    // No falloff: half-grey times the cosine 4/5, the pixel's shift moves it by less than 1 %.
    assert!((middle(&rendering) - 0.4).abs() < 0.01, "{}", middle(&rendering));
    assert!((rendering.depth.get(16, 16) - 50.0).abs() < 1e-3);
    assert_eq!(rendering.object_id.get(16, 16), 1);
    assert_eq!(rendering.normal.get(16, 16), [0.0, 1.0, 0.0]);
}

#[test]
fn a_vpl_over_a_plane() {
    let vpl = Vpl {
        position: Vec3::new(3.0, 4.0, 0.0),
        direction: Vec3::NEG_Y,
        diffuse: Vec3::ONE,
        attenuation: 0.5,
        ..Vpl::default()
    };
    let mut settings = settings();
    settings.vpl.enabled = true;
    let rendering = picture(&floor(1.0), &settings, Some(vec![vpl; 2]));
    // Two of them: each half-grey times both cosines times the attenuation.
    assert!((middle(&rendering) - 2.0 * 0.5 * 0.8 * 0.8 * 0.5).abs() < 0.01, "{}", middle(&rendering));
    assert_eq!(rendering.lights_selected.get(16, 16), 2.0);
}

#[test]
fn parallel_light_has_a_diffuse_term_and_shadows() {
    let mut scene = floor(1.0);
    scene.lights.push(light(LightKind::Directional { direction: Vec3::new(1.0, -1.0, 0.0) }));
    assert!((middle(&picture(&scene, &settings(), None)) - 0.5 * 0.5_f32.sqrt()).abs() < 1e-3);
    // Out of the camera's sight, in the light's way.
    scene.objects.push(object(ShapeDesc::Sphere { center: Vec3::new(-20.0, 20.0, 0.0), radius: 4.0 }, 0));
    assert_eq!(middle(&picture(&scene, &settings(), None)), 0.0);
}

#[test]
fn an_area_light_is_visible_and_shines_as_one() {
    let mut scene = floor(1.0);
    scene.lights.push(light(LightKind::Area {
        center: Vec3::new(0.0, 60.0, 0.0),
        normal: Vec3::NEG_Y,
        head: Vec3::X,
        width: 2.0,
        height: 2.0,
        spacing: 0.25,
    }));
    // Behind the camera: 64 lights right above, each a 64th of the colour, both cosines nearly 1.
    let shining = picture(&scene, &settings(), None);
    assert!((middle(&shining) - 0.5).abs() < 0.005, "{}", middle(&shining));
    // Before the camera, turned up: its dark side hides the floor but glows.
    let LightKind::Area { center, .. } = &mut scene.lights[0].kind else { panic!("an area light") };
    *center = Vec3::Y * 10.0;
    assert_eq!(middle(&picture(&scene, &settings(), None)), 1.0);
}

#[test]
fn occlusion_of_an_open_plane_and_of_a_low_ceiling() {
    let mut scene = floor(1.0);
    scene.lights.push(light(LightKind::Omni { position: Vec3::Y * 40.0 }));
    let mut settings = settings();
    settings.ambient_occlusion.enabled = true;
    let open = middle(&picture(&scene, &settings, None));
    assert!((open - 0.5).abs() < 0.01, "{open}");
    // A ceiling at height h with range r, seen within the cone of 50 degrees: a ray at angle t meets it at h / cos t, so the
    // mean of 1 - h / (r cos t) under the density cos t / (pi sin^2 50) is 1 - 2 (h / r) (1 - cos 50) / sin^2 50.
    let (height, range) = (60.0_f32, 200.0_f32);
    settings.ambient_occlusion.range = range;
    scene.objects.push(object(
        ShapeDesc::Square {
            center: Vec3::Y * height,
            normal: Vec3::NEG_Y,
            head: Vec3::X,
            width: 1000.0,
            height: 1000.0,
        },
        0,
    ));
    let (sin, cos) = 50.0_f32.to_radians().sin_cos();
    let occluded = 1.0 - 2.0 * (height / range) * (1.0 - cos) / (sin * sin);
    let under = middle(&picture(&scene, &settings, None));
    assert!((under / open - (1.0 - occluded)).abs() < 0.01, "{under} {open} {occluded}");
}

/// A mirror that sends parallel light down lights the floor like the light itself: photons carry their power.
#[test]
fn photons_of_a_plane_mirror_have_the_lights_density() {
    let mut scene = floor(1.0);
    scene.materials[0].diffuse = Vec3::splat(0.4);
    scene.materials.push(MaterialDesc { reflection: 0.5, local: 0.0, diffuse: Vec3::ZERO, ..MaterialDesc::default() });
    // Light along -x meets a mirror tilted by 45 degrees above the camera and turns down.
    scene.lights.push(light(LightKind::Directional { direction: Vec3::NEG_X }));
    scene.objects.push(object(
        ShapeDesc::Square {
            center: Vec3::Y * 100.0,
            normal: Vec3::new(1.0, -1.0, 0.0),
            head: Vec3::Z,
            width: 60.0,
            height: 60.0,
        },
        1,
    ));
    let mut settings = settings();
    settings.vpl.enabled = true;
    settings.caustics.enabled = true;
    settings.caustics.step = 0.25;
    let rendering = picture(&scene, &settings, Some(Vec::new()));
    let density = rendering.second_pass.get(16, 16)[0];
    // F times the colour times the diffuse colour: 0.5 x 1 x 0.4.
    assert!((density - 0.2).abs() < 0.01, "{density}");
    assert!(rendering.stats.photons_stored > 10_000);
}

#[test]
fn depth_limits_mirrors() {
    // Two mirrors face each other; the lit wall behind the camera is seen after three bounces only.
    let mut scene = floor(1.0);
    scene.background = Vec3::new(0.25, 0.5, 0.75);
    scene.objects.clear();
    scene.materials[0] = MaterialDesc { reflection: 1.0, local: 0.0, ..MaterialDesc::default() };
    let tilted = |center: Vec3, normal: Vec3| {
        object(ShapeDesc::Square { center, normal, head: Vec3::Z, width: 30.0, height: 30.0 }, 0)
    };
    scene.objects.push(tilted(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
    scene.objects.push(tilted(Vec3::X * 100.0, Vec3::new(-1.0, 1.0, 0.0)));
    let with_depth = |depth: u32| {
        let mut settings = settings();
        settings.run.max_depth = depth;
        picture(&scene, &settings, None).beauty.get(16, 16)
    };
    assert_eq!(with_depth(2), [0.0; 3]);
    assert_eq!(with_depth(3), [0.25, 0.5, 0.75]);
}

/// The scene scaled by 1,000 gives the same picture.
#[test]
fn the_unit_of_length_does_not_matter() {
    let scaled = |scale: f32| {
        let mut scene = floor(scale);
        // The view plane has a fixed size: the eye, 5 units behind it, is put where it scales with the scene.
        scene.camera.projection = Projection::Perspective { distance: 5.0 };
        scene.camera.center.y -= 5.0;
        scene.lights.push(light(LightKind::Omni { position: Vec3::new(20.0, 40.0, 10.0) * scale }));
        let ball = |x: f32, material: u32| {
            object(ShapeDesc::Sphere { center: Vec3::new(x, 6.0, 0.0) * scale, radius: 6.0 * scale }, material)
        };
        scene.materials.push(MaterialDesc { refraction: 0.9, refraction_ratio: 0.67, ..MaterialDesc::default() });
        scene.objects.extend([ball(-8.0, 0), ball(8.0, 1)]);
        let mut settings = settings();
        settings.vpl.enabled = true;
        settings.vpl.probability = 0.001;
        settings.vpl.min_illumination = 0.1;
        settings.gather.threshold = 0.0;
        picture(&scene, &settings, None)
    };
    let (small, large) = (scaled(1.0), scaled(1000.0));
    let close = lightcuts_image::fraction_within(&small.beauty, &large.beauty, 0.02).expect("equal sizes");
    assert!(small.stats.vpl_count > 20, "{}", small.stats.vpl_count);
    assert!(close > 0.98, "{close}");
}
