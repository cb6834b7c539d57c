//! Scenes of the physical model made flat.

mod emitter_tree;
mod emitters;
mod environment;
mod images;
mod scatters;

pub use environment::StoredEnvironment;

use crate::lights::Square as SquareFrame;
use crate::mesh::AffinePlacement;
use crate::shapes::Builder;
use crate::{Defect, MAX_PRIMITIVES, Shapes, WorldError};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lightcuts_kernel::emitter::Emitter;
use lightcuts_kernel::emitter_tree::EmitterNode;
use lightcuts_kernel::environment::EnvironmentMap;
use lightcuts_kernel::lens::Lens;
use lightcuts_kernel::mip::MipImage;
use lightcuts_kernel::ray::{NONE, normalize_or_zero};
use lightcuts_kernel::scatter::{Images, Scatter};
use lightcuts_scene::physical::{PhysicalCamera, PhysicalScene, PhysicalShape, SurfaceId, View};

/// A triangle's plane. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Face {
    /// Unit normal about which the corners run counterclockwise; zero where the triangle has no area.
    pub normal: Vec3,
    /// Texture coordinates per scene unit: the root of the ratio of both areas.
    pub texture_density: f32,
    /// Unit direction in which u grows; zero where the triangle has no area in the texture.
    pub tangent: Vec3,
    /// Unused.
    pub padding: f32,
}

/// Everything that rendering with the physical model reads, as flat slices. Immutable once made.
#[derive(Debug, Clone)]
pub struct PhysicalWorld {
    /// What rays can hit.
    pub shapes: Shapes,
    /// Planes of the triangles, in file order.
    pub faces: Vec<Face>,
    /// Materials.
    pub scatters: Vec<Scatter>,
    /// Energy tables of the materials.
    pub tables: Vec<f32>,
    /// Images.
    pub images: Vec<MipImage>,
    /// Pixels of all images.
    pub words: Vec<u32>,
    /// Lights: first those that have a place, then parallel light.
    pub emitters: Vec<Emitter>,
    /// Number of those that have a place.
    pub placed_emitters: u32,
    /// Tree over those that have a place; the first node is the root.
    pub emitter_nodes: Vec<EmitterNode>,
    /// Leaf of each light that has a place.
    pub emitter_leaves: Vec<u32>,
    /// Light of each primitive, or [`NONE`].
    pub primitive_emitters: Vec<u32>,
    /// Light from infinitely far away.
    pub environment: Option<StoredEnvironment>,
    /// Corners of a box around everything; both zero where there is nothing.
    pub bounds: (Vec3, Vec3),
    /// Whether any material is there in parts only.
    pub has_masks: bool,
    camera: PhysicalCamera,
}

impl PhysicalWorld {
    /// Prepares a scene for rendering.
    pub fn new(scene: &PhysicalScene) -> Result<Self, WorldError> {
        if let Some(issue) = scene.validate().into_iter().next() {
            return Err(WorldError::Scene(issue));
        }
        let builder = add_objects(scene);
        if builder.primitives.len() > MAX_PRIMITIVES {
            return Err(WorldError::TooLarge(builder.primitives.len()));
        }
        let (images, words) = images::pack(&scene.images);
        let (scatters, tables) = scatters::flatten(&scene.materials);
        let of_images = Images { images: &images, words: &words };
        let lights = emitters::collect(scene, &builder, &scatters);
        let tree = emitter_tree::build(&lights.emitters[..lights.placed], &of_images);
        let all = builder.boxes.iter().copied().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let reach = scene.camera.position.abs().max_element();
        let faces = faces(&builder);
        let world = Self {
            faces,
            has_masks: scatters.iter().any(|scatter| scatter.mask_image != NONE),
            shapes: builder.finish(reach),
            scatters,
            tables,
            environment: scene.environment.as_ref().map(|of| StoredEnvironment::new(of, &scene.images)),
            images,
            words,
            placed_emitters: lights.placed as u32,
            emitters: lights.emitters,
            emitter_nodes: tree.nodes,
            emitter_leaves: tree.leaves,
            primitive_emitters: lights.of_primitives,
            bounds: all.unwrap_or_default(),
            camera: scene.camera.clone(),
        };
        debug_assert_eq!(world.validate(), Ok(()));
        Ok(world)
    }

