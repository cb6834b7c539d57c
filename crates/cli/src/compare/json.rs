//! What was found, for machines: one object, the metrics at its top.

use super::Outcome;
use super::conditions::Failed;
use crate::exit::Failure;
use lightcuts::image::Transfer;
use lightcuts::image::metrics::flip::Exposures;
use lightcuts::image::metrics::{Bias, Comparison, Metric, MetricOptions, PerceptualDiff, Region};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

/// The whole object. Numbers that JSON lacks, NaN and infinities, are null.
#[derive(Serialize)]
struct Report<'a> {
    reference: String,
    test: String,
    width: usize,
    height: usize,
    channels: String,
    verdict: &'static str,
    failed: Vec<FailedText>,
    #[serde(flatten)]
    values: Values<'a>,
    /// Whether every pixel is shown alike: `psnr` is null then, being infinite.
    same_display: bool,
    /// Whether all light is equal; a NaN equals nothing.
    same_light: bool,
    non_finite_pixels: NonFinitePixels,
    /// What standard error was told of how the files were read.
    warnings: &'a [String],
    exposures: Option<Series>,
    bias_test: Option<BiasTest>,
    seconds: Seconds<'a>,
    read_seconds: f64,
    threads: usize,
    options: Options<'a>,
    maps: Vec<String>,
}

#[derive(Serialize)]
struct FailedText {
    condition: String,
    value: Option<f64>,
    reason: String,
}

/// Every metric's value by its key.
struct Values<'a>(&'a Comparison);

/// Every metric's time by its key.
struct Seconds<'a>(&'a Comparison);

#[derive(Serialize)]
struct NonFinitePixels {
    reference: usize,
    test: usize,
}

#[derive(Serialize)]
struct Series {
    start: f32,
    stop: f32,
    count: u32,
}

#[derive(Serialize)]
struct BiasTest {
    mean: f64,
    z: f64,
    p: f64,
    regions: usize,
    significant: usize,
    worst: Option<WorstRegion>,
}

#[derive(Serialize)]
struct WorstRegion {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
    mean: f64,
    z: f64,
    p: f64,
}

#[derive(Serialize)]
struct Options<'a> {
    transfer: Transfer,
    layer: Option<&'a str>,
    ignore_alpha: bool,
    ignore_windows: bool,
    conditions: Vec<String>,
    pdiff: PdiffOptions,
    flip: FlipOptions,
    bias_regions: usize,
}

#[derive(Serialize)]
struct PdiffOptions {
    fov: f32,
    gamma: f32,
    luminance: f32,
    threshold: usize,
    luminance_only: bool,
    color_factor: f32,
    downsample: u32,
    channels: &'static str,
}

#[derive(Serialize)]
struct FlipOptions {
    pixels_per_degree: f32,
    /// `auto`, or what was given.
    exposures: ExposureOption,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ExposureOption {
    Automatic(&'static str),
    Fixed(Series),
}

/// The object as text.
pub(super) fn json(outcome: &Outcome<'_>) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(&Report::new(outcome));
    text.map(|text| text + "\n").map_err(|error| Failure::output(format!("cannot write the comparison: {error}")))
}

impl<'a> Report<'a> {
    fn new(outcome: &'a Outcome<'a>) -> Self {
        let (args, inputs, comparison) = (outcome.args, outcome.inputs, outcome.comparison);
        let found = &comparison.non_finite;
        Self {
            reference: args.reference.display().to_string(),
            test: args.test.display().to_string(),
            width: inputs.reference.width(),
            height: inputs.reference.height(),
            channels: inputs.channels.to_string(),
            verdict: if outcome.failed.is_empty() { "same" } else { "differs" },
            failed: outcome.failed.iter().map(FailedText::new).collect(),
            values: Values(comparison),
            same_display: inputs.reference.display() == inputs.test.display(),
            same_light: inputs.reference.linear() == inputs.test.linear(),
            non_finite_pixels: NonFinitePixels { reference: found.reference, test: found.test },
            warnings: &inputs.warnings,
            exposures: comparison.flip_hdr.as_ref().map(|found| Series {
                start: found.start,
                stop: found.stop,
                count: found.count,
            }),
            bias_test: comparison.bias.as_ref().map(BiasTest::new),
            seconds: Seconds(comparison),
            read_seconds: inputs.seconds,
            threads: rayon::current_num_threads(),
            options: Options::new(outcome),
            maps: outcome.written.iter().map(|path| path.display().to_string()).collect(),
        }
    }
}

impl FailedText {
    fn new(failed: &Failed) -> Self {
        Self { condition: failed.condition.to_string(), value: failed.value, reason: failed.to_string() }
    }
}

impl Serialize for Values<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.measured.len()))?;
        for measured in &self.0.measured {
            let (key, value) = (measured.metric.key(), measured.value);
            match measured.metric {
                Metric::PdiffPass => map.serialize_entry(key, &value.map(|value| value > 0.0))?,
                Metric::NonFinite | Metric::PdiffPx | Metric::Fireflies => {
                    map.serialize_entry(key, &value.map(|count| count as u64))?;
                }
                _ => map.serialize_entry(key, &value)?,
            }
        }
        map.end()
    }
}

impl Serialize for Seconds<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.measured.iter().map(|measured| (measured.metric.key(), measured.seconds)))
    }
}

impl BiasTest {
    fn new(bias: &Bias) -> Self {
        let worst = bias.worst.map(|worst| {
            let Region { x, y, width, height } = worst.region;
            WorstRegion { x, y, width, height, mean: worst.mean, z: worst.z, p: worst.p }
        });
        let Bias { mean, z, p, regions, significant, .. } = *bias;
        Self { mean, z, p, regions, significant, worst }
    }
}

impl<'a> Options<'a> {
    fn new(outcome: &'a Outcome<'a>) -> Self {
        let input = &outcome.args.input;
        let MetricOptions { pdiff, flip, exposures, bias_regions } = *outcome.options;
        let exposures = match exposures {
            Exposures::Automatic => ExposureOption::Automatic("auto"),
            Exposures::Fixed { start, stop, count } => ExposureOption::Fixed(Series { start, stop, count }),
        };
        Self {
            transfer: input.transfer.into(),
            layer: input.layer.as_deref(),
            ignore_alpha: input.ignore_alpha,
            ignore_windows: input.ignore_windows,
            conditions: outcome.conditions.iter().map(ToString::to_string).collect(),
            pdiff: PdiffOptions::new(&pdiff),
            flip: FlipOptions { pixels_per_degree: flip.pixels_per_degree, exposures },
            bias_regions,
        }
    }
}

impl PdiffOptions {
    fn new(pdiff: &PerceptualDiff) -> Self {
        Self {
            fov: pdiff.fov,
            gamma: pdiff.gamma,
            luminance: pdiff.luminance,
            threshold: pdiff.threshold,
            luminance_only: pdiff.luminance_only,
            color_factor: pdiff.color_factor,
            downsample: pdiff.downsample,
            channels: if pdiff.swap_red_blue { "bgr" } else { "rgb" },
        }
    }
}
