//! Exposure: the plain factor on light before it is shown.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use rayon::prelude::*;
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{Image, luminance};

/// What the middle of a picture's light becomes: middle grey (Reinhard et al. 2002, "Photographic Tone Reproduction for Digital
/// Images", section 2).
const MIDDLE_GREY: f64 = 0.18;
/// Share of the lit pixels that is left out at either end, so that neither lamps nor the last specks of noise decide.
const LEFT_OUT: f64 = 0.05;
/// The word for a factor that the picture decides.
const AUTO: &str = "auto";

/// A factor on light. In a job file: a number, or `"auto"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// This one; 1 shows a radiance of 1 as white.
    Factor(f32),
    /// The one that makes the picture's middle grey 0.18; see [`Exposure::factor`].
    Auto,
}

impl Default for Exposure {
    fn default() -> Self {
        Self::Factor(1.0)
    }
}

impl Exposure {
    /// Whether it leaves every bit as it is.
    pub fn is_neutral(&self) -> bool {
        *self == Self::default()
    }

    /// The factor for a picture of linear light.
    ///
    /// [`Exposure::Auto`]: pixels whose luminance is finite and above 0 are sorted by it, a twentieth of them is left out at
    /// either end, and the geometric mean of the rest becomes 0.18. So a picture that is `k` times as bright gets a factor `k`
    /// times as small. A picture without light gets 1.
    pub fn factor(&self, image: &Image) -> f32 {
        match self {
            Self::Factor(factor) => *factor,
            Self::Auto => middle(image).map_or(1.0, |middle| {
                let factor = MIDDLE_GREY / middle;
                factor.clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX)) as f32
            }),
        }
    }

    /// The picture times the factor; the picture itself where that is 1.
    pub fn apply<'a>(&self, image: &'a Image) -> Cow<'a, Image> {
        let factor = self.factor(image);
        if factor == 1.0 {
            return Cow::Borrowed(image);
        }
        Cow::Owned(image.map(|pixel| pixel.map(|value| factor * value)))
    }
}

/// The geometric mean of the luminances of a picture without its ends; `None` without light.
fn middle(image: &Image) -> Option<f64> {
    let lit = |light: &f32| light.is_finite() && *light > 0.0;
    let mut lights: Vec<f32> = image.pixels().iter().map(|pixel| luminance(*pixel)).filter(lit).collect();
    lights.par_sort_unstable_by(f32::total_cmp);
    let left_out = (lights.len() as f64 * LEFT_OUT) as usize;
    let kept = &lights[left_out..lights.len() - left_out];
    let sum: f64 = kept.iter().map(|light| f64::from(*light).ln()).sum();
    (!kept.is_empty()).then(|| (sum / kept.len() as f64).exp())
}

impl fmt::Display for Exposure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Factor(factor) => factor.fmt(formatter),
            Self::Auto => formatter.pad(AUTO),
        }
    }
}

impl FromStr for Exposure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == AUTO {
            return Ok(Self::Auto);
        }
        // `+1` would be a stop to a photographer.
        let factor = if text.starts_with('+') { None } else { text.parse().ok() };
        factor.map(Self::Factor).ok_or_else(|| "expected a factor such as 2 or 0.25, not stops, or `auto`".to_owned())
    }
}

impl Serialize for Exposure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Factor(factor) => serializer.serialize_f32(*factor),
            Self::Auto => serializer.serialize_str(AUTO),
        }
    }
}

impl<'de> Deserialize<'de> for Exposure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Factors)
    }
}

/// Numbers of any kind, and the one word.
struct Factors;

impl Visitor<'_> for Factors {
    type Value = Exposure;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number or \"auto\"")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Exposure, E> {
        Ok(Exposure::Factor(value as f32))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Exposure, E> {
        Ok(Exposure::Factor(value as f32))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Exposure, E> {
        Ok(Exposure::Factor(value as f32))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Exposure, E> {
        if value == AUTO { Ok(Exposure::Auto) } else { Err(E::invalid_value(Unexpected::Str(value), &self)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn auto(image: &Image) -> f32 {
        Exposure::Auto.factor(image)
    }

    #[test]
    fn the_middle_becomes_middle_grey() {
        assert!((auto(&Image::filled(5, 5, [0.02; 3])) / 9.0 - 1.0).abs() < 1e-5);
        // Half of the pixels at 1, half at 0.01: the geometric mean is 0.1.
        let image = Image::from_fn(20, 20, |x, _| [if x < 10 { 1.0 } else { 0.01 }; 3]);
        assert!((auto(&image) / 1.8 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn lamps_specks_and_what_is_no_light_do_not_decide() {
        let mut image = Image::filled(20, 20, [0.5; 3]);
        let expected = auto(&image);
        for (place, value) in [1e9, 1e6, 1e-20, 1e-30, 0.0, -3.0, f32::NAN, f32::INFINITY].into_iter().enumerate() {
            image.set(place, 3, [value; 3]);
        }
        assert!((auto(&image) / expected - 1.0).abs() < 1e-5);
    }

    #[test]
    fn brighter_light_gets_as_much_less_and_a_dark_picture_1() {
        let image = Image::from_fn(31, 17, |x, y| [0.01 * x as f32, 0.3 * y as f32, (x * y) as f32]);
        for factor in [1e-6_f32, 0.25, 2.0, 1e6] {
            let other = image.map(|pixel| pixel.map(|value| factor * value));
            assert!((auto(&other) * factor / auto(&image) - 1.0).abs() < 1e-4, "{factor}");
        }
        for dark in [Image::new(4, 4), Image::new(0, 0), Image::filled(1, 1, [-1.0; 3])] {
            assert_eq!(auto(&dark), 1.0);
        }
        assert!(auto(&Image::filled(2, 2, [1e-45; 3])).is_finite());
    }

    #[test]
    fn a_factor_multiplies_and_1_changes_no_bit() {
        let image = Image::from_fn(3, 1, |x, _| [[0.5, -0.0, f32::MAX], [f32::NAN; 3], [1e-45, 2.0, 3.0]][x]);
        assert!(
            matches!(Exposure::default().apply(&image), Cow::Borrowed(same) if std::ptr::eq(same, &raw const image))
        );
        assert_eq!(Exposure::Factor(0.5).apply(&image).get(2, 0)[1..], [1.0, 1.5]);
    }

    #[test]
    fn words_and_toml_are_numbers_or_auto() {
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        struct Job {
            exposure: Exposure,
        }
        for (text, exposure) in [
            ("exposure = 2", Exposure::Factor(2.0)),
            ("exposure = 0.1", Exposure::Factor(0.1)),
            ("exposure = \"auto\"", Exposure::Auto),
        ] {
            let job: Job = toml::from_str(text).unwrap();
            assert_eq!(job, Job { exposure });
            assert_eq!(toml::from_str::<Job>(&toml::to_string(&job).unwrap()).unwrap(), job);
            assert_eq!(exposure.to_string().parse(), Ok(exposure));
        }
        assert!("+1".parse::<Exposure>().is_err(), "a stop");
        let error = toml::from_str::<Job>("exposure = \"bright\"").unwrap_err().to_string();
        assert!(error.contains("expected a number or \"auto\""), "{error}");
        assert!("bright".parse::<Exposure>().is_err());
    }
}
