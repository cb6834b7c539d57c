//! Pictures and normal maps lie on surfaces as they are, however these are mirrored and placed.

use super::scenes::{direction, instance, looking, object, quad, rectangle, render, settings};
use crate::physical::scene::{Cone, Scene};
use crate::settings::Integrator;
use glam::{DAffine3, DVec3, Vec3};
use lightcuts_kernel::ray::Ray;
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::surface::surface_at;
use lightcuts_scene::Location;
use lightcuts_scene::physical::{
    EmitterDesc, EmitterKind, ImageId, PhysicalObject, PhysicalScene, PhysicalShape, PixelImage, Pixels, Scattering,
    SurfaceDesc, Tint, View,
};
use lightcuts_world::PhysicalWorld;

/// One texel whose normal leans by 45 degrees towards v, in linear bytes.
fn leaning() -> PixelImage {
    let pixels = Pixels::Linear(vec![[128, 218, 218, 255]]);
    PixelImage { name: "leaning".to_owned(), width: 1, height: 1, pixels }
}

/// Red and green above, blue and yellow below.
fn colors() -> PixelImage {
    let colors = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 0, 255]];
    let pixels = (0..256).map(|k| colors[k / 128 * 2 + k % 16 / 8]).collect();
    PixelImage { name: "colors".to_owned(), width: 16, height: 16, pixels: Pixels::Linear(pixels) }
}

fn scene(objects: Vec<PhysicalObject>, meshes: Vec<lightcuts_scene::MeshDesc>) -> PhysicalScene {
    let albedo = Tint { color: Vec3::ONE, image: None };
    let surface = SurfaceDesc { scattering: Scattering::Lambert { albedo }, ..SurfaceDesc::default() };
    let picture = Tint { color: Vec3::ONE, image: Some(ImageId(1)) };
    PhysicalScene {
        camera: looking(Vec3::Z * 6.0, Vec3::ZERO, 10.0),
        objects,
        meshes,
        images: vec![leaning(), colors()],
        materials: vec![
            SurfaceDesc { normal_map: Some(ImageId(0)), ..surface.clone() },
            SurfaceDesc { scattering: Scattering::Lambert { albedo: picture }, ..surface },
        ],
        ..PhysicalScene::default()
    }
}

/// A normal map leans along growing v, as it is on the surface itself: quads with texture coordinates that are mirrored
/// along u, v or both, turned by quarters, placed by matrices that mirror, and rectangles and spheres.
#[test]
fn normal_maps_lean_along_v() {
    for k in 0..400 {
        let [a, b, c, d] = random4(k, 0, 0, 63);
        let mut mesh = quad(Vec3::ZERO, Vec3::X, Vec3::Y);
        let mirror = |uv: &mut [f32; 2]| {
            if k & 1 != 0 {
                uv[0] *= -3.0;
            }
            if k & 2 != 0 {
                uv[1] = 2.0 - uv[1];
            }
            if k & 4 != 0 {
                *uv = [uv[1], -uv[0]];
            }
        };
        mesh.texture_coordinates.iter_mut().for_each(mirror);
        let turn = DAffine3::from_axis_angle(
            DVec3::new(f64::from(a) - 0.5, f64::from(b), f64::from(c)).normalize(),
            3.0 * f64::from(d),
        );
        let scale = DVec3::new(
            [1.0, -1.0][(k >> 3 & 1) as usize],
            [1.5, -1.5][(k >> 4 & 1) as usize],
            [2.0, -0.5][(k >> 5 & 1) as usize],
        );
        let placement = turn * DAffine3::from_scale(scale);
        let head = turn.transform_vector3(DVec3::Y).as_vec3();
        let front = turn.transform_vector3(DVec3::Z).as_vec3();
        let object = match k % 3 {
            0 => instance(0, placement, 0),
            1 => rectangle(Vec3::ZERO, front, head, 1.0, 2.0, 0),
            _ => object(PhysicalShape::Sphere { center: DVec3::ZERO, radius: 1.0 }, 0),
        };
        let world = PhysicalWorld::new(&scene(vec![object], vec![mesh])).unwrap();
        let scene = Scene::new(&world, crate::cpu::Simd::Off);
        // Three rays near one another find how v grows along the surface.
        let toward = front * 3.0 + direction(k) * 0.2;
        let hit = |shift: Vec3| {
            let ray =
                Ray { origin: toward + shift, direction: -front, t_min: 0.0, t_max: f32::INFINITY, inside: false };
            let hit = scene.closest(&ray)?;
            Some((
                scene.interaction(&ray, &hit, Cone::NONE, 0.5),
                scene.texture_coordinates(&hit, &surface_at(&world.shapes.surfaces(), &ray, &hit)),
            ))
        };
        let across = front.cross(head);
        let step = 2e-3;
        let Some((at, [_, v])) = hit(Vec3::ZERO) else { panic!("{k}: nothing is hit") };
        let Some(((right, [_, v_right]), (up, [_, v_up]))) = hit(across * step).zip(hit(head * step)) else { continue };
        let (along_right, along_up) = (right.point - at.point, up.point - at.point);
        let (slope_right, slope_up) = ((v_right - v) / along_right.length(), (v_up - v) / along_up.length());
        let steepest = along_right.normalize() * slope_right + along_up.normalize() * slope_up;
        let steepest = (steepest - at.face * steepest.dot(at.face)).normalize();
        let lean = at.normal.dot(steepest);
        assert!((lean - 0.5_f32.sqrt()).abs() < 0.03, "{k}: {lean} along v, normal {}, face {}", at.normal, at.face);
    }
}

/// A rectangle shows its picture as it is, with the head up; its light does too.
#[test]
fn rectangles_show_pictures_as_they_are() {
    let mut scene = scene(vec![rectangle(Vec3::ZERO, Vec3::Z, Vec3::Y, 1.0, 1.0, 1)], Vec::new());
    scene.camera.view = View::Orthographic { height: 1.0 };
    scene.lights = vec![EmitterDesc {
        kind: EmitterKind::Directional { direction: Vec3::NEG_Z, irradiance: Vec3::splat(std::f32::consts::PI) },
        location: Location::default(),
    }];
    let rendering = render(&scene, &settings(Integrator::Path, 8, 8));
    let at = |x: usize, y: usize| Vec3::from(rendering.beauty.pixels()[y * 8 + x]);
    // The top row first: red and green above, blue and yellow below.
    for (x, y, color) in [(1, 1, Vec3::X), (6, 1, Vec3::Y), (1, 6, Vec3::Z), (6, 6, Vec3::new(1.0, 1.0, 0.0))] {
        assert!((at(x, y) - color).length() < 0.02, "{x}, {y}: {}", at(x, y));
    }
}
