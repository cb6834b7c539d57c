//! Scenes of the physical model made flat.

mod emitter_tree;
mod emitters;
mod environment;
mod faces;
mod images;
mod middle;
mod overlap;
mod scatters;
mod ties;

pub use environment::StoredEnvironment;
pub use faces::Face;
pub use ties::{Tied, Ties};

use crate::bvh::TriangleForm;
use crate::lights::Square as SquareFrame;
use crate::mesh::AffinePlacement;
use crate::shapes::Builder;
use crate::{Defect, MAX_PRIMITIVES, Shapes, WorldError};
use glam::{DAffine3, DVec3, Vec3};
use lightcuts_kernel::emitter::Emitter;
use lightcuts_kernel::emitter_tree::EmitterNode;
use lightcuts_kernel::environment::EnvironmentMap;
use lightcuts_kernel::lens::Lens;
use lightcuts_kernel::mip::MipImage;
use lightcuts_kernel::ray::{NONE, normalize_or_zero};
use lightcuts_kernel::scatter::{Images, Scatter};
use lightcuts_scene::MeshDesc;
use lightcuts_scene::physical::{PhysicalCamera, PhysicalScene, PhysicalShape, SurfaceId, View};

/// Everything that rendering with the physical model reads, as flat slices. Immutable once made.
#[derive(Debug, Clone)]
pub struct PhysicalWorld {
    /// What rays can hit.
    pub shapes: Shapes,
    /// Planes of the triangles, in file order.
    pub faces: Vec<Face>,
    /// Materials.
    pub scatters: Vec<Scatter>,
    /// Of each material: whether an image decides of it, or of an ingredient, so that places on its surfaces matter.
    pub textured: Vec<bool>,
    /// Energy tables of the materials.
    pub tables: Vec<f32>,
    /// Images.
    pub images: Vec<MipImage>,
    /// Pixels of all images.
    pub words: Vec<u32>,
    /// Lights: first those that have a place, then directional light.
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
    /// Surfaces that shine or have holes in one place with others.
    pub ties: Ties,
    /// The place in the scene that is this world's origin: all else is relative to it.
    pub origin: DVec3,
    /// Corners of a box around everything, relative to the origin; both zero where there is nothing.
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
        let origin = middle::middle(scene);
        let mut builder = add_objects(scene, origin);
        if builder.primitives.len() > MAX_PRIMITIVES {
            return Err(WorldError::TooLarge(builder.primitives.len()));
        }
        let (images, words) = images::pack(&scene.images);
        let (scatters, tables) = scatters::flatten(&scene.materials);
        let of_images = Images { images: &images, words: &words };
        faces::begin_at_short_edges(&mut builder);
        let faces = faces::faces(&builder);
        let all = builder.boxes.iter().copied().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let position = (scene.camera.position - origin).as_vec3();
        let extent = all.map_or(0.0, |(lower, upper): (Vec3, Vec3)| (upper - lower).length());
        let outlines = overlap::overlap(&mut builder, extent);
        faces::set_slacks(&mut builder, &faces);
        let lights = emitters::collect(scene, origin, (&builder, &outlines), &scatters);
        let tree = emitter_tree::build(&lights.emitters[..lights.placed], &of_images);
        let mut world = Self {
            faces,
            has_masks: scatters.iter().any(|scatter| scatter.mask_image != NONE),
            shapes: builder.finish(position.abs().max_element(), TriangleForm::Corners),
            textured: (0..scatters.len()).map(|index| scatters::is_textured(&scatters, index)).collect(),
            scatters,
            tables,
            environment: scene.environment.as_ref().and_then(|of| StoredEnvironment::new(of, &scene.images)),
            images,
            words,
            placed_emitters: lights.placed as u32,
            emitters: lights.emitters,
            emitter_nodes: tree.nodes,
            emitter_leaves: tree.leaves,
            primitive_emitters: lights.of_primitives,
            ties: Ties::default(),
            origin,
            bounds: all.unwrap_or_default(),
            camera: scene.camera.clone(),
        };
        world.settle_ties(&outlines);
        debug_assert_eq!(world.validate(), Ok(()));
        Ok(world)
    }

    /// Corners of a box around everything, in the scene's coordinates; both zero where there is nothing.
    pub fn scene_bounds(&self) -> (DVec3, DVec3) {
        let (lower, upper) = self.bounds;
        if self.shapes.primitives.is_empty() {
            return (DVec3::ZERO, DVec3::ZERO);
        }
        (lower.as_dvec3() + self.origin, upper.as_dvec3() + self.origin)
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
        let view = camera.direction.as_dvec3().normalize_or_zero();
        let ahead = if is_orthographic == 1 && camera.lens_radius == 0.0 { self.way_to_scene(view) } else { 0.0 };
        Lens {
            position: (camera.position + view * ahead - self.origin).as_vec3(),
            half_height,
            forward,
            near: (f64::from(camera.near) - ahead).max(0.0) as f32,
            right,
            radius: camera.lens_radius,
            up: right.cross(forward),
            focus: camera.focus_distance,
            is_orthographic,
            width,
            height,
            ahead: ahead as f32,
        }
    }

    /// How far parallel rays can go on from the camera before they come near anything, in scene units; 0 unless that is
    /// so far that hits would be rounded by more than they are within the scene.
    fn way_to_scene(&self, view: DVec3) -> f64 {
        let (lower, upper) = (self.bounds.0.as_dvec3(), self.bounds.1.as_dvec3());
        let (middle, radius) = ((lower + upper) / 2.0, (upper - lower).length() / 2.0);
        let way = (middle - (self.camera.position - self.origin)).dot(view) - 2.0 * radius;
        if way > 16.0 * radius { way } else { 0.0 }
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

fn add_objects(scene: &PhysicalScene, origin: DVec3) -> Builder {
    let mut builder = Builder::default();
    let greatest = |mesh: &MeshDesc| mesh.positions.iter().fold(Vec3::ZERO, |greatest, p| greatest.max(p.abs()));
    let greatest: Vec<f64> = scene.meshes.iter().map(|mesh| f64::from(greatest(mesh).max_element())).collect();
    for object in &scene.objects {
        builder.begin_object();
        let material = object.material.0;
        match object.shape {
            PhysicalShape::Sphere { center, radius } => {
                builder.add_sphere((center - origin).as_vec3(), radius, material);
            }
            PhysicalShape::Rectangle { center, normal, head, width, height } => {
                let center = (center - origin).as_vec3();
                builder.add_square(&SquareFrame::new(center, normal, head, width, height), material);
            }
            PhysicalShape::Mesh { mesh, placement, smooth, override_material } => {
                let of_face = |own: Option<SurfaceId>| own.filter(|_| !override_material).map_or(material, |own| own.0);
                // Errors of all coordinates may add up along an axis.
                let rows = placement.matrix3.transpose();
                let growth = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.abs().element_sum());
                let given = greatest[mesh.0 as usize] * growth.into_iter().fold(0.0, f64::max);
                builder.given.push((builder.corners.len(), given));
                let placement = AffinePlacement::new(DAffine3::from_translation(-origin) * placement);
                builder.add_mesh(&scene.meshes[mesh.0 as usize], &placement, smooth, of_face);
            }
        }
    }
    builder
}

#[cfg(test)]
mod tests;
