//! `[[mesh]]`, and the materials that models bring along.

use super::build::Builder;
use super::document::Table;
use super::library::{self, Converted};
use super::places::MaterialPlace;
use super::smoothing::Smoothing;
use super::value::{FILE, MESH, TEXT, Value};
use super::words::did_you_mean;
use crate::files::AssetError;
use crate::model::{self, Model, ModelFormat};
use crate::obj::{Libraries, MapPlacement};
use crate::polygon::Cut;
use glam::{DAffine3, DVec3};
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
    /// What an object that names no material takes, by its mesh; `None` if the model has no materials of its own.
    own: HashMap<MeshId, Option<Own>>,
    /// What the positions of models are relative to.
    origins: HashMap<MeshId, DVec3>,
    libraries: Libraries,
    pub(super) smoothing: Smoothing,
    pub(super) unit_cube: Option<MeshId>,
}

/// A mesh with the materials of its model's libraries.
#[derive(Debug, Clone, Copy)]
pub(super) struct Own {
    /// That of faces which have no other.
    pub(super) material: SurfaceId,
    /// The mesh itself, or a copy whose texture coordinates are as the materials want them.
    pub(super) mesh: MeshId,
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
            Err((message, expected)) => {
                self.reader.error_at(table, "file", &message, expected);
                return None;
            }
        };
        self.models.named.insert(name, Some(mesh));
        Some(())
    }

    /// The mesh of the model in file `file`, read at its first use. `Ok(None)` if it has errors, which are reported;
    /// `Err` if it cannot be read: the message, and what was expected.
    fn model(&mut self, table: Table<'d>, name: &str, file: &str) -> Result<Option<MeshId>, (String, &'static str)> {
        let told = |error: AssetError| (error.to_string(), error.expected(FILES));
        let path = self.files.find("model", file, None).map_err(told)?;
        let identity = self.files.identity(&path);
        if let Some(known) = self.models.files.get(&identity) {
            return Ok(*known);
        }
        let format =
            ModelFormat::of(&path).ok_or_else(|| (format!("`{file}` ends neither in .obj nor in .ply"), FILES))?;
        let span = table.get("file").map_or(table.span(), Value::span);
        let place = self.reader.source.fault(span, "");
        let model = Model::load(&mut self.files, &path, format, Cut::Outlines, &place, &mut self.reader.report)
            .map_err(told)?;
        let mesh = model.map(|model| self.push_model(table, name, model, path));
        self.models.files.insert(identity, mesh);
        Ok(mesh)
    }

    fn push_model(&mut self, table: Table<'d>, name: &str, mut model: Model, path: PathBuf) -> MeshId {
        let mut mesh = std::mem::take(&mut model.mesh);
        name.clone_into(&mut mesh.name);
        let id = self.push_mesh(table, mesh);
        self.models.origins.insert(id, model.origin);
        self.models.smoothing.add_groups(id, std::mem::take(&mut model.smoothing));
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

    /// The placement of a mesh whose file is placed so.
    pub(super) fn placed(&self, mesh: MeshId, file: DAffine3) -> DAffine3 {
        let origin = self.models.origins.get(&mesh).copied().unwrap_or_default();
        file * DAffine3::from_translation(origin)
    }

    /// What an object takes that names no material: its model has some, or names some that are nowhere.
    pub(super) fn own_material(&mut self, table: Table<'d>, mesh: MeshId) -> Option<Own> {
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

    /// Warns about libraries that are not found though no object uses their materials.
    pub(super) fn warn_of_unused_libraries(&mut self) {
        let mut unused: Vec<(&MeshId, &Loaded)> = self.models.loaded.iter().collect();
        unused.sort_by_key(|(mesh, _)| mesh.0);
        for (_, Loaded { path, model }) in unused {
            Libraries::warn_of_unused(&self.files, &mut self.reader.report, model, path);
        }
    }

    /// Assigns the materials of the model's libraries to the faces of a mesh. `None` if the model names neither.
    fn assign(&mut self, table: Table<'d>, mesh: MeshId, loaded: &Loaded) -> Option<Own> {
        let Loaded { path, model } = loaded;
        let report = &mut self.reader.report;
        let found = self.models.libraries.of_model(&mut self.files, report, model, path, "are diffuse grey");
        if model.materials.is_empty() && model.libraries.is_empty() {
            return None;
        }
        let converted: Vec<Option<Converted>> = std::iter::zip(&model.materials, found)
            .map(|((name, _), library)| library::material(self, &library?, name))
            .collect();
        let copy = self.placed_copy(table, mesh, model, &converted)?;
        let triangles = &mut self.scene.meshes[copy.0 as usize].triangles;
        for (run, material) in model.material_runs(triangles.len()) {
            let id = converted[material].map(|converted| converted.id);
            for triangle in &mut triangles[run] {
                triangle.material = id;
            }
        }
        let is_complete = triangles.iter().all(|triangle| triangle.material.is_some());
        let first = converted.iter().flatten().next().filter(|_| is_complete).map(|first| first.id);
        let grey = || self.push_material(SurfaceDesc::default(), MaterialPlace::Table(table));
        Some(Own { material: first.unwrap_or_else(grey), mesh: copy })
    }

    /// The mesh, or where maps are scaled or shifted a copy with texture coordinates that are: an object with a material of its
    /// own may use the mesh as it is. `None` (reported) if that takes too much memory.
    fn placed_copy(
        &mut self,
        table: Table<'d>,
        mesh: MeshId,
        model: &Model,
        converted: &[Option<Converted>],
    ) -> Option<MeshId> {
        let placements: Vec<MapPlacement> =
            converted.iter().map(|material| material.map_or_else(MapPlacement::default, |m| m.placement)).collect();
        if placements.iter().all(|placement| *placement == MapPlacement::default()) {
            return Some(mesh);
        }
        let copy = self.copy_mesh(table, mesh)?;
        self.models.smoothing.copy_groups(mesh, copy);
        let mesh = &mut self.scene.meshes[copy.0 as usize];
        for (run, material) in model.material_runs(mesh.triangles.len()) {
            place_coordinates(mesh, run, placements[material]);
        }
        Some(copy)
    }

    /// Adds a mesh once more. `None` (reported) if that takes too much memory.
    pub(super) fn copy_mesh(&mut self, table: Table<'d>, mesh: MeshId) -> Option<MeshId> {
        let copy = self.scene.meshes[mesh.0 as usize].clone();
        self.count_elements(table, model::elements(&copy))?;
        Some(self.push_mesh(table, copy))
    }

    /// Counts what a mesh costs more. `None` (reported) if it is too much.
    pub(super) fn count_elements(&mut self, table: Table<'_>, elements: usize) -> Option<()> {
        self.files.elements = self.files.elements.saturating_add(elements);
        let limit = self.files.limits.mesh_elements;
        if self.files.elements > limit {
            self.reader.error(table.span(), &model::too_large(limit), "fewer or smaller models");
            return None;
        }
        Some(())
    }
}

/// Gives triangles texture coordinates of their own, as a material's maps want them.
fn place_coordinates(mesh: &mut MeshDesc, triangles: std::ops::Range<usize>, placement: MapPlacement) {
    if placement == MapPlacement::default() {
        return;
    }
    let mut placed: HashMap<u32, u32> = HashMap::new();
    let all = &mut mesh.texture_coordinates;
    let mut index = |old: u32| {
        *placed.entry(old).or_insert_with(|| {
            all.push(placement.apply(all[old as usize]));
            all.len() as u32 - 1
        })
    };
    for triangle in &mut mesh.triangles[triangles] {
        triangle.texture_coordinates = triangle.texture_coordinates.map(|corners| corners.map(&mut index));
    }
}
