//! The command `experiment`: plan, render what is not finished, sum up.

mod failure;
mod progress;
mod text;

use crate::args::ExperimentArgs;
use crate::exit::{Exit, Failure};
use crate::job::{JOB_ATTRIBUTE, Job, VERSION_ATTRIBUTE};
use crate::outputs::folder_of;
use crate::plan::search_path;
use crate::{console, interrupt, memory};
use failure::{plan_failure, results_failure, run_failure, unknown_name};
use lightcuts::World;
use lightcuts_experiment::plan::PlannedJob;
use lightcuts_experiment::{ExperimentFile, Plan, Results, Runner, results, run};
use miette::Report;
use progress::Progress;
use std::path::{Path, PathBuf};

/// Default folder of experiments, in the current folder.
const OUTPUT: &str = "out";

/// An experiment with what the command line says of it.
struct Experiment {
    plan: Plan,
    /// The jobs asked for, by their numbers.
    selection: Vec<usize>,
    directory: PathBuf,
    search_path: Vec<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(args: &ExperimentArgs, logs: bool) -> Result<Exit, Failure> {
    interrupt::listen();
    let experiment = Experiment::new(args)?;
    if args.dry_run {
        return experiment.dry_run(args.talk.quiet).map(|()| Exit::Done);
    }
    experiment.check_memory()?;
    let Experiment { plan, selection, directory, .. } = &experiment;
    let mut runner = Runner::open(plan, directory).map_err(|error| run_failure(error, directory))?;
    let progress = Progress::new(args.talk.progress, args.talk.quiet, logs);
    let texts = |job: &PlannedJob, path: &Path| experiment.texts(job, path);
    let outcome = runner.run(selection, &texts, &progress);
    progress.finish();
    let outcome = outcome.map_err(|error| run_failure(error, directory))?;
    if outcome.interrupted {
        console::note(&text::interrupted(&outcome, selection.len(), directory));
        return Ok(Exit::Interrupted);
    }
    if !args.talk.quiet {
        console::print(text::summary(plan, &outcome, directory).as_bytes())?;
    }
    Ok(Exit::Done)
}

impl Experiment {
    /// Makes the plan. Warnings of the scenes are shown on the way.
    fn new(args: &ExperimentArgs) -> Result<Self, Failure> {
        let file = ExperimentFile::read(&args.file).map_err(plan_failure)?;
        let search_path = search_path(&args.search, file.search_path().iter());
        let plan = Plan::new(&file, &search_path).map_err(plan_failure)?;
        for warning in plan.scenes.iter().flat_map(|scene| &scene.warnings) {
            console::show(&Report::new(warning.clone()));
        }
        let selection = plan.select(&args.only).map_err(|error| unknown_name(&error))?;
        let directory = args.directory.clone().unwrap_or_else(|| Path::new(OUTPUT).join(file.name()));
        Ok(Self { plan, selection, directory, search_path })
    }

    /// Checks what a render checks, and prints the plan with what is finished of it.
    fn dry_run(&self, quiet: bool) -> Result<(), Failure> {
        let path = self.directory.join(results::FILE_NAME);
        let results = if path.exists() {
            Results::read(&path).map_err(|error| results_failure(&error))?
        } else {
            Results::default()
        };
        let finished = run::finished(&self.plan, &self.directory, &results);
        for scene in &self.plan.scenes {
            World::new(&scene.description).map_err(Failure::input)?;
        }
        let text = text::plan(&self.plan, &self.selection, &finished, &path);
        if quiet { Ok(()) } else { console::print(text.as_bytes()) }
    }

    /// Fails if a picture of the plan does not fit into memory: no long experiment is to end on its last job.
    fn check_memory(&self) -> Result<(), Failure> {
        self.plan.jobs.iter().try_for_each(|job| memory::require_for(&job.settings, &[]))
    }

    /// Version and job, so that `lightcuts render` renders a picture of the experiment again.
    fn texts(&self, job: &PlannedJob, path: &Path) -> Vec<(&'static str, String)> {
        let job = Job {
            scene: self.plan.scenes[job.scene].file.clone(),
            search_path: self.search_path.clone(),
            crease_angle: None,
            read_vpls: None,
            settings: job.settings.clone(),
        };
        let text = job.to_toml(folder_of(path)).ok();
        let version = (VERSION_ATTRIBUTE, env!("CARGO_PKG_VERSION").to_owned());
        [version].into_iter().chain(text.map(|text| (JOB_ATTRIBUTE, text))).collect()
    }
}
