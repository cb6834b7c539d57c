//! Tone mapping: from unbounded luminance to what a display can show.

use serde::{Deserialize, Serialize};

use crate::plane::luminance_f64;
use crate::{Image, ImageError};

mod global;
mod local;

pub use global::GlobalToneMapping;
pub use local::LocalToneMapping;

/// Which operator a finished picture goes through before it is shown. In a job file: `"none"`, or a table `global` or
/// `local` with parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMapping {
    /// The picture as it is, as the thesis shows it.
    #[default]
    None,
    /// One curve for the whole picture (thesis section 7).
    Global(GlobalToneMapping),
    /// A curve per pixel that depends on its surroundings (Reinhard et al. 2002); a menu entry of the original program
    /// that it never implemented.
    Local(LocalToneMapping),
}

impl ToneMapping {
    /// The picture after the operator. `None` is the identity, bit for bit.
    ///
    /// The other two take NaN and infinity as 0 and return finite values for parameters that pass [`Self::validate`].
    /// Deterministic on any number of threads.
    pub fn apply(&self, image: &Image) -> Image {
        match self {
            Self::None => image.clone(),
            Self::Global(operator) => operator.apply(image),
            Self::Local(operator) => operator.apply(image),
        }
    }

    /// Fails with [`ImageError::Parameter`] on the first parameter outside its range.
    pub fn validate(&self) -> Result<(), ImageError> {
        match self {
            Self::None => Ok(()),
            Self::Global(operator) => operator.validate(),
            Self::Local(operator) => operator.validate(),
        }
    }
}

/// Fails with [`ImageError::Parameter`] unless `value` is finite and above 0.
fn expect_positive(parameter: &'static str, value: f32) -> Result<(), ImageError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(ImageError::Parameter { parameter, range: "above 0", value: f64::from(value) })
}

/// Luminance, or 0 where it is negative, as filters with negative lobes can make it.
fn positive_luminance(rgb: [f32; 3]) -> f64 {
    luminance_f64(rgb).max(0.0)
}

/// `scale * rgb`, limited to what a float holds, so that no operator returns an infinity.
fn scaled(rgb: [f32; 3], scale: f64) -> [f32; 3] {
    rgb.map(|value| {
        let value = f64::from(value) * scale;
        if value.is_nan() { 0.0 } else { value.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPERATORS: [fn() -> ToneMapping; 3] = [
        || ToneMapping::None,
        || ToneMapping::Global(GlobalToneMapping::default()),
        || ToneMapping::Local(LocalToneMapping::default()),
    ];

    #[test]
    fn no_operator_returns_a_nan_or_an_infinity() {
        let extremes = [0.0, -1.0, 1e-45, 1e-30, 1.0, 1e30, f32::MAX, f32::MIN, f32::NAN, f32::INFINITY];
        let mut images = vec![Image::new(0, 0), Image::new(7, 3), Image::filled(1, 1, [2.0, 1.0, 0.5])];
        images.extend(extremes.map(|value| Image::filled(1, 1, [value; 3])));
        images.extend(
            extremes.map(|value| Image::from_fn(20, 9, |x, _| [value, if x == 4 { value } else { 0.0 }, 1e-3])),
        );
        for (operator, image) in
            OPERATORS[1..].iter().flat_map(|operator| images.iter().map(move |image| (operator(), image)))
        {
            let result = operator.apply(image);
            assert!(result.pixels().iter().flatten().all(|value| value.is_finite()), "{operator:?} on {image:?}");
        }
    }

    #[test]
    fn black_stays_black() {
        for operator in OPERATORS {
            assert_eq!(operator().apply(&Image::new(5, 4)), Image::new(5, 4));
        }
    }

    #[test]
    fn operators_are_toml() {
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        struct Job {
            tone_mapping: ToneMapping,
        }
        for operator in OPERATORS {
            let job = Job { tone_mapping: operator() };
            assert_eq!(toml::from_str::<Job>(&toml::to_string(&job).unwrap()).unwrap(), job);
        }
        let job: Job = toml::from_str("[tone_mapping.global]\nmax-display-luminance = 100").unwrap();
        assert_eq!(job.tone_mapping, ToneMapping::Global(GlobalToneMapping { max_display_luminance: 100.0 }));
        assert!(toml::from_str::<Job>("[tone_mapping.global]\nmax-luminance = 100").is_err());
        assert!(toml::from_str::<Job>("[tone_mapping.local]").is_ok());
    }

    #[test]
    fn parameters_are_checked() {
        assert!(OPERATORS.iter().all(|operator| operator().validate().is_ok()));
        for value in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let error = GlobalToneMapping { max_display_luminance: value }.validate().unwrap_err();
            assert!(error.to_string().starts_with("max-display-luminance must be above 0"), "{error}");
        }
        assert!(LocalToneMapping { ratio: 1.0, ..LocalToneMapping::default() }.validate().is_err());
        assert!(LocalToneMapping { scales: 0, ..LocalToneMapping::default() }.validate().is_err());
    }
}
