//! Pictures of numbers: false colours with a scale below.

mod font;
mod panel;
mod ticks;

use rayon::prelude::*;

use crate::{ColorMap, Image, Plane};
use panel::Panel;
use ticks::nice_bound;

/// Where the values of a map are nearly all inside the scale: the rest, a few fireflies, must not darken the others.
const INSIDE: f64 = 0.995;

/// How numbers are shown as colours.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// The colours.
    pub map: ColorMap,
    /// The number that has the first colour. Smaller ones have it too.
    pub low: f32,
    /// The number that has the last colour. Greater ones have it too. Unless `low` and `high` are finite and
    /// `low < high`, the scale is 0 to 1.
    pub high: f32,
    /// What the numbers are, with their unit; broken between words into as many lines as it needs. May be empty.
    pub label: String,
}

impl HeatMap {
    /// A map of FLIP errors: magma from 0 to 1, as in the papers.
    pub fn flip(label: impl Into<String>) -> Self {
        Self { map: ColorMap::Magma, low: 0.0, high: 1.0, label: label.into() }
    }

    /// A map of values from 0 on, in viridis. The scale ends at a round number (1, 2 or 5 times a power of ten) that at
    /// least 99.5 % of the finite values do not exceed.
    pub fn magnitude(values: &Plane<f32>, label: impl Into<String>) -> Self {
        Self { map: ColorMap::Viridis, low: 0.0, high: round_bound(values), label: label.into() }
    }

    /// A map of signed values, blue below 0 and red above, for example of luminance, test minus reference. The scale is
    /// symmetric and ends as that of [`Self::magnitude`] does.
    pub fn signed(values: &Plane<f32>, label: impl Into<String>) -> Self {
        let high = round_bound(values);
        Self { map: ColorMap::Diverging, low: -high, high, label: label.into() }
    }

    /// The ends of the scale, always finite and in order.
    fn range(&self) -> (f64, f64) {
        let usable = self.low.is_finite() && self.high.is_finite() && self.low < self.high;
        if usable { (f64::from(self.low), f64::from(self.high)) } else { (0.0, 1.0) }
    }
}

/// The round number that bounds [`INSIDE`] of the magnitudes; where those are all 0, all of them; 1 where nothing is
/// left.
fn round_bound(values: &Plane<f32>) -> f32 {
    let mut magnitudes: Vec<f32> = values.pixels().iter().filter(|v| v.is_finite()).map(|v| v.abs()).collect();
    let rank = ((INSIDE * magnitudes.len() as f64).ceil() as usize).saturating_sub(1);
    let greatest = magnitudes.iter().copied().fold(0.0, f32::max);
    let typical = if magnitudes.is_empty() { 0.0 } else { *magnitudes.select_nth_unstable_by(rank, f32::total_cmp).1 };
    nice_bound(if typical > 0.0 { typical } else { greatest })
}

