//! The command `render`: plan, render, write.

use crate::args::{PerformanceArgs, RenderArgs, SimdChoice, ThreadArgs};
use crate::devices::GpuWork;
use crate::exit::{Exit, Failure};
use crate::fault::{fault, span_at};
use crate::job::{COMPLETE_ATTRIBUTE, JOB_ATTRIBUTE, Job, VERSION_ATTRIBUTE, require_regular};
use crate::outputs::{Kind, job_text};
use crate::picture::Picture;
use crate::plan::Plan;
use crate::progress::Progress;
use crate::summary::{Statistics, summary};
use crate::{console, devices, interrupt, memory};
use lightcuts::device::Device;
use lightcuts::{
    AnyScene, Options, PhysicalWorld, SettingsError, Simd, Station, VplCsvError, World, image, vpls_from_csv,
};
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &RenderArgs, logs: bool) -> Result<Exit, Failure> {
    start_threads(&args.performance.threads)?;
    interrupt::listen();
    let assignment = devices::assigned(&args.performance.devices)?;
    let plan = Plan::new(args)?;
    if args.output.dry_run {
        return dry_run(plan, args.output.talk.quiet);
    }
    memory::require_for(&plan.job.settings, &plan.outputs.files)?;
    memory::keep_freed();
    let progress = Progress::new(args.output.talk.progress, args.output.talk.quiet, logs);
    match &plan.scene {
        AnyScene::Thesis(scene) => {
            let options = options(&plan, &args.performance)?;
            let world = World::new(scene).map_err(Failure::input)?;
            if interrupt::came() {
                return Ok(nothing_rendered());
            }
            let fleet = devices::open(&assignment, &world, options.simd, &args.performance.devices, &progress)?;
            let rendering = lightcuts::render_on(&world, &plan.job.settings, &options, &fleet.stations(), &progress);
            progress.finish();
            devices::log(&fleet);
            let picture = rendering.map_err(|error| out_of_range(&error))?.into();
            let device = *fleet.stations().at(Station::Develop);
            finish(&plan, picture, Some(device), GpuWork::of(&fleet), args.output.talk.quiet)
        }
        AnyScene::Physical(scene) => {
            devices::require_cpu(&args.performance.devices)?;
            let world = PhysicalWorld::new(scene).map_err(Failure::input)?;
            if interrupt::came() {
                return Ok(nothing_rendered());
            }
            let simd = simd(&args.performance);
            let rendering = lightcuts::render_physical(&world, &plan.job.settings, simd, &progress);
            progress.finish();
            let picture = rendering.map_err(|error| out_of_range(&error))?.into();
            finish(&plan, picture, None, Vec::new(), args.output.talk.quiet)
        }
    }
}

fn out_of_range(error: &SettingsError) -> Failure {
    Failure::usage(error.to_string(), "see `lightcuts render --help`")
}

fn nothing_rendered() -> Exit {
    console::note("lightcuts: nothing was rendered; nothing is written");
    Exit::Interrupted
}

/// Writes the outputs and sums up.
fn finish(
    plan: &Plan,
    mut picture: Picture,
    device: Option<&dyn Device>,
    gpu: Vec<GpuWork>,
    quiet: bool,
) -> Result<Exit, Failure> {
    let stats = std::mem::take(&mut picture.stats);
    let statistics = Statistics::new(plan, &stats, gpu);
    let (written, exit) = plan.outputs.write(|kind, path| match kind {
        Kind::Exr => write_exr(path, &mut picture, &plan.job, stats.complete),
        Kind::Png => write_png(path, &picture, &plan.job, stats.complete, device),
        Kind::Stats => write(path, &statistics.to_json()?),
        Kind::Vpls => write(path, &picture.vpls_csv()),
        Kind::Job => write(path, &job_text(&plan.job, path)?),
    });
    if !quiet {
        console::print(summary(&statistics, &written).as_bytes())?;
    }
    if stats.complete {
        return Ok(exit);
    }
    let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
    console::note(&format!("lightcuts: the render is not complete; written so far: {}", names.join(", ")));
    Ok(Exit::Interrupted)
}

fn dry_run(mut plan: Plan, quiet: bool) -> Result<Exit, Failure> {
    plan.outputs.files.retain(|(kind, _)| *kind == Kind::Job);
    let (written, exit) = plan.outputs.write(|_, path| write(path, &job_text(&plan.job, path)?));
    if !quiet {
        let names = written.iter().map(|path| format!("wrote {}\n", path.display()));
        let said = format!("{}: scene and job are sound; nothing was rendered\n", plan.job.scene.display());
        console::print((said + &names.collect::<String>()).as_bytes())?;
    }
    Ok(exit)
}

/// Starts the threads of this process.
pub(crate) fn start_threads(args: &ThreadArgs) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(args.threads)).build_global();
    pool.map_err(|error| Failure::usage(format!("cannot start threads: {error}"), "ask for fewer with --threads"))
}

fn simd(args: &PerformanceArgs) -> Simd {
    match args.simd {
        SimdChoice::Auto => Simd::Auto,
        SimdChoice::Off => Simd::Off,
    }
}

fn options(plan: &Plan, args: &PerformanceArgs) -> Result<Options, Failure> {
    let mut options = Options { simd: simd(args), ..Options::default() };
    if let Some(path) = &plan.job.read_vpls {
        let refuse = |why: String| Failure::input(format!("cannot read the VPLs {}: {why}", path.display()));
        require_regular(path).map_err(refuse)?;
        let text = std::fs::read_to_string(path).map_err(|error| refuse(error.to_string()))?;
        let malformed = |VplCsvError { line, column, message }| {
            let span = span_at(&text, line, column);
            fault(Exit::Input, &path.display().to_string(), &text, span, &message, "here")
        };
        options.vpls = Some(vpls_from_csv(&text).map_err(malformed)?);
    }
    Ok(options)
}

/// Texts that go into a picture, apart from the job.
fn remarks(is_complete: bool) -> Vec<(&'static str, &'static str)> {
    let complete = (!is_complete).then_some((COMPLETE_ATTRIBUTE, "false"));
    [(VERSION_ATTRIBUTE, env!("CARGO_PKG_VERSION"))].into_iter().chain(complete).collect()
}

fn write_exr(path: &Path, picture: &mut Picture, job: &Job, is_complete: bool) -> Result<(), Failure> {
    let text = job_text(job, path)?;
    let layers = picture.layers();
    for (name, value) in remarks(is_complete).into_iter().chain([(JOB_ATTRIBUTE, text.as_str())]) {
        layers.set_attribute(name, value).map_err(Failure::output)?;
    }
    image::write_exr(path, layers).map_err(Failure::output)
}

fn write_png(
    path: &Path,
    picture: &Picture,
    job: &Job,
    is_complete: bool,
    device: Option<&dyn Device>,
) -> Result<(), Failure> {
    let text = job_text(job, path)?;
    let texts: Vec<_> = [(JOB_ATTRIBUTE, text.as_str())].into_iter().chain(remarks(is_complete)).collect();
    let display = &job.settings.display;
    let shown = picture.displayed(display, device);
    image::write_png_with_text(path, &shown, display.transfer, &texts).map_err(Failure::output)
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    image::write_atomic(path, text.as_bytes()).map_err(Failure::output)
}
