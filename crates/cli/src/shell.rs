//! Completion scripts and man pages, generated from the command line's declaration.

use crate::args;
use crate::console;
use crate::exit::{Exit, Failure};
use clap_complete::Shell;
use std::path::Path;

/// Prints a completion script.
pub(crate) fn completions(shell: Shell) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut args::command(), "lightcuts", &mut script);
    console::print(&script).map(|()| Exit::Done)
}

/// Prints the man page, or writes those of all commands to a folder, created if absent.
pub(crate) fn man(directory: Option<&Path>) -> Result<Exit, Failure> {
    if let Some(directory) = directory {
        let made = std::fs::create_dir_all(directory);
        let written = made.and_then(|()| clap_mangen::generate_to(args::command(), directory));
        let refuse = |error| Failure::output(format!("cannot write man pages to {}: {error}", directory.display()));
        return written.map(|()| Exit::Done).map_err(refuse);
    }
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(args::command()).render(&mut page);
    rendered.map_err(|error| Failure::output(format!("cannot make the man page: {error}")))?;
    console::print(&page).map(|()| Exit::Done)
}
