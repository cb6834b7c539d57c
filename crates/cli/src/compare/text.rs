//! What was found, for people.

use super::Outcome;
use lightcuts::image::metrics::{Bias, Comparison, Measured, Metric};
use std::fmt::Write;

/// Digits that are told of a value; `--json` tells all.
const DIGITS: usize = 6;

/// Header and table, what the metrics found beside their values, and the verdict.
pub(super) fn text(outcome: &Outcome<'_>) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let mut line = |name: &str, value: &str| {
        let _ = writeln!(text, "{name:<12} {value}");
    };
    let (picture, comparison) = (&outcome.inputs.reference, outcome.comparison);
    line("reference", &outcome.args.reference.display().to_string());
    line("test", &outcome.args.test.display().to_string());
    line("size", &format!("{} x {}, channels {}", picture.width(), picture.height(), outcome.inputs.channels));
    for [name, rest] in table(comparison) {
        line(&name, &rest);
    }
    if let Some(found) = &comparison.flip_hdr {
        let [start, stop] = [found.start, found.stop].map(|stops| number(f64::from(stops)));
        line("exposures", &format!("{} from {start} to {stop} stops", found.count));
    }
    if let Some(bias) = &comparison.bias {
        line("bias test", &bias_test(bias));
    }
    for path in outcome.written {
        line("wrote", &path.display().to_string());
    }
    line("verdict", &verdict(outcome));
    text
}

/// `same`, or `differs` with every condition that holds.
fn verdict(outcome: &Outcome<'_>) -> String {
    let reasons: Vec<_> = outcome.failed.iter().map(ToString::to_string).collect();
    if reasons.is_empty() { "same".to_owned() } else { format!("differs: {}", reasons.join(", ")) }
}

/// Per metric its key, and the aligned rest of its line; first the titles of the columns.
fn table(comparison: &Comparison) -> Vec<[String; 2]> {
    let rows = comparison.measured.iter().map(|Measured { metric, value, seconds }| {
        let cells = [told(*metric, *value), metric.unit().to_owned(), format!("{seconds:.3}")];
        (metric.key(), cells, meaning(*metric))
    });
    let titles = ("metric", ["value", "unit", "seconds"].map(str::to_owned), "meaning");
    let rows: Vec<_> = std::iter::once(titles).chain(rows).collect();
    let width = |column: usize| rows.iter().map(|(_, cells, _)| cells[column].chars().count()).max().unwrap_or(0);
    let [value_width, unit_width, seconds_width] = [0, 1, 2].map(width);
    let aligned = |(name, [value, unit, seconds], meaning): &(&str, [String; 3], &str)| {
        let rest = format!("{value:>value_width$} {unit:<unit_width$}  {seconds:>seconds_width$}  {meaning}");
        [(*name).to_owned(), rest]
    };
    rows.iter().map(aligned).collect()
}

fn told(metric: Metric, value: Option<f64>) -> String {
    match value {
        None => "none".to_owned(),
        Some(value) if metric == Metric::PdiffPass => if value < 1.0 { "fail" } else { "pass" }.to_owned(),
        Some(value) => number(value),
    }
}

/// A number with few digits, in powers of ten where it is far from 1.
pub(super) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if !value.is_finite() || value.fract() == 0.0 && magnitude < 1e15 {
        return value.to_string();
    }
    if !(1e-4..1e6).contains(&magnitude) {
        let text = format!("{value:.*e}", DIGITS - 1);
        return text.split_once('e').map_or(text.clone(), |(digits, power)| format!("{}e{power}", trimmed(digits)));
    }
    let before_point = magnitude.log10().floor() as i32 + 1; // 0 and below: zeros after the point
    let decimals = (DIGITS as i32 - before_point).max(0) as usize;
    trimmed(&format!("{value:.decimals$}")).to_owned()
}

/// The digits without zeros at the end of a fraction.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

fn bias_test(bias: &Bias) -> String {
    let mut text = format!("z {}, p {}", number(bias.z), number(bias.p));
    let _ = write!(text, "; {} of {} regions biased", bias.significant, bias.regions);
    if let Some(worst) = bias.worst {
        let (region, mean, z, p) = (worst.region, number(worst.mean), number(worst.z), number(worst.p));
        let place = format!("{} x {} at column {}, row {}", region.width, region.height, region.x, region.y);
        let _ = write!(text, "; worst {place}: mean {mean}, z {z}, p {p}");
    }
    text
}

/// What a metric says, in few words.
fn meaning(metric: Metric) -> &'static str {
    match metric {
        Metric::NonFinite => "pixels with NaN or infinity, of both pictures",
        Metric::PdiffPx => "pixels that look different (Yee 2004)",
        Metric::PdiffPass => "whether those are few",
        Metric::FlipLdr => "difference seen when flipping; 0 none, 1 greatest",
        Metric::FlipHdr => "the same at the worst exposure",
        Metric::Mse => "mean squared error",
        Metric::Rmse => "its root",
        Metric::Mae => "mean absolute error",
        Metric::RelMse => "squared error / (reference^2 + 0.01)",
        Metric::Mrse => "squared (error / (reference + 0.01))",
        Metric::Smape => "|error| / (|reference| + |test| + 0.01)",
        Metric::Ssim => "similarity of structure; 1 equal",
        Metric::Psnr => "signal to noise of what is shown; inf equal",
        Metric::Bias => "mean of test - reference",
        Metric::RelBias => "its magnitude over the mean of the reference",
        Metric::Fireflies => "lone pixels far too bright",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_few_digits() {
        let cases = [
            (0.0, "0"),
            (4096.0, "4096"),
            (0.123_456_789, "0.123457"),
            (0.05, "0.05"),
            (-12.5, "-12.5"),
            (123_456.7, "123457"),
            (999_999.6, "1000000"),
            (1_234_567.5, "1.23457e6"),
            (0.000_123_456_78, "0.000123457"),
            (0.000_01, "1e-5"),
            (-0.000_082_197_04, "-8.2197e-5"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ];
        for (value, expected) in cases {
            assert_eq!(number(value), expected);
        }
    }
}
