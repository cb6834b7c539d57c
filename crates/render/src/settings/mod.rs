//! Everything that says how a scene is to be rendered: plain parameter structs with the original program's defaults.
//!
//! The same structs are the TOML job file's tables; unknown keys are errors.

mod physical;
mod tables;
mod validate;

pub use physical::{Integrator, Physical};
pub use tables::{TomlFault, overlay, value_at};
pub use validate::SettingsError;

use lightcuts_image::{GlobalToneMapping, LocalToneMapping, ToneMapping, Transfer};
use lightcuts_scene::{SamplerKind, SceneDesc};
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
    /// How samples become pixels.
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
    /// The physical model; of the thesis' model nothing here matters, and of the physical one neither VPL placement nor
    /// effects.
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
    /// Longest chain of mirrored and refracted rays, camera ray included (thesis: 4).
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
    /// Samples of every pixel.
    pub samples: u32,
    /// Samples of pixels that differ from a neighbour; no adaptive anti-aliasing unless above `samples`.
    pub adaptive_samples: u32,
    /// Difference between neighbouring pixels, in any channel, from which on they get `adaptive_samples`.
    pub adaptive_threshold: f32,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { sampler: SamplerKind::Stratified, samples: 1, adaptive_samples: 0, adaptive_threshold: 0.05 }
    }
}

/// How samples become pixels.
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

/// How VPLs are placed: at hits of the first pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct VplPlacement {
    /// Nominal probability p that a hit becomes a VPL, for a picture of 512 x 512 pixels of one sample. The effective one
    /// is (floor(p 10^6) + 1) / 32768, about 30.5 times as much, as in the original; shared out over the camera rays and
    /// at most 1, so that pictures of one shape place as many VPLs at any size and number of samples.
    pub probability: f32,
    /// Least r + g + b of a hit's colour for it to become a VPL.
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
    /// Least relevance (intensity x cosine / squared distance) of a chosen VPL; not for `all`.
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
    /// The thesis' lightcuts: every VPL whose relevance reaches the threshold, found through a bounded tree. In the physical
    /// model those of 2005: clusters by error bound.
    Lightcuts,
    /// The same VPLs as `lightcuts`, found by testing every one: the plain version, for comparison. Thesis' model only.
    LightcutsExhaustive,
    /// A few, drawn down the tree by what they may send (after Yuksel 2019). Physical model only.
    Stochastic,
}

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
    /// Distance from which on a surface no longer occludes, in scene units.
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

/// Photon-mapped caustics of the second pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Caustics {
    /// Whether photons are shot.
    pub enabled: bool,
    /// Spacing of the photons on the disk through a target's bounding sphere, in scene units; wider where all lights and
    /// targets together would take more than 2^26 photons.
    pub step: f32,
    /// Radius of the gathered disk, in scene units.
    pub radius: f32,
    /// Fewest photons in the disk that count.
    pub min_photons: u32,
    /// Least F of a target.
    pub min_reflection: f32,
    /// Least R of a target.
    pub min_refraction: f32,
    /// Least r + g + b of a diffuse colour that catches photons.
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

/// Glow around bright places of the finished picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Bloom {
    /// Whether it is applied.
    pub enabled: bool,
    /// Radius in pixels.
    pub radius: f32,
    /// Share of the blurred picture, 0..1.
    pub weight: f32,
}

impl Default for Bloom {
    fn default() -> Self {
        Self { enabled: false, radius: 12.0, weight: 0.7 }
    }
}

/// From linear light to displayed values; for PNG only.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Display {
    /// Tone mapping operator.
    pub tone_mapping: ToneMappingKind,
    /// Parameters of the global operator.
    pub global: GlobalToneMapping,
    /// Parameters of the local operator.
    pub local: LocalToneMapping,
    /// Transfer curve; the thesis shows values as they are.
    pub transfer: Transfer,
}

/// Tone mapping operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMappingKind {
    /// Values as they are.
    #[default]
    None,
    /// The thesis' global operator.
    Global,
    /// Reinhard et al. 2002, local: the menu entry that the original left empty.
    Local,
}

impl Display {
    /// The chosen operator with its parameters.
    pub fn operator(&self) -> ToneMapping {
        match self.tone_mapping {
            ToneMappingKind::None => ToneMapping::None,
            ToneMappingKind::Global => ToneMapping::Global(self.global),
            ToneMappingKind::Local => ToneMapping::Local(self.local),
        }
    }
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
