//! Size, samples and filter of a picture.

use lightcuts_scene::SamplerKind;
use serde::{Deserialize, Serialize};

/// Size of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImageSize {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

impl Default for ImageSize {
    fn default() -> Self {
        Self { width: 512, height: 512 }
    }
}

/// Samples per pixel and where they lie.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Sampling {
    /// Pattern of the samples.
    pub sampler: SamplerKind,
    /// Samples of every pixel. In the physical model 0 is no limit, where time or noise is one.
    pub samples: u32,
    /// Samples of pixels that differ from a neighbour; no adaptive anti-aliasing unless above `samples`.
    pub adaptive_samples: u32,
    /// Difference between neighbouring pixels, in any channel, at which they get `adaptive_samples`.
    pub adaptive_threshold: f32,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { sampler: SamplerKind::Stratified, samples: 1, adaptive_samples: 0, adaptive_threshold: 0.05 }
    }
}

/// Reconstruction filter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Filter {
    /// Form of the filter.
    pub kind: FilterKind,
    /// Radius in pixels; box 0.5, triangle 1, Gaussian and Mitchell 2 where absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// Falloff of the Gaussian.
    pub alpha: f32,
    /// Mitchell's B.
    pub mitchell_b: f32,
    /// Mitchell's C.
    pub mitchell_c: f32,
}

impl Default for Filter {
    fn default() -> Self {
        Self { kind: FilterKind::Box, radius: None, alpha: 2.0, mitchell_b: 1.0 / 3.0, mitchell_c: 1.0 / 3.0 }
    }
}

impl Filter {
    /// The radius in pixels, explicit or of its kind.
    pub fn resolved_radius(&self) -> f32 {
        self.radius.unwrap_or(match self.kind {
            FilterKind::Box => 0.5,
            FilterKind::Triangle => 1.0,
            FilterKind::Gaussian | FilterKind::Mitchell => 2.0,
        })
    }
}

/// Forms of pixel filter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FilterKind {
    /// Constant.
    #[default]
    Box,
    /// Linear falloff.
    Triangle,
    /// exp(-alpha x^2), lowered to reach 0 at the radius.
    Gaussian,
    /// Mitchell & Netravali 1988, with negative lobes.
    Mitchell,
}
