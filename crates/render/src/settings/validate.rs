//! The range of every parameter, checked once, so that rendering cannot fail.

use super::{ImageSize, Model, Settings, Strategy, ToneMappingKind};
use lightcuts_image::{Exposure, ImageError, MAX_PIXELS};
use std::borrow::Cow;

/// Most that light can be multiplied by before it is shown.
const MAX_EXPOSURE: f32 = 1e12;

/// A parameter out of its range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{name} is {value}; expected {expected}")]
pub struct SettingsError {
    /// `table.key` as in a job file.
    pub name: Cow<'static, str>,
    /// The value.
    pub value: String,
    /// What was expected.
    pub expected: String,
}

impl Settings {
    /// Checks every parameter's range, so that rendering cannot fail; the first fault found is returned.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let pixels = u64::from(self.image.width) * u64::from(self.image.height);
        ensure("image.width", self.image.width, (1..=65_536).contains(&self.image.width), "1 to 65536")?;
        ensure("image.height", self.image.height, (1..=65_536).contains(&self.image.height), "1 to 65536")?;
        ensure("image.width", self.image.width, pixels <= MAX_PIXELS as u64, "fewer than 2^28 pixels in all")?;
        ensure("run.max-depth", self.run.max_depth, (1..=12).contains(&self.run.max_depth), "1 to 12")?;
        self.validate_reproduction()?;
        self.validate_sampling()?;
        number("vpl.probability", self.vpl.probability, 0.0, 1.0)?;
        number("vpl.min-illumination", self.vpl.min_illumination, 0.0, 3.0)?;
        number("vpl.attenuation", self.vpl.attenuation, 0.0, 1e6)?;
        number("gather.threshold", self.gather.threshold, 0.0, f32::MAX)?;
        self.validate_physical()?;
        self.validate_effects()
    }

    /// Fails unless this is the model of light.
    pub fn require_model(&self, model: Model) -> Result<(), SettingsError> {
        ensure("run.model", self.run.model.name(), self.run.model == model, model.name())
    }

    fn validate_reproduction(&self) -> Result<(), SettingsError> {
        if !self.run.reproduce {
            return Ok(());
        }
        ensure("run.reproduce", true, self.run.model == Model::Thesis, "the thesis' model")?;
        let plain = self.image == ImageSize::default() && self.sampling.samples == 1 && self.adaptive_extra() == 0;
        ensure("run.reproduce", true, plain, "512 x 512 pixels and one sample per pixel")
    }

    /// Whether time or noise ends a render of the physical model.
    pub fn has_other_limit(&self) -> bool {
        let physical = &self.physical;
        self.run.model == Model::Physical && (physical.time_limit > 0.0 || physical.noise > 0.0)
    }

    fn validate_sampling(&self) -> Result<(), SettingsError> {
        let sampling = &self.sampling;
        let most = if self.run.model == Model::Physical { 1 << 24 } else { 4096 };
        let samples = sampling.samples;
        let expected = if self.run.model == Model::Physical {
            format!("1 to {most}, or 0, no limit, where there is one of time or noise")
        } else {
            format!("1 to {most}")
        };
        let is_enough = samples > 0 || self.has_other_limit();
        ensure("sampling.samples", samples, samples <= most && is_enough, &expected)?;
        let adaptive = sampling.adaptive_samples;
        ensure("sampling.adaptive-samples", adaptive, adaptive <= 4096, "0 to 4096")?;
        number("sampling.adaptive-threshold", sampling.adaptive_threshold, 0.0, 1e6)?;
        number("filter.radius", self.filter.resolved_radius(), 0.5, 16.0)?;
        number("filter.alpha", self.filter.alpha, 0.0, 1e3)?;
        number("filter.mitchell-b", self.filter.mitchell_b, -10.0, 10.0)?;
        number("filter.mitchell-c", self.filter.mitchell_c, -10.0, 10.0)
    }

    fn validate_physical(&self) -> Result<(), SettingsError> {
        let physical = &self.physical;
        let (strategy, fits) = match self.gather.strategy {
            Strategy::LightcutsExhaustive => ("lightcuts-exhaustive", self.run.model == Model::Thesis),
            Strategy::Stochastic => ("stochastic", self.run.model == Model::Physical),
            Strategy::Auto => ("auto", self.run.model == Model::Physical),
            Strategy::All | Strategy::Lightcuts => ("", true),
        };
        let expected = match self.run.model {
            Model::Thesis => "`all`, `lightcuts` or `lightcuts-exhaustive` in the thesis' model",
            Model::Physical => "`all`, `lightcuts`, `stochastic` or `auto` in the physical model",
        };
        ensure("gather.strategy", strategy, fits, expected)?;
        number("physical.time-limit", physical.time_limit, 0.0, 1e9)?;
        number("physical.noise", physical.noise, 0.0, 1e3)?;
        ensure("physical.vpls", physical.vpls, (1..=1 << 24).contains(&physical.vpls), "1 to 16777216")?;
        number("physical.cut-error", physical.cut_error, 0.0, 1e3)?;
        ensure("physical.max-cut", physical.max_cut, physical.max_cut > 0, "1 or more")?;
        number("physical.clamp", physical.clamp, 0.0, 1.0)?;
        number("physical.light-scale", physical.light_scale, 0.0, 1e6)
    }

    fn validate_effects(&self) -> Result<(), SettingsError> {
        let occlusion = &self.ambient_occlusion;
        number("ambient-occlusion.angle", occlusion.angle, 0.0, 90.0)?;
        number("ambient-occlusion.step", occlusion.step, 0.1, 180.0)?;
        number("ambient-occlusion.range", occlusion.range, f32::MIN_POSITIVE, 1e9)?;
        number("ambient-occlusion.factor", occlusion.factor, 0.0, 1e6)?;
        let caustics = &self.caustics;
        number("caustics.step", caustics.step, 1e-9, 1e9)?;
        number("caustics.radius", caustics.radius, 1e-9, 1e9)?;
        number("caustics.min-reflection", caustics.min_reflection, 0.0, 1e6)?;
        number("caustics.min-refraction", caustics.min_refraction, 0.0, 1e6)?;
        number("caustics.min-diffuse", caustics.min_diffuse, 0.0, 1e6)?;
        number("bloom.radius", self.bloom.radius, 0.0, 1024.0)?;
        number("bloom.weight", self.bloom.weight, 0.0, 1.0)?;
        if let Exposure::Factor(factor) = self.display.exposure {
            let is_sound = factor > 0.0 && factor <= MAX_EXPOSURE;
            ensure("display.exposure", factor, is_sound, "a factor above 0, at most 1e12, or `auto`")?;
        }
        self.display.operator().validate().map_err(|error| self.display_error(error))
    }

    /// A fault of the tone mapping operator, by its name in a job file.
    fn display_error(&self, error: ImageError) -> SettingsError {
        let table = if self.display.tone_mapping == ToneMappingKind::Local { "local" } else { "global" };
        match error {
            ImageError::Parameter { parameter, range, value } => SettingsError {
                name: format!("display.{table}.{parameter}").into(),
                value: value.to_string(),
                expected: range.to_owned(),
            },
            other => SettingsError {
                name: format!("display.{table}").into(),
                value: other.to_string(),
                expected: "parameters in range".to_owned(),
            },
        }
    }
}

fn ensure(name: &'static str, value: impl std::fmt::Display, holds: bool, expected: &str) -> Result<(), SettingsError> {
    if holds {
        Ok(())
    } else {
        Err(SettingsError { name: name.into(), value: value.to_string(), expected: expected.to_owned() })
    }
}

fn number(name: &'static str, value: f32, least: f32, most: f32) -> Result<(), SettingsError> {
    let holds = (least..=most).contains(&value);
    let most = if most < 1e6 { most.to_string() } else { format!("{most:e}") };
    ensure(name, value, holds, &format!("a number from {least} to {most}"))
}
