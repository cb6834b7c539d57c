//! Ambient occlusion, caustics and bloom of the thesis' model.

use serde::{Deserialize, Serialize};

/// Ambient occlusion of the first pass. The original's angular grid decides only the number of rays; they are
/// distributed in proportion to the cosine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct AmbientOcclusion {
    /// Whether it is computed.
    pub enabled: bool,
    /// Half angle of the cone of directions about the normal, in degrees.
    pub angle: f32,
    /// Step of the grid in degrees: (2 angle / step + 1)^2 rays per hit.
    pub step: f32,
    /// Distance beyond which surfaces do not occlude, in scene units.
    pub range: f32,
    /// Factor on the result.
    pub factor: f32,
}

impl Default for AmbientOcclusion {
    fn default() -> Self {
        Self { enabled: false, angle: 50.0, step: 4.0, range: 90.0, factor: 1.0 }
    }
}

impl AmbientOcclusion {
    /// Number of rays per hit.
    pub fn rays(&self) -> u32 {
        let per_side = (2.0 * self.angle / self.step) as u32 + 1;
        per_side * per_side
    }
}

/// Photon-mapped caustics of the second pass. In the physical model `enabled` alone matters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Caustics {
    /// Whether photons are shot.
    pub enabled: bool,
    /// Spacing of the photons on the disk across the bounding sphere of an object they are shot at, in scene units; wider
    /// where all lights and objects together would take more than 2^26 photons.
    pub step: f32,
    /// Radius of the gathered disk, in scene units.
    pub radius: f32,
    /// Minimum number of photons in the disk; fewer are ignored.
    pub min_photons: u32,
    /// Minimum F of a target.
    pub min_reflection: f32,
    /// Minimum R of a target.
    pub min_refraction: f32,
    /// Minimum r + g + b of a diffuse colour on which photons are stored.
    pub min_diffuse: f32,
}

impl Default for Caustics {
    fn default() -> Self {
        Self {
            enabled: false,
            step: 1.0,
            radius: 4.0,
            min_photons: 10,
            min_reflection: 0.2,
            min_refraction: 0.1,
            min_diffuse: 0.9,
        }
    }
}

/// Glow around bright areas of the finished picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Bloom {
    /// Whether it is applied.
    pub enabled: bool,
    /// Radius in pixels.
    pub radius: f32,
    /// Weight of the blurred picture, 0..1.
    pub weight: f32,
}

impl Default for Bloom {
    fn default() -> Self {
        Self { enabled: false, radius: 12.0, weight: 0.7 }
    }
}
