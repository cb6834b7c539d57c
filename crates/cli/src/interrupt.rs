//! SIGINT and SIGTERM: the first asks the render to stop, the second ends the process.

use crate::console;
use crate::exit::Exit;
use std::sync::atomic::{AtomicU32, Ordering};

/// Signals so far. A static because a signal is the process' matter, not a caller's.
static SIGNALS: AtomicU32 = AtomicU32::new(0);

/// Starts listening. Where the system refuses, signals keep their usual meaning.
pub(crate) fn listen() {
    let listening = ctrlc::set_handler(|| {
        if SIGNALS.fetch_add(1, Ordering::SeqCst) > 0 {
            std::process::exit(i32::from(Exit::Interrupted.code()));
        }
        console::note(
            "lightcuts: interrupted; stopping and writing what was rendered so far (press again to stop at once)",
        );
    });
    if let Err(error) = listening {
        tracing::warn!("no orderly end on Ctrl-C: {error}");
    }
}

/// Whether a signal came.
pub(crate) fn came() -> bool {
    SIGNALS.load(Ordering::SeqCst) > 0
}
