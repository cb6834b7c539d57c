//! From the command line to a finished plan: scene read, job resolved, outputs checked. Nothing is rendered or written.

use crate::args::{JobArgs, RenderArgs, SearchArgs};
use crate::console;
use crate::exit::{Exit, Failure};
use crate::job::{self, Job, JobFile};
use crate::outputs::Outputs;
use lightcuts::scene::SceneDesc;
use lightcuts::{ImportOptions, Imported, Settings};
use miette::Report;
use std::path::{Path, PathBuf};

/// Separated as in PATH: more folders to search for models and textures.
const SEARCH_VARIABLE: &str = "LIGHTCUTS_PATH";

/// All that a render needs to know.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) scene: SceneDesc,
    pub(crate) job: Job,
    pub(crate) outputs: Outputs,
}

/// What the job files and the command line say before the scene is read.
struct Sources {
    files: Vec<JobFile>,
    scene: PathBuf,
    search_path: Vec<PathBuf>,
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
        let imported = load(&sources.scene, &sources.search_path)?;
        let recommended = Settings::for_scene(&imported.scene);
        let settings = job::resolve(&recommended, &sources.files, &args.settings)?;
        sources.inputs.extend(imported.files);
        outputs.check(&sources.inputs)?;
        let Sources { scene, search_path, read_vpls, .. } = sources;
        Ok(Self { scene: imported.scene, job: Job { scene, search_path, read_vpls, settings }, outputs })
    }
}

impl Sources {
    fn new(scene: Option<&Path>, args: &JobArgs) -> Result<Self, Failure> {
        let carriers = scene.filter(|path| job::is_job_carrier(path)).into_iter().chain(args.file.as_deref());
        let files: Vec<JobFile> = carriers.map(JobFile::read).collect::<Result<_, _>>()?;
        let last = |path: fn(&JobFile) -> &Option<PathBuf>| files.iter().rev().find_map(|file| path(file).clone());
        let given = scene.filter(|path| !job::is_job_carrier(path)).map(Path::to_path_buf);
        let scene_of_job = given.or_else(|| last(|file| &file.scene)).ok_or_else(|| {
            Failure::usage(
                "the job names no scene",
                "give a scene on the command line, or `scene = \"file\"` in the job",
            )
        })?;
        let read_vpls = args.read_vpls.clone().or_else(|| last(|file| &file.read_vpls));
        let inputs = [scene, args.file.as_deref(), Some(&scene_of_job), read_vpls.as_deref()];
        Ok(Self {
            inputs: inputs.into_iter().flatten().map(Path::to_path_buf).collect(),
            search_path: search_path(&args.search, files.iter().rev().flat_map(|file| &file.search_path)),
            files,
            scene: scene_of_job,
            read_vpls,
        })
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

/// Reads a scene; its warnings go to standard error.
pub(crate) fn load(path: &Path, search_paths: &[PathBuf]) -> Result<Imported, Failure> {
    let options = ImportOptions { search_paths: search_paths.to_vec(), ..ImportOptions::default() };
    let imported = lightcuts::load(path, &options).map_err(|error| Failure::new(Exit::Input, error))?;
    tracing::info!(files = imported.files.len(), "read {}", path.display());
    for warning in &imported.warnings {
        console::show(&Report::new(warning.clone()));
    }
    Ok(imported)
}
