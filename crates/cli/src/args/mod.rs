//! The command line. Every parameter is declared once, here: help, completions, man pages and job files follow from it.

mod compare;
mod develop;
mod device;
mod display;
mod effects;
mod experiment;
mod heatmap;
mod lights;
mod model;
mod physical;
mod picture;
mod render;
mod report;
#[cfg(test)]
mod tests;
mod value;

pub(crate) use compare::{ChannelOrder, CompareArgs, InputArgs};
pub(crate) use develop::DevelopArgs;
pub(crate) use device::{DeviceArgs, DevicesArgs};
pub(crate) use experiment::ExperimentArgs;
pub(crate) use heatmap::HeatmapArgs;
pub(crate) use model::{command, counterpart_of, parse, scope_of};
pub(crate) use render::{
    JobArgs, OutputArgs, PerformanceArgs, ProgressStyle, RenderArgs, SimdChoice, TalkArgs, ThreadArgs,
};
pub(crate) use report::ReportArgs;

use clap::{Args, Parser, Subcommand, ValueHint};
use clap_complete::Shell;
use serde::Serialize;
use std::path::PathBuf;

/// What the help texts of the program and of `render` end with.
const AFTER_HELP: &str = "\
Exit codes:
    0  success
    1  the render finished, but an output could not be written
    2  bad usage, job file or parameters; a device that does not exist
    3  a scene, model, texture, picture or VPL file is missing, cannot be read or is malformed
  130  interrupted (SIGINT, SIGTERM); what was rendered so far is written
  The exit code of `lightcuts compare` is a verdict; see its help.

Environment:
  LIGHTCUTS_PATH  more folders to search for models and textures, separated as in PATH
  LIGHTCUTS_LOG   what to log, such as `debug`; overrides -v
  NO_COLOR        no colours if set

Start with `lightcuts info SCENE`, then `lightcuts render SCENE`.";

/// What the help texts of commands that render nothing end with.
const VIEWING_AFTER_HELP: &str = "\
Exit codes:
    0  success
    1  the output could not be written
    2  bad usage or parameters
    3  an input is missing, cannot be read or is malformed";

/// Render scenes with global illumination from virtual point lights (VPLs) and lightcuts.
#[derive(Debug, Parser)]
#[command(name = "lightcuts", version, after_help = AFTER_HELP, arg_required_else_help = true, max_term_width = 100)]
pub(crate) struct Cli {
    /// Log what happens to stderr; repeat for more detail.
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene, or re-render from a picture or job file.
    #[command(after_help = AFTER_HELP)]
    Render(Box<RenderArgs>),
    /// Show how a scene was understood, or what a picture contains.
    #[command(after_help = VIEWING_AFTER_HELP)]
    Info(InfoArgs),
    /// List the devices that can render, and which one is used by default.
    #[command(after_help = device::AFTER_HELP)]
    Devices(DevicesArgs),
    /// Measure how much two pictures differ.
    #[command(after_help = compare::AFTER_HELP)]
    Compare(Box<CompareArgs>),
    /// Make a PNG of a finished picture: exposure, tone mapping, transfer, bloom.
    #[command(after_help = format!("{}\n\n{VIEWING_AFTER_HELP}", develop::AFTER_HELP))]
    Develop(Box<DevelopArgs>),
    /// Show a layer of a picture (cut sizes, variance, depth, ...) in false colours with a scale.
    #[command(after_help = VIEWING_AFTER_HELP)]
    Heatmap(HeatmapArgs),
    /// Run the renders of an experiment file and record times, counts and errors, one line per render.
    #[command(after_help = experiment::AFTER_HELP)]
    Experiment(ExperimentArgs),
    /// Make tables, charts and a web page from an experiment's results, without rendering.
    #[command(after_help = VIEWING_AFTER_HELP)]
    Report(ReportArgs),
    /// Print a completion script for a shell, to be stored where that shell looks for completions.
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Print the man page, or write the man pages of all commands to a folder.
    Man {
        /// Folder for `lightcuts.1`, `lightcuts-render.1`, ..., created if absent.
        #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
        directory: Option<PathBuf>,
    },
}

/// Arguments of `info`.
#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// A scene, or a picture: EXR, PNG, Radiance HDR or PFM.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) search: SearchArgs,
    #[command(flatten)]
    pub(crate) crease: CreaseArgs,
    /// Print JSON for machines.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where models and textures are searched.
#[derive(Debug, Default, Args)]
pub(crate) struct SearchArgs {
    /// Folder to search for models and textures after the scene's own; may be repeated.
    ///
    /// Search order: next to the file that names them, next to the scene, these folders, the `search-path` of the job
    /// or the experiment file, if there is one, then the folders in the environment variable LIGHTCUTS_PATH.
    #[arg(long = "search-path", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) folders: Vec<PathBuf>,
}

/// How meshes without normals are smoothed.
#[derive(Debug, Default, Args)]
pub(crate) struct CreaseArgs {
    /// Angle between faces, in degrees, up to which meshes without normals look smooth; 0 shows every face flat
    /// [default: that of each object, 40 where it has none]
    ///
    /// Physical scenes in TOML only. Overrides every object's `crease-angle`.
    #[arg(id = "crease-angle", long = "crease-angle", value_name = "DEGREES", value_parser = value::angle)]
    pub(crate) angle: Option<f32>,
}

/// The settings that were given on the command line: serialised, the tables of a job file with only these keys.
#[derive(Debug, Default, Args, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) struct SettingFlags {
    #[command(flatten)]
    run: picture::RunFlags,
    #[command(flatten)]
    image: picture::ImageFlags,
    #[command(flatten)]
    sampling: picture::SamplingFlags,
    #[command(flatten)]
    filter: picture::FilterFlags,
    #[command(flatten)]
    vpl: lights::VplFlags,
    #[command(flatten)]
    gather: lights::GatherFlags,
    #[command(flatten)]
    ambient_occlusion: effects::AmbientOcclusionFlags,
    #[command(flatten)]
    caustics: effects::CausticsFlags,
    #[command(flatten)]
    bloom: display::BloomFlags,
    #[command(flatten)]
    display: display::DisplayFlags,
    #[command(flatten)]
    physical: physical::PhysicalFlags,
}
