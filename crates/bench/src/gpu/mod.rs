//! `cargo xtask bench gpu`: everything that is worth knowing of a GPU, in one call.

mod adapter;
mod batches;
mod heavy;
mod log;
mod published;
mod rays;
mod scenes;
mod selection;
mod setup;
mod submissions;

use crate::place;
use crate::record;
use anyhow::{Result, ensure};
use log::Log;
use setup::Setup;
use std::path::PathBuf;
use std::time::Instant;

/// What the help ends with.
const AFTER_HELP: &str = "\
Examples:
  cargo xtask bench gpu --quick             does everything work?
  cargo xtask bench gpu --append            figures to keep, in benches/LOG.md
  cargo xtask bench gpu --device llvmpipe   Mesa's software driver, even where there is a card
  cargo xtask bench gpu --section 6         whether submissions keep to the budget, nothing else

A card needs about a minute for everything; a software driver needs many, most of them for
section 2, whose pictures cannot be smaller.

What is measured, and how:
  * Seconds of programs are the device's own where it has timestamps, and exclude transfers;
    else they are shares of the submissions' time. Wall seconds include transfers and what the
    processor does meanwhile.
  * Programs are compiled when they are first used, so each measurement is preceded by one that
    does not count.
  * Sections 1 to 4 say how fast the device is; 5 and 6 whether it stays responsive: no
    submission is to take longer than twice the governor's budget, once it has had a second to
    learn what work costs.
  * The CPU stands beside it with its renderer on two threads, as in the other benchmark.

For figures worth keeping let nothing else run on the machine; its load is noted in the entry.";

#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct Args {
    /// The GPU: `gpu` is the best adapter, even a software driver; `auto` a graphics card only; NAME a part of an adapter's
    /// name, as `lightcuts devices` lists them.
    #[arg(long, value_name = "NAME", default_value = "gpu")]
    device: String,
    /// Folder with venus.obj and galleon.obj, which are not part of the project [default: ../shared/models].
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// One run instead of the middle one of three, fewer rays and smaller pictures.
    #[arg(long)]
    quick: bool,
    /// Section to measure, by its number; may be repeated [default: all].
    #[arg(long = "section", value_name = "N", value_parser = clap::value_parser!(u8).range(1..=SECTIONS.len() as i64))]
    sections: Vec<u8>,
    /// Append everything to a Markdown file, with the date, the device and the git revision; benches/LOG.md unless FILE is
    /// given, which is relative to the project's root.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "benches/LOG.md")]
    append: Option<PathBuf>,
    /// Date of the entry, such as 2026-11-30 [default: today, UTC].
    #[arg(long, requires = "append")]
    date: Option<String>,
}

type Section = fn(&Setup, &mut Log) -> Result<String>;

/// What is printed, in order.
const SECTIONS: [(&str, Section); 6] = [
    ("1. The device", adapter::section),
    ("2. The thesis' scenes", scenes::section),
    ("3. Rays", rays::section),
    ("4. Choice of VPLs", selection::section),
    ("5. Submissions of all the work above", submissions::section),
    ("6. Submissions of a heavy scene", heavy::section),
];

/// Measures everything, printing each section as soon as it is there; fails at the end if one failed.
pub(crate) fn run(args: &Args) -> Result<()> {
    let setup = Setup::new(&args.device, args.models.clone().unwrap_or_else(place::shared_models), args.quick)?;
    let mut entry = record::heading(args.date.as_deref(), Some(&setup.title())) + &setup.conditions();
    print!("{entry}");
    let (mut log, mut failed) = (Log::default(), Vec::new());
    let is_wanted = |number: &u8| args.sections.is_empty() || args.sections.contains(number);
    for (_, (title, section)) in (1..).zip(SECTIONS).filter(|(number, _)| is_wanted(number)) {
        let start = Instant::now();
        let text = section(&setup, &mut log).unwrap_or_else(|error| {
            failed.push(title);
            format!("Failed: {error:#}\n")
        });
        let text = format!("\n### {title}\n\n{text}");
        print!("{text}");
        entry += &text;
        eprintln!("[{title}: {:.0} s]", start.elapsed().as_secs_f64());
    }
    if let Some(path) = &args.append {
        record::append(&place::root().join(path), record::INTRODUCTION, &entry)?;
    }
    ensure!(failed.is_empty(), "not measured: {}", failed.join("; "));
    Ok(())
}
