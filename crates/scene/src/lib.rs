//! Scene descriptions: named data with units stated and validated, free of any file format.
//!
//! A [`SceneDesc`] is what an importer produces and what `lightcuts-world` prepares for rendering. Lengths are in scene
//! units, angles in degrees, colours are linear RGB factors without a physical unit (the thesis' model of light).

mod camera;
mod defaults;
mod light;
mod material;
mod object;
pub mod physical;
mod smoothing;
mod validate;

pub use camera::{CameraDesc, Projection, SamplerKind};
pub use defaults::{PerDevice, RunDefaults, VplDefaults};
pub use light::{LightDesc, LightKind};
pub use material::{ImageDesc, ImageId, MaterialDesc, MaterialId, TextureDesc, TextureMode};
pub use object::{MeshDesc, MeshId, MeshTriangle, ObjectDesc, ShapeDesc, Transform};
pub use smoothing::smooth_normals;
pub use validate::{Issue, MAX_COORDINATE, MAX_EMITTERS, MAX_LIGHT, Subject};

use glam::Vec3;

/// A whole scene: everything a picture needs apart from how it is to be rendered.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneDesc {
    /// Name shown to people, usually the file's stem.
    pub name: String,
    /// Colour of rays that leave the scene.
    pub background: Vec3,
    /// The view.
    pub camera: CameraDesc,
    /// Lights in file order.
    pub lights: Vec<LightDesc>,
    /// Objects in file order; the order decides which of two equally near hits wins.
    pub objects: Vec<ObjectDesc>,
    /// Materials, addressed by [`MaterialId`].
    pub materials: Vec<MaterialDesc>,
    /// Texture images, addressed by [`ImageId`].
    pub images: Vec<ImageDesc>,
    /// Triangle meshes, addressed by [`MeshId`].
    pub meshes: Vec<MeshDesc>,
    /// Run parameters that the scene's author recommends.
    pub defaults: RunDefaults,
}

/// Where in its source a thing was described, for messages. Lines and columns count from 1; 0 means "not from a text".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Location {
    /// Line in the scene file.
    pub line: u32,
    /// Column (in characters) in that line.
    pub column: u32,
}
