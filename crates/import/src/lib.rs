//! Importers: scene and model files to scene descriptions, with errors that name file, line and column.
//!
//! Scenes of the thesis' model come in the thesis' text ([`parse_thesis`]), those of the physical model in TOML
//! ([`parse_physical`]); with meshes in OBJ or PLY files, their materials in MTL files and images in PNG, JPEG, EXR, HDR or PFM
//! files. Nothing in a file can make an importer panic, hang or use memory without bound: sizes are checked against [`Limits`]
//! before anything is read, only regular files are opened, and the number and length of messages is limited. What holds of
//! every scene, whatever its format, is checked by its `validate` in `lightcuts-scene`; the importers only turn its issues into
//! messages that point at the field.

mod anchor;
mod error;
mod fault;
mod files;
mod format;
mod limits;
mod lines;
mod model;
mod number;
mod obj;
mod physical;
mod ply;
mod polygon;
mod report;
mod resolver;
mod source;
mod texture;
mod thesis;

pub use error::{Faults, ImportError, Warning};
pub use fault::Fault;
pub use limits::Limits;
pub use physical::parse_physical;
pub use resolver::{FileError, FileResolver, MemoryResolver, Resolver};
pub use thesis::parse_thesis;

use lightcuts_scene::SceneDesc;
use lightcuts_scene::physical::PhysicalScene;
use std::path::{Path, PathBuf};

/// How to import.
#[derive(Debug, Clone, Default)]
pub struct ImportOptions {
    /// Folders in which models and textures are searched after the scene's own, in this order.
    pub search_paths: Vec<PathBuf>,
    /// Largest sizes to accept.
    pub limits: Limits,
    /// Angle in degrees, 0 to 180, that takes the place of every object's `crease-angle` in scenes of the physical model.
    pub crease_degrees: Option<f32>,
}

/// A scene that was read.
#[derive(Debug)]
pub struct Imported<S = SceneDesc> {
    /// The scene; its `validate` finds no issue in it.
    pub scene: S,
    /// What was ignored or looks like a mistake, in the order it was met.
    pub warnings: Vec<Warning>,
    /// Every file that was read, the scene first.
    pub files: Vec<PathBuf>,
}

/// A scene of either model.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyScene {
    /// Of the thesis' model.
    Thesis(SceneDesc),
    /// Of the physical model.
    Physical(PhysicalScene),
}

impl<S> Imported<S> {
    /// The same import of a scene made of this one.
    pub fn map<T>(self, change: impl FnOnce(S) -> T) -> Imported<T> {
        Imported { scene: change(self.scene), warnings: self.warnings, files: self.files }
    }
}

/// Reads the scene file at `path`, of the thesis' model, and every model and texture that it names.
///
/// Fails if the file cannot be read, is in no known format or one of the physical model, or holds an error; see
/// [`ImportError`].
pub fn load(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    format::refuse_known_extensions(path)?;
    if format::is_toml(path) {
        return Err(format::toml(path));
    }
    read(path, options, options.limits.scene_bytes, |text, name, resolver| {
        parse_thesis(text, name, resolver, &options.limits)
    })
}

/// Reads the scene file at `path`, of either model, and every model and image that it names. What ends in `.toml` is read as
/// [`parse_physical`] does, all else as [`load`] does.
pub fn load_any(path: &Path, options: &ImportOptions) -> Result<Imported<AnyScene>, ImportError> {
    if format::is_toml(path) {
        let physical = read(path, options, options.limits.document_bytes, |text, name, resolver| {
            physical::parse_creased(text, name, resolver, &options.limits, options.crease_degrees)
        })?;
        return Ok(physical.map(AnyScene::Physical));
    }
    Ok(load(path, options)?.map(AnyScene::Thesis))
}

/// Reads a file of at most `limit` bytes; `parse` makes a scene of its text and its name.
fn read<S>(
    path: &Path,
    options: &ImportOptions,
    limit: u64,
    parse: impl FnOnce(&str, &str, &dyn Resolver) -> Result<Imported<S>, ImportError>,
) -> Result<Imported<S>, ImportError> {
    let resolver = FileResolver::new(path, &options.search_paths);
    let bytes = resolver::read(&resolver, path, limit)?;
    let name = path.display().to_string();
    format::refuse_other_content(path, &bytes)?;
    let text = source::decode(&name, &bytes)?;
    let mut imported = parse(&text, &name, &resolver)?;
    imported.files.insert(0, path.to_path_buf());
    Ok(imported)
}
