//! Arguments of `develop`.

use super::display::{BloomFlags, DisplayFlags};
use super::{SettingFlags, ThreadArgs};
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// What the help text of `develop` ends with.
pub(super) const AFTER_HELP: &str = "\
develop's default transfer is srgb, whatever the model.

Examples:
  lightcuts develop a.exr --exposure 2 -o a.png
  lightcuts develop a.exr --exposure auto --tone-mapping local -o a.png
  lightcuts develop sky.hdr --exposure auto -o sky.png";

/// Arguments of `develop`.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(crate) struct DevelopArgs {
    /// A picture that holds light: EXR, Radiance HDR or PFM from any program; the format is detected by content.
    #[arg(value_name = "PICTURE", value_hint = ValueHint::FilePath)]
    pub(crate) picture: PathBuf,
    /// File to write, .png [default: PICTURE.png in the current folder]
    #[arg(short = 'o', long = "output", value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Layer of an EXR instead of the picture itself, such as `direct`; see `lightcuts info`.
    #[arg(long, value_name = "NAME")]
    pub(crate) layer: Option<String>,
    /// Do not print what was written.
    #[arg(short, long)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) flags: DevelopFlags,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
}

/// The settings that were given on the command line: some of `SettingFlags`.
#[derive(Debug, Default, Args)]
pub(crate) struct DevelopFlags {
    #[command(flatten)]
    bloom: BloomFlags,
    #[command(flatten)]
    display: DisplayFlags,
}

impl DevelopFlags {
    /// The same among all settings.
    pub(crate) fn settings(&self) -> SettingFlags {
        SettingFlags { bloom: self.bloom.clone(), display: self.display.clone(), ..SettingFlags::default() }
    }
}