/// The values in false colours above a scale with numbers and the label: sRGB code values 0..=1, to be written with
/// [`Transfer::Linear`](crate::Transfer::Linear).
///
/// Value (x, y) is pixel (x, y), or further right in the middle where the scale needs more width than the values have.
/// Numbers and label grow with the width by whole factors. NaN is cyan, and the label says so. An empty plane gives the
/// scale alone.
pub fn heat_map(values: &Plane<f32>, style: &HeatMap) -> Image {
    let (low, high) = style.range();
    let mut label = style.label.clone();
    if values.pixels().iter().any(|value| value.is_nan()) {
        label.push_str("\ncyan: not a number");
    }
    let panel = Panel::new(style.map, low, high, &label, values.width());
    let (height, left) = (values.height(), (panel.width() - values.width()) / 2);
    let mut picture = Image::filled(panel.width(), height + panel.height(), panel::PAPER);
    let rows = picture.pixels_mut().par_chunks_mut(panel.width()).take(height);
    rows.enumerate().for_each(|(y, row)| {
        for (pixel, value) in row[left..].iter_mut().zip(values.row(y)) {
            *pixel = style.map.at(((f64::from(*value) - low) / (high - low)) as f32);
        }
    });
    panel.draw(&mut picture, height);
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Plane<f32> {
        Plane::from_fn(200, 20, |x, _| x as f32 / 199.0)
    }

    #[test]
    fn values_have_the_colours_of_the_scale_below_them() {
        let values = ramp();
        let picture = heat_map(&values, &HeatMap::flip("FLIP error"));
        assert_eq!(picture.width(), 200);
        assert!(picture.height() > 20 + 30);
        for x in 0..200 {
            assert_eq!(picture.get(x, 7), ColorMap::Magma.at(values.get(x, 7)));
        }
        // Some row of the panel shows the whole gradient between its frame.
        let row = (20..picture.height()).find(|y| picture.get(6, *y) == ColorMap::Magma.at(0.0)).unwrap();
        assert_eq!(picture.get(193, row), ColorMap::Magma.at(1.0));
        let middle = [picture.get(99, row), picture.get(100, row)];
        assert!(middle.iter().all(|color| (color[0] - ColorMap::Magma.at(0.5)[0]).abs() < 0.02));
    }

    #[test]
    fn tiny_and_empty_planes_get_a_readable_scale() {
        for (width, height) in [(0, 0), (1, 1), (0, 5), (64, 64)] {
            let picture = heat_map(&Plane::filled(width, height, 1.0), &HeatMap::flip("FLIP"));
            assert!(picture.width() >= 40 && picture.height() >= height + 30);
            let dark = picture.pixels().iter().filter(|pixel| **pixel != panel::PAPER).count();
            assert!(dark > 200, "{width} x {height}: {dark} pixels drawn");
        }
    }

    #[test]
    fn ranges_that_are_none_are_replaced() {
        let values = ramp();
        let style = |low, high| HeatMap { map: ColorMap::Viridis, low, high, label: String::new() };
        let expected = heat_map(&values, &style(0.0, 1.0));
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f32::NAN, 1.0), (0.0, f32::INFINITY)] {
            assert_eq!(heat_map(&values, &style(low, high)), expected);
        }
        heat_map(&values, &style(-f32::MAX, f32::MAX));
        heat_map(&values, &style(1.0, 1.0_f32.next_up()));
    }

    #[test]
    fn scales_are_round_symmetric_and_not_ruled_by_fireflies() {
        let mut values = Plane::from_fn(100, 100, |x, y| if (x + y) % 2 == 0 { 0.03 } else { -0.04 });
        values.set(3, 3, 1e6);
        values.set(4, 4, f32::NAN);
        values.set(5, 5, f32::INFINITY);
        let signed = HeatMap::signed(&values, "luminance");
        assert_eq!((signed.low, signed.high, signed.map), (-0.05, 0.05, ColorMap::Diverging));
        let magnitude = HeatMap::magnitude(&values, "error");
        assert_eq!((magnitude.low, magnitude.high), (0.0, 0.05));
        assert_eq!(HeatMap::magnitude(&Plane::new(5, 5), "").high, 1.0);
        assert_eq!(HeatMap::magnitude(&Plane::new(0, 0), "").high, 1.0);
        let mut rare = Plane::new(100, 100);
        rare.set(1, 1, 3.0);
        assert_eq!(HeatMap::magnitude(&rare, "").high, 5.0, "a single error is still seen");
    }

    #[test]
    fn what_is_not_a_number_is_cyan_and_explained() {
        let mut values = ramp();
        let plain = heat_map(&values, &HeatMap::flip("FLIP"));
        values.set(9, 9, f32::NAN);
        let picture = heat_map(&values, &HeatMap::flip("FLIP"));
        assert_eq!(picture.get(9, 9), ColorMap::NAN);
        assert!(picture.height() > plain.height());
    }
}
