//! Flags of the physical model.

use super::value::Seconds;
use clap::Args;
use serde::Serialize;

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Physical model")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct PhysicalFlags {
    /// How light is found [default: lightcuts]
    ///
    /// `lightcuts`: direct light by sampling, indirect light from VPLs (fresh ones in each pass) through cuts by error
    /// bound; best where light comes around corners. `path`: path tracing, the reference; often the better one in open
    /// scenes. `auto`: measures both in each tile of 16 x 16 pixels, gives time to the one that needs less of it for the
    /// same noise, and weighs them by their variances; as times differ, so do two such pictures. All converge to the
    /// same picture.
    #[arg(long, value_name = "NAME", value_parser = ["lightcuts", "path", "auto"])]
    integrator: Option<String>,
    /// Stop after this time, such as 10s, 2m or 1.5h; 0 for no limit [default: 0]
    ///
    /// Rendering is over then, however large the picture: pixels that got no sample in time show the nearest one that has.
    /// Reading the scene and writing files come on top. There is no other limit of samples unless --samples is given.
    #[arg(long, value_name = "TIME")]
    time_limit: Option<Seconds>,
    /// Stop when the pixels' relative error, as a root mean square, is this small, such as 0.02; 0 for never [default: 0]
    ///
    /// It is looked at every four passes. There is no other limit of samples unless --samples is given.
    #[arg(long, value_name = "X")]
    noise: Option<f32>,
    /// VPLs of each pass, about [default: 2000]
    ///
    /// All passes together are as many as there is time for; more per pass cost more per sample and are worth it only up to
    /// a few thousand.
    #[arg(long, value_name = "N")]
    vpls: Option<u32>,
    /// Error of a cluster, relative to the pixel's light, up to which one VPL stands for it [default: 0.3]
    ///
    /// The picture converges whatever it is: smaller cuts are noisier and faster. 0 opens every cluster.
    #[arg(long, value_name = "X")]
    cut_error: Option<f32>,
    /// Clusters of a cut, at most [default: 1000]
    #[arg(long, value_name = "N")]
    max_cut: Option<u32>,
    /// Distance below which a VPL's light no longer grows, relative to the scene's diagonal [default: 0.03]
    ///
    /// Without it VPLs show as bright spots in corners. 0 switches it off.
    #[arg(long, value_name = "X")]
    clamp: Option<f32>,
    /// Give back by short rays what --clamp takes; false leaves corners too dark, for ever [default: true]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    compensation: Option<bool>,
    /// Keep VPLs by how much they bring to what the camera sees; false keeps all that light paths leave [default: true]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    rejection: Option<bool>,
    /// Factor on the lights of a thesis scene [default: 1]
    ///
    /// They have no falloff in the thesis' model; here they get intensities with which a surface at half the scene's
    /// diagonal is as bright as there.
    #[arg(long, value_name = "X")]
    light_scale: Option<f32>,
}
