//! `cargo xtask bench equal-time` and `convergence`: error against a reference after the same time.

mod case;
mod convergence;
mod cornell;
mod lamps;
mod reference;
mod report;

pub(crate) use convergence::Args as ConvergenceArgs;
pub(crate) use convergence::run as run_convergence;

use crate::physical::{busy_s, render, settings};
use crate::record;
use anyhow::{Context as _, Result};
use case::Case;
use clap::ValueEnum;
use lightcuts::PhysicalRendering;
use lightcuts::rendering::Integrator;
use report::Measured;

/// Threads that render, as many as the peers' figures are of.
const THREADS: usize = 2;

/// What is compared, with the names of the tables.
const INTEGRATORS: [(&str, Integrator); 3] =
    [("path", Integrator::Path), ("lightcuts", Integrator::Lightcuts), ("auto", Integrator::Auto)];

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Times in seconds.
    #[arg(long, value_delimiter = ',', default_values_t = [1.0, 3.0, 10.0, 30.0])]
    seconds: Vec<f64>,
    /// Scene to measure; may be repeated [default: all].
    #[arg(long = "scene", value_name = "NAME", value_enum)]
    scenes: Vec<Scene>,
    #[command(flatten)]
    reference: reference::Args,
    /// Append the table to benches/LOG.md, with the date, the processor and the git revision.
    #[arg(long)]
    append: bool,
}

/// The scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Scene {
    /// scenes/physical/room.toml: most of the picture sees the lamp.
    Open,
    /// scenes/physical/corner.toml: nothing sees the lamp.
    Occluded,
    /// A thousand small lamps in a room of 100,000 triangles.
    Lamps,
    /// Cornell University's box, beside other renderers.
    Cornell,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    on_threads(|| {
        let folder = tempfile::tempdir().context("cannot make a folder for the scenes")?;
        let scenes = if args.scenes.is_empty() { Scene::value_variants() } else { &args.scenes };
        let mut text = String::new();
        let mut clock = Clock { slowness: 1.0 };
        for &scene in scenes {
            let Some(case) = Case::new(scene, folder.path(), &args.reference)? else { continue };
            let mut rows = Vec::new();
            for (name, integrator) in INTEGRATORS {
                let errors = args.seconds.iter().map(|&seconds| clock.error_after(&case, integrator, seconds));
                let errors: Vec<f64> = errors.collect::<Result<_>>()?;
                let shown: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
                eprintln!("{}, {name}: {}", case.title, shown.join(", "));
                rows.push(Measured { name, errors });
            }
            text += &report::section(&case, &args.seconds, &rows);
        }
        text += report::REMARKS;
        println!("{text}");
        if args.append {
            record::append_to_log("error after equal time, two threads", &text)?;
        }
        Ok(())
    })
}

/// Runs something with [`THREADS`] threads.
fn on_threads<T: Send>(work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS).build().context("cannot start threads")?;
    pool.install(work)
}

/// Time as the threads see it: other programs on the machine make it pass more slowly.
struct Clock {
    /// Elapsed seconds per second of work, by the last render.
    slowness: f64,
}

impl Clock {
    /// relMSE of a picture that the threads worked at for so long. What they worked more or less is made up for: error falls with
    /// 1 / time.
    fn error_after(&mut self, case: &Case, integrator: Integrator, seconds: f64) -> Result<f64> {
        let mut settings = settings(case.size, 1 << 20);
        settings.physical.integrator = integrator;
        settings.physical.time_limit = (seconds * self.slowness) as f32;
        settings.run.seed = 7;
        let rendering = render(&case.world, &settings)?;
        let busy_s = busy_s(&rendering);
        self.slowness = (rendering.stats.total_wall_s / busy_s).clamp(1.0, 8.0);
        Ok(error(case, &rendering)? * (busy_s / seconds))
    }
}

/// relMSE against the case's reference, without the reference's own.
fn error(case: &Case, rendering: &PhysicalRendering) -> Result<f64> {
    Ok(case.reference.error_of(&rendering.beauty)?)
}
