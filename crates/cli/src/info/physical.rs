//! What was understood of a scene of the physical model.

use lightcuts::scene::physical::{
    EmitterKind, PhysicalCamera, PhysicalObject, PhysicalScene, PhysicalShape, Scattering, SurfaceDesc, View,
};
use lightcuts::{Imported, PhysicalWorld, Settings};
use serde::Serialize;
use std::collections::BTreeMap;

/// A scene of the physical model; serialised, what machines are told.
#[derive(Debug, Serialize)]
pub(super) struct PhysicalInfo {
    pub(super) name: String,
    pub(super) camera: Camera,
    pub(super) environment: Option<Environment>,
    /// Lights in file order: those that are no surfaces, then rectangles and spheres.
    pub(super) lights: Vec<Light>,
    /// Number of emissive triangles, rectangles and spheres.
    pub(super) emissive: usize,
    /// Objects but for lights, in file order.
    pub(super) objects: Vec<Object>,
    /// Materials but for those of lights.
    pub(super) materials: Vec<Material>,
    /// Meshes by the angle in degrees up to which missing normals were smoothed, as text.
    pub(super) smoothed_meshes: BTreeMap<String, usize>,
    pub(super) images: usize,
    pub(super) triangles: usize,
    pub(super) spheres: usize,
    pub(super) rectangles: usize,
    /// Corners of a box around everything; none where there is nothing.
    pub(super) bounds: Option<[[f32; 3]; 2]>,
    /// What a render uses unless told otherwise.
    pub(super) settings: Settings,
    pub(super) warnings: Vec<String>,
    pub(super) files: Vec<String>,
}

/// The view. Exactly one of `fov`, in degrees, and `height` has a value.
#[derive(Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) struct Camera {
    pub(super) position: [f32; 3],
    /// As long as the file has it.
    pub(super) direction: [f32; 3],
    pub(super) up: [f32; 3],
    pub(super) fov: Option<f32>,
    pub(super) height: Option<f32>,
    pub(super) near: f32,
    pub(super) lens_radius: f32,
    pub(super) focus_distance: f32,
}

#[derive(Debug, Serialize)]
pub(super) struct Environment {
    pub(super) radiance: [f32; 3],
    pub(super) image: Option<String>,
    /// Degrees.
    pub(super) rotate: f32,
}

/// A light; what does not apply to its type is absent.
#[derive(Debug, Serialize)]
pub(super) struct Light {
    #[serde(rename = "type")]
    pub(super) kind: &'static str,
    /// Line of the scene file.
    pub(super) line: u32,
    pub(super) position: Option<[f32; 3]>,
    pub(super) direction: Option<[f32; 3]>,
    pub(super) bounds: Option<[[f32; 3]; 2]>,
    /// What `value` is: intensity, irradiance or radiance.
    pub(super) quantity: &'static str,
    pub(super) value: [f32; 3],
}

#[derive(Debug, Serialize)]
pub(super) struct Object {
    #[serde(rename = "type")]
    pub(super) kind: &'static str,
    pub(super) name: String,
    /// Name of the mesh.
    pub(super) mesh: Option<String>,
    /// Line of the scene file.
    pub(super) line: u32,
    pub(super) material: String,
    pub(super) triangles: usize,
    pub(super) bounds: Option<[[f32; 3]; 2]>,
    /// Angle in degrees up to which missing normals were smoothed.
    pub(super) crease_angle: Option<f32>,
}

#[derive(Debug, Serialize)]
pub(super) struct Material {
    #[serde(rename = "type")]
    pub(super) kind: &'static str,
    pub(super) name: String,
    pub(super) emissive: bool,
}

impl PhysicalInfo {
    pub(super) fn new(imported: &Imported<PhysicalScene>, world: &PhysicalWorld) -> Self {
        let scene = &imported.scene;
        let (lower, upper) = world.scene_bounds();
        Self {
            name: scene.name.clone(),
            camera: camera(&scene.camera),
            environment: environment(scene),
            lights: lights(scene),
            emissive: world.primitive_emitters.iter().filter(|&&light| light != u32::MAX).count(),
            objects: scene.objects.iter().filter(|o| light_of(scene, o).is_none()).map(|o| object(scene, o)).collect(),
            materials: materials(scene),
            smoothed_meshes: smoothed_meshes(scene),
            images: scene.images.len(),
            triangles: world.shapes.corners.len(),
            spheres: world.shapes.spheres.len(),
            rectangles: world.shapes.squares.len(),
            bounds: (!world.shapes.primitives.is_empty()).then(|| [lower.as_vec3().into(), upper.as_vec3().into()]),
            settings: Settings::for_physical(),
            warnings: imported.warnings.iter().map(ToString::to_string).collect(),
            files: imported.files.iter().map(|path| path.display().to_string()).collect(),
        }
    }
}

