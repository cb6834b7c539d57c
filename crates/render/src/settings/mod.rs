//! How a scene is rendered: plain parameter structs with the original program's defaults.
//!
//! The same structs are the TOML job file's tables; unknown keys are errors.

mod display;
mod effects;
mod physical;
mod picture;
mod scope;
mod tables;
mod validate;

pub use display::{Display, ToneMappingKind};
pub use effects::{AmbientOcclusion, Bloom, Caustics};
pub use physical::{Integrator, Physical};
pub use picture::{Filter, FilterKind, ImageSize, Sampling};
pub use scope::{Scope, keys_of, value_in};
pub use tables::{TomlFault, overlay, value_at};
pub use validate::SettingsError;

use lightcuts_image::Transfer;
use lightcuts_scene::SceneDesc;
use serde::{Deserialize, Serialize};

/// A whole job apart from the scene: what [`crate::render`] needs to make a picture again.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Settings {
    /// Model of light and whole-run switches.
    pub run: Run,
    /// Size of the picture.
    pub image: ImageSize,
    /// Samples per pixel and where they lie.
    pub sampling: Sampling,
    /// Reconstruction filter.
    pub filter: Filter,
    /// How VPLs are placed.
    pub vpl: VplPlacement,
    /// Which VPLs light a point.
    pub gather: Gather,
    /// Ambient occlusion of the first pass.
    pub ambient_occlusion: AmbientOcclusion,
    /// Photon-mapped caustics.
    pub caustics: Caustics,
    /// Glow around bright places.
    pub bloom: Bloom,
    /// From linear light to displayed values.
    pub display: Display,
    /// Used only with `run.model = "physical"`, which ignores VPL placement and most effects ([`Scope`] has the list).
    pub physical: Physical,
}

/// Model of light and whole-run switches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Run {
    /// Model of light.
    pub model: Model,
    /// Exactly the original's random numbers, arithmetic and defects (thesis model only).
    pub reproduce: bool,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Maximum ray depth: mirrored and refracted rays, the camera ray included (thesis: 4).
    pub max_depth: u32,
}

impl Default for Run {
    fn default() -> Self {
        Self { model: Model::Thesis, reproduce: false, seed: 1, max_depth: 4 }
    }
}

/// Models of light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The thesis' Phong model without falloff, clamped at every step.
    #[default]
    Thesis,
    /// Radiometric: converges to the rendering equation.
    Physical,
}

/// How VPLs are placed: at hits of the first pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct VplPlacement {
    /// Nominal probability p that a hit becomes a VPL, for a picture of 512 x 512 pixels of one sample. The effective
    /// one is (floor(p 10^6) + 1) / 32768, about 30.5 times as much, as in the original; shared out over the camera
    /// rays and at most 1, so that pictures of one shape place as many VPLs at any size and number of samples.
    pub probability: f32,
    /// Minimum r + g + b of a hit's colour for it to become a VPL.
    pub min_illumination: f32,
    /// Factor on every VPL's light.
    pub attenuation: f32,
    /// Whether the second pass is made at all; VPLs are placed all the same, to be looked at or written.
    pub enabled: bool,
}

impl Default for VplPlacement {
    /// The thesis' values for its Simple scene.
    fn default() -> Self {
        Self { probability: 0.0001, min_illumination: 0.7, attenuation: 0.075, enabled: true }
    }
}

/// Which VPLs light a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Gather {
    /// How they are chosen.
    pub strategy: Strategy,
    /// Minimum relevance (intensity x cosine / squared distance) of a chosen VPL; not for `all`.
    pub threshold: f32,
}

impl Default for Gather {
    fn default() -> Self {
        Self { strategy: Strategy::Lightcuts, threshold: 1e-6 }
    }
}

/// Strategies of choosing VPLs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// Every VPL.
    All,
    /// The thesis' lightcuts: every VPL whose relevance reaches the threshold, found through a bounded tree. In the
    /// physical model those of 2005: clusters by error bound.
    Lightcuts,
    /// The same VPLs as `lightcuts`, found by testing every one: the plain version, for comparison. Thesis' model only.
    LightcutsExhaustive,
    /// A few, sampled down the tree by importance (after Yuksel 2019). Physical model only.
    Stochastic,
    /// In each tile, the one of the other strategies that measurements favour. Physical model only.
    Auto,
}

impl Settings {
    /// The built-in defaults with what a scene recommends (for the CPU, where devices differ).
    pub fn for_scene(scene: &SceneDesc) -> Self {
        let mut settings = Self::default();
        settings.sampling.sampler = scene.camera.sampler;
        if let Some(vpl) = scene.defaults.vpl {
            settings.vpl.probability = vpl.probability.cpu;
            settings.vpl.min_illumination = vpl.min_illumination.cpu;
            settings.vpl.attenuation = vpl.attenuation.cpu;
        }
        if let Some(threshold) = scene.defaults.threshold {
            settings.gather.threshold = threshold.cpu;
        }
        settings
    }

    /// The built-in defaults for the physical model.
    pub fn for_physical() -> Self {
        let mut settings = Self::default();
        settings.run.model = Model::Physical;
        settings.sampling.samples = 64;
        settings.display.transfer = Transfer::Srgb;
        settings
    }

    /// Samples that pixels with differing neighbours get beyond the others.
    pub fn adaptive_extra(&self) -> u32 {
        self.sampling.adaptive_samples.saturating_sub(self.sampling.samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_image::Exposure;
    use lightcuts_scene::{PerDevice, RunDefaults, VplDefaults};

    #[test]
    fn the_defaults_are_valid_and_survive_a_scene() {
        let defaults = RunDefaults {
            vpl: Some(VplDefaults {
                probability: 0.00003.into(),
                min_illumination: 0.5.into(),
                attenuation: PerDevice { cpu: 0.16, gpu: 0.15 },
            }),
            threshold: None,
        };
        let settings = Settings::for_scene(&SceneDesc { defaults, ..SceneDesc::default() });
        assert_eq!(settings.validate(), Ok(()));
        assert_eq!((settings.vpl.attenuation, settings.gather.threshold), (0.16, 1e-6));
    }

    #[test]
    fn faults_are_named() {
        let mut settings = Settings::default();
        settings.caustics.radius = f32::NAN;
        assert_eq!(settings.validate().unwrap_err().name, "caustics.radius");
        settings.display.tone_mapping = ToneMappingKind::Local;
        settings.caustics.radius = 4.0;
        settings.display.local.key = -1.0;
        assert_eq!(settings.validate().unwrap_err().name, "display.local.key");
        settings.display.exposure = Exposure::Factor(0.0);
        assert_eq!(settings.validate().unwrap_err().name, "display.exposure");
        settings.image.width = 0;
        assert_eq!(settings.validate().unwrap_err().name, "image.width");
    }

    #[test]
    fn reproduction_is_of_one_size() {
        let mut settings = Settings::default();
        settings.run.reproduce = true;
        assert!(settings.validate().is_ok());
        settings.sampling.samples = 4;
        assert_eq!(settings.validate().unwrap_err().name, "run.reproduce");
    }
}
