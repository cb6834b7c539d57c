//! The command `compare`: read two pictures, measure, judge, tell.

mod conditions;
mod inputs;
mod json;
mod maps;
mod text;

use crate::args::{ChannelOrder, CompareArgs};
use crate::console;
use crate::exit::{Exit, Failure};
use crate::progress::Progress;
use crate::render::start_threads;
use conditions::{Condition, Failed};
use inputs::Inputs;
use lightcuts::Monitor;
use lightcuts::image::metrics::flip::Flip;
use lightcuts::image::metrics::{Comparison, Metric, MetricOptions, PerceptualDiff, compare};
use lightcuts::image::{Image, Picture, Transfer};
use maps::Map;
use std::path::Path;

/// Smaller pictures are measured before anybody looks for progress.
const PIXELS_WORTH_PROGRESS: usize = 1 << 20;

/// What the command line asks for, checked.
struct Plan {
    /// Those that are asked for by name, or all, without those that conditions and maps need.
    listed: Vec<Metric>,
    conditions: Vec<Condition>,
    options: MetricOptions,
    maps: Vec<Map>,
}

/// All that is told of two pictures.
struct Outcome<'a> {
    args: &'a CompareArgs,
    options: &'a MetricOptions,
    conditions: &'a [Condition],
    inputs: &'a Inputs,
    comparison: &'a Comparison,
    failed: Vec<Failed>,
    written: &'a [&'a Path],
}

/// Runs the command. Whatever keeps it from a verdict has one exit code, so that a script can tell it from `differs`.
pub(crate) fn run(args: &CompareArgs, logs: bool) -> Result<Exit, Failure> {
    judge(args, logs).map_err(|failure| Failure { exit: Exit::Trouble, ..failure })
}

fn judge(args: &CompareArgs, logs: bool) -> Result<Exit, Failure> {
    start_threads(&args.output.threads)?;
    let mut plan = Plan::new(args)?;
    let inputs = Inputs::read(args)?;
    if !inputs.hold_light {
        plan.conditions = conditions::of_display(plan.conditions, &args.judging.conditions);
    }
    let comparison = plan.measure(args, &inputs, logs)?;
    let (written, not_written) = maps::write(&plan.maps, &inputs, &comparison);
    let outcome = Outcome {
        args,
        options: &plan.options,
        conditions: &plan.conditions,
        inputs: &inputs,
        comparison: &comparison,
        failed: conditions::failed(&plan.conditions, &comparison, plan.options.pdiff.threshold),
        written: &written,
    };
    outcome.tell()?;
    // Only now: what was measured is worth telling, whether or not a map could be written.
    match not_written {
        Some(failure) => Err(failure),
        None if outcome.failed.is_empty() => Ok(Exit::Done),
        None => Ok(Exit::Differs),
    }
}

impl Plan {
    /// Everything that can be refused without the pictures is refused here.
    fn new(args: &CompareArgs) -> Result<Self, Failure> {
        let conditions = conditions::conditions(&args.judging.conditions)?;
        let maps = maps::maps(args)?;
        let listed = match &args.judging.metrics[..] {
            [] => Metric::ALL.to_vec(),
            listed => listed.to_vec(),
        };
        let plan = Self { listed, conditions, options: options(args), maps };
        plan.rehearse()?;
        Ok(plan)
    }

    /// All that are to be measured, in the order of reports.
    fn metrics(&self) -> Vec<Metric> {
        let of_conditions = self.conditions.iter().map(|condition| condition.metric);
        let of_maps = self.maps.iter().filter_map(|map| map.kind.metric());
        let mut metrics: Vec<Metric> = self.listed.iter().copied().chain(of_conditions).chain(of_maps).collect();
        metrics.sort_unstable();
        metrics.dedup();
        metrics
    }

    /// Measures one pixel, so that an option out of range is refused before large pictures are read.
    fn rehearse(&self) -> Result<(), Failure> {
        let pixel = Picture::from_display(Image::filled(1, 1, [0.5; 3]), Transfer::Linear);
        let measured = compare(&pixel, &pixel, &self.metrics(), &self.options, &|_| {});
        measured.map(drop).map_err(|error| Failure::usage(error.to_string(), "see `lightcuts compare --help`"))
    }

    fn measure(&self, args: &CompareArgs, inputs: &Inputs, logs: bool) -> Result<Comparison, Failure> {
        let is_small = inputs.reference.width() * inputs.reference.height() < PIXELS_WORTH_PROGRESS;
        let progress = Progress::new(args.output.progress, args.output.quiet || is_small, logs);
        let metrics = self.metrics();
        progress.begin_stage("compare", metrics.len() as u64);
        let told = |metric: Metric| {
            // Told before each metric: all but the first end another one.
            if metrics.first() != Some(&metric) {
                progress.advance();
            }
        };
        let comparison = compare(&inputs.reference, &inputs.test, &metrics, &self.options, &told);
        progress.end();
        progress.finish();
        comparison.map_err(Failure::input)
    }
}

impl Outcome<'_> {
    fn tell(&self) -> Result<(), Failure> {
        if self.args.output.json {
            return console::print(json::json(self)?.as_bytes());
        }
        if self.args.output.quiet {
            return Ok(());
        }
        console::print(text::text(self).as_bytes())
    }
}

/// The parameters of the metrics.
fn options(args: &CompareArgs) -> MetricOptions {
    let (pdiff, flip) = (&args.pdiff, &args.flip);
    let pdiff = PerceptualDiff {
        fov: pdiff.fov,
        gamma: pdiff.gamma,
        luminance: pdiff.luminance,
        threshold: pdiff.threshold,
        luminance_only: pdiff.luminance_only,
        color_factor: pdiff.color_factor,
        downsample: pdiff.downsample,
        swap_red_blue: pdiff.pdiff_channels == ChannelOrder::Bgr,
    };
    let exposures = flip.exposures;
    let flip = flip.pixels_per_degree.map_or_else(Flip::default, |pixels_per_degree| Flip { pixels_per_degree });
    MetricOptions { pdiff, flip, exposures, ..MetricOptions::default() }
}
