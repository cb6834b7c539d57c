//! Models, materials and textures that a scene names, each file read once.

use crate::draft::{Draft, MaterialOrigin};
use crate::obj::{self, Library, Lines, Model};
use crate::resolver::{self, FileError, Resolver};
use crate::source;
use crate::texture::{self, TextureError};
use crate::{Fault, Limits};
use lightcuts_scene::{ImageId, MaterialDesc, MaterialId, MeshId, TextureDesc};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Why a named file is of no use.
#[derive(Debug, thiserror::Error)]
pub(crate) enum AssetError {
    #[error("the {what} `{name}` was not found; searched {}", list(searched))]
    NotFound { what: &'static str, name: String, searched: Vec<PathBuf> },
    #[error("cannot read the {what} {error}")]
    File { what: &'static str, error: FileError },
    #[error("the texture `{name}` {error}")]
    Texture { name: String, error: TextureError },
}

/// Reads what a scene names and keeps track of it.
pub(crate) struct Assets<'a> {
    resolver: &'a dyn Resolver,
    limits: &'a Limits,
    /// Every file that was opened, in order.
    pub(crate) files: Vec<PathBuf>,
    /// These three by identity.
    images: HashMap<PathBuf, Result<ImageId, String>>,
    libraries: HashMap<PathBuf, Result<Rc<Library>, String>>,
    /// `None` for models with errors, which are reported once.
    models: HashMap<PathBuf, Option<Loaded>>,
    elements: usize,
}

/// A model in the scene.
struct Loaded {
    path: PathBuf,
    model: Model,
    mesh: MeshId,
    /// The library material of each of the model's material names; `None` before they are asked for.
    materials: Option<Vec<Option<Rc<Library>>>>,
    /// Meshes that carry library materials, by the optical ratios these were given.
    assigned: HashMap<[u32; 4], MeshId>,
}

/// How a directive uses a model.
#[derive(Debug)]
pub(crate) struct MeshUse<'d> {
    pub(crate) file: &'d str,
    /// Start of the directive.
    pub(crate) directive: usize,
    /// Where the optical ratios of library materials come from; `None` if libraries do not matter.
    pub(crate) library_optics: Option<&'d MaterialDesc>,
}

impl<'a> Assets<'a> {
    pub(crate) fn new(resolver: &'a dyn Resolver, limits: &'a Limits) -> Self {
        Self {
            resolver,
            limits,
            files: Vec::new(),
            images: HashMap::new(),
            libraries: HashMap::new(),
            models: HashMap::new(),
            elements: 0,
        }
    }

    fn find(&self, what: &'static str, name: &str, beside: Option<&Path>) -> Result<PathBuf, AssetError> {
        let not_found = |searched| AssetError::NotFound { what, name: name.to_owned(), searched };
        self.resolver.find(name, beside).map_err(not_found)
    }

    fn read(&mut self, what: &'static str, path: &Path, limit: u64) -> Result<Vec<u8>, AssetError> {
        let bytes = resolver::read(self.resolver, path, limit).map_err(|error| AssetError::File { what, error })?;
        self.files.push(path.to_path_buf());
        Ok(bytes)
    }

    /// The image in file `name`, read at its first use.
    pub(crate) fn image(&mut self, draft: &mut Draft, name: &str, beside: Option<&Path>) -> Result<ImageId, String> {
        let path = self.find("texture", name, beside).map_err(|error| error.to_string())?;
        let identity = self.resolver.identity(&path);
        if let Some(known) = self.images.get(&identity) {
            return known.clone();
        }
        let image = self.load_image(draft, name, &path).map_err(|error| error.to_string());
        self.images.insert(identity, image.clone());
        image
    }

    fn load_image(&mut self, draft: &mut Draft, name: &str, path: &Path) -> Result<ImageId, AssetError> {
        let bytes = self.read("texture", path, self.limits.texture_bytes)?;
        let image = texture::decode(name, &bytes, self.limits.texture_side)
            .map_err(|error| AssetError::Texture { name: name.to_owned(), error })?;
        draft.scene.images.push(image);
        Ok(ImageId(draft.scene.images.len() as u32 - 1))
    }