    /// All images.
    pub fn all_images(&self) -> Images<'_> {
        Images { images: &self.images, words: &self.words }
    }

    /// The environment with its image.
    pub fn environment_map(&self) -> Option<EnvironmentMap<'_>> {
        self.environment.as_ref().map(StoredEnvironment::map)
    }

    /// The camera for a picture of `width` x `height` pixels.
    pub fn lens(&self, width: u32, height: u32) -> Lens {
        let camera = &self.camera;
        let forward = normalize_or_zero(camera.direction);
        let right = normalize_or_zero(forward.cross(camera.up));
        let (half_height, is_orthographic) = match camera.view {
            View::Perspective { degrees } => ((degrees.to_radians() / 2.0).tan(), 0),
            View::Orthographic { height } => (height / 2.0, 1),
        };
        Lens {
            position: camera.position,
            half_height,
            forward,
            near: camera.near,
            right,
            radius: camera.lens_radius,
            up: right.cross(forward),
            focus: camera.focus_distance,
            is_orthographic,
            width,
            height,
            padding: 0,
        }
    }

    /// Checks that every number points at something, and the hierarchy.
    pub fn validate(&self) -> Result<(), Defect> {
        let image = |index: u32| index == NONE || (index as usize) < self.images.len();
        let scatters = self.scatters.iter().all(|s| {
            let images =
                [s.color_image, s.specular_image, s.radiance_image, s.normal_image, s.mask_image, s.weight_image];
            images.into_iter().all(image)
                && (s.first.max(s.second) as usize) < self.scatters.len()
                && (s.table as usize) < self.tables.len()
        });
        let emitters = self.emitters.iter().all(|e| image(e.image))
            && self.primitive_emitters.iter().all(|&e| e == NONE || (e as usize) < self.emitters.len())
            && self.emitter_leaves.iter().all(|&leaf| (leaf as usize) < self.emitter_nodes.len());
        if !scatters || !emitters || self.faces.len() != self.shapes.corners.len() {
            return Err(Defect::DanglingNumber);
        }
        self.shapes.validate(self.scatters.len())
    }
}

fn add_objects(scene: &PhysicalScene) -> Builder {
    let mut builder = Builder::default();
    for object in &scene.objects {
        builder.begin_object();
        let material = object.material.0;
        match object.shape {
            PhysicalShape::Sphere { center, radius } => builder.add_sphere(center, radius, material),
            PhysicalShape::Rectangle { center, normal, head, width, height } => {
                builder.add_square(&SquareFrame::new(center, normal, head, width, height), material);
            }
            PhysicalShape::Mesh { mesh, placement, smooth, override_material } => {
                let of_face = |own: Option<SurfaceId>| own.filter(|_| !override_material).map_or(material, |own| own.0);
                let placement = AffinePlacement::new(placement);
                builder.add_mesh(&scene.meshes[mesh.0 as usize], &placement, smooth, of_face);
            }
        }
    }
    builder
}

fn faces(builder: &Builder) -> Vec<Face> {
    let of = |(points, corners): (&[Vec3; 3], &lightcuts_kernel::surface::TriangleCorners)| {
        let cross = (points[1] - points[0]).cross(points[2] - points[0]);
        let [a, b, c] = corners.texture_coordinates;
        let in_texture = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        let area = cross.length().max(f32::MIN_POSITIVE);
        // Corner normals stay on their side where a placement mirrors; the plane's goes with them.
        let normal = normalize_or_zero(cross);
        let mean = corners.normals[0] + corners.normals[1] + corners.normals[2];
        let normal = if normal.dot(mean) < 0.0 { -normal } else { normal };
        let along_u = (points[1] - points[0]) * (c[1] - a[1]) - (points[2] - points[0]) * (b[1] - a[1]);
        let tangent = normalize_or_zero(along_u * in_texture.signum());
        Face { normal, texture_density: (in_texture.abs() / area).sqrt(), tangent, padding: 0.0 }
    };
    builder.points.iter().zip(&builder.corners).map(of).collect()
}

#[cfg(test)]
mod tests;
