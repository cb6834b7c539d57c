//! The command `report`: tables, charts and a page of results.

use crate::args::ReportArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use lightcuts_experiment::Report;
use miette::{MietteDiagnostic, Severity};
use std::fmt::Write;
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &ReportArgs) -> Result<Exit, Failure> {
    let report = Report::read(&args.results).map_err(Failure::input)?;
    for missing in &report.missing {
        let warning = MietteDiagnostic::new(missing).with_severity(Severity::Warning);
        console::show(&warning.into());
    }
    let beside = || args.results.parent().unwrap_or(Path::new("")).join("report");
    let directory = args.directory.clone().unwrap_or_else(beside);
    let written = report.write(&directory).map_err(Failure::output)?;
    if args.quiet {
        return Ok(Exit::Done);
    }
    let mut text = String::new();
    for path in written {
        let _ = writeln!(text, "{:<12} {}", "wrote", path.display()); // writing to a String cannot fail
    }
    console::print(text.as_bytes()).map(|()| Exit::Done)
}
