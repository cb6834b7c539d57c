//! Scenes of the thesis' model in the physical one.
//!
//! Its lights do not fall off with distance, its materials do not keep energy: neither can be carried over exactly.
//! Geometry and view are the same; a light gets the radiant intensity with which it gives the thesis' brightness at a
//! middle distance.

use super::{
    EmissionDesc, EmitterDesc, EmitterKind, ImageId, PhysicalCamera, PhysicalObject, PhysicalScene, PhysicalShape,
    PixelImage, Pixels, Scattering, SurfaceDesc, SurfaceId, Tint, View,
};
use crate::{
    ImageDesc, LightDesc, LightKind, MaterialDesc, MaterialId, MeshDesc, MeshId, MeshTriangle, ObjectDesc, Projection,
    SceneDesc, ShapeDesc, Transform,
};
use glam::{Affine3A, DAffine3, DMat3, Mat3, Quat, Vec3};
use std::f32::consts::PI;

/// Height of the thesis' view plane, in scene units.
const PLANE_HEIGHT: f32 = 5.12;

/// A scene of the thesis' model in the physical one.
///
/// * A light of colour c (diffuse colour times attenuation) would light a white surface that faces it to c at any
///   distance. Here it does at the reference distance d, half the diagonal of the box around all objects: a point has
///   the intensity pi d^2 c, an area light the radiance pi d^2 n c / A for its area A and the n points that the thesis
///   cuts it into, directional light the irradiance pi c. `light_scale` is a factor on all of them.
/// * E times the diffuse and specular colours make a Phong material, scaled down where both exceed 1; F mixes in a
///   mirror, R a smooth dielectric of index 1/K. Ambient light has no counterpart: interreflection takes its place.
/// * The thesis adds a texture's texels to the colour of the surface; here they are the diffuse colour.
pub fn from_thesis(scene: &SceneDesc, light_scale: f32) -> PhysicalScene {
    let mut made = PhysicalScene {
        name: scene.name.clone(),
        camera: camera(scene),
        meshes: scene.meshes.clone(),
        images: scene.images.iter().map(image).collect(),
        ..PhysicalScene::default()
    };
    // Materials keep their numbers, because meshes name them: their ingredients follow behind.
    made.materials = vec![SurfaceDesc::default(); scene.materials.len()];
    for (i, desc) in scene.materials.iter().enumerate() {
        made.materials[i] = material(desc, &mut made.materials);
    }
    made.objects = scene.objects.iter().flat_map(object).collect();
    mirror_pictures(&mut made);
    let (lower, upper) = bounds(scene);
    let distance = (upper - lower).length() / 2.0;
    let strength = PI * distance * distance * light_scale;
    for light in &scene.lights {
        add_light(light, strength, light_scale, &mut made);
    }
    made
}

fn camera(scene: &SceneDesc) -> PhysicalCamera {
    let from = &scene.camera;
    let direction = from.view.normalize_or_zero();
    let (view, behind) = match from.projection {
        Projection::Perspective { distance } => {
            let degrees = 2.0 * (PLANE_HEIGHT / 2.0 / distance).atan().to_degrees();
            (View::Perspective { degrees }, distance)
        }
        Projection::Orthographic => (View::Orthographic { height: PLANE_HEIGHT }, 0.0),
    };
    PhysicalCamera {
        position: (from.center - direction * behind).as_dvec3(),
        direction,
        up: from.up,
        view,
        near: behind,
        ..PhysicalCamera::default()
    }
}

fn image(from: &ImageDesc) -> PixelImage {
    let pixels = from.texels.iter().map(|&[r, g, b]| [r, g, b, 255]).collect();
    PixelImage { name: from.name.clone(), width: from.width, height: from.height, pixels: Pixels::Linear(pixels) }
}

