//! Arguments of `compare`.

use super::{ProgressStyle, ThreadArgs};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum, ValueHint};
use lightcuts::image::Transfer;
use lightcuts::image::metrics::flip::Exposures;
use lightcuts::image::metrics::{Metric, UnknownMetric};
use std::path::PathBuf;

/// What the help text of `compare` ends with: its exit codes are those of diff(1), not those of the other commands.
pub(super) const AFTER_HELP: &str = "\
Exit codes:
    0  the pictures are the same: no condition holds
    1  they differ: at least one condition holds
    2  error, no verdict: bad usage, a picture that cannot be read, sizes, window positions or
       channels that do not match, a map that cannot be written
  130  interrupted (SIGINT, SIGTERM)

Conditions without --fail:
  non_finite>0, pdiff_pass<1, flip_ldr>0.05; where both pictures hold light (EXR, PFM, HDR, PNG of
  16 bits), flip_hdr>0.05 and relbias>0.1 too. The first always applies, even with --fail.

Examples:
  lightcuts compare reference.exr test.exr
  lightcuts compare a.png b.png --metrics ssim,psnr --fail 'ssim<0.99'
  lightcuts compare a.exr b.exr --map flip.png --map difference.png --json";

/// Arguments of `compare`.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct CompareArgs {
    /// The reference picture: EXR, PNG, PFM or Radiance HDR, detected by content.
    #[arg(value_name = "REFERENCE", value_hint = ValueHint::FilePath)]
    pub(crate) reference: PathBuf,
    /// The picture to test, with the same size and channels.
    #[arg(value_name = "TEST", value_hint = ValueHint::FilePath)]
    pub(crate) test: PathBuf,
    #[command(flatten)]
    pub(crate) judging: JudgingArgs,
    #[command(flatten)]
    pub(crate) input: InputArgs,
    #[command(flatten)]
    pub(crate) pdiff: PdiffArgs,
    #[command(flatten)]
    pub(crate) flip: FlipArgs,
    #[command(flatten)]
    pub(crate) output: CompareOutputArgs,
}

/// Metrics, and what counts as different.
#[derive(Debug, Args)]
#[command(next_help_heading = "Judging")]
pub(crate) struct JudgingArgs {
    /// Metrics, separated by commas [default: all]
    ///
    /// Metrics named in a condition are computed too, and non-finite pixels are always counted.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = metric_parser())]
    pub(crate) metrics: Vec<Metric>,
    /// The pictures differ if this holds, such as `flip>0.05`; may be repeated.
    ///
    /// A metric, one of > >= < <= == !=, and a number. A metric without a value, or one that is NaN, counts as
    /// different. Quote conditions, or the shell interprets the >.
    #[arg(long = "fail", value_name = "CONDITION")]
    pub(crate) conditions: Vec<String>,
}

/// How pictures are read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(crate) struct InputArgs {
    /// Transfer function: how light is displayed, and how code values of a PNG become light.
    ///
    /// PNGs that `lightcuts render` writes are `linear` in the thesis' model and `srgb` in the physical model, unless
    /// they were rendered with another --transfer.
    #[arg(long, value_enum, default_value_t = TransferChoice::Srgb)]
    pub(crate) transfer: TransferChoice,
    /// Compare this layer of EXR files instead of the picture itself, such as `albedo`; see `lightcuts info`.
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
    /// Compare the colours even if only one of the pictures has an alpha channel. Alpha itself is never compared.
    #[arg(long)]
    pub(crate) ignore_alpha: bool,
    /// Compare the pixels of EXR files whose data windows lie at other places in their display windows.
    #[arg(long)]
    pub(crate) ignore_windows: bool,
}

/// The parameters of Perceptual Image Diff, as in the original program.
#[derive(Debug, Args)]
#[command(next_help_heading = "Perceptual Image Diff")]
pub(crate) struct PdiffArgs {
    /// Horizontal field of view that the picture covers.
    #[arg(long, value_name = "DEGREES", default_value_t = 45.0)]
    pub(crate) fov: f32,
    /// Exponent from code values to light.
    #[arg(long, value_name = "X", default_value_t = 2.2)]
    pub(crate) gamma: f32,
    /// Peak luminance of the display, in cd/m^2.
    #[arg(long, value_name = "X", default_value_t = 100.0)]
    pub(crate) luminance: f32,
    /// Pictures pass if fewer pixels than this differ visibly.
    #[arg(long, value_name = "PIXELS", default_value_t = 100)]
    pub(crate) threshold: usize,
    /// Compare only luminance, not colour.
    #[arg(long)]
    pub(crate) luminance_only: bool,
    /// Weight of colour differences.
    #[arg(long, value_name = "X", default_value_t = 1.0)]
    pub(crate) color_factor: f32,
    /// Halve the resolution of both pictures this many times first.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) downsample: u32,
    /// Order in which the channels are read.
    ///
    /// The published program swaps red and blue: its figures, including those for the thesis' pictures, are those of
    /// `bgr`. `rgb` is what the paper describes.
    #[arg(long, value_enum, default_value_t = ChannelOrder::Bgr)]
    pub(crate) pdiff_channels: ChannelOrder,
}