    /// The mesh of a model, with library materials if they matter. `Ok(None)` if the model's content has errors, which
    /// are reported; `Err` if the model cannot be read. Warnings of the model as a whole stand at `place`.
    pub(crate) fn mesh(
        &mut self,
        draft: &mut Draft,
        wanted: &MeshUse<'_>,
        place: &Fault,
    ) -> Result<Option<MeshId>, AssetError> {
        let path = self.find("model", wanted.file, None)?;
        let identity = self.resolver.identity(&path);
        if !self.models.contains_key(&identity) {
            let loaded = self.load_model(draft, wanted, &path, place)?;
            self.models.insert(identity.clone(), loaded);
        }
        let Some(Some(mut loaded)) = self.models.remove(&identity) else {
            self.models.insert(identity, None);
            return Ok(None);
        };
        let mesh = match wanted.library_optics {
            Some(optics) => self.assign(draft, &mut loaded, optics, wanted.directive, place),
            None => Some(loaded.mesh),
        };
        self.models.insert(identity, Some(loaded));
        Ok(mesh)
    }

    fn load_model(
        &mut self,
        draft: &mut Draft,
        wanted: &MeshUse<'_>,
        path: &Path,
        place: &Fault,
    ) -> Result<Option<Loaded>, AssetError> {
        let file_error = |error| AssetError::File { what: "model", error };
        let limit = self.limits.model_bytes;
        let reader = self.resolver.open(path, limit).map_err(file_error)?;
        self.files.push(path.to_path_buf());
        let name = path.display().to_string();
        let room = self.limits.mesh_elements.saturating_sub(self.elements);
        let lines = Lines::new(reader, path, &name, limit);
        let Some(mut model) = obj::parse(lines, room, &mut draft.report).map_err(file_error)? else { return Ok(None) };
        if model.mesh.triangles.is_empty() {
            draft.report.warn(|| place.clone().with_message("the model has no faces"));
        }
        self.elements += obj::elements(&model.mesh);
        let mut mesh = std::mem::take(&mut model.mesh);
        wanted.file.clone_into(&mut mesh.name);
        let id = push_mesh(draft, mesh, wanted.directive);
        Ok(Some(Loaded { path: path.to_path_buf(), model, mesh: id, materials: None, assigned: HashMap::new() }))
    }

    /// The model's mesh with the materials of its libraries and the optical ratios of `optics`. `None` (reported) if
    /// that takes too much memory.
    fn assign(
        &mut self,
        draft: &mut Draft,
        loaded: &mut Loaded,
        optics: &MaterialDesc,
        directive: usize,
        place: &Fault,
    ) -> Option<MeshId> {
        let ratios = [optics.reflection, optics.refraction, optics.refraction_ratio, optics.local].map(f32::to_bits);
        if let Some(mesh) = loaded.assigned.get(&ratios) {
            return Some(*mesh);
        }
        let materials = match loaded.materials.take() {
            Some(materials) => materials,
            None => self.libraries(draft, loaded),
        };
        let ids: Vec<Option<MaterialId>> = std::iter::zip(&loaded.model.materials, &materials)
            .map(|((name, _), library)| Some(self.material(draft, library.as_ref()?, name, optics, directive)))
            .collect();
        loaded.materials = Some(materials);
        let mesh = if ids.iter().all(Option::is_none) || loaded.assigned.is_empty() {
            loaded.mesh
        } else {
            self.copy_mesh(draft, loaded.mesh, directive, place)?
        };
        let triangles = &mut draft.scene.meshes[mesh.0 as usize].triangles;
        for (i, run) in loaded.model.runs.iter().enumerate() {
            let end = loaded.model.runs.get(i + 1).map_or(triangles.len(), |next| next.first_triangle);
            for triangle in &mut triangles[run.first_triangle..end] {
                triangle.material = ids[run.material];
            }
        }
        loaded.assigned.insert(ratios, mesh);
        Some(mesh)
    }

    /// A copy of a mesh: its triangles are to wear other materials.
    fn copy_mesh(&mut self, draft: &mut Draft, mesh: MeshId, directive: usize, place: &Fault) -> Option<MeshId> {
        let mesh = &draft.scene.meshes[mesh.0 as usize];
        self.elements += obj::elements(mesh);
        if self.elements > self.limits.mesh_elements {
            let message = format!("the meshes have more than {} vertices and triangles", self.limits.mesh_elements);
            let fault = place.clone().with_message(&message);
            draft.report.error(|| fault.expected("fewer copies of the model with MAT(0) and different FRKE"));
            return None;
        }
        let copy = mesh.clone();
        Some(push_mesh(draft, copy, directive))
    }