/// A material's counterpart; ingredients of a mix are added to `materials`.
fn material(desc: &MaterialDesc, materials: &mut Vec<SurfaceDesc>) -> SurfaceDesc {
    let local = phong(desc);
    let mut ingredients = vec![(local, desc.local.clamp(0.0, 1.0))];
    let mirror = Scattering::Mirror { reflectance: Vec3::ONE.into() };
    let ior = 1.0 / desc.refraction_ratio.max(1e-3);
    let is_glass = (1.0 / 3.0..=3.0).contains(&ior) && (ior - 1.0).abs() > 1e-2;
    ingredients.push((mirror, desc.reflection.clamp(0.0, 1.0)));
    if is_glass {
        let glass = Scattering::Dielectric { ior, roughness: 0.0, transmittance: Vec3::ONE };
        ingredients.push((glass, desc.refraction.clamp(0.0, 1.0)));
    }
    ingredients.retain(|(_, share)| *share > 0.0);
    let named = |scattering| SurfaceDesc { name: desc.name.clone(), scattering, ..SurfaceDesc::default() };
    let mut ingredients = ingredients.into_iter();
    let Some((mut made, mut total)) = ingredients.next() else {
        return named(Scattering::Lambert { albedo: Vec3::ZERO.into() });
    };
    for (next, share) in ingredients {
        total += share;
        let first = SurfaceId(materials.len() as u32);
        materials.push(named(made));
        let second = SurfaceId(materials.len() as u32);
        materials.push(named(next));
        made = Scattering::Mix { first, second, weight: share / total, image: None };
    }
    named(made)
}

fn phong(desc: &MaterialDesc) -> Scattering {
    let image = desc.texture.map(|texture| ImageId(texture.image.0));
    let (diffuse, specular) = (desc.diffuse, desc.specular);
    let scale = 1.0 / (diffuse + specular).max_element().max(1.0);
    let diffuse = Tint { color: if image.is_some() { Vec3::ONE - specular * scale } else { diffuse * scale }, image };
    if specular == Vec3::ZERO {
        return Scattering::Lambert { albedo: diffuse };
    }
    Scattering::Phong { diffuse, specular: (specular * scale).into(), exponent: desc.exponent.max(1.0) }
}

/// From a model's space to the scene's.
fn placement(transform: &Transform) -> Affine3A {
    let rotation = if transform.degrees == 0.0 {
        Mat3::IDENTITY
    } else {
        // The thesis' files turn against the right-hand rule.
        Mat3::from_quat(Quat::from_axis_angle(transform.axis.normalize_or_zero(), -transform.degrees.to_radians()))
    };
    Affine3A::from_mat3_translation(Mat3::from_diagonal(transform.scale) * rotation, transform.translation)
}

fn rectangle(center: Vec3, normal: Vec3, head: Vec3, width: f32, height: f32) -> PhysicalShape {
    PhysicalShape::Rectangle { center: center.as_dvec3(), normal, head, width, height }
}

/// Squares of the thesis show their textures mirrored, rectangles do not: those that have one become meshes.
fn mirror_pictures(made: &mut PhysicalScene) {
    let mesh = MeshId(made.meshes.len() as u32);
    let mut is_used = false;
    for object in &mut made.objects {
        let PhysicalShape::Rectangle { center, normal, head, width, height } = object.shape else { continue };
        if !has_picture(object.material, &made.materials) {
            continue;
        }
        let normal = normal.as_dvec3().normalize_or_zero();
        let along = head.as_dvec3().reject_from_normalized(normal).normalize_or_zero();
        let (across, along) = (along.cross(normal) * f64::from(width), along * f64::from(height));
        let placement = DAffine3 { matrix3: DMat3::from_cols(across, along, normal), translation: center };
        object.shape = PhysicalShape::Mesh { mesh, placement, smooth: false, override_material: true };
        is_used = true;
    }
    if is_used {
        made.meshes.push(mirrored_square());
    }
}

/// Whether a material, or an ingredient of it, has an image.
fn has_picture(id: SurfaceId, materials: &[SurfaceDesc]) -> bool {
    match materials.get(id.0 as usize).map(|material| &material.scattering) {
        Some(Scattering::Lambert { albedo: diffuse } | Scattering::Phong { diffuse, .. }) => diffuse.image.is_some(),
        // Ingredients stand behind the mixes that they are in.
        Some(&Scattering::Mix { first, second, .. }) => {
            [first, second].into_iter().any(|part| part.0 > id.0 && has_picture(part, materials))
        }
        _ => false,
    }
}

