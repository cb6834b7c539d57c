//! Models, materials and textures that a scene names, each file read once.

use super::draft::{Draft, MaterialOrigin};
use crate::Fault;
use crate::files::{AssetError, Files};
use crate::model::{self, Model, ModelFormat};
use crate::obj::{Libraries, Library};
use crate::polygon::Cut;
use crate::resolver::Resolver;
use crate::{Limits, texture};
use lightcuts_scene::{ImageId, MaterialDesc, MaterialId, MeshId, TextureDesc};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Reads what a scene names and keeps track of it.
pub(super) struct Assets<'a> {
    pub(super) files: Files<'a>,
    libraries: Libraries,
    /// By identity.
    images: HashMap<PathBuf, Result<ImageId, String>>,
    /// Likewise; `None` for models with errors, which are reported once.
    models: HashMap<PathBuf, Option<Loaded>>,
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
pub(super) struct MeshUse<'d> {
    pub(super) file: &'d str,
    /// Start of the directive.
    pub(super) directive: usize,
    /// Where the optical ratios of library materials come from; `None` if libraries do not matter.
    pub(super) library_optics: Option<&'d MaterialDesc>,
}

impl<'a> Assets<'a> {
    pub(super) fn new(resolver: &'a dyn Resolver, limits: &'a Limits) -> Self {
        Self {
            files: Files::new(resolver, limits),
            libraries: Libraries::default(),
            images: HashMap::new(),
            models: HashMap::new(),
        }
    }

    /// The image in file `name`, read at its first use.
    pub(super) fn image(&mut self, draft: &mut Draft, name: &str, beside: Option<&Path>) -> Result<ImageId, String> {
        let path = self.files.find("texture", name, beside).map_err(|error| error.to_string())?;
        let identity = self.files.identity(&path);
        if let Some(known) = self.images.get(&identity) {
            return known.clone();
        }
        let image = self.load_image(draft, name, &path).map_err(|error| error.to_string());
        self.images.insert(identity, image.clone());
        image
    }

    /// The image of a library's map, in the first file of these names that there is.
    fn library_image<'n>(
        &mut self,
        draft: &mut Draft,
        library: &Library,
        names: impl Iterator<Item = &'n str>,
    ) -> Result<ImageId, String> {
        let beside = Path::new(library.name());
        let name = self.files.first_found(names, beside);
        self.image(draft, name, Some(beside))
    }

    fn load_image(&mut self, draft: &mut Draft, name: &str, path: &Path) -> Result<ImageId, AssetError> {
        let bytes = self.files.read("texture", path, self.files.limits.texture_bytes)?;
        let image = texture::decode_rgb(name, &bytes, self.files.limits.texture_side).map_err(|error| {
            AssetError::Content { what: "texture", name: name.to_owned(), reason: error.to_string() }
        })?;
        draft.scene.images.push(image);
        Ok(ImageId(draft.scene.images.len() as u32 - 1))
    }

    /// The mesh of a model, with library materials if they matter. `Ok(None)` if the model's content has errors, which
    /// are reported; `Err` if the model cannot be read. Warnings of the model as a whole stand at `place`.
    pub(super) fn mesh(
        &mut self,
        draft: &mut Draft,
        wanted: &MeshUse<'_>,
        place: &Fault,
    ) -> Result<Option<MeshId>, AssetError> {
        let path = self.files.find("model", wanted.file, None)?;
        let identity = self.files.identity(&path);
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
        let loaded = Model::load(&mut self.files, path, ModelFormat::Obj, Cut::Fans, place, &mut draft.report)?;
        let Some(mut model) = loaded else { return Ok(None) };
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
        let materials = loaded.materials.take().unwrap_or_else(|| {
            let (files, report) = (&mut self.files, &mut draft.report);
            let fallback = "take the material of the O line";
            self.libraries.of_model(files, report, &loaded.model, &loaded.path, fallback)
        });
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
        for (run, material) in loaded.model.material_runs(triangles.len()) {
            for triangle in &mut triangles[run] {
                triangle.material = ids[material];
            }
        }
        loaded.assigned.insert(ratios, mesh);
        Some(mesh)
    }

    /// A copy of a mesh: its triangles are to have other materials.
    fn copy_mesh(&mut self, draft: &mut Draft, mesh: MeshId, directive: usize, place: &Fault) -> Option<MeshId> {
        let mesh = &draft.scene.meshes[mesh.0 as usize];
        self.files.elements += model::elements(mesh);
        if self.files.elements > self.files.limits.mesh_elements {
            let fault = place.clone().with_message(&model::too_large(self.files.limits.mesh_elements));
            draft.report.error(|| fault.expected("fewer copies of the model with MAT(0) and different FRKE"));
            return None;
        }
        let copy = mesh.clone();
        Some(push_mesh(draft, copy, directive))
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
        if let Some(span) = found.and_then(|material| material.texture.as_ref()) {
            let map = library.map(span);
            match self.library_image(draft, library, map.names()) {
                Ok(image) => desc.texture = Some(TextureDesc { image, mode: map.mode }),
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
