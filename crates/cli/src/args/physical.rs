//! Flags of the physical model.

use super::value::Seconds;
use clap::Args;
use serde::Serialize;

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Physical model")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct PhysicalFlags {
    /// Light transport algorithm [default: lightcuts]
    ///
    /// `lightcuts`: samples direct light, and takes indirect light from VPLs (new ones in each pass) through cuts by
    /// error bound; best where light comes around corners. `path`: path tracing, the reference; often better in open
    /// scenes. `auto`: measures both in each tile of 16 x 16 pixels, spends more time on the more efficient one, and
    /// weights them by the inverse of their variances; as it measures time, two such renders differ in their noise. All
    /// converge to the same picture.
    #[arg(id = "physical.integrator", long = "integrator", value_name = "NAME", value_parser = ["lightcuts", "path", "auto"])]
    integrator: Option<String>,
    /// Stop after this time, such as 10s, 500ms, 2m or 1.5h; 0 for no limit [default: 0]
    ///
    /// Rendering stops then, at any picture size; pixels without a sample show the nearest one of a coarse preview.
    /// Reading the scene and writing files come on top. The number of samples is not limited unless --samples is given.
    #[arg(id = "physical.time-limit", long = "time-limit", value_name = "TIME")]
    time_limit: Option<Seconds>,
    /// Stop when the estimated relative RMS error of the pixels falls below this, such as 0.02; 0 for never [default:
    /// 0]
    ///
    /// It is checked every four passes. The number of samples is not limited unless --samples is given.
    #[arg(id = "physical.noise", long = "noise", value_name = "X")]
    noise: Option<f32>,
    /// Approximate number of VPLs per pass [default: 2000]
    ///
    /// Every pass places new ones. More VPLs per pass make each sample more expensive, which pays off only up to a few
    /// thousand.
    #[arg(id = "physical.vpls", long = "vpls", value_name = "N")]
    vpls: Option<u32>,
    /// Error bound up to which one VPL represents its cluster, relative to the pixel's light [default: 0.3]
    ///
    /// The picture converges with any value: smaller cuts are noisier and faster. 0 refines every cluster.
    #[arg(id = "physical.cut-error", long = "cut-error", value_name = "X")]
    cut_error: Option<f32>,
    /// Maximum number of clusters in a cut [default: 1000]
    #[arg(id = "physical.max-cut", long = "max-cut", value_name = "N")]
    max_cut: Option<u32>,
    /// Distance below which the light of a VPL is clamped, relative to the scene's diagonal [default: 0.03]
    ///
    /// Without it VPLs show as bright spots in corners. 0 switches it off.
    #[arg(id = "physical.clamp", long = "clamp", value_name = "X")]
    clamp: Option<f32>,
    /// Compensate for the energy that --clamp removes, with short paths; false is biased: dark corners [default: true]
    #[arg(id = "physical.compensation", long = "compensation", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    compensation: Option<bool>,
    /// Keep VPLs in proportion to what they contribute to the picture; false keeps all VPLs [default: true]
    #[arg(id = "physical.rejection", long = "rejection", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    rejection: Option<bool>,
    /// Factor on the lights of a thesis scene [default: 1]
    ///
    /// Those lights have no falloff. Each gets the intensity that makes a surface half the scene's diagonal away as
    /// bright as in the thesis' model.
    #[arg(id = "physical.light-scale", long = "light-scale", value_name = "X")]
    light_scale: Option<f32>,
}
