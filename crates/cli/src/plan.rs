//! From the command line to a finished plan: scene read, job resolved, outputs checked. Nothing is rendered or written.

use crate::args::{CreaseArgs, JobArgs, RenderArgs, SearchArgs};
use crate::console;
use crate::exit::{Exit, Failure};
use crate::job::{self, Job, JobFile};
use crate::outputs::Outputs;
use lightcuts::rendering::{Integrator, Model};
use lightcuts::scene::physical::from_thesis;
use lightcuts::{AnyScene, ImportError, ImportOptions, Imported, Settings};
use miette::Report;
use std::path::{Path, PathBuf};

/// Separated as in PATH: more folders to search for models and textures.
const SEARCH_VARIABLE: &str = "LIGHTCUTS_PATH";

/// Everything that a render needs.
#[derive(Debug)]
pub(crate) struct Plan {
    /// Of the job's model of light.
    pub(crate) scene: AnyScene,
    pub(crate) job: Job,
    pub(crate) outputs: Outputs,
}

/// What the job files and the command line say before the scene is read.
struct Sources {
    files: Vec<JobFile>,
    scene: PathBuf,
    search_path: Vec<PathBuf>,
    crease_angle: Option<f32>,
    read_vpls: Option<PathBuf>,
    /// Every file that was named as input.
    inputs: Vec<PathBuf>,
}

impl Plan {
    /// Makes the plan, cheap checks first. The scene's warnings are shown on the way.
    pub(crate) fn new(args: &RenderArgs) -> Result<Self, Failure> {
        let mut sources = Sources::new(args.scene.as_deref(), &args.job)?;
        let outputs = Outputs::new(&args.output, &sources.scene)?;
        outputs.check(&sources.inputs)?;
        let imported = load(&sources.scene, &sources.search_path, sources.crease_angle)?;
        refuse_crease_angle(&imported.scene, &args.job.crease, &sources.files)?;
        let model = fitting_model(&imported.scene, &sources.files, args)?;
        let settings = job::resolve(&recommended(&imported.scene, model), &sources.files, &args.settings)?;
        refuse_light_scale(&imported.scene, &settings)?;
        warn_of_unused(&settings, args);
        let scene = in_model(imported.scene, &settings);
        sources.inputs.extend(imported.files);
        outputs.check(&sources.inputs)?;
        let Sources { scene: file, search_path, crease_angle, read_vpls, .. } = sources;
        // A job of the thesis' model may name some, and be rendered in the other one, which makes new VPLs in each
        // pass.
        let read_vpls = read_vpls.filter(|_| model == Model::Thesis);
        Ok(Self { scene, job: Job { scene: file, search_path, crease_angle, read_vpls, settings }, outputs })
    }

    /// The scene's name.
    pub(crate) fn scene_name(&self) -> &str {
        match &self.scene {
            AnyScene::Thesis(scene) => &scene.name,
            AnyScene::Physical(scene) => &scene.name,
        }
    }
}

impl Sources {
    fn new(scene: Option<&Path>, args: &JobArgs) -> Result<Self, Failure> {
        let carriers = scene.filter(|path| job::is_job_carrier(path)).into_iter().chain(args.file.as_deref());
        let files: Vec<JobFile> = carriers.map(JobFile::read).collect::<Result<_, _>>()?;
        let last = |path: fn(&JobFile) -> &Option<PathBuf>| files.iter().rev().find_map(|file| path(file).clone());
        let given = scene.filter(|path| !job::is_job_carrier(path)).map(Path::to_path_buf);
        let scene_of_job = given.or_else(|| last(|file| &file.scene)).ok_or_else(|| no_scene(&files))?;
        let read_vpls = args.read_vpls.clone().or_else(|| last(|file| &file.read_vpls));
        let inputs = [scene, args.file.as_deref(), Some(&scene_of_job), read_vpls.as_deref()];
        Ok(Self {
            inputs: inputs.into_iter().flatten().map(Path::to_path_buf).collect(),
            crease_angle: args.crease.angle.or_else(|| files.iter().rev().find_map(|file| file.crease_angle)),
            search_path: search_path(&args.search, files.iter().rev().flat_map(|file| &file.search_path)),
            files,
            scene: scene_of_job,
            read_vpls,
        })
    }
}

/// The error where neither the command line nor a job file names a scene.
fn no_scene(files: &[JobFile]) -> Failure {
    if let [file] = files
        && file.is_empty()
    {
        return Failure::usage(
            format!("{} is empty, or holds only comments: it is neither a scene nor a job", file.name()),
            "a scene begins with the line `format = \"lightcuts-scene\"`; a job has a line `scene = \"file\"`",
        );
    }
    let names: Vec<&str> = files.iter().map(JobFile::name).collect();
    let verb = if names.len() == 1 { "names" } else { "name" };
    Failure::usage(
        format!("{} {verb} no scene", names.join(" and ")),
        "give a scene on the command line, or `scene = \"file\"` in the job",
    )
}

