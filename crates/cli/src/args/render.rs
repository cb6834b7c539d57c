//! Arguments of `render`: input, job, outputs, and what does not belong to the job.

use super::{CreaseArgs, DeviceArgs, SearchArgs, SettingFlags};
use clap::{Args, ValueEnum, ValueHint};
use std::path::PathBuf;

/// Most threads that can be asked for; more than any machine has, fewer than start to hurt.
const MAX_THREADS: i64 = 1024;

/// Arguments of `render`.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct RenderArgs {
    /// A scene (.txt, .toml), or a picture (.exr, .png) or job file (.toml) that lightcuts wrote, to render it again.
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath, required_unless_present = "job")]
    pub(crate) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
    #[command(flatten)]
    pub(crate) job: JobArgs,
    #[command(flatten)]
    pub(crate) settings: SettingFlags,
    #[command(flatten)]
    pub(crate) performance: PerformanceArgs,
}

/// What is written.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct OutputArgs {
    /// Picture to write, .exr or .png; may be repeated [default: SCENE.png in the current folder; of a picture or job,
    /// SCENE is the scene that it holds]
    ///
    /// EXR: linear light in floats, every layer, and the whole job, so that `lightcuts render FILE.exr` renders it again.
    /// PNG: 8 bits per channel for display, also with the job.
    #[arg(short = 'o', long = "output", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) pictures: Vec<PathBuf>,
    /// Write counts, times, memory use and settings as JSON.
    #[arg(long = "stats", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) stats: Option<PathBuf>,
    /// Write the VPLs as CSV.
    #[arg(id = "write-vpls", long = "write-vpls", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) write_vpls: Option<PathBuf>,
    /// Write the whole job, with every setting, as TOML for --job.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) write_job: Option<PathBuf>,
    /// Check everything and write the job if requested, but do not render.
    #[arg(long)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}

/// What commands that render print while they run and at the end.
#[derive(Debug, Default, Args)]
pub(crate) struct TalkArgs {
    /// No summary and no progress; warnings and errors only.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Progress on stderr [default: bar on a terminal, else plain]
    #[arg(long, value_name = "STYLE", value_enum)]
    pub(crate) progress: Option<ProgressStyle>,
}

/// Where the job comes from, beside flags.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Job")]
pub(crate) struct JobArgs {
    /// Settings from a job file, or from a picture that lightcuts wrote. Options override it; it overrides the scene.
    ///
    /// TOML with a table per group of these options: `[image] width = 640`. `scene`, `search-path` and `read-vpls` are
    /// relative to the file. --write-job writes all keys.
    #[arg(id = "job", long = "job", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) file: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) search: SearchArgs,
    #[command(flatten)]
    pub(crate) crease: CreaseArgs,
    /// Read the VPLs from a CSV that --write-vpls wrote, instead of placing them.
    #[arg(id = "read-vpls", long = "read-vpls", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) read_vpls: Option<PathBuf>,
}

/// What affects the time that a render takes, and the picture at most by rounding; not part of the job.
#[derive(Debug, Args)]
#[command(next_help_heading = "Performance")]
pub(crate) struct PerformanceArgs {
    #[command(flatten)]
    pub(crate) devices: DeviceArgs,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    /// Use of the processor's vector instructions; `off` to track down a fault.
    #[arg(long, value_enum, default_value_t = SimdChoice::Auto)]
    pub(crate) simd: SimdChoice,
}

/// How many cores are used.
#[derive(Debug, Default, Args)]
pub(crate) struct ThreadArgs {
    /// Number of threads; 0 means one per processor.
    #[arg(short = 'j', long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS))]
    pub(crate) threads: u16,
}

/// Styles of progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressStyle {
    /// A bar with the remaining time
    Bar,
    /// A few lines of text
    Plain,
    /// A JSON object per line, with stage, done, total, elapsed_s and remaining_s, or with note; `experiment` adds job,
    /// jobs, scene, configuration, point, seed and run
    Json,
    /// Nothing
    None,
}

/// Use of vector instructions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SimdChoice {
    /// All that the processor supports and lightcuts uses
    #[default]
    Auto,
    /// None
    Off,
}
