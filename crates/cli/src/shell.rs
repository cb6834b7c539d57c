//! Completion scripts and man pages, made of the command line's declaration.

use crate::args::Cli;
use crate::console;
use crate::exit::{Exit, Failure};
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::Path;

/// Prints a completion script.
pub(crate) fn completions(shell: Shell) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "lightcuts", &mut script);
    console::print(&script).map(|()| Exit::Done)
}

/// Prints the man page, or writes those of all commands to a folder.
pub(crate) fn man(directory: Option<&Path>) -> Result<Exit, Failure> {
    if let Some(directory) = directory {
        let written = clap_mangen::generate_to(Cli::command(), directory);
        return match written {
            Ok(()) => Ok(Exit::Done),
            Err(error) => Err(Failure::output(format!("cannot write man pages to {}: {error}", directory.display()))),
        };
    }
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(Cli::command()).render(&mut page);
    rendered.map_err(|error| Failure::output(format!("cannot make the man page: {error}")))?;
    console::print(&page).map(|()| Exit::Done)
}
