//! The material libraries that models name, each file read once.

use super::Library;
use super::library_names::library_names;
use crate::Fault;
use crate::files::Files;
use crate::model::Model;
use crate::report::Report;
use crate::source;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// What messages call them.
const KIND: &str = "material library";

/// Libraries by the identity of their files; why not, for those that cannot be read.
#[derive(Debug, Default)]
pub(crate) struct Libraries {
    known: HashMap<PathBuf, Result<Rc<Library>, String>>,
}

impl Libraries {
    /// Reads the libraries of the model at `path` and finds each of its materials in them. A material that is nowhere is
    /// warned about; `fallback` says what becomes of its faces, to follow the words "its faces".
    pub(crate) fn of_model(
        &mut self,
        files: &mut Files<'_>,
        report: &mut Report,
        model: &Model,
        path: &Path,
        fallback: &str,
    ) -> Vec<Option<Rc<Library>>> {
        let mut libraries: Vec<Rc<Library>> = Vec::new();
        for (line, place) in &model.libraries {
            for library in self.of_line(files, report, line, place, path) {
                if !libraries.iter().any(|known| Rc::ptr_eq(known, &library)) {
                    libraries.push(library);
                }
            }
        }
        let mut find = |name: &str, place: &Fault| {
            let library = libraries.iter().rev().find(|library| library.get(name).is_some()).cloned();
            if library.is_none() {
                let message = format!("the material `{name}` is not defined; its faces {fallback}");
                report.warn(|| place.clone().with_message(&message));
            }
            library
        };
        model.materials.iter().map(|(name, place)| find(name, place)).collect()
    }

    /// Warns about libraries of the model at `path` that are not found though nothing of them is used: they may be missed.
    pub(crate) fn warn_of_unused(files: &Files<'_>, report: &mut Report, model: &Model, path: &Path) {
        for (line, place) in &model.libraries {
            for name in names(files, line, path) {
                if let Err(error) = files.find(KIND, &name, Some(path)) {
                    let message = format!("{error}; none of its materials is used");
                    report.warn(|| place.clone().with_message(&message));
                }
            }
        }
    }

    /// The libraries of one `mtllib` line; what cannot be read is warned about.
    fn of_line(
        &mut self,
        files: &mut Files<'_>,
        report: &mut Report,
        line: &str,
        place: &Fault,
        model: &Path,
    ) -> Vec<Rc<Library>> {
        let mut libraries = Vec::new();
        for name in names(files, line, model) {
            match self.named(files, report, &name, model) {
                Ok(library) => libraries.push(library),
                Err(message) => report.warn(|| place.clone().with_message(&message)),
            }
        }
        libraries
    }

    /// The library in file `name`, read at its first use.
    fn named(
        &mut self,
        files: &mut Files<'_>,
        report: &mut Report,
        name: &str,
        model: &Path,
    ) -> Result<Rc<Library>, String> {
        let path = files.find(KIND, name, Some(model)).map_err(|error| error.to_string())?;
        let identity = files.identity(&path);
        if identity == files.identity(model) {
            return Err(format!("the material library `{name}` is the model itself"));
        }
        if let Some(known) = self.known.get(&identity) {
            return known.clone();
        }
        let library = load(files, report, &path);
        self.known.insert(identity, library.clone());
        library
    }
}

/// The names in an `mtllib` line, of the readings of its blanks the one of which most files are there.
fn names(files: &Files<'_>, line: &str, model: &Path) -> Vec<String> {
    let readings = library_names(line);
    let found = |name: &String| files.find(KIND, name, Some(model)).is_ok();
    let complete = readings.iter().find(|names| names.iter().all(found));
    let best = complete.or_else(|| readings.iter().skip(1).find(|names| names.iter().any(found)));
    best.or(readings.get(1)).or(readings.first()).cloned().unwrap_or_default()
}

fn load(files: &mut Files<'_>, report: &mut Report, path: &Path) -> Result<Rc<Library>, String> {
    let limit = files.limits.material_bytes;
    let bytes = files.read(KIND, path, limit).map_err(|error| error.to_string())?;
    let display = path.display().to_string();
    let text = source::decode(&display, &bytes).map_err(|fault| fault.to_string())?;
    Ok(Rc::new(Library::parse(&display, text.into_owned(), report)))
}
