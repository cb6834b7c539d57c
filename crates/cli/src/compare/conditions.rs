//! Conditions under which pictures count as different: `flip>0.05`.

use crate::exit::{Exit, Failure};
use lightcuts::image::metrics::{Comparison, Metric};
use miette::{LabeledSpan, MietteDiagnostic, NamedSource, Report};
use std::fmt;
use std::ops::Range;

/// How a value is held against a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Relation {
    Above,
    AtLeast,
    Below,
    AtMost,
    Equal,
    Unequal,
}

/// A metric, a relation and a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Condition {
    pub(super) metric: Metric,
    relation: Relation,
    number: f64,
}

/// A condition that holds, so that the pictures differ.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Failed {
    pub(super) condition: Condition,
    pub(super) value: Option<f64>,
    /// Where Perceptual Image Diff did not pass: how many pixels differ visibly, and from how many on it does not.
    visible: Option<[usize; 2]>,
}

/// What is wrong with the text of a condition, and where.
#[derive(Debug, PartialEq)]
struct Fault {
    span: Range<usize>,
    expected: &'static str,
}

/// Two pixels that are no numbers are no pixels that are the same: this holds whatever else is asked for.
const NON_FINITE: Condition = Condition { metric: Metric::NonFinite, relation: Relation::Above, number: 0.0 };

/// What counts as different unless the command line says so: what a viewer sees. Perceptual Image Diff finds few pixels
/// that differ much, FLIP many that differ a little; 0.05 lies between a gain of 2 % on every pixel, 0.034 for a typical
/// picture, and one of 10 %, 0.107.
const DEFAULT: [Condition; 2] = [
    Condition { metric: Metric::PdiffPass, relation: Relation::Below, number: 1.0 },
    Condition { metric: Metric::FlipLdr, relation: Relation::Above, number: 0.05 },
];

/// What counts beside them where both pictures hold light: a display shows nothing above 1 and hardly anything near 0.
/// HDR-FLIP sees at all exposures what FLIP sees at one; the relative bias sees light that few pixels hold, which no mean
/// over pixels does.
const DEFAULT_OF_LIGHT: [Condition; 2] = [
    Condition { metric: Metric::FlipHdr, relation: Relation::Above, number: 0.05 },
    Condition { metric: Metric::RelBias, relation: Relation::Above, number: 0.1 },
];

/// The conditions of the command line, or the default ones; pixels that are no numbers first.
pub(super) fn conditions(texts: &[String]) -> Result<Vec<Condition>, Failure> {
    let given = texts.iter().map(|text| Condition::parse(text).map_err(|fault| fault.into_failure(text)));
    let given: Vec<Condition> = given.collect::<Result<_, _>>()?;
    let chosen = if given.is_empty() { [DEFAULT, DEFAULT_OF_LIGHT].concat() } else { given };
    let others = chosen.into_iter().filter(|condition| *condition != NON_FINITE);
    Ok(std::iter::once(NON_FINITE).chain(others).collect())
}

/// Without those that are about light, where none were given and a picture holds only what a display shows.
pub(super) fn of_display(conditions: Vec<Condition>, texts: &[String]) -> Vec<Condition> {
    let is_kept = |condition: &Condition| !texts.is_empty() || !DEFAULT_OF_LIGHT.contains(condition);
    conditions.into_iter().filter(is_kept).collect()
}

/// Those that hold, in their order. `threshold` is that of Perceptual Image Diff.
pub(super) fn failed(conditions: &[Condition], comparison: &Comparison, threshold: usize) -> Vec<Failed> {
    let visible = comparison.pdiff.as_ref().filter(|found| !found.pass).map(|found| [found.pixels, threshold]);
    let failing = |condition: &Condition| {
        let value = comparison.value(condition.metric);
        let visible = visible.filter(|_| condition.metric == Metric::PdiffPass);
        let failed = Failed { condition: *condition, value, visible };
        value.is_none_or(|value| condition.holds(value)).then_some(failed)
    };
    conditions.iter().filter_map(failing).collect()
}

impl Condition {
    /// Whether a value is one of a picture that differs; what is not a number is.
    fn holds(&self, value: f64) -> bool {
        let number = self.number;
        value.is_nan()
            || match self.relation {
                Relation::Above => value > number,
                Relation::AtLeast => value >= number,
                Relation::Below => value < number,
                Relation::AtMost => value <= number,
                Relation::Equal => value == number,
                Relation::Unequal => value != number,
            }
    }

