//! Values that are more than a number or a word.

use serde::{Serialize, Serializer};
use std::str::FromStr;

/// Width and height, written `640x480`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) width: u32,
    pub(super) height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
        let (width, height) = sides.ok_or("expected width and height in pixels, such as 640x480")?;
        Ok(Self { width, height })
    }
}

/// A time in seconds, written `90`, `90s`, `500ms`, `1.5m` or `1h`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(transparent)]
pub(super) struct Seconds(f32);

impl FromStr for Seconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // `ms` ends as `s` does, so it comes first.
        let units = [("ms", 0.001), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
        let (number, factor) = units
            .into_iter()
            .find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, factor)))
            .unwrap_or((text, 1.0));
        let number: f32 = number.trim().parse().map_err(|_| "expected a time such as 10s, 500ms, 2m or 1.5h")?;
        if number.is_finite() && number >= 0.0 {
            Ok(Self(number * factor))
        } else {
            Err("expected a time of 0 or more".to_owned())
        }
    }
}

/// An angle in degrees, 0 to 180.
pub(super) fn angle(text: &str) -> Result<f32, String> {
    let angle = text.parse().ok().filter(|angle: &f32| (0.0..=180.0).contains(angle));
    angle.ok_or_else(|| "expected an angle from 0 to 180 degrees".to_owned())
}

/// For a flag that switches off what its key switches on.
#[expect(clippy::ref_option, clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
pub(super) fn negated<S: Serializer>(flag: &Option<bool>, serializer: S) -> Result<S::Ok, S::Error> {
    match flag {
        Some(flag) => serializer.serialize_some(&!flag),
        None => serializer.serialize_none(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        let seconds = |text: &str| text.parse::<Seconds>().map(|Seconds(s)| s);
        assert_eq!([seconds("90"), seconds("90s"), seconds("1.5m"), seconds("2h")], [90.0, 90.0, 90.0, 7200.0].map(Ok));
        assert_eq!([seconds("1ms"), seconds("250 ms"), seconds("0ms")], [0.001, 0.25, 0.0].map(Ok));
        for text in ["", "s", "ms", "-1", "-1ms", "1d", "1sm", "inf", "nans", "infms"] {
            assert!(text.parse::<Seconds>().is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_are_two_numbers() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        for text in ["", "x", "640", "640x", "640x480x2", "-1x1", "1.5x1", "99999999999x1"] {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
    }
}
