//! From tables to a scene.

use super::document::Table;
use super::image::Images;
use super::mesh::Models;
use super::places::{MaterialPlace, Places};
use super::reader::Reader;
use super::value::{MATERIAL, TEXT, Value};
use super::words::did_you_mean;
use super::{camera, environment};
use crate::files::Files;
use crate::resolver::Resolver;
use crate::source::Source;
use crate::{ImportError, Imported, Limits};
use lightcuts_scene::physical::{PhysicalScene, SurfaceDesc, SurfaceId};
use std::collections::HashMap;
use std::path::Path;

/// Keys of the whole document.
const KEYS: [&str; 9] = ["format", "version", "name", "camera", "environment", "material", "mesh", "object", "light"];

/// A scene that grows.
pub(super) struct Builder<'d> {
    pub(super) reader: Reader<'d>,
    pub(super) files: Files<'d>,
    pub(super) images: Images,
    pub(super) models: Models,
    pub(super) scene: PhysicalScene,
    pub(super) places: Places<'d>,
    /// Angle that takes the place of every object's `crease-angle`.
    pub(super) crease_degrees: Option<f32>,
    /// Materials by name.
    materials: HashMap<String, SurfaceId>,
}

impl<'d> Builder<'d> {
    pub(super) fn new(
        source: &'d Source<'d>,
        resolver: &'d dyn Resolver,
        limits: &'d Limits,
        crease_degrees: Option<f32>,
    ) -> Self {
        Self {
            crease_degrees,
            reader: Reader::new(source),
            files: Files::new(resolver, limits),
            images: Images::default(),
            models: Models::default(),
            scene: PhysicalScene::default(),
            places: Places::default(),
            materials: HashMap::new(),
        }
    }

    /// Reads the whole document of the file `file`.
    pub(super) fn run(mut self, document: Table<'d>, file: &str) -> Result<Imported<PhysicalScene>, ImportError> {
        // Other tables may be sound all the same.
        let _ = document.check_keys(&mut self.reader, "a scene", &[&KEYS]);
        let stem = || Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.scene.name = self.reader.optional(document, "name", TEXT).flatten().unwrap_or_else(stem);
        let [materials, meshes, objects, lights] = self.all_tables(document);
        self.name_materials(&materials);
        self.each(&materials, Self::material);
        self.each(&meshes, Self::mesh);
        self.each(&objects, Self::object);
        self.each(&lights, Self::light);
        // Whatever takes too much memory was reported.
        let _ = self.smooth_meshes();
        self.view(document);
        self.finish(!objects.is_empty(), !lights.is_empty())
    }

    /// Reads tables in order, as long as another error would still be told.
    fn each(&mut self, tables: &[Table<'d>], read: impl Fn(&mut Self, usize, Table<'d>) -> Option<()>) {
        for (i, table) in tables.iter().enumerate() {
            if self.reader.report.is_full() {
                break;
            }
            // What is missing of a table that cannot be read was reported.
            let _ = read(self, i, *table);
        }
    }

    /// The tables of each list of them. Where there are too many none is read.
    fn all_tables(&mut self, document: Table<'d>) -> [Vec<Table<'d>>; 4] {
        let all = ["material", "mesh", "object", "light"].map(|key| self.tables(document, key));
        let limit = self.files.limits.directives;
        if all.iter().map(Vec::len).sum::<usize>() > limit {
            self.reader.error(0..0, &format!("more than {limit} tables"), "a smaller scene");
            return [const { Vec::new() }; 4];
        }
        all
    }

    /// The tables of one list.
    fn tables(&mut self, document: Table<'d>, key: &'static str) -> Vec<Table<'d>> {
        let Some(list) = document.get(key) else { return Vec::new() };
        let tables: Option<Vec<Table<'d>>> = list.items().and_then(|items| items.map(Value::table).collect());
        tables.unwrap_or_else(|| {
            self.reader.error(list.span(), &format!("`{key}` is not a list of tables"), &format!("`[[{key}]]`"));
            Vec::new()
        })
    }

    /// Gives every material its number, so that mixes and objects can name it wherever it stands.
    fn name_materials(&mut self, tables: &[Table<'d>]) {
        for (i, table) in tables.iter().enumerate() {
            self.scene.materials.push(SurfaceDesc::default());
            self.places.materials.push(MaterialPlace::Table(*table));
            let Some(name) = self.reader.required(*table, "name", TEXT) else { continue };
            let id = SurfaceId(i as u32);
            let first = *self.materials.entry(name.clone()).or_insert(id);
            if first != id {
                let message = format!("there is a material `{name}` above");
                self.reader.error_at(*table, "name", &message, "another name");
            }
        }
    }

    /// The material that `key` of a table names.
    pub(super) fn named_material(&mut self, table: Table<'_>, key: &'static str) -> Option<SurfaceId> {
        let name = self.reader.required(table, key, MATERIAL)?;
        let found = self.materials.get(&name).copied();
        if found.is_none() {
            let mut known: Vec<&str> = self.materials.keys().map(String::as_str).collect();
            known.sort_unstable();
            let message = format!("there is no material `{name}`{}", did_you_mean(&name, &known));
            self.reader.error_at(table, key, &message, "the name of a [[material]]");
        }
        found
    }

    /// Adds a material that no table names.
    pub(super) fn push_material(&mut self, desc: SurfaceDesc, place: MaterialPlace<'d>) -> SurfaceId {
        self.scene.materials.push(desc);
        self.places.materials.push(place);
        SurfaceId(self.scene.materials.len() as u32 - 1)
    }

    /// Camera and environment.
    fn view(&mut self, document: Table<'d>) {
        if let Some(table) = self.single(document, "camera") {
            self.places.camera = Some(table);
            if let Some(camera) = camera::camera(&mut self.reader, table) {
                self.scene.camera = camera;
            }
        } else if !document.has("camera") {
            self.reader.error(0..0, "the scene has no camera", camera::EXAMPLE);
        }
        if let Some(table) = self.single(document, "environment") {
            self.places.environment = Some(table);
            self.scene.environment = environment::environment(self, table);
        }
    }

    /// A table that there is once or not at all.
    fn single(&mut self, document: Table<'d>, key: &'static str) -> Option<Table<'d>> {
        let value = document.get(key)?;
        let table = value.table();
        if table.is_none() {
            self.reader.error(value.span(), &format!("`{key}` is not a table"), &format!("`[{key}]`"));
        }
        table
    }

    fn finish(mut self, has_objects: bool, has_lights: bool) -> Result<Imported<PhysicalScene>, ImportError> {
        let emits = self.scene.materials.iter().any(|material| material.emission.is_some());
        if !has_lights && !emits && self.scene.environment.is_none() {
            self.reader.warn(0..0, "the scene has no light");
        }
        if !has_objects {
            self.reader.warn(0..0, "the scene has no object");
        }
        // What could not be read has a default in its place, about which nothing should be said.
        if !self.reader.report.has_errors() {
            for issue in self.scene.validate() {
                self.reader.report.error(|| self.places.fault(&issue, self.reader.source));
            }
        }
        if !self.reader.report.has_errors() {
            self.warn_of_large_spheres();
            self.warn_of_unused_libraries();
            self.warn_of_clipped_images();
        }
        let warnings = self.reader.report.finish()?;
        Ok(Imported { scene: self.scene, warnings, files: self.files.opened })
    }
}
