//! Scenes of a plan: read, or their stand-ins where a model cannot be found.

use super::fault::PlanError;
use super::file::{ExperimentFile, SceneTable};
use crate::hash;
use lightcuts::import::{FileError, FileResolver, Limits, Resolver, Warning, parse_thesis};
use lightcuts::{ImportError, ImportOptions, Imported, SceneDesc};
use std::cell::RefCell;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What is said of a scene in TOML.
const OF_ANOTHER_MODEL: &str =
    "experiments render the thesis' model only, and a scene in TOML is of the physical model";

/// What was expected where the scene cannot be read.
const A_SCENE: &str = "a scene, relative to this file";

/// A scene of the experiment, ready to be rendered.
#[derive(Debug)]
pub struct PlannedScene {
    /// Key of the rows.
    pub name: String,
    /// The file that was read: the scene's or its stand-in's.
    pub file: PathBuf,
    /// Models that could not be found, so that the stand-in was read; else empty.
    pub missing: Vec<String>,
    /// What the file says.
    pub description: SceneDesc,
    /// What was ignored in the file or looks like a mistake.
    pub warnings: Vec<Warning>,
    /// SHA-256 over the contents of every file that the scene consists of.
    pub(super) hash: String,
}

impl PlannedScene {
    /// Reads scene number `i` of an experiment.
    pub(super) fn load(file: &ExperimentFile, i: usize, search_paths: &[PathBuf]) -> Result<Self, PlanError> {
        let table = &file.document.scene[i];
        let options = ImportOptions { search_paths: search_paths.to_vec(), ..ImportOptions::default() };
        let path = file.find(&table.file);
        let load = |path: &Path, key: &str| {
            let place = format!("scene.{i}.{key}");
            refuse_toml(file, &place, path)?;
            lightcuts::load(path, &options).map_err(|error| import_error(file, &place, error))
        };
        let Some(stand_in) = &table.stand_in else {
            return Self::new(table, path.clone(), Vec::new(), load(&path, "file")?);
        };
        let missing = missing_models(&path, search_paths);
        if missing.is_empty() {
            return Self::new(table, path.clone(), missing, load(&path, "file")?);
        }
        let path = file.find(&stand_in.file);
        let imported = load(&path, "stand-in.file")?;
        Self::new(table, path, missing, imported)
    }

    fn new(table: &SceneTable, file: PathBuf, missing: Vec<String>, imported: Imported) -> Result<Self, PlanError> {
        let mut hash = hash::Fields::of("lightcuts scene");
        for path in &imported.files {
            let of_file = hash::of_file(path).map_err(|source| PlanError::File { path: path.clone(), source })?;
            hash = hash.with("file", of_file);
        }
        let Imported { scene: description, warnings, .. } = imported;
        Ok(Self { name: table.name.clone(), file, missing, description, warnings, hash: hash.finish() })
    }
}

/// Fails for a scene in TOML, named at `place`: only the physical model renders those.
fn refuse_toml(file: &ExperimentFile, place: &str, path: &Path) -> Result<(), PlanError> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        return Ok(());
    }
    let (message, expected) = match std::fs::metadata(path) {
        Ok(_) => (OF_ANOTHER_MODEL.to_owned(), "a scene in the thesis' text format (.txt)"),
        Err(error) => (format!("cannot read the scene {}: {error}", path.display()), A_SCENE),
    };
    Err(file.source.fault(place, message, expected))
}

/// A scene file that is not there is a fault of the experiment; one that is wrong is not.
fn import_error(file: &ExperimentFile, place: &str, error: ImportError) -> PlanError {
    match error {
        ImportError::Unreadable(error) => file.source.fault(place, error.to_string(), A_SCENE),
        error => PlanError::Scene(Box::new(error)),
    }
}

/// The models that a scene names and that cannot be found, if nothing else is wrong with the scene.
fn missing_models(path: &Path, search_paths: &[PathBuf]) -> Vec<String> {
    let limits = Limits::default();
    let resolver = Filled { files: FileResolver::new(path, search_paths), missing: RefCell::default() };
    let mut bytes = Vec::new();
    let read = resolver.open(path, limits.scene_bytes).map(|mut file| file.read_to_end(&mut bytes));
    let sound = matches!(read, Ok(Ok(_)))
        && parse_thesis(&String::from_utf8_lossy(&bytes), &path.display().to_string(), &resolver, &limits).is_ok();
    if sound { resolver.missing.into_inner() } else { Vec::new() }
}

/// Finds files, and gives a triangle for each model of the scene that is not there.
struct Filled {
    files: FileResolver,
    missing: RefCell<Vec<String>>,
}

/// No file can have this name.
const FILLER: &str = "\0triangle";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

impl Resolver for Filled {
    fn find(&self, name: &str, beside: Option<&Path>) -> Result<PathBuf, Vec<PathBuf>> {
        let found = self.files.find(name, beside);
        if found.is_ok() || beside.is_some() {
            return found;
        }
        let mut missing = self.missing.borrow_mut();
        if !missing.iter().any(|known| known == name) {
            missing.push(name.to_owned());
        }
        Ok(PathBuf::from(FILLER))
    }

    fn open(&self, path: &Path, limit: u64) -> Result<Box<dyn Read>, FileError> {
        if path == Path::new(FILLER) {
            return Ok(Box::new(TRIANGLE.as_bytes()));
        }
        self.files.open(path, limit)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.files.identity(path)
    }
}
