//! Why an experiment ended, for people.

use crate::exit::{Exit, Failure};
use crate::fault::fault;
use lightcuts_experiment::plan::UnknownName;
use lightcuts_experiment::{PlanError, ResultsError, RunError};
use miette::MietteDiagnostic;
use std::path::Path;

pub(super) fn plan_failure(error: PlanError) -> Failure {
    match error {
        PlanError::Text(text) => fault(Exit::Usage, &text.file, &text.text, text.span, &text.message, &text.label),
        PlanError::Scene(error) => Failure::new(Exit::Input, *error),
        PlanError::Unreadable { .. } => Failure::usage(error.to_string(), "an experiment is a TOML file"),
        PlanError::File { .. } => Failure::input(error),
    }
}

pub(super) fn unknown_name(error: &UnknownName) -> Failure {
    Failure::usage(error.to_string(), format!("expected one of {}", error.known.join(", ")))
}

pub(super) fn results_failure(error: &ResultsError) -> Failure {
    let (exit, help) = match error {
        ResultsError::InUse { .. } => (Exit::Usage, "wait until it ends, or use another folder with -o"),
        ResultsError::Malformed { .. } | ResultsError::Unfit { .. } => {
            (Exit::Input, "use another folder with -o, or repair the file")
        }
        ResultsError::Io { action: "read", .. } => (Exit::Input, "use another folder with -o"),
        ResultsError::Io { .. } => (Exit::NotWritten, "finished rows are kept"),
    };
    Failure::new(exit, MietteDiagnostic::new(error.to_string()).with_help(help))
}

pub(super) fn run_failure(error: RunError, directory: &Path) -> Failure {
    let help = format!("use another folder with -o, or remove {} to render everything again", directory.display());
    match error {
        RunError::Results(error) => results_failure(&error),
        RunError::World { .. } => Failure::input(error),
        RunError::Device { .. } => {
            Failure::usage(error.to_string(), "leave the configuration out with --only; finished rows are kept")
        }
        RunError::Settings(_) | RunError::Threads(_) => Failure::usage(error.to_string(), "change the experiment file"),
        RunError::NotReproducible { .. } => {
            Failure::new(Exit::NotWritten, MietteDiagnostic::new(error.to_string()).with_help(help))
        }
        RunError::Folder { .. } | RunError::Image(_) => Failure::output(error),
    }
}
