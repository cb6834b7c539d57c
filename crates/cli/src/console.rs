//! Standard output and error. Nothing here panics when the reader at the other end of a pipe has gone.

use crate::exit::Failure;
use indicatif::ProgressBar;
use lightcuts::ImportError;
use miette::{Diagnostic, MietteDiagnostic, MietteHandlerOpts, Report, Severity};
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::sync::{Mutex, PoisonError};

/// Decides once how diagnostics look: in colours on a terminal, and elsewhere without line breaks of our own, so that
/// `file:line:column` stays in one piece for other programs. Causes are part of our messages already.
pub(crate) fn set_up() {
    let (colors, terminal) = (has_colors(), stderr().is_terminal());
    let hook = miette::set_hook(Box::new(move |_| {
        let options = MietteHandlerOpts::new()
            .without_cause_chain()
            .terminal_links(colors)
            .wrap_lines(terminal)
            .break_words(terminal);
        Box::new(if colors { options } else { options.color(false) }.build())
    }));
    debug_assert!(hook.is_ok(), "the hook is set once");
}

/// Whether standard error wants colours: a terminal, unless NO_COLOR is set (no-color.org).
pub(crate) fn has_colors() -> bool {
    stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Writes to standard output. A closed pipe is no failure: its reader has what it wanted.
pub(crate) fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::output(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// The bar on standard error, if there is one. A static because signals are told of by a thread that knows no render.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// A bar is shown from now on: lines go above it.
pub(crate) fn share_with(bar: &ProgressBar) {
    *BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
}

/// Writes a line of its own to standard error, if anybody still listens.
pub(crate) fn note(line: &str) {
    let bar = BAR.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let write = || drop(writeln!(stderr().lock(), "{line}"));
    match bar.filter(|bar| !bar.is_finished()) {
        Some(bar) => bar.suspend(write),
        None => write(),
    }
}

/// Shows a warning of one sentence on standard error.
pub(crate) fn warn(message: &str) {
    show(&Report::new(MietteDiagnostic::new(message).with_severity(Severity::Warning)));
}

/// Shows an error or a warning on standard error; of a scene with several errors each as one of its own.
pub(crate) fn show(report: &Report) {
    let note_report = |report: &Report| note(format!("{report:?}").trim_end());
    let Some(error) = report.downcast_ref::<ImportError>().filter(|error| !error.faults().is_empty()) else {
        return note_report(report);
    };
    for fault in error.faults() {
        note_report(&Report::new(fault.clone()));
    }
    if let Some(help) = error.help() {
        note_report(&Report::new(MietteDiagnostic::new(help.to_string()).with_severity(Severity::Advice)));
    }
}