    /// Reads a model's libraries and finds each of its materials in them.
    fn libraries(&mut self, draft: &mut Draft, loaded: &Loaded) -> Vec<Option<Rc<Library>>> {
        let mut libraries: Vec<Rc<Library>> = Vec::new();
        for (line, place) in &loaded.model.libraries {
            for library in self.library_line(draft, line, place, &loaded.path) {
                if !libraries.iter().any(|known| Rc::ptr_eq(known, &library)) {
                    libraries.push(library);
                }
            }
        }
        let mut find = |name: &str, place: &Fault| {
            let library = libraries.iter().rev().find(|library| library.get(name).is_some()).cloned();
            if library.is_none() {
                let message =
                    format!("the material `{name}` is not defined; its faces take the material of the O line");
                draft.report.warn(|| place.clone().with_message(&message));
            }
            library
        };
        loaded.model.materials.iter().map(|(name, place)| find(name, place)).collect()
    }

    /// The libraries of one `mtllib` line; what cannot be read is warned about.
    fn library_line(&mut self, draft: &mut Draft, line: &str, place: &Fault, model: &Path) -> Vec<Rc<Library>> {
        let readings = obj::library_names(line);
        let found = |name: &String| self.find("material library", name, Some(model)).is_ok();
        let complete = readings.iter().find(|names| names.iter().all(found));
        let best = complete.or_else(|| readings.iter().skip(1).find(|names| names.iter().any(found)));
        let names = best.or(readings.get(1)).or(readings.first()).cloned().unwrap_or_default();
        let mut libraries = Vec::new();
        for name in names {
            match self.library(draft, &name, model) {
                Ok(library) => libraries.push(library),
                Err(message) => draft.report.warn(|| place.clone().with_message(&message)),
            }
        }
        libraries
    }

    /// The library in file `name`, read at its first use.
    fn library(&mut self, draft: &mut Draft, name: &str, model: &Path) -> Result<Rc<Library>, String> {
        let path = self.find("material library", name, Some(model)).map_err(|error| error.to_string())?;
        let identity = self.resolver.identity(&path);
        if identity == self.resolver.identity(model) {
            return Err(format!("the material library `{name}` is the model itself"));
        }
        if let Some(known) = self.libraries.get(&identity) {
            return known.clone();
        }
        let library = self.load_library(draft, &path);
        self.libraries.insert(identity, library.clone());
        library
    }

    fn load_library(&mut self, draft: &mut Draft, path: &Path) -> Result<Rc<Library>, String> {
        let limit = self.limits.material_bytes;
        let bytes = self.read("material library", path, limit).map_err(|error| error.to_string())?;
        let display = path.display().to_string();
        let text = source::decode(&display, &bytes).map_err(|fault| fault.to_string())?;
        Ok(Rc::new(Library::parse(&display, text.into_owned(), &mut draft.report)))
    }

    /// Adds a library's material to the scene, with the optical ratios of `optics`.
    fn material(
        &mut self,
        draft: &mut Draft,
        library: &Rc<Library>,
        name: &str,
        optics: &MaterialDesc,
        directive: usize,
    ) -> MaterialId {
        let found = library.get(name);
        let mut desc = found.map(|material| material.desc.clone()).unwrap_or_default();
        desc.reflection = optics.reflection;
        desc.refraction = optics.refraction;
        desc.refraction_ratio = optics.refraction_ratio;
        desc.local = optics.local;
        if let Some((file, mode, span)) = found.and_then(|material| material.texture.as_ref()) {
            let path = PathBuf::from(library.name());
            match self.image(draft, file, Some(&path)) {
                Ok(image) => desc.texture = Some(TextureDesc { image, mode: *mode }),
                Err(message) => draft.report.warn(|| library.fault(span.clone(), &message)),
            }
        }
        draft.scene.materials.push(desc);
        draft.materials.push(MaterialOrigin::Library(Rc::clone(library), name.to_owned(), directive));
        MaterialId(draft.scene.materials.len() as u32 - 1)
    }
}

fn push_mesh(draft: &mut Draft, mesh: lightcuts_scene::MeshDesc, directive: usize) -> MeshId {
    draft.scene.meshes.push(mesh);
    draft.meshes.push(directive);
    MeshId(draft.scene.meshes.len() as u32 - 1)
}

fn list(paths: &[PathBuf]) -> String {
    let shown: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    shown.join(", ")
}
