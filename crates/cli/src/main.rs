//! The `lightcuts` command: render scenes with global illumination, inspect them, compare pictures.
//!
//! The command line ([`args`]) and job files ([`job`]) become one finished plan ([`plan`]) before anything is rendered;
//! after that nobody asks what was typed. How the command can end is in [`exit`].

mod args;
mod command;
mod compare;
mod console;
mod develop;
mod devices;
mod drivers;
mod exit;
mod experiment;
mod fault;
mod heatmap;
mod info;
mod interrupt;
mod job;
mod memory;
mod outputs;
mod picture;
mod plan;
mod progress;
mod render;
mod report;
mod shell;
mod summary;

fn main() -> std::process::ExitCode {
    command::run(&args::parse()).into()
}
