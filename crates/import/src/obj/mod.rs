//! Wavefront OBJ models and their MTL materials.
//!
//! Written here and not taken from the `tobj` crate, because its errors name neither line nor column and it re-orders
//! faces by material; the renderer's results depend on the order of triangles.

mod library_names;
mod lines;
mod material;
mod parse;

pub(crate) use library_names::library_names;
pub(crate) use lines::Lines;
pub(crate) use material::Library;
pub(crate) use parse::parse;

use crate::Fault;
use lightcuts_scene::MeshDesc;

/// A model as its file has it; materials are names only.
#[derive(Debug)]
pub(crate) struct Model {
    /// Triangles without materials.
    pub(crate) mesh: MeshDesc,
    /// Which triangles wear which of `materials`: from a run's start to the next run's.
    pub(crate) runs: Vec<MaterialRun>,
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

/// Number of vertices, normals, texture coordinates and triangles together: what a mesh costs.
pub(crate) fn elements(mesh: &MeshDesc) -> usize {
    mesh.positions.len() + mesh.normals.len() + mesh.texture_coordinates.len() + mesh.triangles.len()
}
