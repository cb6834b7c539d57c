//! Arguments of `experiment`.

use super::{SearchArgs, TalkArgs};
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// What the help text of `experiment` ends with.
pub(super) const AFTER_HELP: &str = "\
Exit codes:
    0  success
    1  a result could not be written, or a run gave a different picture than the first
    2  bad usage or experiment file; a device that cannot be used
    3  a scene, model, texture or result is missing, cannot be read or is malformed
  130  interrupted (SIGINT, SIGTERM); finished renders are kept, and the same command continues";

/// Arguments of `experiment`.
#[derive(Debug, Args)]
pub(crate) struct ExperimentArgs {
    /// The experiment file (TOML): scenes of the thesis' model, configurations, and the sections of a report.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// Folder for results and pictures, created if absent [default: out/NAME]
    ///
    /// Renders that are already finished there are not repeated.
    #[arg(short = 'o', long = "output", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) directory: Option<PathBuf>,
    /// Render only what has this name: a scene, a configuration or a point; may be repeated, `*` matches anything
    ///
    /// Names of the same kind are combined: `--only venus --only galleon --only 'cpu*'` renders two scenes, in each the
    /// configurations whose names begin with `cpu`. References that are needed for comparison are rendered too.
    #[arg(long, value_name = "NAME")]
    pub(crate) only: Vec<String>,
    #[command(flatten)]
    pub(crate) search: SearchArgs,
    /// Check everything and print the plan, but do not render.
    #[arg(long)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}