    fn parse(text: &str) -> Result<Self, Fault> {
        let start = text.find(['<', '>', '=', '!']).unwrap_or(text.len());
        let metric = trimmed(text, 0..start);
        let name = &text[metric.clone()];
        let metric = name.parse().map_err(|_| Fault { span: metric, expected: KNOWN_METRICS })?;
        let (relation, length) =
            Relation::at(&text[start..]).ok_or(Fault { span: start..text.len(), expected: KNOWN_RELATIONS })?;
        let number = trimmed(text, start + length..text.len());
        match text[number.clone()].parse::<f64>() {
            Ok(value) if !value.is_nan() => Ok(Self { metric, relation, number: value }),
            _ => Err(Fault { span: number, expected: "expected a number" }),
        }
    }
}

const KNOWN_METRICS: &str = "expected the key of a metric; `lightcuts compare --help` lists them";
const KNOWN_RELATIONS: &str = "expected one of > >= < <= == !=";

impl Relation {
    const ALL: [(Self, &'static str); 6] = [
        (Self::AtLeast, ">="),
        (Self::AtMost, "<="),
        (Self::Equal, "=="),
        (Self::Unequal, "!="),
        (Self::Above, ">"),
        (Self::Below, "<"),
    ];

    /// The relation at the start of a text, and its length in bytes; the longer ones come first.
    fn at(text: &str) -> Option<(Self, usize)> {
        let found = Self::ALL.into_iter().find(|(_, symbol)| text.starts_with(symbol));
        found.map(|(relation, symbol)| (relation, symbol.len()))
    }

    fn symbol(self) -> &'static str {
        Self::ALL.into_iter().find(|(relation, _)| *relation == self).map_or("", |(_, symbol)| symbol)
    }
}

/// The part of `text` in `range` without white space at its ends.
fn trimmed(text: &str, range: Range<usize>) -> Range<usize> {
    let part = &text[range.clone()];
    let start = range.start + (part.len() - part.trim_start().len());
    start..(start + part.trim().len())
}

impl Fault {
    /// The text with a mark under the place.
    fn into_failure(self, text: &str) -> Failure {
        let message = format!("--fail {}: {}", text.escape_debug(), self.expected);
        let label = LabeledSpan::new_primary_with_span(Some("here".to_owned()), self.span);
        let diagnostic = MietteDiagnostic::new(message).with_label(label).with_help("such as --fail 'flip>0.05'");
        let report = Report::new(diagnostic).with_source_code(NamedSource::new("--fail", text.to_owned()));
        Failure { exit: Exit::Usage, report }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}{}{}", self.metric.key(), self.relation.symbol(), self.number)
    }
}