/// A square of edge length 1 about the origin, whose normal is z and whose pictures are mirrored.
fn mirrored_square() -> MeshDesc {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let triangle = |of| MeshTriangle { positions: of, normals: None, texture_coordinates: Some(of), material: None };
    MeshDesc {
        name: "mirrored square".to_owned(),
        positions: corners.map(|[x, y]: [f32; 2]| Vec3::new(x - 0.5, y - 0.5, 0.0)).to_vec(),
        texture_coordinates: corners.map(|[x, y]| [1.0 - x, y]).to_vec(),
        triangles: vec![triangle([0, 1, 2]), triangle([0, 2, 3])],
        ..MeshDesc::default()
    }
}

/// A box is six rectangles.
fn object(from: &ObjectDesc) -> Vec<PhysicalObject> {
    let of = |shape| PhysicalObject {
        name: from.name.clone(),
        shape,
        material: SurfaceId(from.material.0),
        location: from.location,
    };
    match from.shape {
        ShapeDesc::Sphere { center, radius } => vec![of(PhysicalShape::Sphere { center: center.as_dvec3(), radius })],
        ShapeDesc::Square { center, normal, head, width, height } => {
            vec![of(rectangle(center, normal, head, width, height))]
        }
        ShapeDesc::Cube { center, vertical, horizontal, length, width, height } => {
            let up = vertical.normalize_or_zero();
            let right = (horizontal - up * horizontal.dot(up)).normalize_or_zero();
            let front = right.cross(up);
            let axes = [
                (right, length, up, height, width),
                (front, width, up, height, length),
                (up, height, right, length, width),
            ];
            let faces = axes.into_iter().flat_map(|axis| [(1.0, axis), (-1.0, axis)]);
            faces
                .map(|(side, (outwards, extent, head, height, width))| {
                    let normal = outwards * side;
                    let center = center + normal * (extent / 2.0);
                    of(rectangle(center, normal, head, width, height))
                })
                .collect()
        }
        ShapeDesc::Mesh { mesh, ref transform, smooth, override_material } => {
            let placement = placement(transform).as_daffine3();
            vec![of(PhysicalShape::Mesh { mesh, placement, smooth, override_material })]
        }
    }
}

fn add_light(light: &LightDesc, strength: f32, light_scale: f32, made: &mut PhysicalScene) {
    let color = light.diffuse * light.attenuation;
    let mut add = |kind| made.lights.push(EmitterDesc { kind, location: light.location });
    match light.kind {
        LightKind::Omni { position } => {
            add(EmitterKind::Point { position: position.as_dvec3(), intensity: color * strength });
        }
        LightKind::Hemisphere { position, direction } => add(EmitterKind::Spot {
            position: position.as_dvec3(),
            direction,
            intensity: color * strength,
            inner_degrees: 0.0,
            outer_degrees: 90.0,
        }),
        LightKind::Directional { direction } => {
            add(EmitterKind::Directional { direction, irradiance: color * (PI * light_scale) });
        }
        LightKind::Area { center, normal, head, width, height, .. } => {
            let (across, along) = light.kind.subdivision().unwrap_or((1, 1));
            let radiance = color * (strength * (across * along) as f32 / (width * height));
            let emission = Some(EmissionDesc { radiance, image: None, two_sided: false });
            let scattering = Scattering::Lambert { albedo: Vec3::ZERO.into() };
            let id: MaterialId = SurfaceId(made.materials.len() as u32);
            made.materials.push(SurfaceDesc { scattering, emission, ..SurfaceDesc::default() });
            made.objects.push(PhysicalObject {
                name: String::new(),
                shape: rectangle(center, normal, head, width, height),
                material: id,
                location: light.location,
            });
        }
    }
}

