//! Flags of the whole run and of the picture: size, samples, filter.

use super::value::Size;
use clap::Args;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Run")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct RunFlags {
    /// Model of light [default: thesis, or physical for scenes in TOML]
    ///
    /// `thesis` is the Phong model of Tong Zhang's thesis (Purdue, 2011): no falloff with distance, every ray's colour
    /// clamped to 1. `physical` is radiometric: light falls off, materials keep energy, and the picture converges to the
    /// truth; thesis scenes can be rendered with it too.
    #[arg(long, value_parser = ["thesis", "physical"])]
    model: Option<String>,
    /// Draw the original program's random numbers, with its arithmetic and its defects [default: false]
    ///
    /// For comparing numbers with the thesis' tables: the VPL counts and light ratios of its Appendix C come out to the
    /// last digit. Needs 512 x 512 pixels of one sample. Otherwise leave it off: defects are repaired then.
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    reproduce: Option<bool>,
    /// Seed of the random numbers [default: 1]
    ///
    /// The same job and seed give the same picture, bit for bit, on any number of threads; not where measured times decide:
    /// with --time-limit, --integrator auto or --gather auto. Change it to see how much of a picture is chance.
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// Longest chain of mirrored and refracted rays, the camera's included, 1 to 12 [default: 4]
    ///
    /// Raise it where glass or facing mirrors show black. The time can double with each step.
    #[arg(long, value_name = "N")]
    max_depth: Option<u32>,
}

/// `size` is `width` and `height` in one.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Image")]
pub(crate) struct ImageFlags {
    /// Width and height in one, such as 640x480.
    ///
    /// VPLs stay as many, and their light as bright, at any size: their probability is shared out over the camera's rays.
    /// In a wide picture some of them go to what it sees beside a square one.
    #[arg(long, value_name = "WxH", conflicts_with_all = ["width", "height"])]
    size: Option<Size>,
    /// Width in pixels [default: 512]
    ///
    /// A wider picture sees more at its sides; the pixels stay square.
    #[arg(long, value_name = "PIXELS")]
    width: Option<u32>,
    /// Height in pixels [default: 512]
    ///
    /// The height always spans the same part of the scene: half of it shows the same, coarser.
    #[arg(long, value_name = "PIXELS")]
    height: Option<u32>,
}

impl Serialize for ImageFlags {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut table = serializer.serialize_struct("ImageFlags", 2)?;
        table.serialize_field("width", &self.size.map(|size| size.width).or(self.width))?;
        table.serialize_field("height", &self.size.map(|size| size.height).or(self.height))?;
        table.end()
    }
}

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Sampling")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct SamplingFlags {
    /// Pattern of a pixel's samples [default: the scene's, else stratified]
    ///
    /// `stratified`: a random point per cell of a grid, as in the original. `low-discrepancy`: Owen-scrambled Sobol'
    /// points, the smoothest edges for the time. `best-candidate`: blue noise.
    #[arg(long, value_parser = ["stratified", "low-discrepancy", "best-candidate"])]
    sampler: Option<String>,
    /// Samples of every pixel, 1 to 4096; of the physical model 1 to 2^24 [default: 1, physical model 64]
    ///
    /// The time is proportional to it. 4 to 16 make smooth edges. VPLs stay as many: their probability is shared out over
    /// the camera's rays. Of the physical model 0 is no limit where --time-limit or --noise is one, and that is the default
    /// with them.
    #[arg(long, short = 's', value_name = "N")]
    samples: Option<u32>,
    /// Samples of pixels that differ from a neighbour; none unless above --samples [default: 0]
    ///
    /// Adaptive anti-aliasing: smooth edges for less than --samples everywhere.
    #[arg(long, value_name = "N")]
    adaptive_samples: Option<u32>,
    /// Difference to a neighbour, in any channel, from which on a pixel gets --adaptive-samples [default: 0.05]
    #[arg(long, value_name = "X")]
    adaptive_threshold: Option<f32>,
}

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Filter")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct FilterFlags {
    /// How samples become pixels [default: box]
    ///
    /// `box` is the plain mean. `triangle` and `gaussian` are softer, `mitchell` is sharp with little ringing. All but the
    /// box want --samples of 4 or more.
    #[arg(id = "filter-kind", long = "filter", value_name = "KIND", value_parser = ["box", "triangle", "gaussian", "mitchell"])]
    kind: Option<String>,
    /// Radius in pixels, 0.5 to 16 [default: box 0.5, triangle 1, gaussian and mitchell 2]
    #[arg(id = "filter-radius", long = "filter-radius", value_name = "PIXELS")]
    radius: Option<f32>,
    /// Falloff of the Gaussian: a higher one is sharper [default: 2]
    #[arg(id = "filter-alpha", long = "filter-alpha", value_name = "X")]
    alpha: Option<f32>,
    /// Mitchell's B, blur [default: 0.33333334]
    #[arg(long = "filter-mitchell-b", value_name = "X")]
    mitchell_b: Option<f32>,
    /// Mitchell's C, ringing [default: 0.33333334]
    #[arg(long = "filter-mitchell-c", value_name = "X")]
    mitchell_c: Option<f32>,
}