/// The parameters of both FLIPs.
#[derive(Debug, Args)]
#[command(next_help_heading = "FLIP")]
pub(crate) struct FlipArgs {
    /// Pixels per degree of visual angle [default: 67.02, 3840 pixels on 0.7 m seen from 0.7 m]
    #[arg(long = "ppd", value_name = "X")]
    pub(crate) pixels_per_degree: Option<f32>,
    /// Exposures of HDR-FLIP: `auto`, from the reference, or START,STOP,COUNT, in stops.
    #[arg(long, value_name = "EXPOSURES", default_value = "auto", value_parser = exposures, allow_hyphen_values = true)]
    pub(crate) exposures: Exposures,
}

/// What is printed and written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct CompareOutputArgs {
    /// Difference map to write, .png; may be repeated.
    ///
    /// [KIND=]FILE.png; the kinds are flip, flip-hdr, pdiff, difference (signed), relmse and absolute. Without KIND=,
    /// it is taken from the file name if that is a kind, else flip.
    #[arg(long = "map", value_name = "[KIND=]FILE", value_hint = ValueHint::FilePath)]
    pub(crate) maps: Vec<PathBuf>,
    /// Print one JSON object for machines.
    #[arg(long)]
    pub(crate) json: bool,
    /// No table and no progress, only the exit code.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Progress on stderr [default: for pictures of a million pixels and more a bar on a
    /// terminal, else plain; for smaller ones none]
    #[arg(long, value_name = "STYLE", value_enum)]
    pub(crate) progress: Option<ProgressStyle>,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
}

/// Transfer functions by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TransferChoice {
    /// IEC 61966-2-1, which displays expect
    Srgb,
    /// Values as they are
    Linear,
}

impl From<TransferChoice> for Transfer {
    fn from(choice: TransferChoice) -> Self {
        match choice {
            TransferChoice::Srgb => Self::Srgb,
            TransferChoice::Linear => Self::Linear,
        }
    }
}

/// Which channel is read as red.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ChannelOrder {
    /// Blue first, as in the published figures
    Bgr,
    /// Red first, as in the paper
    Rgb,
}

/// Metrics by key, each with its meaning in the help, and by their short names.
fn metric_parser() -> impl TypedValueParser<Value = Metric> {
    let keys = Metric::ALL.map(|metric| PossibleValue::new(metric.key()).help(metric.summary()));
    let short = Metric::SHORT.map(|(name, metric)| PossibleValue::new(name).help(format!("Short for {metric}.")));
    PossibleValuesParser::new(keys.into_iter().chain(short))
        .try_map(|name| -> Result<Metric, UnknownMetric> { name.parse() })
}

/// `auto`, or START,STOP,COUNT.
fn exposures(text: &str) -> Result<Exposures, String> {
    if text == "auto" {
        return Ok(Exposures::Automatic);
    }
    let fields: Vec<_> = text.split(',').collect();
    let parsed = match fields[..] {
        [start, stop, count] => (start.parse().ok()).zip(stop.parse().ok()).zip(count.parse().ok()),
        _ => None,
    };
    let ((start, stop), count) = parsed.ok_or("expected `auto` or START,STOP,COUNT, such as -2,5,8")?;
    Ok(Exposures::Fixed { start, stop, count })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Command};
    use clap::Parser;

    fn parsed(arguments: &[&str]) -> Result<Box<CompareArgs>, clap::Error> {
        let words = ["lightcuts", "compare", "a", "b"].iter().chain(arguments);
        let Command::Compare(args) = Cli::try_parse_from(words)?.command else { panic!("not `compare`") };
        Ok(args)
    }

    #[test]
    fn metrics_are_known_by_key_and_short_name() {
        let args = parsed(&["--metrics", "ssim,flip,pdiff", "--metrics", "bias"]).unwrap();
        assert_eq!(args.judging.metrics, [Metric::Ssim, Metric::FlipLdr, Metric::PdiffPx, Metric::Bias]);
        let error = parsed(&["--metrics", "ssmi"]).unwrap_err().to_string();
        let listed = error.split_once("[possible values: ").unwrap().1.split_once(']').unwrap().0;
        let listed: Vec<&str> = listed.split(", ").collect();
        assert_eq!(listed, [&Metric::ALL.map(Metric::key)[..], &["flip", "pdiff"]].concat(), "{error}");
    }

    #[test]
    fn exposures_are_automatic_or_three_numbers() {
        assert_eq!(parsed(&[]).unwrap().flip.exposures, Exposures::Automatic);
        let fixed = parsed(&["--exposures", "-2.5,4,7"]).unwrap().flip.exposures;
        assert_eq!(fixed, Exposures::Fixed { start: -2.5, stop: 4.0, count: 7 });
        for wrong in ["", "1", "1,2", "1,2,3,4", "1,2,-3", "a,2,3", "1,2,3.5"] {
            assert!(parsed(&["--exposures", wrong]).unwrap_err().to_string().contains("START,STOP,COUNT"), "{wrong}");
        }
    }
}
