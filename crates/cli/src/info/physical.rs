//! What was understood of a scene of the physical model.

use lightcuts::scene::physical::{EmitterKind, PhysicalScene, Scattering};
use lightcuts::{Imported, PhysicalWorld, Settings};
use serde::Serialize;
use std::collections::BTreeMap;

/// A scene of the physical model; serialised, what machines are told.
#[derive(Debug, Serialize)]
pub(super) struct PhysicalInfo {
    pub(super) name: String,
    /// Number of lights that are no surfaces, by kind.
    pub(super) lights: BTreeMap<&'static str, usize>,
    /// Number of luminous triangles, squares and spheres.
    pub(super) luminous: usize,
    pub(super) has_environment: bool,
    pub(super) objects: usize,
    /// Number of materials by kind.
    pub(super) materials: BTreeMap<&'static str, usize>,
    pub(super) images: usize,
    pub(super) triangles: usize,
    pub(super) spheres: usize,
    pub(super) squares: usize,
    /// Corners of a box around everything; none where there is nothing.
    pub(super) bounds: Option<[[f32; 3]; 2]>,
    /// What a render uses unless told otherwise.
    pub(super) settings: Settings,
    pub(super) warnings: Vec<String>,
    pub(super) files: Vec<String>,
}

impl PhysicalInfo {
    pub(super) fn new(imported: &Imported<PhysicalScene>, world: &PhysicalWorld) -> Self {
        let scene = &imported.scene;
        let mut lights = BTreeMap::new();
        for light in &scene.lights {
            *lights.entry(light_kind(&light.kind)).or_default() += 1;
        }
        let mut materials = BTreeMap::new();
        for material in &scene.materials {
            *materials.entry(material_kind(&material.scattering)).or_default() += 1;
        }
        let (lower, upper) = world.scene_bounds();
        Self {
            name: scene.name.clone(),
            lights,
            luminous: world.primitive_emitters.iter().filter(|&&light| light != u32::MAX).count(),
            has_environment: scene.environment.is_some(),
            objects: scene.objects.len(),
            materials,
            images: scene.images.len(),
            triangles: world.shapes.corners.len(),
            spheres: world.shapes.spheres.len(),
            squares: world.shapes.squares.len(),
            bounds: (!world.shapes.primitives.is_empty()).then(|| [lower.as_vec3().into(), upper.as_vec3().into()]),
            settings: Settings::for_physical(),
            warnings: imported.warnings.iter().map(ToString::to_string).collect(),
            files: imported.files.iter().map(|path| path.display().to_string()).collect(),
        }
    }
}

fn light_kind(kind: &EmitterKind) -> &'static str {
    match kind {
        EmitterKind::Point { .. } => "point",
        EmitterKind::Spot { .. } => "spot",
        EmitterKind::Directional { .. } => "directional",
    }
}

fn material_kind(scattering: &Scattering) -> &'static str {
    match scattering {
        Scattering::Lambert { .. } => "lambert",
        Scattering::Phong { .. } => "phong",
        Scattering::Conductor { .. } => "conductor",
        Scattering::Dielectric { .. } => "dielectric",
        Scattering::Plastic { .. } => "plastic",
        Scattering::Mirror { .. } => "mirror",
        Scattering::Mix { .. } => "mix",
    }
}
