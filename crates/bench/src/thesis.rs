//! `cargo xtask bench thesis`: the thesis' experiment on the CPU.

use crate::experiment::{Case, Scene};
use crate::measure::{self, Configuration};
use crate::place;
use crate::record;
use crate::row::{self, Row};
use anyhow::{Context as _, Result};
use std::collections::BTreeSet;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Runs of each configuration; the median counts.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    runs: u32,
    /// Folder with venus.obj and galleon.obj, which are not part of the project [default: ../shared/models].
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// Scene to measure; may be repeated [default: all].
    #[arg(long = "scene", value_name = "NAME", value_enum)]
    scenes: Vec<Scene>,
    /// Append the table to a Markdown file, with the date, the processor and the git revision.
    #[arg(long, value_name = "FILE")]
    append: Option<PathBuf>,
    /// Date of the entry, such as 2026-11-30 [default: today, UTC].
    #[arg(long, requires = "append")]
    date: Option<String>,
}

/// Renders the scenes and prints the table.
pub(crate) fn run(args: &Args) -> Result<()> {
    let models = args.models.clone().unwrap_or_else(place::shared_models);
    let cli = place::cli()?;
    let folder = tempfile::tempdir().context("cannot make a folder for the results")?;
    let scenes = if args.scenes.is_empty() { &Scene::ALL[..] } else { &args.scenes };
    let mut rows = Vec::new();
    for scene in scenes {
        let case = Case::new(*scene, &models);
        if let Some(absent) = case.absent_model {
            println!("{absent} is not here: {} takes its place, without a factor", case.file);
        }
        // One, as the original program has, and all of the machine's: what they wait for each other counts too.
        for threads in BTreeSet::from([1, record::hardware_threads()]) {
            let median = measure::interleaved(&cli, &case, threads, &models, folder.path(), args.runs)?;
            let plain_s = median[Configuration::Plain as usize].total_cpu_s;
            rows.extend(Configuration::ALL.map(|configuration| {
                let measured = median[configuration as usize];
                let compared = (configuration == Configuration::Lightcuts).then_some(plain_s);
                Row::new(&case, configuration, threads, measured, compared)
            }));
        }
    }
    let table = row::markdown(&rows);
    println!("\n{table}");
    if let Some(path) = &args.append {
        record::append(path, "", &record::entry(args.date.as_deref(), args.runs, &table))?;
    }
    Ok(())
}
