use glam::Vec3;
use serde::{Deserialize, Serialize};

/// The view: a plane through `center`, seen along `view`.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraDesc {
    /// How samples are spread over a pixel, as the scene asks for it.
    pub sampler: SamplerKind,
    /// Perspective or parallel rays.
    pub projection: Projection,
    /// Centre of the view plane, in scene units.
    pub center: Vec3,
    /// View direction, any length but zero.
    pub view: Vec3,
    /// Up direction, any length but zero, not parallel to `view`.
    pub up: Vec3,
}

impl Default for CameraDesc {
    /// At the origin, looking along -z.
    fn default() -> Self {
        Self {
            sampler: SamplerKind::default(),
            projection: Projection::Perspective { distance: 10.0 },
            center: Vec3::ZERO,
            view: Vec3::NEG_Z,
            up: Vec3::Y,
        }
    }
}

/// How rays leave the view plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// All rays come from an eye `distance` units behind the view plane.
    Perspective {
        /// Distance from the eye to the view plane, in scene units, above zero.
        distance: f32,
    },
    /// All rays are parallel to the view direction.
    Orthographic,
}

/// How samples are spread over a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SamplerKind {
    /// One random point per cell of a regular grid.
    #[default]
    Stratified,
    /// Owen-scrambled Sobol' points.
    LowDiscrepancy,
    /// Mitchell's best-candidate points (1991): blue noise.
    BestCandidate,
}
