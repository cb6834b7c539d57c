//! How the command ends.
//!
//! | code | meaning |
//! | --- | --- |
//! | 0 | done |
//! | 1 | the render finished, but an output could not be written |
//! | 2 | bad usage, job file or parameters |
//! | 3 | a scene, model, texture, picture or VPL file cannot be read or is malformed |
//! | 130 | interrupted; what was rendered so far is written |

use miette::{Diagnostic, MietteDiagnostic, Report};
use std::process::ExitCode;

/// The exit codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// All is done.
    Done = 0,
    /// An output could not be written.
    NotWritten = 1,
    /// Bad usage, job file or parameters; clap uses the same code.
    Usage = 2,
    /// An input cannot be read.
    Input = 3,
    /// A signal broke it off: 128 + SIGINT, as shells have it.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// An error with the code to exit with.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) exit: Exit,
    pub(crate) report: Report,
}

impl Failure {
    /// Of any diagnostic.
    pub(crate) fn new(exit: Exit, error: impl Diagnostic + Send + Sync + 'static) -> Self {
        Self { exit, report: Report::new(error) }
    }

    /// Bad usage, with a way out.
    pub(crate) fn usage(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::new(Exit::Usage, MietteDiagnostic::new(message).with_help(help))
    }

    /// An input that cannot be read.
    #[expect(clippy::needless_pass_by_value, reason = "fits `map_err`")]
    pub(crate) fn input(message: impl ToString) -> Self {
        Self::new(Exit::Input, MietteDiagnostic::new(message.to_string()))
    }

    /// An output that cannot be written.
    #[expect(clippy::needless_pass_by_value, reason = "fits `map_err`")]
    pub(crate) fn output(message: impl ToString) -> Self {
        Self::new(Exit::NotWritten, MietteDiagnostic::new(message.to_string()))
    }
}
