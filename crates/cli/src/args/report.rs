//! Arguments of `report`.

use clap::{Args, ValueHint};
use std::path::PathBuf;

/// Arguments of `report`.
#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// The `results.jsonl` that `lightcuts experiment` wrote.
    #[arg(value_name = "RESULTS", value_hint = ValueHint::FilePath)]
    pub(crate) results: PathBuf,
    /// Folder for the report, created if absent [default: report, next to the results]
    ///
    /// Files of an earlier report are replaced, others are left alone. `index.html` is the whole report on one page,
    /// pictures included.
    #[arg(short = 'o', long = "output", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) directory: Option<PathBuf>,
    /// No list of the files written; warnings and errors only.
    #[arg(short, long)]
    pub(crate) quiet: bool,
}
