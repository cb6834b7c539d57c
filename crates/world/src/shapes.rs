//! Objects made into primitives, in file order.

use crate::lights::Square as SquareFrame;
use crate::mesh::{Placement, place_triangle};
use crate::{ObjectBounds, flat_material};
use glam::Vec3;
use lightcuts_kernel::intersect::{SPHERE, SQUARE, Sphere, Square, TRIANGLE};
use lightcuts_kernel::material::Material;
use lightcuts_kernel::surface::{Primitive, TriangleCorners};
use lightcuts_scene::{LightKind, MaterialDesc, ObjectDesc, SceneDesc, ShapeDesc};

/// Collects primitives. `boxes` holds the bounds of each.
pub(crate) struct Builder<'a> {
    scene: &'a SceneDesc,
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) boxes: Vec<(Vec3, Vec3)>,
    pub(crate) corners: Vec<TriangleCorners>,
    /// Corner points of the triangles, in file order.
    pub(crate) points: Vec<[Vec3; 3]>,
    pub(crate) spheres: Vec<Sphere>,
    pub(crate) squares: Vec<Square>,
    pub(crate) materials: Vec<Material>,
    objects: u32,
}

impl<'a> Builder<'a> {
    pub(crate) fn new(scene: &'a SceneDesc) -> Self {
        Self {
            scene,
            primitives: Vec::new(),
            boxes: Vec::new(),
            corners: Vec::new(),
            points: Vec::new(),
            spheres: Vec::new(),
            squares: Vec::new(),
            materials: scene.materials.iter().map(flat_material).collect(),
            objects: 0,
        }
    }

    pub(crate) fn add_objects(&mut self) {
        for object in &self.scene.objects {
            self.objects += 1;
            self.add_shape(object);
        }
    }

    /// The visible squares of area lights: they glow in the light's diffuse colour and neither reflect nor are lit.
    pub(crate) fn add_area_lights(&mut self) {
        for light in &self.scene.lights {
            if let LightKind::Area { center, normal, head, width, height, .. } = light.kind {
                self.objects += 1;
                let dark = MaterialDesc { diffuse: Vec3::ZERO, local: 0.0, ..MaterialDesc::default() };
                let glow = (light.diffuse * light.attenuation).min(Vec3::ONE);
                self.materials.push(Material { glow, ..flat_material(&dark) });
                let material = self.materials.len() as u32 - 1;
                self.add_square(&SquareFrame::new(center, normal, head, width, height), material);
            }
        }
    }

    fn add_shape(&mut self, object: &ObjectDesc) {
        let material = object.material.0;
        match object.shape {
            ShapeDesc::Sphere { center, radius } => {
                let primitive = self.push(SPHERE, self.spheres.len(), material, (center - radius, center + radius));
                self.spheres.push(Sphere { center, radius, primitive, padding: [0; 3] });
            }
            ShapeDesc::Square { center, normal, head, width, height } => {
                self.add_square(&SquareFrame::new(center, normal, head, width, height), material);
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
                        self.add_square(&SquareFrame::new(middle, normal, head, across_extent, head_extent), material);
                    }
                }
            }
            ShapeDesc::Mesh { mesh, transform, smooth, override_material } => {
                let mesh = &self.scene.meshes[mesh.0 as usize];
                let placement = Placement::new(&transform);
                for triangle in &mesh.triangles {
                    let own = triangle.material.filter(|_| !override_material).map_or(material, |m| m.0);
                    let (points, corners) = place_triangle(mesh, triangle, &placement, smooth);
                    let [a, b, c] = points;
                    self.push(TRIANGLE, self.corners.len(), own, (a.min(b).min(c), a.max(b).max(c)));
                    self.corners.push(corners);
                    self.points.push(points);
                }
            }
        }
    }

    fn add_square(&mut self, frame: &SquareFrame, material: u32) {
        let (half_width, half_height) = (frame.width / 2.0, frame.height / 2.0);
        let reach = (frame.across * half_width).abs() + (frame.along * half_height).abs();
        let primitive = self.push(SQUARE, self.squares.len(), material, (frame.center - reach, frame.center + reach));
        self.squares.push(Square {
            center: frame.center,
            half_height,
            normal: frame.normal,
            half_width,
            along: frame.along,
            primitive,
            across: frame.across,
            padding: 0,
        });
    }

    fn push(&mut self, kind: u32, index: usize, material: u32, bounds: (Vec3, Vec3)) -> u32 {
        self.primitives.push(Primitive { kind, index: index as u32, object: self.objects, material });
        self.boxes.push(bounds);
        self.primitives.len() as u32 - 1
    }

    /// A sphere around each object's box; area lights' squares count as objects.
    pub(crate) fn object_bounds(&self) -> Vec<ObjectBounds> {
        let mut boxes = vec![(Vec3::INFINITY, Vec3::NEG_INFINITY); self.objects as usize];
        let mut optics = vec![(0.0_f32, 0.0_f32); self.objects as usize];
        for (primitive, bounds) in self.primitives.iter().zip(&self.boxes) {
            let object = primitive.object as usize - 1;
            boxes[object] = (boxes[object].0.min(bounds.0), boxes[object].1.max(bounds.1));
            let material = &self.materials[primitive.material as usize];
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
        for sphere in &self.spheres {
            // A sphere's own radius is tighter than its box's.
            bounds[self.primitives[sphere.primitive as usize].object as usize - 1].radius = sphere.radius;
        }
        bounds
    }
}
