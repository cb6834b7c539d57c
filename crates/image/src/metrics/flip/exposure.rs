//! How linear light becomes the pictures that are compared: a series of exposures and a tone mapper.

use crate::plane::finite_or_zero;
use crate::{Image, ImageError, Transfer};

/// Numerator and denominator of the ACES curve, `(a x^2 + b x) / (c x^2 + d x + e)`: Narkowicz' fit of
/// 2015 for 0.6 x (2021, tone mappers).
const ACES: [f32; 5] = [0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14];

/// Where the automatic series ends: the display value that the greatest luminance is brought down to and the median
/// luminance is brought up to (2021, automatic exposures).
const ANCHOR: f64 = 0.85;

/// Luminances are taken as at least this large, so that a black median asks for 24 stops instead of infinitely many. A
/// reference that has nothing above is black.
const BLACK: f64 = f32::EPSILON as f64;

/// The series for a black reference, which has no exposure of its own; it suits pictures that are about 0 to 1.
const BLACK_SERIES: Series = Series { start: -2.0, stop: 2.0, count: 5 };

/// Beyond that, an f32 leaves its range.
const MAX_STOPS: f32 = 126.0;

/// More would be finer than a tenth of a stop over the whole range of f32.
const MAX_COUNT: u32 = 2560;

/// Arguments above have the curve's limit, and their squares would leave the range of f32.
const MAX_EXPOSED: f32 = 1e9;

/// The exposures that HDR-FLIP compares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposures {
    /// From the reference picture: from the exposure that brings its greatest luminance to 0.85 of
    /// the display's white, to the one that does so with its median luminance; one exposure per stop begun, at least 2.
    ///
    /// A median below 2^-23 counts as 2^-23. A reference that is nowhere brighter is compared with 5 exposures from -2
    /// to 2 (the authors' program refuses such a picture). NaN and infinities count as black.
    #[default]
    Automatic,
    /// `count` exposures in equal steps; a single one is `start`.
    Fixed {
        /// First exposure compensation in stops, -126 to 126.
        start: f32,
        /// Last exposure compensation in stops, `start` to 126.
        stop: f32,
        /// Number of exposures, 1 to 2560.
        count: u32,
    },
}

impl Exposures {
    /// The series for a reference of linear light. Fails with [`ImageError::Parameter`] for fixed exposures outside
    /// their ranges.
    pub(super) fn series(&self, reference: &Image) -> Result<Series, ImageError> {
        match *self {
            Self::Automatic => Ok(Series::automatic(reference)),
            Self::Fixed { start, stop, count } => {
                let refuse = |parameter, range, value| Err(ImageError::Parameter { parameter, range, value });
                if !(-MAX_STOPS..=MAX_STOPS).contains(&start) {
                    return refuse("the first exposure", "from -126 to 126 stops", f64::from(start));
                }
                if !(start..=MAX_STOPS).contains(&stop) {
                    return refuse("the last exposure", "from the first exposure to 126 stops", f64::from(stop));
                }
                if !(1..=MAX_COUNT).contains(&count) {
                    return refuse("the number of exposures", "from 1 to 2560", f64::from(count));
                }
                Ok(Series { start, stop, count })
            }
        }
    }
}

/// `count` exposures in equal steps from `start` to `stop`, in stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Series {
    pub(super) start: f32,
    pub(super) stop: f32,
    pub(super) count: u32,
}

impl Series {
    fn automatic(reference: &Image) -> Self {
        let mut luminances: Vec<f64> = reference.pixels().iter().map(|rgb| luminance(finite_or_zero(*rgb))).collect();
        let greatest = luminances.iter().copied().fold(0.0, f64::max);
        if greatest <= BLACK {
            return BLACK_SERIES;
        }
        let middle = luminances.len() / 2;
        let median = luminances.select_nth_unstable_by(middle, f64::total_cmp).1.max(BLACK);
        let anchored = exposed_value_of(ANCHOR);
        let start = (anchored / greatest).log2() as f32;
        let stop = (anchored / median).log2() as f32;
        Self { start, stop, count: (stop - start).ceil().max(2.0) as u32 }
    }

    /// One development per exposure.
    pub(super) fn developments(self) -> Vec<Development> {
        let step = (self.stop - self.start) / self.count.saturating_sub(1).max(1) as f32;
        (0..self.count).map(|i| Development::Exposed((self.start + i as f32 * step).exp2())).collect()
    }
}

/// From a pixel of the input to linear light on a display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Development {
    /// The pixel holds sRGB code values.
    Code,
    /// The pixel holds linear light, which is multiplied by that factor and tone mapped.
    Exposed(f32),
}

impl Development {
    /// Linear light on a display, 0..=1 per channel.
    pub(super) fn linear(self, pixel: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Code => pixel.map(|code| Transfer::Srgb.decode(unit(code))),
            Self::Exposed(factor) => finite_or_zero(pixel).map(|light| unit(aces(light * factor))),
        }
    }
}

