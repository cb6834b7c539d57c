//! False colours.

use serde::{Deserialize, Serialize};

/// A map from numbers 0..=1 to colours whose lightness can be read off.
///
/// The tables are those of `colorous`, which has them from matplotlib and ColorBrewer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorMap {
    /// Black over purple and orange to light yellow, as in the FLIP papers (van der Walt and Smith 2015).
    #[default]
    Magma,
    /// Dark purple over green to yellow (van der Walt and Smith 2015).
    Viridis,
    /// Dark blue over white (0.5) to dark red: for signed values (ColorBrewer RdBu, Brewer 2003).
    Diverging,
}

impl ColorMap {
    /// The sRGB code values 0..=1 for a value, which is clamped to 0..=1; NaN has [`Self::NAN`].
    pub fn at(self, value: f32) -> [f32; 3] {
        if value.is_nan() {
            return Self::NAN;
        }
        let value = f64::from(value.clamp(0.0, 1.0));
        let color = match self {
            Self::Magma => colorous::MAGMA.eval_continuous(value),
            Self::Viridis => colorous::VIRIDIS.eval_continuous(value),
            Self::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - value),
        };
        color.into_array().map(|code| f32::from(code) / 255.0)
    }

    /// Code values of cyan, which is near to no colour of any map.
    pub const NAN: [f32; 3] = [0.0, 1.0, 1.0];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Transfer, luminance};

    const ALL: [ColorMap; 3] = [ColorMap::Magma, ColorMap::Viridis, ColorMap::Diverging];

    /// CIE lightness 0..=100 of the colour of a value.
    fn lightness(map: ColorMap, value: f32) -> f32 {
        let y = luminance(map.at(value).map(|code| Transfer::Srgb.decode(code)));
        if y > 0.008_856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
    }

    fn codes(map: ColorMap, value: f32) -> [u8; 3] {
        map.at(value).map(|code| (255.0 * code).round() as u8)
    }

    #[test]
    fn ends_of_the_published_tables() {
        // matplotlib's tables, rounded to 8 bits.
        assert_eq!(codes(ColorMap::Magma, 0.0), [0, 0, 4]);
        assert_eq!(codes(ColorMap::Magma, 1.0), [252, 253, 191]);
        assert_eq!(codes(ColorMap::Viridis, 0.0), [68, 1, 84]);
        assert_eq!(codes(ColorMap::Viridis, 1.0), [253, 231, 37]);
        let ([dark_red, .., a], [b, .., dark_blue]) =
            (codes(ColorMap::Diverging, 1.0), codes(ColorMap::Diverging, 0.0));
        assert!(dark_red > a + 50 && dark_blue > b + 50, "red is positive, blue negative");
    }

    #[test]
    fn lightness_grows_evenly_with_the_value() {
        for map in [ColorMap::Magma, ColorMap::Viridis] {
            let total = lightness(map, 1.0) - lightness(map, 0.0);
            let steps: Vec<f32> =
                (0..20).map(|i| i as f32 / 20.0).map(|t| lightness(map, t + 0.05) - lightness(map, t)).collect();
            assert!(
                steps.iter().all(|step| *step > 0.35 * total / 20.0 && *step < 1.6 * total / 20.0),
                "{map:?} {steps:?}"
            );
        }
    }

    #[test]
    fn the_diverging_map_is_white_in_the_middle_and_darkens_evenly_to_both_sides() {
        let map = ColorMap::Diverging;
        let [r, g, b] = map.at(0.5);
        assert!(lightness(map, 0.5) > 94.0 && (r - g).abs() < 0.02 && (g - b).abs() < 0.02);
        for distance in (0..50).map(|i| i as f32 / 100.0) {
            let [below, above] = [0.5 - distance, 0.5 + distance].map(|value| lightness(map, value));
            assert!((below - above).abs() < 8.0, "{distance}: {below} {above}");
            assert!(below > lightness(map, 0.49 - distance) && above > lightness(map, 0.51 + distance));
        }
    }

    #[test]
    fn values_outside_are_clamped_and_nan_stands_out() {
        for map in ALL {
            assert_eq!(map.at(-1.0), map.at(0.0));
            assert_eq!(map.at(f32::INFINITY), map.at(1.0));
            let nan = map.at(f32::NAN);
            let nearest = (0..=100).map(|i| map.at(i as f32 / 100.0));
            let distance = |color: [f32; 3]| color.iter().zip(nan).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(nearest.map(distance).fold(1.0, f32::min) > 0.2, "{map:?}");
        }
    }
}
