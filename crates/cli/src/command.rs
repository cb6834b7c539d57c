//! From parsed arguments to an exit code.

use crate::args::{Cli, Command};
use crate::exit::{Exit, Failure};
use crate::{compare, console, develop, devices, drivers, experiment, heatmap, info, render, report, shell};
use std::io::IsTerminal;
use tracing_subscriber::EnvFilter;

/// Runs the command; failures are shown here and nowhere else.
pub(crate) fn run(cli: &Cli) -> Exit {
    console::set_up();
    start_logging(cli.verbose);
    if matches!(cli.command, Command::Render(_) | Command::Devices(_) | Command::Experiment(_)) {
        drivers::hush();
    }
    let result = match &cli.command {
        Command::Render(args) => render::run(args, cli.verbose > 0),
        Command::Info(args) => info::run(args),
        Command::Devices(args) => devices::run(args),
        Command::Compare(args) => compare::run(args, cli.verbose > 0),
        Command::Develop(args) => develop::run(args),
        Command::Heatmap(args) => heatmap::run(args),
        Command::Experiment(args) => experiment::run(args, cli.verbose > 0),
        Command::Report(args) => report::run(args),
        Command::Completions { shell } => shell::completions(*shell),
        Command::Man { directory } => shell::man(directory.as_deref()),
    };
    result.unwrap_or_else(|Failure { exit, report }| {
        console::show(&report);
        exit
    })
}

fn start_logging(verbose: u8) {
    let level = match verbose {
        0 => "off",
        1 => "info",
        2 => "debug",
        _ => "trace",
    };
    let filter = EnvFilter::try_from_env("LIGHTCUTS_LOG").unwrap_or_else(|_| EnvFilter::new(level));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_ansi(console::has_colors())
        .with_writer(std::io::stderr)
        .without_time()
        .with_target(std::io::stderr().is_terminal())
        .init();
}
