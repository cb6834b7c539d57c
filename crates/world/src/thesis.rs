//! Objects and area lights of a thesis scene made into primitives, in file order.

use crate::lights::Square as SquareFrame;
use crate::mesh::Placement;
use crate::shapes::Builder;
use crate::{ObjectBounds, flat_material};
use glam::Vec3;
use lightcuts_kernel::material::Material;
use lightcuts_scene::{LightKind, MaterialDesc, ObjectDesc, SceneDesc, ShapeDesc};

/// All primitives, and the materials that they name.
pub(crate) fn build(scene: &SceneDesc) -> (Builder, Vec<Material>) {
    let mut builder = Builder::default();
    let mut materials: Vec<Material> = scene.materials.iter().map(flat_material).collect();
    for object in &scene.objects {
        builder.begin_object();
        add_shape(&mut builder, scene, object);
    }
    add_area_lights(&mut builder, scene, &mut materials);
    (builder, materials)
}

/// The visible squares of area lights: they glow in the light's diffuse colour and neither reflect nor are lit.
fn add_area_lights(builder: &mut Builder, scene: &SceneDesc, materials: &mut Vec<Material>) {
    for light in &scene.lights {
        if let LightKind::Area { center, normal, head, width, height, .. } = light.kind {
            builder.begin_object();
            let dark = MaterialDesc { diffuse: Vec3::ZERO, local: 0.0, ..MaterialDesc::default() };
            let glow = (light.diffuse * light.attenuation).min(Vec3::ONE);
            materials.push(Material { glow, ..flat_material(&dark) });
            let material = materials.len() as u32 - 1;
            builder.add_square(&SquareFrame::new(center, normal, head, width, height), material);
        }
    }
}

fn add_shape(builder: &mut Builder, scene: &SceneDesc, object: &ObjectDesc) {
    let material = object.material.0;
    match object.shape {
        ShapeDesc::Sphere { center, radius } => builder.add_sphere(center, radius, material),
        ShapeDesc::Square { center, normal, head, width, height } => {
            builder.add_square(&SquareFrame::new(center, normal, head, width, height), material);
        }
        ShapeDesc::Cube { center, vertical, horizontal, length, width, height } => {
            let up = vertical.normalize();
            let right = (horizontal - up * horizontal.dot(up)).normalize();
            let front = right.cross(up);
            // Each face: direction outwards and its extent, head and its extent, extent of the remaining axis.
            let axes = [
                (right, length, up, height, width),
                (front, width, up, height, length),
                (up, height, right, length, width),
            ];
            for (outwards, extent, head, head_extent, across_extent) in axes {
                for normal in [outwards, -outwards] {
                    let middle = center + normal * (extent / 2.0);
                    builder.add_square(&SquareFrame::new(middle, normal, head, across_extent, head_extent), material);
                }
            }
        }
        ShapeDesc::Mesh { mesh, transform, smooth, override_material } => {
            let of_face = |own: Option<lightcuts_scene::MaterialId>| {
                own.filter(|_| !override_material).map_or(material, |own| own.0)
            };
            builder.add_mesh(&scene.meshes[mesh.0 as usize], &Placement::new(&transform), smooth, of_face);
        }
    }
}

/// A sphere around each object's box; area lights' squares count as objects.
pub(crate) fn object_bounds(builder: &Builder, materials: &[Material]) -> Vec<ObjectBounds> {
    let mut boxes = vec![(Vec3::INFINITY, Vec3::NEG_INFINITY); builder.objects as usize];
    let mut optics = vec![(0.0_f32, 0.0_f32); builder.objects as usize];
    for (primitive, bounds) in builder.primitives.iter().zip(&builder.boxes) {
        let object = primitive.object as usize - 1;
        boxes[object] = (boxes[object].0.min(bounds.0), boxes[object].1.max(bounds.1));
        let material = &materials[primitive.material as usize];
        optics[object].0 = optics[object].0.max(material.reflection);
        optics[object].1 = optics[object].1.max(material.refraction);
    }
    let around = |((lower, upper), (reflection, refraction)): ((Vec3, Vec3), (f32, f32))| {
        let empty = lower.x > upper.x;
        let center = if empty { Vec3::ZERO } else { (lower + upper) / 2.0 };
        let radius = if empty { 0.0 } else { (upper - center).length() };
        ObjectBounds { center, radius, reflection, refraction }
    };
    let mut bounds: Vec<ObjectBounds> = boxes.into_iter().zip(optics).map(around).collect();
    for sphere in &builder.spheres {
        // A sphere's own radius is tighter than its box's.
        bounds[builder.primitives[sphere.primitive as usize].object as usize - 1].radius = sphere.radius;
    }
    bounds
}
