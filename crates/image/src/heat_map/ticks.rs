//! Round numbers for scales, and how they are written.

/// Numbers that are marked on a scale, all written with the same precision.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// The numbers in ascending order with their text.
    pub(super) marks: Vec<(f64, String)>,
}

impl Ticks {
    /// The finest series of multiples of a round step (1, 2 or 5 times a power of ten) inside `low..=high` that
    /// `fits`; the coarsest that has two numbers where none does.
    pub(super) fn new(low: f64, high: f64, fits: impl Fn(&Self) -> bool) -> Self {
        let candidates = round_steps(high - low).map(|step| Self::with_step(low, high, step));
        let mut candidates: Vec<Self> = candidates.filter(|ticks| ticks.marks.len() > 1).collect();
        let chosen = candidates.iter().position(fits).unwrap_or(candidates.len() - 1);
        candidates.swap_remove(chosen)
    }

    /// The coarsest series with at least two numbers: what every scale must have room for.
    pub(super) fn coarsest(low: f64, high: f64) -> Self {
        Self::new(low, high, |_| false)
    }

    fn with_step(low: f64, high: f64, step: f64) -> Self {
        // A little tolerance keeps an end of the scale that rounding has put just outside.
        let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
        let greatest = low.abs().max(high.abs());
        let mark = |i: i64| (i as f64 * step, number(i as f64 * step, step, greatest));
        Self { marks: (first..=last).map(mark).collect() }
    }
}

/// Round steps from a fiftieth of the range to the whole range, ascending.
fn round_steps(range: f64) -> impl Iterator<Item = f64> {
    let exponent = range.log10().floor() as i32;
    let steps = (exponent - 2..=exponent).flat_map(|k| [1.0, 2.0, 5.0].map(|digit| digit * 10.0_f64.powi(k)));
    steps.filter(move |step| range / step > 0.999 && range / step < 50.0)
}

/// The smallest of 1, 2 and 5 times a power of ten that is at least `value`; 1 for 0.
pub(super) fn nice_bound(value: f32) -> f32 {
    if value <= 0.0 {
        return 1.0;
    }
    let exponent = value.log10().floor() as i32;
    let candidates =
        [1.0, 2.0, 5.0, 10.0].map(|digit| (digit * 10.0_f64.powi(exponent)).min(f64::from(f32::MAX)) as f32);
    candidates.into_iter().find(|bound| *bound >= value).unwrap_or(f32::MAX)
}

/// The text of a multiple of `step` on a scale whose numbers reach `greatest`.
fn number(value: f64, step: f64, greatest: f64) -> String {
    let digits_after_point = (-step.log10() - 1e-6).ceil().max(0.0);
    if (1e-4..1e5).contains(&greatest) && digits_after_point <= 5.0 {
        return without_trailing_zeros(&format!("{value:.*}", digits_after_point as usize));
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (value.abs().log10().floor() - step.log10().floor()).max(0.0);
    let text = format!("{value:.*e}", digits as usize);
    let (mantissa, exponent) = text.split_once('e').expect("the format has an exponent");
    format!("{}e{exponent}", without_trailing_zeros(mantissa))
}

fn without_trailing_zeros(text: &str) -> String {
    let shortened = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text };
    if shortened == "-0" { "0".to_owned() } else { shortened.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(low: f64, high: f64, most: usize) -> Vec<String> {
        Ticks::new(low, high, |ticks| ticks.marks.len() <= most).marks.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn round_numbers_as_many_as_fit() {
        assert_eq!(texts(0.0, 1.0, 11), ["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"]);
        assert_eq!(texts(0.0, 1.0, 6), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(texts(0.0, 1.0, 3), ["0", "0.5", "1"]);
        assert_eq!(texts(0.0, 1.0, 0), ["0", "1"]);
        assert_eq!(texts(-0.02, 0.02, 5), ["-0.02", "-0.01", "0", "0.01", "0.02"]);
        assert_eq!(texts(0.0, 0.0237, 3), ["0", "0.01", "0.02"]);
        assert_eq!(texts(0.0, 20_000.0, 3), ["0", "10000", "20000"]);
    }

    #[test]
    fn very_small_and_large_numbers_have_exponents() {
        assert_eq!(texts(-5e-7, 5e-7, 3), ["-5e-7", "0", "5e-7"]);
        assert_eq!(texts(0.0, 2e8, 5), ["0", "5e7", "1e8", "1.5e8", "2e8"]);
        assert_eq!(texts(0.0, 2e30, 3), ["0", "1e30", "2e30"]);
    }

    #[test]
    fn every_range_has_two_different_numbers_inside() {
        let ends = [
            -3e38,
            -1e5,
            -0.3,
            -1e-38,
            0.0,
            1e-44,
            1e-5,
            0.37,
            1.0,
            1.000_001,
            9.99,
            1e4,
            16_777_216.0,
            16_777_217.0,
            3e38,
        ];
        for (i, low) in ends.iter().enumerate() {
            for high in &ends[i + 1..] {
                for ticks in [Ticks::coarsest(*low, *high), Ticks::new(*low, *high, |ticks| ticks.marks.len() < 12)] {
                    assert!(ticks.marks.len() >= 2, "{low} to {high}");
                    let slack = 1e-6 * (high - low);
                    assert!(
                        ticks.marks.iter().all(|(v, _)| (low - slack..=high + slack).contains(v)),
                        "{low} to {high}"
                    );
                    assert!(ticks.marks.windows(2).all(|pair| pair[0].1 != pair[1].1), "{low} to {high}: {ticks:?}");
                }
            }
        }
    }

    #[test]
    fn bounds_are_round_and_not_below() {
        for (value, bound) in
            [(0.0, 1.0), (1.0, 1.0), (1.01, 2.0), (0.037, 0.05), (0.06, 0.1), (7e-12, 1e-11), (600.0, 1000.0)]
        {
            assert_eq!(nice_bound(value), bound);
        }
        assert_eq!(nice_bound(f32::MAX), f32::MAX);
        assert!(nice_bound(1e-45) >= 1e-45);
    }
}
