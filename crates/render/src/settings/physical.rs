//! Parameters of the physical model.

use serde::{Deserialize, Serialize};

/// How the physical model is rendered, besides the number of samples (one per pass) and the strategy of gathering.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Physical {
    /// How light is found.
    pub integrator: Integrator,
    /// Seconds that rendering may take, first pass and all; 0 for no limit. A picture is whole whatever the limit: pixels that get
    /// no sample in time show the nearest one that has.
    pub time_limit: f32,
    /// Relative error of the pixels, as a root mean square, at which no more samples are taken; 0 for none.
    pub noise: f32,
    /// VPLs of each pass, about.
    pub vpls: u32,
    /// Error of a cluster, relative to the light of all, up to which its representative stands for it.
    pub cut_error: f32,
    /// Clusters of a cut, at most.
    pub max_cut: u32,
    /// Distance below which a VPL's light no longer grows, relative to the scene's diagonal.
    pub clamp: f32,
    /// Whether what the clamp takes is given back by short rays; without it corners stay too dark for ever.
    pub compensation: bool,
    /// Whether VPLs are kept by how much they bring to what the camera sees.
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

/// Ways to find light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Indirect light from VPLs, fresh ones in each pass.
    Lightcuts,
    /// Path tracing: the reference.
    Path,
    /// Each tile the one of both that measurement favours there.
    Auto,
}