fn camera(camera: &PhysicalCamera) -> Camera {
    let (fov, height) = match camera.view {
        View::Perspective { degrees } => (Some(degrees), None),
        View::Orthographic { height } => (None, Some(height)),
    };
    Camera {
        position: camera.position.as_vec3().into(),
        direction: camera.direction.into(),
        up: camera.up.into(),
        fov,
        height,
        near: camera.near,
        lens_radius: camera.lens_radius,
        focus_distance: camera.focus_distance,
    }
}

fn environment(scene: &PhysicalScene) -> Option<Environment> {
    let environment = scene.environment.as_ref()?;
    let image = environment.image.and_then(|image| scene.images.get(image.0 as usize));
    Some(Environment {
        radiance: environment.radiance.into(),
        image: image.map(|image| image.name.clone()),
        rotate: environment.degrees,
    })
}

/// The material of an object that a `[[light]]` describes: it has no name, and those of libraries and tables have one.
fn light_of<'s>(scene: &'s PhysicalScene, object: &PhysicalObject) -> Option<&'s SurfaceDesc> {
    let material = scene.materials.get(object.material.0 as usize)?;
    let is_surface = !matches!(object.shape, PhysicalShape::Mesh { .. });
    (is_surface && is_of_light(material)).then_some(material)
}

fn is_of_light(material: &SurfaceDesc) -> bool {
    material.name.is_empty() && material.emission.is_some()
}

fn lights(scene: &PhysicalScene) -> Vec<Light> {
    let sources = scene.lights.iter().map(|light| {
        let (kind, position, direction, quantity, value) = match light.kind {
            EmitterKind::Point { position, intensity } => ("point", Some(position), None, "intensity", intensity),
            EmitterKind::Spot { position, direction, intensity, .. } => {
                ("spot", Some(position), Some(direction), "intensity", intensity)
            }
            EmitterKind::Directional { direction, irradiance } => {
                ("directional", None, Some(direction), "irradiance", irradiance)
            }
        };
        let (position, direction) = (position.map(|place| place.as_vec3().into()), direction.map(Into::into));
        Light { kind, line: light.location.line, position, direction, bounds: None, quantity, value: value.into() }
    });
    let surfaces = scene.objects.iter().filter_map(|object| {
        let emission = light_of(scene, object)?.emission?;
        Some(Light {
            kind: shape_kind(&object.shape),
            line: object.location.line,
            position: None,
            direction: None,
            bounds: bounds(scene, object),
            quantity: "radiance",
            value: emission.radiance.into(),
        })
    });
    sources.chain(surfaces).collect()
}

fn object(scene: &PhysicalScene, object: &PhysicalObject) -> Object {
    let mesh = match object.shape {
        PhysicalShape::Mesh { mesh, .. } => scene.meshes.get(mesh.0 as usize),
        _ => None,
    };
    let (is_smooth, is_own) = match object.shape {
        PhysicalShape::Mesh { smooth, override_material, .. } => (smooth, !override_material),
        _ => (false, false),
    };
    let material = scene.materials.get(object.material.0 as usize).map_or("", |material| material.name.as_str());
    // The mesh of boxes has no name, those of `[[mesh]]` have one.
    let is_box = mesh.is_some_and(|mesh| mesh.name.is_empty());
    Object {
        kind: if is_box { "box" } else { shape_kind(&object.shape) },
        name: object.name.clone(),
        mesh: mesh.filter(|_| !is_box).map(|mesh| mesh.name.clone()),
        line: object.location.line,
        material: if is_own { "of the model".to_owned() } else { material.to_owned() },
        triangles: mesh.map_or(0, |mesh| mesh.triangles.len()),
        bounds: bounds(scene, object),
        crease_angle: mesh.filter(|_| is_smooth).and_then(|mesh| mesh.crease_degrees),
    }
}

fn bounds(scene: &PhysicalScene, object: &PhysicalObject) -> Option<[[f32; 3]; 2]> {
    object.shape.bounds(&scene.meshes).map(|(lower, upper)| [lower.as_vec3().into(), upper.as_vec3().into()])
}

fn shape_kind(shape: &PhysicalShape) -> &'static str {
    match shape {
        PhysicalShape::Sphere { .. } => "sphere",
        PhysicalShape::Rectangle { .. } => "rectangle",
        PhysicalShape::Mesh { .. } => "mesh",
    }
}

fn materials(scene: &PhysicalScene) -> Vec<Material> {
    let shown = scene.materials.iter().filter(|material| !is_of_light(material));
    let material = |desc: &SurfaceDesc| Material {
        kind: material_kind(&desc.scattering),
        name: desc.name.clone(),
        emissive: desc.emission.is_some(),
    };
    shown.map(material).collect()
}

fn smoothed_meshes(scene: &PhysicalScene) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for degrees in scene.meshes.iter().filter_map(|mesh| mesh.crease_degrees) {
        *counts.entry(degrees.to_string()).or_default() += 1;
    }
    counts
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
