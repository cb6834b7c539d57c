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
    /// clamped to 1. `physical` is radiometric: light falls off, materials conserve energy, and the picture converges
    /// to the solution of the rendering equation; thesis scenes can be rendered with it too. Options marked (thesis) or
    /// (physical) belong to that model alone and are errors in the other.
    #[arg(id = "run.model", long = "model", value_name = "NAME", value_parser = ["thesis", "physical"])]
    model: Option<String>,
    /// Use the original program's random numbers, arithmetic and defects [default: false]
    ///
    /// For comparing numbers with the thesis' tables: the VPL counts and light ratios of its Appendix C come out to the
    /// last digit. Needs 512 x 512 pixels with one sample each. Leave it off otherwise: without it the defects are
    /// fixed.
    #[arg(id = "run.reproduce", long = "reproduce", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    reproduce: Option<bool>,
    /// Seed of the random numbers [default: 1]
    ///
    /// The same job and seed give the same picture, bit for bit, on any number of threads, except where measured times
    /// decide: with --time-limit, --integrator auto or --gather auto. Change it to see how much of a picture is noise.
    #[arg(id = "run.seed", long = "seed", value_name = "N")]
    seed: Option<u32>,
    /// Maximum ray depth: mirrored and refracted rays, the camera ray included, 1 to 12 [default: 4]
    ///
    /// Raise it if glass or facing mirrors show black. The time can double with each step.
    #[arg(id = "run.max-depth", long = "max-depth", value_name = "N")]
    max_depth: Option<u32>,
}

/// `size` is `width` and `height` in one.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Image")]
pub(crate) struct ImageFlags {
    /// Width and height, such as 640x480
    ///
    /// In the thesis' model neither the number nor the brightness of VPLs depends on the size: their probability is
    /// divided among the camera rays. A wide picture places some of them in the extra area at its sides.
    #[arg(long, value_name = "WxH", conflicts_with_all = ["image.width", "image.height"])]
    size: Option<Size>,
    /// Width in pixels [default: 512]
    ///
    /// A wider picture shows more at its sides; the pixels stay square.
    #[arg(id = "image.width", long = "width", value_name = "PIXELS")]
    width: Option<u32>,
    /// Height in pixels [default: 512]
    ///
    /// The height always spans the same part of the scene from bottom to top. Halve width and height for the same view
    /// at half the resolution.
    #[arg(id = "image.height", long = "height", value_name = "PIXELS")]
    height: Option<u32>,
}

impl ImageFlags {
    /// Whether width and height were given in one.
    pub(super) fn has_size(&self) -> bool {
        self.size.is_some()
    }
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
    #[arg(id = "sampling.sampler", long = "sampler", value_name = "PATTERN", value_parser = ["stratified", "low-discrepancy", "best-candidate"])]
    sampler: Option<String>,
    /// Samples per pixel, 1 to 4096, in the physical model up to 2^24 [default: thesis 1, physical 64]
    ///
    /// The time is proportional to it. In the thesis' model 4 to 16 make smooth edges, and the number of VPLs stays the
    /// same: their probability is divided among the camera rays. In the physical model more samples mean less noise:
    /// four times as many halve it. With --time-limit or --noise the default is 0: no limit.
    #[arg(id = "sampling.samples", long = "samples", short = 's', value_name = "N")]
    samples: Option<u32>,
    /// Samples of pixels that differ from a neighbour; used if higher than --samples [default: 0]
    ///
    /// Adaptive anti-aliasing: smooth edges at less cost than more samples everywhere.
    #[arg(id = "sampling.adaptive-samples", long = "adaptive-samples", value_name = "N")]
    adaptive_samples: Option<u32>,
    /// Difference from a neighbour, in any channel, at which a pixel gets --adaptive-samples [default: 0.05]
    #[arg(id = "sampling.adaptive-threshold", long = "adaptive-threshold", value_name = "X")]
    adaptive_threshold: Option<f32>,
}

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Filter")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct FilterFlags {
    /// Reconstruction filter [default: box]
    ///
    /// `box` is the plain mean. `triangle` and `gaussian` are softer, `mitchell` is sharp with little ringing. All but
    /// the box look right with 4 or more --samples only.
    #[arg(id = "filter.kind", long = "filter", value_name = "KIND", value_parser = ["box", "triangle", "gaussian", "mitchell"])]
    kind: Option<String>,
    /// Radius in pixels, 0.5 to 16 [default: box 0.5, triangle 1, gaussian and mitchell 2]
    #[arg(id = "filter.radius", long = "filter-radius", value_name = "PIXELS")]
    radius: Option<f32>,
    /// Falloff of the Gaussian: higher is sharper [default: 2]
    #[arg(id = "filter.alpha", long = "filter-alpha", value_name = "X")]
    alpha: Option<f32>,
    /// Mitchell's B, blur [default: 0.33333334]
    #[arg(id = "filter.mitchell-b", long = "filter-mitchell-b", value_name = "X", allow_hyphen_values = true)]
    mitchell_b: Option<f32>,
    /// Mitchell's C, ringing [default: 0.33333334]
    #[arg(id = "filter.mitchell-c", long = "filter-mitchell-c", value_name = "X", allow_hyphen_values = true)]
    mitchell_c: Option<f32>,
}
