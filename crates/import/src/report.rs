//! Collects errors and warnings, bounded in number so that a garbled file gives a readable answer.

use crate::{Fault, Faults, Warning};

/// Errors after which an importer gives up.
const MAX_ERRORS: usize = 20;

/// Warnings that are kept; later ones are dropped, the last one says so.
const MAX_WARNINGS: usize = 100;

/// The errors and warnings of one import.
#[derive(Debug, Default)]
pub(crate) struct Report {
    errors: Vec<Fault>,
    warnings: Vec<Warning>,
}

impl Report {
    /// Whether no further error is wanted: time to stop.
    pub(crate) fn is_full(&self) -> bool {
        self.errors.len() >= MAX_ERRORS
    }

    /// Whether there is an error.
    pub(crate) fn has_errors(&self) -> bool {
        !self.errors.is_empty()
    }

    /// Adds an error, unless the report is full or has the same one already.
    pub(crate) fn error(&mut self, fault: impl FnOnce() -> Fault) {
        if !self.is_full() {
            let fault = fault();
            if !self.errors.contains(&fault) {
                self.errors.push(fault);
            }
        }
    }

    /// Adds a warning, unless there are enough. The fault is only built if it is wanted.
    pub(crate) fn warn(&mut self, fault: impl FnOnce() -> Fault) {
        if self.warnings.len() < MAX_WARNINGS {
            let mut fault = fault();
            if self.warnings.len() + 1 == MAX_WARNINGS {
                fault = fault.expected("fewer warnings: there may be more, but none is shown after this one");
            }
            self.warnings.push(fault.into());
        }
    }

    /// The warnings if there is no error, else the errors.
    pub(crate) fn finish(self) -> Result<Vec<Warning>, Faults> {
        let complete = !self.is_full();
        Faults::new(self.errors, complete).map_or(Ok(self.warnings), Err)
    }
}