/// Says which options a path tracer without VPLs has no use for.
fn warn_of_unused(settings: &Settings, args: &RenderArgs) {
    let unused = args.settings.options_of_vpls();
    let is_path = settings.run.model == Model::Physical && settings.physical.integrator == Integrator::Path;
    if is_path && !unused.is_empty() {
        let have = if unused.len() == 1 { "has" } else { "have" };
        console::warn(&format!("{} {have} no effect with the integrator `path`, which has no VPLs", unused.join(", ")));
    }
}

/// The model of light of the render. Fails if it cannot render the scene, or if an option has no meaning in it.
fn fitting_model(scene: &AnyScene, files: &[JobFile], args: &RenderArgs) -> Result<Model, Failure> {
    let of_scene = match scene {
        AnyScene::Thesis(_) => Model::Thesis,
        AnyScene::Physical(_) => Model::Physical,
    };
    let model = job::model(of_scene, files, &args.settings);
    if model == Model::Thesis && of_scene == Model::Physical {
        let culprit = files.iter().rev().find(|file| file.model().is_some());
        // Flags win over files.
        let culprit = culprit.filter(|_| job::model(of_scene, &[], &args.settings) == Model::Physical);
        return Err(culprit.map_or_else(
            || {
                let message = "the scene is of the physical model and cannot be rendered in the thesis' model";
                Failure::usage(message, "leave out --model")
            },
            JobFile::wrong_model,
        ));
    }
    job::require_fitting(args, model, of_scene)?;
    Ok(model)
}

/// The built-in defaults with what the scene recommends for a model of light.
fn recommended(scene: &AnyScene, model: Model) -> Settings {
    match (scene, model) {
        (AnyScene::Thesis(scene), Model::Thesis) => Settings::for_scene(scene),
        _ => Settings::for_physical(),
    }
}

/// Fails if lights are scaled of a scene that has radiometric ones.
fn refuse_light_scale(scene: &AnyScene, settings: &Settings) -> Result<(), Failure> {
    let scale = settings.physical.light_scale;
    if scale == 1.0 || matches!(scene, AnyScene::Thesis(_)) {
        return Ok(());
    }
    Err(Failure::usage(
        format!("physical.light-scale is {scale}, but only lights of scenes in the thesis' text format are scaled"),
        "leave out --light-scale, or the job's key, and scale the lights in the scene",
    ))
}

/// The scene in the model of light that the settings name, which can render it.
fn in_model(scene: AnyScene, settings: &Settings) -> AnyScene {
    match (scene, settings.run.model) {
        (AnyScene::Thesis(scene), Model::Physical) => {
            AnyScene::Physical(from_thesis(&scene, settings.physical.light_scale))
        }
        (scene, _) => scene,
    }
}

/// Folders to search, without repetitions: flags, job, environment.
pub(crate) fn search_path<'a>(args: &'a SearchArgs, of_job: impl Iterator<Item = &'a PathBuf>) -> Vec<PathBuf> {
    let variable = std::env::var_os(SEARCH_VARIABLE).unwrap_or_default();
    let of_environment = std::env::split_paths(&variable).filter(|folder| !folder.as_os_str().is_empty());
    let mut folders: Vec<PathBuf> = Vec::new();
    for folder in args.folders.iter().chain(of_job).cloned().chain(of_environment) {
        if !folders.contains(&folder) {
            folders.push(folder);
        }
    }
    folders
}

/// Reads a scene; its warnings go to standard error. `crease_angle`, in degrees, takes the place of those of its
/// objects.
pub(crate) fn load(
    path: &Path,
    search_paths: &[PathBuf],
    crease_angle: Option<f32>,
) -> Result<Imported<AnyScene>, Failure> {
    let options =
        ImportOptions { search_paths: search_paths.to_vec(), crease_degrees: crease_angle, ..ImportOptions::default() };
    let result = lightcuts::load_any(path, &options);
    // Warnings may tell where errors come from.
    let warnings = result.as_ref().map_or_else(ImportError::warnings, |imported| imported.warnings.as_slice());
    for warning in warnings {
        console::show(&Report::new(warning.clone()));
    }
    let imported = result.map_err(|error| Failure::new(Exit::Input, error))?;
    tracing::info!(files = imported.files.len(), "read {}", path.display());
    Ok(imported)
}

/// Fails if the flag, or else a job file, gives a crease angle to a scene in the thesis' text format, whatever the model
/// of light: nothing in it is smoothed by an angle.
pub(crate) fn refuse_crease_angle(scene: &AnyScene, flag: &CreaseArgs, files: &[JobFile]) -> Result<(), Failure> {
    match scene {
        AnyScene::Physical(_) => Ok(()),
        AnyScene::Thesis(_) if flag.angle.is_some() => {
            Err(Failure::usage("--crease-angle has no meaning in the thesis' text format", "leave it out"))
        }
        AnyScene::Thesis(_) => files.iter().rev().find_map(JobFile::needless_crease_angle).map_or(Ok(()), Err),
    }
}
