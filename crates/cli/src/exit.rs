//! How the command ends.
//!
//! | code | meaning |
//! | --- | --- |
//! | 0 | success |
//! | 1 | the render finished, but an output could not be written |
//! | 2 | bad usage, job file or parameters; a device that does not exist |
//! | 3 | a scene, model, texture, picture or VPL file is missing, cannot be read or is malformed |
//! | 130 | interrupted; what was rendered so far is written |
//!
//! `compare` answers a question, so its codes are those of diff(1):
//!
//! | code | meaning |
//! | --- | --- |
//! | 0 | the pictures are the same |
//! | 1 | they differ |
//! | 2 | an error of any kind: no verdict |

use miette::{Diagnostic, MietteDiagnostic, Report};
use std::process::ExitCode;

/// How a command ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Success; of `compare`: the pictures are the same.
    Done,
    /// An output could not be written.
    NotWritten,
    /// Bad usage, job file or parameters; a device that does not exist.
    Usage,
    /// An input cannot be read.
    Input,
    /// Of `compare`: the pictures differ.
    Differs,
    /// Of `compare`: no verdict, whatever the reason.
    Trouble,
    /// Interrupted by a signal.
    Interrupted,
}

impl Exit {
    /// The number that the shell gets.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::NotWritten | Self::Differs => 1,
            Self::Usage | Self::Trouble => 2, // clap uses the same for bad usage
            Self::Input => 3,
            Self::Interrupted => 130, // 128 + SIGINT, as shells have it
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
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
