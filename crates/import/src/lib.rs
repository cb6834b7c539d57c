//! Importers: scene and model files to scene descriptions, with errors that name file, line and column.
//!
//! The one scene format so far is the thesis' text ([`parse_thesis`]), with meshes in OBJ files, their materials in MTL
//! files and textures in PNG or JPEG files. Nothing in a file can make an importer panic, hang or use memory without
//! bound: sizes are checked against [`Limits`] before anything is read, only regular files are opened, and the number
//! and length of messages is limited. What holds of every scene, whatever its format, is checked by
//! [`lightcuts_scene::SceneDesc::validate`]; the importers only turn its issues into messages that point at the field.

mod assets;
mod draft;
mod error;
mod fault;
mod format;
mod limits;
mod number;
mod obj;
mod report;
mod resolver;
mod source;
mod texture;
mod thesis;

pub use error::{Faults, ImportError, Warning};
pub use fault::Fault;
pub use limits::Limits;
pub use resolver::{FileError, FileResolver, MemoryResolver, Resolver};
pub use thesis::parse_thesis;

use lightcuts_scene::SceneDesc;
use std::path::{Path, PathBuf};

/// How to import.
#[derive(Debug, Clone, Default)]
pub struct ImportOptions {
    /// Folders in which models and textures are searched after the scene's own, in this order.
    pub search_paths: Vec<PathBuf>,
    /// Largest sizes to accept.
    pub limits: Limits,
}

/// A scene that was read.
#[derive(Debug)]
pub struct Imported {
    /// The scene; [`SceneDesc::validate`] finds no issue in it.
    pub scene: SceneDesc,
    /// What was ignored or looks like a mistake, in the order it was met.
    pub warnings: Vec<Warning>,
    /// Every file that was read, the scene first.
    pub files: Vec<PathBuf>,
}

/// Reads the scene file at `path` and every model and texture that it names.
///
/// Fails if the file cannot be read, is in no known format, or holds an error; see [`ImportError`].
pub fn load(path: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let resolver = FileResolver::new(path, &options.search_paths);
    format::refuse_known_extensions(path)?;
    let bytes = resolver::read(&resolver, path, options.limits.scene_bytes)?;
    let name = path.display().to_string();
    format::refuse_other_content(path, &bytes)?;
    let text = source::decode(&name, &bytes)?;
    let mut imported = parse_thesis(&text, &name, &resolver, &options.limits)?;
    imported.files.insert(0, path.to_path_buf());
    Ok(imported)
}
