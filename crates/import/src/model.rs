//! Models, whatever their file format: triangles, and the names of their materials.

use crate::files::{AssetError, Files};
use crate::lines::Lines;
use crate::ply::{self, PlyFile};
use crate::polygon::Cut;
use crate::report::Report;
use crate::{Fault, obj};
use glam::DVec3;
use lightcuts_scene::MeshDesc;
use std::path::Path;

/// A model as its file has it; materials are names only.
#[derive(Debug, Default)]
pub(crate) struct Model {
    /// Triangles without materials.
    pub(crate) mesh: MeshDesc,
    /// What the mesh's positions are relative to, in the file's coordinates.
    pub(crate) origin: DVec3,
    /// Which triangles have which of `materials`: from a run's start to the next run's.
    pub(crate) runs: Vec<MaterialRun>,
    /// Smoothing groups likewise; none if the file says nothing of them.
    pub(crate) smoothing: Vec<SmoothingRun>,
    /// Material names in the order of their first use, with a fault that points there and has yet to say why.
    pub(crate) materials: Vec<(String, Fault)>,
    /// The file names of each `mtllib` line, unsplit, likewise.
    pub(crate) libraries: Vec<(String, Fault)>,
}

/// Triangles that follow one `usemtl` line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MaterialRun {
    pub(crate) first_triangle: usize,
    /// Index into [`Model::materials`].
    pub(crate) material: usize,
}

/// Triangles that follow one `s` line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SmoothingRun {
    pub(crate) first_triangle: usize,
    /// 0 for faces that are not smoothed.
    pub(crate) group: u32,
}

/// The formats of models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ModelFormat {
    Obj,
    Ply,
}

impl ModelFormat {
    /// By the extension; `None` if it is of neither.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        let known = [("obj", Self::Obj), ("ply", Self::Ply)];
        known.into_iter().find(|(name, _)| extension.eq_ignore_ascii_case(name)).map(|(_, format)| format)
    }
}

impl Model {
    /// Reads the model at `path`. `Ok(None)` if its content has errors, which are reported; `Err` if it cannot be read.
    /// Warnings about the model as a whole stand at `place`.
    pub(crate) fn load(
        files: &mut Files<'_>,
        path: &Path,
        format: ModelFormat,
        cut: Cut,
        place: &Fault,
        report: &mut Report,
    ) -> Result<Option<Self>, AssetError> {
        let limit = files.limits.model_bytes;
        let reader = files.open("model", path, limit)?;
        let name = path.display().to_string();
        let room = files.room();
        let parsed = match format {
            ModelFormat::Obj => obj::parse(Lines::new(reader, path, &name, limit, "an OBJ model"), room, cut, report),
            ModelFormat::Ply => ply::parse(PlyFile { reader, path, name: &name, limit }, room, cut, report),
        };
        let Some(model) = parsed.map_err(|error| AssetError::File { what: "model", error })? else { return Ok(None) };
        if model.mesh.triangles.is_empty() {
            report.warn(|| place.clone().with_message("the model has no faces"));
        }
        files.elements += elements(&model.mesh);
        Ok(Some(model))
    }

    /// The triangles of each run, with the run's material as an index into [`Self::materials`]; `count` triangles in all.
    pub(crate) fn material_runs(&self, count: usize) -> impl Iterator<Item = (std::ops::Range<usize>, usize)> {
        self.runs.iter().enumerate().map(move |(i, run)| {
            let end = self.runs.get(i + 1).map_or(count, |next| next.first_triangle);
            (run.first_triangle..end, run.material)
        })
    }
}

/// Number of vertices, normals, texture coordinates and triangles together: what a mesh costs.
pub(crate) fn elements(mesh: &MeshDesc) -> usize {
    mesh.positions.len() + mesh.normals.len() + mesh.texture_coordinates.len() + mesh.triangles.len()
}

/// The message about meshes that cost more than `limit`.
pub(crate) fn too_large(limit: usize) -> String {
    format!("the meshes have more than {limit} vertices and triangles")
}

/// The warning about the colours of vertices.
pub(crate) const VERTEX_COLORS_UNUSED: &str =
    "the model has vertex colours, which are not supported: its surfaces have the colours of their materials";