/// Clamps to 0..=1; NaN becomes 0.
#[allow(clippy::manual_clamp)] // `max` first: it is what turns a NaN into 0
fn unit(value: f32) -> f32 {
    value.max(0.0).min(1.0)
}

/// The curve itself. It is meant for values from 0 on; far below 0 it rises again, which is kept because the authors'
/// program does the same with negative values.
fn aces(value: f32) -> f32 {
    let [a, b, c, d, e] = ACES;
    let x = value.clamp(-MAX_EXPOSED, MAX_EXPOSED);
    (a * x * x + b * x) / (c * x * x + d * x + e)
}

/// The positive argument at which the curve has a value: the greater root of a quadratic equation.
fn exposed_value_of(value: f64) -> f64 {
    let [a, b, c, d, e] = ACES.map(f64::from);
    let (square, linear, constant) = (a - value * c, b - value * d, -value * e);
    let half = -0.5 * linear / square;
    half + (half * half - constant / square).sqrt()
}

/// Relative luminance with the weights that FLIP uses.
fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_anchor_is_where_the_curve_has_its_value() {
        assert!((f64::from(aces(exposed_value_of(ANCHOR) as f32)) - ANCHOR).abs() < 1e-6);
        assert_eq!(aces(0.0), 0.0);
        assert!(aces(f32::MAX) > 1.0 && aces(f32::MAX) < 1.04, "{}", aces(f32::MAX));
    }

    #[test]
    fn the_automatic_series_brings_greatest_and_median_to_the_anchor() {
        // Luminance 1 once and 1/16 elsewhere: four stops between them.
        let mut reference = Image::filled(5, 3, [1.0 / 16.0; 3]);
        reference.set(2, 1, [1.0; 3]);
        let Series { start, stop, count } = Exposures::Automatic.series(&reference).unwrap();
        assert!((f64::from(aces(start.exp2())) - ANCHOR).abs() < 1e-5);
        assert!((stop - start - 4.0).abs() < 1e-5);
        assert!((4..=5).contains(&count), "rounding decides whether a fifth stop has begun: {count}");
    }

    #[test]
    fn a_dark_reference_has_a_finite_series() {
        let black = Image::new(4, 4);
        assert_eq!(Exposures::Automatic.series(&black).unwrap(), BLACK_SERIES);
        assert_eq!(Exposures::Automatic.series(&Image::new(0, 0)).unwrap(), BLACK_SERIES);
        let broken = Image::filled(4, 4, [f32::NAN, f32::INFINITY, -1.0]);
        assert_eq!(Exposures::Automatic.series(&broken).unwrap(), BLACK_SERIES);
        let mut mostly_black = black;
        mostly_black.set(0, 0, [1.0; 3]);
        // flip_evaluator 1.7 for a picture with one white row of eight: 1.0832973, 24.083297, 23 exposures.
        let Series { start, stop, count } = Exposures::Automatic.series(&mostly_black).unwrap();
        assert!((start - 1.083_297_3).abs() < 1e-6 && (stop - 24.083_298).abs() < 1e-5 && count == 23);
    }

    #[test]
    fn the_brightest_reference_has_a_finite_series() {
        let bright = Image::filled(2, 2, [f32::MAX; 3]);
        let series = Exposures::Automatic.series(&bright).unwrap();
        assert!(series.start.is_finite() && series.count == 2);
        let shown = series.developments()[0].linear(bright.get(0, 0));
        assert!((shown[1] - 0.85).abs() < 1e-4, "{shown:?}");
    }

    #[test]
    fn fixed_exposures_are_checked() {
        let series = |start, stop, count| Exposures::Fixed { start, stop, count }.series(&Image::new(1, 1));
        assert_eq!(series(1.0, 3.0, 1).unwrap().developments(), [Development::Exposed(2.0)]);
        assert_eq!(series(-1.0, 1.0, 3).unwrap().developments(), [0.5, 1.0, 2.0].map(Development::Exposed));
        let message = series(2.0, 1.0, 2).unwrap_err().to_string();
        assert_eq!(message, "the last exposure must be from the first exposure to 126 stops, not 1");
        assert!(series(0.0, 1.0, 0).is_err() && series(0.0, 1.0, 2561).is_err());
        assert!(series(f32::NAN, 1.0, 2).is_err() && series(0.0, f32::INFINITY, 2).is_err());
    }

    #[test]
    fn what_is_not_a_number_becomes_black() {
        let broken = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        assert_eq!(Development::Exposed(1.0).linear(broken), [0.0; 3]);
        assert_eq!(Development::Code.linear(broken), [0.0, 1.0, 0.0]);
        assert_eq!(Development::Exposed(MAX_STOPS.exp2()).linear([f32::MAX, 0.0, 1.0]), [1.0, 0.0, 1.0]);
    }
}
