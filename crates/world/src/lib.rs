//! Scene descriptions made into flat, immutable worlds: triangles, bounding volume hierarchy, materials, texels, emitters.
//!
//! [`World::new`] is the one door: it checks the description, so that rendering cannot fail on content.

mod binary_tree;
pub mod bvh;
mod collapse;
mod compressed;
mod lights;
mod mesh;
mod pages;
pub mod physical;
mod shapes;
mod thesis;
mod validate;
mod widen;

pub use compressed::CompressedHierarchy;
pub use pages::Pages;
pub use physical::PhysicalWorld;
pub use shapes::Shapes;
pub use validate::Defect;

use bvh::TriangleForm;
use glam::Vec3;
use lightcuts_kernel::camera::{Camera, PIXEL_PITCH, THESIS_SIZE};
use lightcuts_kernel::light::Light;
use lightcuts_kernel::material::Material;
use lightcuts_kernel::ray::{NONE, normalize_or_zero};
use lightcuts_kernel::texture::{REPEAT, STRAIGHT, STRETCH, Texture};
use lightcuts_scene::{Issue, MaterialDesc, Projection, SceneDesc, TextureMode};

/// Largest number of primitives: what a child reference of the hierarchy can number.
pub const MAX_PRIMITIVES: usize = 1 << 28;

/// Everything that rendering reads, as flat slices. Immutable once made.
#[derive(Debug, Clone)]
pub struct World {
    /// What rays can hit.
    pub shapes: Shapes,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Texels of all textures.
    pub texels: Vec<[u8; 4]>,
    /// The scene's lights, area lights already cut into points.
    pub lights: Vec<Light>,
    /// Bounding spheres of the objects in file order (for photon targets).
    pub object_bounds: Vec<ObjectBounds>,
    /// Colour of rays that leave the scene.
    pub background: Vec3,
    view: View,
}

/// A sphere around an object, with its optical ratios.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectBounds {
    /// Centre in scene units.
    pub center: Vec3,
    /// Radius in scene units.
    pub radius: f32,
    /// Greatest F of its materials.
    pub reflection: f32,
    /// Greatest R of its materials.
    pub refraction: f32,
}

/// The view without a picture size.
#[derive(Debug, Clone, Copy)]
struct View {
    center: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    eye_distance: f32,
}

/// Why a scene cannot be made into a world.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WorldError {
    /// The description breaks a rule; the first of the issues.
    #[error("the scene cannot be rendered: {0}")]
    Scene(Issue),
    /// More surfaces than the hierarchy can number.
    #[error("the scene has {0} primitives; at most {MAX_PRIMITIVES} are possible")]
    TooLarge(usize),
}

impl World {
    /// Prepares a scene for rendering.
    pub fn new(scene: &SceneDesc) -> Result<Self, WorldError> {
        if let Some(issue) = scene.validate().into_iter().next() {
            return Err(WorldError::Scene(issue));
        }
        let (textures, texels) = pack_textures(scene);
        let (builder, materials) = thesis::build(scene);
        if builder.primitives.len() > MAX_PRIMITIVES {
            return Err(WorldError::TooLarge(builder.primitives.len()));
        }
        let object_bounds = thesis::object_bounds(&builder, &materials);
        let world = Self {
            shapes: builder.finish(scene.camera.center.abs().max_element(), TriangleForm::Edges),
            object_bounds,
            materials,
            textures,
            texels,
            lights: lights::flatten(scene),
            background: scene.background,
            view: view(scene),
        };
        debug_assert_eq!(world.validate(), Ok(()));
        Ok(world)
    }

    /// The camera for a picture of `width` x `height` pixels. The height always spans the thesis' 5.12 units of the view
    /// plane; a wider picture sees more at the sides.
    pub fn camera(&self, width: u32, height: u32) -> Camera {
        let View { center, forward: view, right, up, eye_distance } = self.view;
        let pitch = PIXEL_PITCH * (THESIS_SIZE as f32 / height as f32);
        Camera { center, pitch, view, eye_distance, right, width, up, height }
    }
}

fn view(scene: &SceneDesc) -> View {
    let camera = &scene.camera;
    let forward = normalize_or_zero(camera.view);
    let right = normalize_or_zero(forward.cross(camera.up));
    let eye_distance = match camera.projection {
        Projection::Perspective { distance } => distance,
        Projection::Orthographic => 0.0,
    };
    View { center: camera.center, forward, right, up: right.cross(forward), eye_distance }
}

fn pack_textures(scene: &SceneDesc) -> (Vec<Texture>, Vec<[u8; 4]>) {
    let mut texels = Vec::new();
    let mut textures = Vec::new();
    for image in &scene.images {
        textures.push(Texture { first: texels.len() as u32, width: image.width, height: image.height, padding: 0 });
        texels.extend(image.texels.iter().map(|&[r, g, b]| [r, g, b, 255]));
    }
    (textures, texels)
}

fn flat_material(desc: &MaterialDesc) -> Material {
    let mode = |mode: TextureMode| match mode {
        TextureMode::Stretch => STRETCH,
        TextureMode::Repeat => REPEAT,
        TextureMode::Straight => STRAIGHT,
    };
    Material {
        specular: desc.specular,
        exponent: desc.exponent,
        diffuse: desc.diffuse,
        reflection: desc.reflection,
        ambient: desc.ambient,
        refraction: desc.refraction,
        glow: Vec3::ZERO,
        refraction_ratio: desc.refraction_ratio,
        local: desc.local,
        texture: desc.texture.map_or(NONE, |t| t.image.0),
        texture_mode: desc.texture.map_or(STRETCH, |t| mode(t.mode)),
        padding: 0,
    }
}
