//! Normals for meshes without any, once all objects are known.

use super::build::Builder;
use crate::model::SmoothingRun;
use lightcuts_scene::physical::PhysicalShape;
use lightcuts_scene::{MeshId, smooth_normals};
use std::collections::{HashMap, HashSet};

/// Angle between faces up to which meshes without normals look smooth unless an object says otherwise, in degrees: the sides of
/// a prism of ten corners are 36 degrees apart.
pub(super) const CREASE_DEGREES: f32 = 40.0;

/// What is to be smoothed.
#[derive(Debug, Default)]
pub(super) struct Smoothing {
    /// The smoothing groups of models that have some.
    groups: HashMap<MeshId, Vec<SmoothingRun>>,
    /// Objects that are smooth, in order.
    wanted: Vec<(usize, Crease)>,
}

/// Up to which angle an object wants to be smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crease {
    pub(super) degrees: f32,
    /// Whether it was said: then the model's smoothing groups do not matter.
    pub(super) is_given: bool,
}

impl Smoothing {
    pub(super) fn add_groups(&mut self, mesh: MeshId, groups: Vec<SmoothingRun>) {
        if !groups.is_empty() {
            self.groups.insert(mesh, groups);
        }
    }

    /// A copy has the groups of its original.
    pub(super) fn copy_groups(&mut self, from: MeshId, to: MeshId) {
        if let Some(groups) = self.groups.get(&from).cloned() {
            self.groups.insert(to, groups);
        }
    }

    pub(super) fn want(&mut self, object: usize, crease: Crease) {
        self.wanted.push((object, crease));
    }
}

impl Builder<'_> {
    /// Smooths what objects want smooth. Of a mesh that is wanted in several ways there is a copy for each but the first.
    pub(super) fn smooth_meshes(&mut self) -> Option<()> {
        let mut ways: Vec<(MeshId, Crease, MeshId)> = Vec::new();
        let mut known: HashMap<(MeshId, u32, bool), MeshId> = HashMap::new();
        let mut originals: HashSet<MeshId> = HashSet::new();
        for (object, crease) in std::mem::take(&mut self.models.smoothing.wanted) {
            let Some(mesh) = self.bare_mesh(object) else { continue };
            let way = (mesh, crease.degrees.to_bits(), crease.is_given);
            let smooth = match known.get(&way) {
                Some(smooth) => *smooth,
                None if originals.insert(mesh) => mesh,
                None => self.copy_mesh(self.places.objects[object], mesh)?,
            };
            if known.insert(way, smooth).is_none() {
                ways.push((mesh, crease, smooth));
            }
            if let PhysicalShape::Mesh { mesh, .. } = &mut self.scene.objects[object].shape {
                *mesh = smooth;
            }
        }
        // Only now: copies are of what the file says.
        for (original, crease, smooth) in ways {
            self.smooth(original, crease, smooth)?;
        }
        Some(())
    }

    /// The mesh of an object, if some of its triangles have no normals.
    fn bare_mesh(&self, object: usize) -> Option<MeshId> {
        let PhysicalShape::Mesh { mesh, .. } = self.scene.objects[object].shape else { return None };
        let triangles = &self.scene.meshes[mesh.0 as usize].triangles;
        triangles.iter().any(|triangle| triangle.normals.is_none()).then_some(mesh)
    }

    fn smooth(&mut self, original: MeshId, crease: Crease, smooth: MeshId) -> Option<()> {
        let groups = self.models.smoothing.groups.get(&original).filter(|_| !crease.is_given);
        let mesh = &mut self.scene.meshes[smooth.0 as usize];
        let before = mesh.normals.len();
        match groups {
            Some(runs) => smooth_normals(mesh, crease.degrees, |triangle| group_of(runs, triangle)),
            None => smooth_normals(mesh, crease.degrees, |_| Some(0)),
        }
        let more = mesh.normals.len() - before;
        self.count_elements(self.places.meshes[smooth.0 as usize], more)
    }
}

/// The smoothing group of a triangle; `None` for faces that are flat. Before the first `s` line nothing was said: group 0.
fn group_of(runs: &[SmoothingRun], triangle: usize) -> Option<u32> {
    match runs[..runs.partition_point(|run| run.first_triangle <= triangle)].last() {
        None => Some(0),
        Some(run) => (run.group > 0).then_some(run.group),
    }
}
