//! The global operator of the thesis.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{expect_positive, positive_luminance, scaled};
use crate::plane::finite_or_zero;
use crate::{Image, ImageError};

/// Luminous efficacy of monochromatic light of 540 THz, in lumen per watt (SI definition of the candela, rounded).
const LUMINOUS_EFFICACY: f32 = 683.0;

/// Reinhard's global curve with the picture's greatest luminance as its white (thesis section 7; PBRT's "nonlinear"
/// operator): with luminance Y, `scale = (1 + Y / Ymax^2) / (1 + Y) * 683 / max_display_luminance`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct GlobalToneMapping {
    /// Luminance of the display's white, in candela per square metre.
    ///
    /// 683 lumen per watt turn radiance into luminance, so the factor is physical only where colours are radiance in
    /// watts. Those of the thesis model have no unit; hence the default of 683, with which the factor is 1.
    pub max_display_luminance: f32,
}

impl Default for GlobalToneMapping {
    fn default() -> Self {
        Self { max_display_luminance: LUMINOUS_EFFICACY }
    }
}

impl GlobalToneMapping {
    pub(super) fn validate(self) -> Result<(), ImageError> {
        expect_positive("max-display-luminance", self.max_display_luminance)
    }

    /// The picture after the curve; NaN and infinity count as 0, negative luminance as none.
    ///
    /// In f64 throughout, because `Ymax^2` leaves the range of f32 at both ends.
    pub(super) fn apply(self, image: &Image) -> Image {
        let mut result = image.map(finite_or_zero);
        let white = result.pixels().par_iter().map(|rgb| positive_luminance(*rgb)).reduce(|| 0.0, f64::max);
        if white > 0.0 {
            let factor = f64::from(LUMINOUS_EFFICACY) / f64::from(self.max_display_luminance);
            result.pixels_mut().par_iter_mut().for_each(|rgb| {
                let y = positive_luminance(*rgb);
                *rgb = scaled(*rgb, (1.0 + y / (white * white)) / (1.0 + y) * factor);
            });
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_of_a_grey_ramp() {
        let image = Image::from_fn(5, 1, |x, _| [x as f32; 3]);
        let result = GlobalToneMapping::default().apply(&image);
        for x in 0..5 {
            let y = x as f32;
            let expected = y * (1.0 + y / 16.0) / (1.0 + y);
            assert!((result.get(x, 0)[1] - expected).abs() < 1e-5, "{x}: {:?}", result.get(x, 0));
        }
        assert!((result.get(4, 0)[0] - 1.0).abs() < 1e-5, "the greatest luminance becomes white");
    }

    #[test]
    fn hue_stays_and_the_display_scales() {
        let image = Image::from_fn(2, 1, |x, _| if x == 0 { [2.0, 1.0, 0.5] } else { [9.0; 3] });
        let operator = GlobalToneMapping { max_display_luminance: 341.5 };
        let [r, g, b] = operator.apply(&image).get(0, 0);
        assert!((r / g - 2.0).abs() < 1e-5 && (b / g - 0.5).abs() < 1e-5);
        let [plain, ..] = GlobalToneMapping::default().apply(&image).get(0, 0);
        assert!((r / plain - 2.0).abs() < 1e-5);
    }
}
