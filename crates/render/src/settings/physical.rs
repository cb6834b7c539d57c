//! Parameters of the physical model.

use serde::{Deserialize, Serialize};

/// How the physical model is rendered, besides the number of samples (one per pass) and the strategy of gathering.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Physical {
    /// Light transport algorithm.
    pub integrator: Integrator,
    /// Seconds that rendering may take, first pass and all; 0 for no limit. A picture is whole whatever the limit:
    /// pixels that get no sample in time show the nearest one that has.
    pub time_limit: f32,
    /// Estimated relative RMS error of the pixels below which no more samples are taken; 0 for none.
    pub noise: f32,
    /// Approximate number of VPLs per pass.
    pub vpls: u32,
    /// Error bound of a cluster, relative to the pixel's light, up to which its representative stands for it.
    pub cut_error: f32,
    /// Maximum number of clusters in a cut.
    pub max_cut: u32,
    /// Distance below which the light of a VPL is clamped, relative to the scene's diagonal.
    pub clamp: f32,
    /// Whether short paths compensate for the energy that the clamp removes; without it the picture is biased: dark
    /// corners.
    pub compensation: bool,
    /// Whether VPLs are kept in proportion to what they contribute to the picture.
    pub rejection: bool,
    /// Factor on the lights of a thesis scene, which have no falloff and get intensities from the scene's size.
    pub light_scale: f32,
}

impl Default for Physical {
    fn default() -> Self {
        Self {
            integrator: Integrator::Lightcuts,
            time_limit: 0.0,
            noise: 0.0,
            vpls: 2000,
            cut_error: 0.3,
            max_cut: 1000,
            clamp: 0.03,
            compensation: true,
            rejection: true,
            light_scale: 1.0,
        }
    }
}

/// Light transport algorithms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Indirect light from VPLs, new ones in each pass.
    Lightcuts,
    /// Path tracing: the reference.
    Path,
    /// In each tile, the one of both that measurements favour.
    Auto,
}