/// A box around all objects.
fn bounds(scene: &SceneDesc) -> (Vec3, Vec3) {
    let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let mut hold = |point: Vec3| bounds = (bounds.0.min(point), bounds.1.max(point));
    for object in &scene.objects {
        match object.shape {
            ShapeDesc::Sphere { center, radius } => [center - radius, center + radius].into_iter().for_each(&mut hold),
            ShapeDesc::Square { center, normal, head, width, height } => {
                let normal = normal.normalize_or_zero();
                let along = (head - normal * head.dot(normal)).normalize_or_zero();
                let reach = (along.cross(normal) * width).abs() / 2.0 + (along * height).abs() / 2.0;
                [center - reach, center + reach].into_iter().for_each(&mut hold);
            }
            ShapeDesc::Cube { center, length, width, height, .. } => {
                let reach = Vec3::splat(Vec3::new(length, width, height).length() / 2.0);
                [center - reach, center + reach].into_iter().for_each(&mut hold);
            }
            ShapeDesc::Mesh { mesh, ref transform, .. } => {
                let placement = placement(transform);
                for &p in scene.meshes.get(mesh.0 as usize).map_or(&[][..], |mesh| &mesh.positions) {
                    hold(placement.transform_point3(p));
                }
            }
        }
    }
    if bounds.0.x > bounds.1.x { (Vec3::ZERO, Vec3::ONE) } else { bounds }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Location;

    fn scene(material: MaterialDesc, kind: LightKind) -> SceneDesc {
        let light = LightDesc {
            kind,
            attenuation: 0.5,
            specular: Vec3::ONE,
            diffuse: Vec3::new(1.0, 0.5, 0.0),
            ambient: Vec3::ZERO,
            location: Location::default(),
        };
        let object = ObjectDesc {
            name: String::new(),
            shape: ShapeDesc::Sphere { center: Vec3::ZERO, radius: 2.0 },
            material: MaterialId(0),
            location: Location::default(),
        };
        SceneDesc { materials: vec![material], objects: vec![object], lights: vec![light], ..SceneDesc::default() }
    }

    #[test]
    fn lights_have_the_thesis_brightness_at_the_reference_distance() {
        let made = from_thesis(&scene(MaterialDesc::default(), LightKind::Omni { position: Vec3::X }), 2.0);
        assert_eq!(made.validate(), []);
        let EmitterKind::Point { intensity, .. } = made.lights[0].kind else { panic!() };
        // Half the diagonal of a box of 4 x 4 x 4 is the root of 12; a white Lambertian shows I / (pi d^2).
        let shown = intensity / (PI * 12.0) / 2.0;
        assert!((shown - Vec3::new(0.5, 0.25, 0.0)).length() < 1e-5, "{shown}");
    }

    #[test]
    fn area_lights_become_emissive_rectangles() {
        let kind = LightKind::Area {
            center: Vec3::Y,
            normal: Vec3::NEG_Y,
            head: Vec3::X,
            width: 2.0,
            height: 3.0,
            spacing: 1.0,
        };
        let made = from_thesis(&scene(MaterialDesc::default(), kind), 1.0);
        assert_eq!((made.lights.len(), made.objects.len(), made.validate()), (0, 2, vec![]));
        let radiance = made.materials[1].emission.expect("it shines").radiance;
        assert!((radiance.x - PI * 12.0 * 6.0 * 0.5 / 6.0).abs() < 1e-3, "{radiance}");
    }

    #[test]
    fn optical_ratios_become_mixes() {
        let glassy = MaterialDesc {
            specular: Vec3::splat(0.8),
            reflection: 0.25,
            refraction: 0.25,
            refraction_ratio: 0.66,
            local: 0.5,
            ..MaterialDesc::default()
        };
        let made = from_thesis(&scene(glassy, LightKind::Omni { position: Vec3::X }), 1.0);
        assert_eq!(made.validate(), []);
        let Scattering::Mix { first, second, weight, .. } = made.materials[0].scattering else { panic!() };
        assert_eq!(weight, 0.25);
        assert!(matches!(made.materials[second.0 as usize].scattering, Scattering::Dielectric { .. }));
        let Scattering::Mix { first, weight, .. } = made.materials[first.0 as usize].scattering else { panic!() };
        assert!((weight - 1.0 / 3.0).abs() < 1e-6);
        assert!(matches!(made.materials[first.0 as usize].scattering, Scattering::Phong { .. }));
    }

    #[test]
    fn the_view_is_the_same() {
        let made = from_thesis(&scene(MaterialDesc::default(), LightKind::Omni { position: Vec3::X }), 1.0);
        let View::Perspective { degrees } = made.camera.view else { panic!() };
        assert!((degrees - 28.72).abs() < 0.01, "{degrees}");
        assert_eq!(made.camera.position.as_vec3(), Vec3::new(0.0, 0.0, 10.0));
        assert_eq!(made.camera.near, 10.0);
    }
}
