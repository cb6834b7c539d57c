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

    /// The warnings if there is no error, else the errors with the warnings, which may tell where the errors come from.
    pub(crate) fn finish(self) -> Result<Vec<Warning>, Faults> {
        if self.errors.is_empty() {
            return Ok(self.warnings);
        }
        let complete = !self.is_full();
        Err(Faults { list: self.errors, warnings: self.warnings, complete })
    }
}

/// Things of one kind in a file, counted and warned about once, at the first of them.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    count: usize,
    first: Option<Box<Fault>>,
}

impl Tally {
    /// Counts one more; `place` is a fault there that has yet to say what is wrong.
    pub(crate) fn note(&mut self, place: impl FnOnce() -> Fault) {
        self.count += 1;
        self.first.get_or_insert_with(|| Box::new(place()));
    }

    /// Warns if there were any.
    pub(crate) fn warn(self, report: &mut Report, message: impl FnOnce(usize) -> String) {
        if let Some(first) = self.first {
            report.warn(|| first.with_message(&message(self.count)));
        }
    }
}

/// `1 face`, `2 faces`.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