impl fmt::Display for Failed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Condition { metric, relation, number } = self.condition;
        if let Some([pixels, threshold]) = self.visible {
            return write!(formatter, "{metric} fail: {pixels} pixels look different (fewer than {threshold} pass)");
        }
        match self.value {
            None => write!(formatter, "{metric} has no value for these pictures"),
            Some(value) if value.is_nan() => write!(formatter, "{metric} is not a number"),
            Some(value) => write!(formatter, "{metric} {} {} {number}", super::text::number(value), relation.symbol()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts::image::metrics::{Measured, PdiffOutcome};

    fn parse(text: &str) -> Condition {
        Condition::parse(text).unwrap()
    }

    fn measured(metric: Metric, value: Option<f64>) -> Comparison {
        Comparison { measured: vec![Measured { metric, value, seconds: 0.0 }], ..Comparison::default() }
    }

    /// What is said of the first condition that holds.
    fn said(text: &str, comparison: &Comparison) -> Option<String> {
        failed(&[parse(text)], comparison, 100).first().map(ToString::to_string)
    }

    #[test]
    fn conditions_are_metric_relation_number() {
        assert_eq!(parse("flip>0.05"), DEFAULT[1]);
        assert_eq!(parse(" flip_ldr > 5e-2 "), DEFAULT[1]);
        assert_eq!(parse("pdiff_pass<1"), DEFAULT[0]);
        for text in ["rmse>=0.001", "mae<=-3", "non_finite!=0", "psnr<inf", "pdiff_px==12", "ssim<0.99"] {
            assert_eq!(parse(text).to_string(), text);
        }
    }

    #[test]
    fn faults_are_placed() {
        let cases = [
            ("", 0..0, KNOWN_METRICS),
            ("flop>1", 0..4, KNOWN_METRICS),
            ("flip", 4..4, KNOWN_RELATIONS),
            ("flip=1", 4..6, KNOWN_RELATIONS),
            ("flip!1", 4..6, KNOWN_RELATIONS),
            (">1", 0..0, KNOWN_METRICS),
            ("flip> x ", 6..7, "expected a number"),
            ("flip>nan", 5..8, "expected a number"),
            ("flip>", 5..5, "expected a number"),
            ("flip>=>1", 6..8, "expected a number"),
            ("größe>1", 0..7, KNOWN_METRICS),
            ("flip>ä", 5..7, "expected a number"),
        ];
        for (text, span, expected) in cases {
            assert_eq!(Condition::parse(text), Err(Fault { span, expected }), "{text:?}");
            let failure = conditions(&[text.to_owned()]).unwrap_err();
            assert!(failure.report.to_string().ends_with(expected), "{text:?}");
        }
    }

    #[test]
    fn relations_mean_what_they_say() {
        for (relation, below, equal, above) in [
            (">", false, false, true),
            (">=", false, true, true),
            ("<", true, false, false),
            ("<=", true, true, false),
            ("==", false, true, false),
            ("!=", true, false, true),
        ] {
            let condition = parse(&format!("mae{relation}1"));
            assert_eq!([0.5, 1.0, 1.5].map(|value| condition.holds(value)), [below, equal, above], "{relation}");
            assert!(condition.holds(f64::NAN), "{relation}");
        }
    }

    #[test]
    fn pixels_that_are_no_numbers_are_always_asked_for_once_and_first() {
        let of = |texts: &[&str]| {
            let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
            conditions(&texts).unwrap().iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        assert_eq!(of(&[]), ["non_finite>0", "pdiff_pass<1", "flip_ldr>0.05", "flip_hdr>0.05", "relbias>0.1"]);
        assert_eq!(of(&["mae>1"]), ["non_finite>0", "mae>1"]);
        assert_eq!(of(&["mae>1", "non_finite>0"]), ["non_finite>0", "mae>1"]);
    }

    #[test]
    fn what_a_display_shows_is_not_judged_as_light_unless_that_is_asked_for() {
        let of = |texts: &[&str]| {
            let texts: Vec<String> = texts.iter().map(|text| (*text).to_owned()).collect();
            let kept = of_display(conditions(&texts).unwrap(), &texts);
            kept.iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        assert_eq!(of(&[]), ["non_finite>0", "pdiff_pass<1", "flip_ldr>0.05"]);
        assert_eq!(of(&["flip_hdr>0.05"]), ["non_finite>0", "flip_hdr>0.05"]);
    }

    #[test]
    fn what_failed_is_said_in_words() {
        let of = |value| said("ssim<0.99", &measured(Metric::Ssim, value));
        assert_eq!(of(Some(0.995)), None);
        assert_eq!(of(Some(0.5)).as_deref(), Some("ssim 0.5 < 0.99"));
        assert_eq!(of(Some(f64::NAN)).as_deref(), Some("ssim is not a number"));
        assert_eq!(of(None).as_deref(), Some("ssim has no value for these pictures"));
    }

    #[test]
    fn visible_pixels_are_said_with_their_limit() {
        let mask = lightcuts::image::Plane::filled(1, 1, true);
        let found = |pass, value| Comparison {
            pdiff: Some(PdiffOutcome { pixels: 523, pass, error_sum: 0.0, mask: mask.clone() }),
            ..measured(Metric::PdiffPass, Some(value))
        };
        let expected = "pdiff_pass fail: 523 pixels look different (fewer than 100 pass)";
        assert_eq!(said("pdiff_pass<1", &found(false, 0.0)).as_deref(), Some(expected));
        assert_eq!(said("pdiff_pass>0", &found(true, 1.0)).as_deref(), Some("pdiff_pass 1 > 0"));
    }
}
