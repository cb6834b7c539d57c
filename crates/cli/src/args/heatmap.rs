//! Arguments of `heatmap`.

use clap::{Args, ValueHint};
use std::path::PathBuf;
use std::str::FromStr;

/// Arguments of `heatmap`.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct HeatmapArgs {
    /// An EXR that lightcuts wrote.
    #[arg(value_name = "PICTURE", value_hint = ValueHint::FilePath)]
    pub(crate) picture: PathBuf,
    /// The layer, or `beauty`; `lightcuts info PICTURE` lists them, and so does the error if it is left out.
    ///
    /// Colours are shown by their luminance, directions and positions by their length, ids by their number.
    #[arg(value_name = "LAYER")]
    pub(crate) layer: Option<String>,
    /// File to write, .png [default: PICTURE-LAYER.png in the current folder]
    #[arg(short = 'o', long = "output", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Range of the scale, such as 0..200 [default: 0 to a round number above nearly all values]
    ///
    /// With --log these are logarithms: `--range -6..-2`.
    #[arg(long, value_name = "LOW..HIGH", allow_hyphen_values = true)]
    pub(crate) range: Option<Range>,
    /// Show the decimal logarithm; values of 0 and below get the first colour.
    #[arg(long)]
    pub(crate) log: bool,
    /// Do not print what was written.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// Two numbers in order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub(crate) low: f32,
    pub(crate) high: f32,
}

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text.split_once("..").and_then(|(low, high)| Some((low.parse().ok()?, high.parse().ok()?)));
        let (low, high): (f32, f32) = ends.ok_or("expected two numbers such as 0..200")?;
        if low.is_finite() && high.is_finite() && low < high {
            Ok(Self { low, high })
        } else {
            Err("expected a smaller number before a greater one".to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Command};
    use clap::Parser;

    /// The range that a command line gives.
    fn given(arguments: &[&str]) -> Result<Option<Range>, clap::Error> {
        let words = ["lightcuts", "heatmap", "a.exr", "depth"].iter().chain(arguments);
        let Command::Heatmap(args) = Cli::try_parse_from(words)?.command else { panic!("not `heatmap`") };
        Ok(args.range)
    }

    #[test]
    fn a_range_may_begin_with_a_minus() {
        for (text, low, high) in
            [("-6..-2", -6.0, -2.0), ("-6..2", -6.0, 2.0), ("-.5..1e3", -0.5, 1e3), ("-1e-3..-1e-4", -1e-3, -1e-4)]
        {
            let expected = Some(Range { low, high });
            assert_eq!(given(&["--range", text]).unwrap(), expected, "{text}");
            assert_eq!(given(&[&format!("--range={text}"), "-q"]).unwrap(), expected, "{text}");
        }
        let error = given(&["--range", "-o"]).unwrap_err().to_string();
        assert!(error.contains("expected two numbers such as 0..200"), "{error}");
    }

    #[test]
    fn ranges_are_two_numbers_in_order() {
        assert_eq!("-1..2.5".parse(), Ok(Range { low: -1.0, high: 2.5 }));
        for text in ["", "1", "1..", "..2", "2..1", "1..1", "0..inf", "nan..1", "a..b"] {
            assert!(text.parse::<Range>().is_err(), "{text}");
        }
    }
}
