//! Quantities of curves: their words, and their values of a row.

use crate::layout::Quantity;
use crate::record::{ConfigurationInfo, Row};
use crate::report::device::told_pass_seconds;
use crate::report::measured::Spread;
use crate::report::number::significant;
use crate::report::section::{self, agreement};
use lightcuts::Stage;
use lightcuts::image::metrics::Metric;

/// What is on the y axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::report::section) enum Kind {
    TimePerPixel,
    TimePerVpl,
    ShadowRays,
    LightRatio,
    Metric(Metric),
}

impl Kind {
    /// The message says that there is no such metric.
    pub(in crate::report::section) fn of(quantity: &Quantity) -> Result<Self, String> {
        Ok(match quantity {
            Quantity::TimePerPixel => Self::TimePerPixel,
            Quantity::TimePerVpl => Self::TimePerVpl,
            Quantity::ShadowRays => Self::ShadowRays,
            Quantity::LightRatio => Self::LightRatio,
            Quantity::Metric(key) => Self::Metric(section::metric(key)?),
        })
    }

    pub(super) fn title(self) -> String {
        match self {
            Self::TimePerPixel => "Processor time per pixel, µs".to_owned(),
            Self::TimePerVpl => "Processor time per pixel and VPL, ns".to_owned(),
            Self::ShadowRays => "Shadow rays per pixel and VPL".to_owned(),
            Self::LightRatio => "Light ratio, %".to_owned(),
            Self::Metric(metric) if metric.unit().is_empty() => metric.title().to_owned(),
            Self::Metric(metric) => format!("{}, {}", metric.title(), metric.unit()),
        }
    }

    /// Within a sentence.
    pub(super) fn name(self) -> String {
        match self {
            Self::TimePerPixel => "processor time per pixel".to_owned(),
            Self::TimePerVpl => "processor time per pixel and VPL".to_owned(),
            Self::ShadowRays => "shadow rays per pixel and VPL".to_owned(),
            Self::LightRatio => "light ratio".to_owned(),
            Self::Metric(metric) => metric.title().to_owned(),
        }
    }

    /// A value with its unit.
    pub(super) fn value(self, value: f64) -> String {
        let value = significant(value);
        match self {
            Self::TimePerPixel => format!("{value} µs per pixel"),
            Self::TimePerVpl => format!("{value} ns per pixel and VPL"),
            Self::ShadowRays => format!("{value} shadow rays per pixel and VPL"),
            Self::LightRatio => format!("a light ratio of {value} %"),
            Self::Metric(metric) => format!("{} {value}", metric.title()),
        }
    }

    /// How the smaller one is called.
    pub(super) fn smaller(self) -> &'static str {
        if self.is_time() { "faster" } else { "lower" }
    }

    pub(super) fn is_time(self) -> bool {
        matches!(self, Self::TimePerPixel | Self::TimePerVpl)
    }

    /// The one value that stands for several runs: of times the least, for noise only ever adds to them.
    pub(super) fn of_runs(self, spread: &Spread) -> f64 {
        if self.is_time() { spread.least } else { spread.mean }
    }

    pub(super) fn of_row(self, row: &Row, configuration: &ConfigurationInfo) -> Option<f64> {
        let pixels = row.width as f64 * row.height as f64;
        let pixels_and_vpls = pixels * row.stats.vpl_count as f64;
        let value = match self {
            Self::TimePerPixel => 1e6 * gathering_s(row) / pixels,
            Self::TimePerVpl => 1e9 * gathering_s(row) / pixels_and_vpls,
            Self::ShadowRays => row.stats.rays.shadow as f64 / pixels_and_vpls,
            Self::LightRatio => row.stats.light_ratio_percent,
            Self::Metric(metric) => agreement::value(row, configuration.references.first()?, metric)?,
        };
        Some(value).filter(|value| value.is_finite())
    }
}

/// Time of the light tree and the second pass, in seconds: processor time, of GPUs elapsed time.
fn gathering_s(row: &Row) -> f64 {
    let shading = [Stage::LightTree.name(), Stage::SecondPass.name()];
    row.stats
        .passes
        .iter()
        .filter(|pass| shading.contains(&pass.name.as_ref()))
        .map(|pass| told_pass_seconds(row, pass))
        .sum()
}
