//! Axes: from numbers to pixels, with round numbers as ticks.

use crate::report::number::as_printed;

/// Values beyond are drawn at the edge.
const LARGEST: f64 = 1e15;
/// Most ticks of an axis.
const MOST_TICKS: usize = 11;
/// Fewest ticks of a logarithmic axis at 1, 2 and 5 times powers of ten; an axis with fewer has them at equal steps.
const FEWEST_TICKS: usize = 4;
/// Least factor between the ends of a logarithmic axis.
const LEAST_FACTOR: f64 = 1.5;

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    from: f64,
    to: f64,
    logarithmic: bool,
    /// Pixels of `from` and `to`.
    pixels: (i32, i32),
    ticks: Vec<f64>,
}

impl Scale {
    /// From 0, or below, to at least the greatest value; both ends are ticks.
    pub(super) fn linear(values: impl Iterator<Item = f64>, pixels: (i32, i32)) -> Self {
        let (mut least, mut greatest) = (0f64, 0f64);
        for value in values.map(|value| value.clamp(-LARGEST, LARGEST)) {
            (least, greatest) = (least.min(value), greatest.max(value));
        }
        if least == greatest {
            greatest = 1.0;
        }
        let step = round_step((greatest - least) / 6.0);
        let (first, last) = ((least / step).floor() as i64, (greatest / step).ceil() as i64);
        let ticks: Vec<f64> = (first..=last).map(|k| k as f64 * step).collect();
        Self { from: first as f64 * step, to: last as f64 * step, logarithmic: false, pixels, ticks }
    }

    /// Around the values, which are above 0.
    pub(super) fn logarithmic(values: impl Iterator<Item = f64>, pixels: (i32, i32)) -> Self {
        let (mut least, mut greatest) = (f64::INFINITY, 0f64);
        for value in values.map(|value| value.clamp(1.0 / LARGEST, LARGEST)) {
            (least, greatest) = (least.min(value), greatest.max(value));
        }
        if greatest == 0.0 {
            (least, greatest) = (1.0, 10.0);
        }
        // A little room, and more around values that are nearly the same.
        let room = (LEAST_FACTOR.sqrt() / (greatest / least).sqrt()).max(1.12);
        let (from, to) = (least / room, greatest * room);
        Self { from, to, logarithmic: true, pixels, ticks: powers(from, to) }
    }

    pub(super) fn ticks(&self) -> impl Iterator<Item = f64> + '_ {
        self.ticks.iter().copied()
    }

    /// Where a value lies; the nearer edge for one outside.
    pub(super) fn pixel(&self, value: f64) -> i32 {
        let share = if self.logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        };
        let (first, last) = self.pixels;
        (f64::from(first) + share.clamp(0.0, 1.0) * f64::from(last - first)).round() as i32
    }
}

/// The least of 1, 2 and 5 times a power of ten that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|digit| digit * power).find(|round| *round >= step).unwrap_or(10.0 * power)
}

/// 1, 2 and 5 times powers of ten, or fewer where there are too many.
fn powers(from: f64, to: f64) -> Vec<f64> {
    let decades = (from.log10().floor() as i32)..=(to.log10().ceil() as i32);
    let ticks = |digits: &[f64], stride: usize| -> Vec<f64> {
        let powers = decades.clone().filter(|decade| decade.rem_euclid(stride as i32) == 0);
        let numbers = powers.flat_map(|decade| digits.iter().map(move |digit| power_of_ten(*digit, decade)));
        numbers.filter(|number| (from..=to).contains(number)).collect()
    };
    let fine = ticks(&[1.0, 2.0, 5.0], 1);
    match fine.len() {
        0..FEWEST_TICKS => multiples(from, to),
        FEWEST_TICKS..=MOST_TICKS => fine,
        _ => ticks(&[1.0], decades.clone().count() / MOST_TICKS + 1),
    }
}

/// Multiples of a round step.
fn multiples(from: f64, to: f64) -> Vec<f64> {
    let step = round_step((to - from) / 6.0);
    let (first, last) = ((from / step).ceil() as i64, (to / step).floor() as i64);
    (first..=last).map(|k| k as f64 * step).collect()
}

/// Through text, so that 2 * 10^-4 is the number that 0.0002 is.
fn power_of_ten(digit: f64, exponent: i32) -> f64 {
    format!("{digit}e{exponent}").parse().unwrap_or(digit)
}

/// A tick's number, with a true minus sign.
pub(super) fn label(tick: f64) -> String {
    // Multiples of a step such as 0.2 carry rounding errors.
    let rounded: f64 = format!("{tick:.6e}").parse().unwrap_or(tick);
    let text = if rounded != 0.0 && rounded.abs() < 1e-3 { format!("{rounded:e}") } else { as_printed(rounded) };
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_axes_hold_zero_and_end_at_ticks() {
        let scale = Scale::linear([-88.3, 476.5].into_iter(), (400, 0));
        assert_eq!(scale.ticks().collect::<Vec<_>>(), [-100.0, 0.0, 100.0, 200.0, 300.0, 400.0, 500.0]);
        assert_eq!([scale.pixel(-100.0), scale.pixel(500.0), scale.pixel(200.0)], [400, 0, 200]);
        let nothing = Scale::linear([].into_iter(), (10, 0));
        assert_eq!((nothing.pixel(0.0), nothing.pixel(1.0)), (10, 0));
    }

    #[test]
    fn logarithmic_axes_have_round_ticks() {
        let scale = Scale::logarithmic([64.0, 65_536.0].into_iter(), (0, 1000));
        let expected = [100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4];
        assert_eq!(scale.ticks().collect::<Vec<_>>(), expected);
        // Equal factors are equal distances.
        let steps: Vec<i32> = (6..=16).map(|k| scale.pixel(2f64.powi(k))).collect();
        assert!(steps.windows(2).all(|pair| (pair[1] - pair[0] - (steps[10] - steps[0]) / 10).abs() <= 1), "{steps:?}");
    }

    #[test]
    fn narrow_logarithmic_axes_have_ticks_at_equal_steps() {
        let scale = Scale::logarithmic([52.0, 61.0].into_iter(), (0, 100));
        assert_eq!(scale.ticks().collect::<Vec<_>>(), [50.0, 55.0, 60.0, 65.0]);
        // The values take a good part of it.
        assert!(scale.pixel(61.0) - scale.pixel(52.0) > 35, "{scale:?}");
    }

    #[test]
    fn wide_and_narrow_ranges_have_a_few_ticks() {
        for values in [[1e-12, 1e12], [0.03, 0.031], [7.0, 7.0], [1e-300, 1e300], [1.0, 1e9]] {
            let count = Scale::logarithmic(values.into_iter(), (0, 100)).ticks().count();
            assert!((2..=MOST_TICKS).contains(&count), "{values:?}: {count}");
        }
        for values in [[0.0, 1e300], [-1e-9, 0.0], [0.0, 0.07]] {
            let count = Scale::linear(values.into_iter(), (0, 100)).ticks().count();
            assert!((2..=MOST_TICKS).contains(&count), "{values:?}: {count}");
        }
    }

    #[test]
    fn labels_are_what_people_write() {
        assert_eq!(
            [label(-100.0), label(0.2 * 3.0), label(20_000.0), label(2e-4)],
            ["\u{2212}100", "0.6", "20,000", "2e\u{2212}4"]
        );
    }
}
