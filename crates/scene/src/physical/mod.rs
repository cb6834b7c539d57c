//! Scenes of the physical model: radiometric units, materials and lights that keep energy.
//!
//! Lengths are in scene units. Of a point light the radiant intensity is given (power per solid angle, W/sr), of
//! directional light the irradiance across it (W per square unit), of surfaces and the environment the radiance (W per
//! square unit and steradian); each as linear RGB with the primaries of Rec. 709.

mod camera;
mod light;
mod material;
mod object;
mod thesis;
mod validate;

pub use camera::{PhysicalCamera, View};
pub use light::{EmitterDesc, EmitterKind, EnvironmentDesc};
pub use material::{AlphaMask, EmissionDesc, ImageId, PixelImage, Pixels, Scattering, SurfaceDesc, SurfaceId, Tint};
pub use object::{PhysicalObject, PhysicalShape};
pub use thesis::from_thesis;
pub use validate::MAX_MIX_DEPTH;

use crate::MeshDesc;

/// A whole scene of the physical model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PhysicalScene {
    /// Name shown to people, usually the file's stem.
    pub name: String,
    /// The view.
    pub camera: PhysicalCamera,
    /// Lights that are not surfaces, in file order.
    pub lights: Vec<EmitterDesc>,
    /// Light from infinitely far away.
    pub environment: Option<EnvironmentDesc>,
    /// Objects in file order; the order decides which of two equally near hits wins.
    pub objects: Vec<PhysicalObject>,
    /// Surfaces, addressed by [`SurfaceId`]; the faces of meshes name them too.
    pub materials: Vec<SurfaceDesc>,
    /// Images, addressed by [`ImageId`].
    pub images: Vec<PixelImage>,
    /// Triangle meshes, addressed by [`crate::MeshId`].
    pub meshes: Vec<MeshDesc>,
}
