//! `[[mesh]]`, and the materials that models bring along.

use super::build::Builder;
use super::document::Table;
use super::library;
use super::places::MaterialPlace;
use super::value::{FILE, MESH, TEXT, Value};
use super::words::did_you_mean;
use crate::files::AssetError;
use crate::model::{Model, ModelFormat};
use crate::obj::Libraries;
use lightcuts_scene::physical::{SurfaceDesc, SurfaceId};
use lightcuts_scene::{MeshDesc, MeshId};
use std::collections::HashMap;
use std::path::PathBuf;

/// What a model can be, to follow the word "expected".
const FILES: &str = "an OBJ or PLY file beside the scene or in a search path";

/// The models of a scene, each file read once.
#[derive(Debug, Default)]
pub(super) struct Models {
    /// By the name of their tables; `None` for models with errors, which are reported once.
    named: HashMap<String, Option<MeshId>>,
    /// By the identity of their files, likewise.
    files: HashMap<PathBuf, Option<MeshId>>,
    /// The models behind meshes, until their materials are asked for.
    loaded: HashMap<MeshId, Loaded>,
    /// The material of an object that names none, by its mesh; `None` if the model has none of its own.
    own: HashMap<MeshId, Option<SurfaceId>>,
    libraries: Libraries,
    pub(super) unit_cube: Option<MeshId>,
}

/// A model whose triangles are in the scene.
#[derive(Debug)]
struct Loaded {
    path: PathBuf,
    model: Model,
}

impl<'d> Builder<'d> {
    pub(super) fn mesh(&mut self, _index: usize, table: Table<'d>) -> Option<()> {
        let name = self.reader.required(table, "name", TEXT)?;
        if self.models.named.contains_key(&name) {
            self.reader.error_at(table, "name", &format!("there is a mesh `{name}` above"), "another name");
            return None;
        }
        // An object that names a mesh with errors should not be told that there is none.
        self.models.named.insert(name.clone(), None);
        table.check_keys(&mut self.reader, "a mesh", &[&["name", "file"]])?;
        let file = self.reader.required(table, "file", FILE)?;
        let mesh = match self.model(table, &name, &file) {
            Ok(mesh) => mesh?,
            Err(message) => {
                self.reader.error_at(table, "file", &message, FILES);
                return None;
            }
        };
        self.models.named.insert(name, Some(mesh));
        Some(())
    }

    /// The mesh of the model in file `file`, read at its first use. `Ok(None)` if it has errors, which are reported.
    fn model(&mut self, table: Table<'d>, name: &str, file: &str) -> Result<Option<MeshId>, String> {
        let told = |error: AssetError| error.to_string();
        let path = self.files.find("model", file, None).map_err(told)?;
        let identity = self.files.identity(&path);
        if let Some(known) = self.models.files.get(&identity) {
            return Ok(*known);
        }
        let format = ModelFormat::of(&path).ok_or_else(|| format!("`{file}` ends neither in .obj nor in .ply"))?;
        let span = table.get("file").map_or(table.span(), Value::span);
        let place = self.reader.source.fault(span, "");
        let model = Model::load(&mut self.files, &path, format, &place, &mut self.reader.report).map_err(told)?;
        let mesh = model.map(|model| self.push_model(table, name, model, path));
        self.models.files.insert(identity, mesh);
        Ok(mesh)
    }

    fn push_model(&mut self, table: Table<'d>, name: &str, mut model: Model, path: PathBuf) -> MeshId {
        let mut mesh = std::mem::take(&mut model.mesh);
        name.clone_into(&mut mesh.name);
        let id = self.push_mesh(table, mesh);
        self.models.loaded.insert(id, Loaded { path, model });
        id
    }

    pub(super) fn push_mesh(&mut self, table: Table<'d>, mesh: MeshDesc) -> MeshId {
        self.scene.meshes.push(mesh);
        self.places.meshes.push(table);
        MeshId(self.scene.meshes.len() as u32 - 1)
    }

    /// The mesh that an object names.
    pub(super) fn named_mesh(&mut self, table: Table<'_>) -> Option<MeshId> {
        let name = self.reader.required(table, "mesh", MESH)?;
        if let Some(known) = self.models.named.get(&name) {
            return *known;
        }
        let mut known: Vec<&str> = self.models.named.keys().map(String::as_str).collect();
        known.sort_unstable();
        let message = format!("there is no mesh `{name}`{}", did_you_mean(&name, &known));
        self.reader.error_at(table, "mesh", &message, "the name of a [[mesh]]");
        None
    }

    /// The material of an object that names none: its mesh has materials of its own.
    pub(super) fn own_material(&mut self, table: Table<'d>, mesh: MeshId) -> Option<SurfaceId> {
        let own = if let Some(known) = self.models.own.get(&mesh) {
            *known
        } else {
            let loaded = self.models.loaded.remove(&mesh);
            let own = loaded.and_then(|loaded| self.assign(table, mesh, &loaded));
            self.models.own.insert(mesh, own);
            own
        };
        if own.is_none() {
            let message = "`material` is missing, and the model has none of its own";
            self.reader.error(table.span(), message, "the name of a [[material]]");
        }
        own
    }

    /// Dresses a mesh in the materials of its model's libraries. `None` if there are none.
    fn assign(&mut self, table: Table<'d>, mesh: MeshId, loaded: &Loaded) -> Option<SurfaceId> {
        let Loaded { path, model } = loaded;
        let report = &mut self.reader.report;
        let found = self.models.libraries.of_model(&mut self.files, report, model, path, "a matt grey");
        let ids: Vec<Option<SurfaceId>> = std::iter::zip(&model.materials, found)
            .map(|((name, _), library)| library::material(self, &library?, name))
            .collect();
        let first = ids.iter().flatten().next().copied()?;
        let triangles = &mut self.scene.meshes[mesh.0 as usize].triangles;
        for (run, material) in model.material_runs(triangles.len()) {
            triangles[run].iter_mut().for_each(|triangle| triangle.material = ids[material]);
        }
        if triangles.iter().all(|triangle| triangle.material.is_some()) {
            return Some(first);
        }
        Some(self.push_material(SurfaceDesc::default(), MaterialPlace::Table(table)))
    }
}
