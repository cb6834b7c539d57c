use crate::{Fault, FileError};
use miette::{Diagnostic, LabeledSpan, Severity, SourceCode};
use std::fmt;
use std::path::PathBuf;

/// Why a scene could not be imported.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum ImportError {
    /// The scene file itself cannot be read.
    #[error("cannot read the scene: {0}")]
    Unreadable(#[from] FileError),

    /// The file is not a scene in a known format.
    #[error("{}: this is {found}; expected a scene in the thesis' text format (.txt) or in the project's own (.toml)", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// What it seems to be.
        found: &'static str,
        /// How to go on, if there is a way.
        #[help]
        help: Option<&'static str>,
    },

    /// The content of the scene, or of a file that it names, is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(#[from] Faults),
}

impl ImportError {
    /// The faults in the files' contents, in the order they were found; empty for the other errors.
    pub fn faults(&self) -> &[Fault] {
        match self {
            Self::Invalid(faults) => &faults.list,
            _ => &[],
        }
    }

    /// What was warned about before and beside the errors: a file that was not found may be why something is missing.
    pub fn warnings(&self) -> &[Warning] {
        match self {
            Self::Invalid(faults) => &faults.warnings,
            _ => &[],
        }
    }
}

/// At least one fault. Displayed as the first; the others are related diagnostics.
#[derive(Debug, Clone)]
pub struct Faults {
    pub(crate) list: Vec<Fault>,
    pub(crate) warnings: Vec<Warning>,
    /// Whether the search for faults went to the end.
    pub(crate) complete: bool,
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self { list: vec![fault], warnings: Vec::new(), complete: true }
    }
}

impl From<Fault> for ImportError {
    fn from(fault: Fault) -> Self {
        Self::Invalid(fault.into())
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.list.first().map_or(Ok(()), |first| first.fmt(f))
    }
}

impl std::error::Error for Faults {}

impl Diagnostic for Faults {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        (!self.complete).then(|| Box::new(format!("the search stopped after {} errors", self.list.len())) as _)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.list.first().and_then(|first| first.source_code())
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.list.first().and_then(Diagnostic::labels)
    }

    fn related(&self) -> Option<Box<dyn Iterator<Item = &dyn Diagnostic> + '_>> {
        (self.list.len() > 1).then(|| Box::new(self.list.iter().skip(1).map(|fault| fault as &dyn Diagnostic)) as _)
    }
}

/// Something that was ignored or looks like a mistake; the scene was read all the same.
///
/// Its `Display` form is `file:line:column: message`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(transparent)]
pub struct Warning(#[from] Fault);

impl Warning {
    /// Where it is and what it says.
    pub fn fault(&self) -> &Fault {
        &self.0
    }
}

impl Diagnostic for Warning {
    fn severity(&self) -> Option<Severity> {
        Some(Severity::Warning)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.0.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.0.labels()
    }
}
