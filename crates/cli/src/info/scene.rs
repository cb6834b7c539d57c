//! What was understood of a scene.

use lightcuts::scene::{
    LightKind, MaterialDesc, PerDevice, Projection, SamplerKind, SceneDesc, ShapeDesc, TextureMode,
};
use lightcuts::{Imported, Settings, World};
use serde::Serialize;
use std::collections::BTreeMap;

/// A scene as people want to check it.
#[derive(Debug, Serialize)]
pub(super) struct SceneInfo {
    pub(super) name: String,
    pub(super) background: [f32; 3],
    pub(super) camera: Camera,
    /// Number of lights by kind.
    pub(super) lights: BTreeMap<&'static str, usize>,
    /// Number of point lights after area lights are cut up.
    pub(super) emitters: usize,
    pub(super) objects: Vec<Object>,
    pub(super) totals: Totals,
    /// Lower and upper corner of everything that rays can hit.
    pub(super) bounds: Option<[[f32; 3]; 2]>,
    /// What the scene's author recommends.
    pub(super) recommended: Vec<Parameter>,
    /// What a render without options uses.
    pub(super) settings: Settings,
    pub(super) files: Vec<String>,
    /// `file:line:column: message`.
    pub(super) warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
pub(super) struct Camera {
    pub(super) sampler: SamplerKind,
    /// From the eye to the view plane; none where rays are parallel.
    pub(super) eye_distance: Option<f32>,
    pub(super) center: [f32; 3],
    pub(super) view: [f32; 3],
    pub(super) up: [f32; 3],
}

#[derive(Debug, Serialize)]
pub(super) struct Object {
    pub(super) kind: &'static str,
    pub(super) name: String,
    /// Line of the scene file.
    pub(super) line: u32,
    pub(super) material: String,
    /// F, R, K and E: mirrored, refracted, ratio of indices, local.
    pub(super) optics: [f32; 4],
    pub(super) triangles: usize,
    pub(super) texture: Option<Texture>,
}

#[derive(Debug, Serialize)]
pub(super) struct Texture {
    pub(super) name: String,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) mode: &'static str,
}

#[derive(Debug, Serialize)]
pub(super) struct Totals {
    pub(super) triangles: usize,
    pub(super) spheres: usize,
    pub(super) squares: usize,
}

#[derive(Debug, Serialize)]
pub(super) struct Parameter {
    /// `table.key` as in a job file.
    pub(super) name: &'static str,
    pub(super) cpu: f32,
    pub(super) gpu: f32,
}

impl SceneInfo {
    /// Of a scene and the world made of it.
    pub(super) fn new(imported: &Imported, world: &World) -> Self {
        let scene = &imported.scene;
        let mut lights = BTreeMap::new();
        for light in &scene.lights {
            *lights.entry(light_kind(&light.kind)).or_default() += 1;
        }
        Self {
            name: scene.name.clone(),
            background: scene.background.into(),
            camera: camera(scene),
            lights,
            emitters: world.lights.len(),
            objects: objects(scene),
            totals: Totals {
                triangles: world.shapes.corners.len(),
                spheres: world.shapes.spheres.len(),
                squares: world.shapes.squares.len(),
            },
            bounds: bounds(world),
            recommended: recommended(scene),
            settings: Settings::for_scene(scene),
            warnings: imported.warnings.iter().map(ToString::to_string).collect(),
            files: imported.files.iter().map(|path| path.display().to_string()).collect(),
        }
    }
}

fn camera(scene: &SceneDesc) -> Camera {
    let camera = &scene.camera;
    let eye_distance = match camera.projection {
        Projection::Perspective { distance } => Some(distance),
        Projection::Orthographic => None,
    };
    let (center, view, up) = (camera.center.into(), camera.view.into(), camera.up.into());
    Camera { sampler: camera.sampler, eye_distance, center, view, up }
}

fn light_kind(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Omni { .. } => "omni",
        LightKind::Hemisphere { .. } => "hemisphere",
        LightKind::Directional { .. } => "directional",
        LightKind::Area { .. } => "area",
    }
}

fn objects(scene: &SceneDesc) -> Vec<Object> {
    let describe = |object: &lightcuts::scene::ObjectDesc| {
        // A valid scene has the material; without it the default is as good a description.
        let material = scene.materials.get(object.material.0 as usize).cloned().unwrap_or_default();
        let (kind, triangles, overrides) = match object.shape {
            ShapeDesc::Sphere { .. } => ("sphere", 0, true),
            ShapeDesc::Square { .. } => ("square", 0, true),
            ShapeDesc::Cube { .. } => ("cube", 0, true),
            ShapeDesc::Mesh { mesh, override_material, .. } => {
                ("mesh", scene.meshes.get(mesh.0 as usize).map_or(0, |mesh| mesh.triangles.len()), override_material)
            }
        };
        Object {
            kind,
            name: object.name.clone(),
            line: object.location.line,
            material: if overrides { material_name(&material) } else { "of the model".to_owned() },
            optics: [material.reflection, material.refraction, material.refraction_ratio, material.local],
            triangles,
            texture: texture(scene, &material),
        }
    };
    scene.objects.iter().map(describe).collect()
}

/// The name, or the diffuse colour where there is none.
fn material_name(material: &MaterialDesc) -> String {
    let [r, g, b]: [f32; 3] = material.diffuse.into();
    if material.name.is_empty() { format!("diffuse {r} {g} {b}") } else { material.name.clone() }
}

fn texture(scene: &SceneDesc, material: &MaterialDesc) -> Option<Texture> {
    let texture = material.texture?;
    let image = scene.images.get(texture.image.0 as usize)?;
    let mode = match texture.mode {
        TextureMode::Stretch => "stretch",
        TextureMode::Repeat => "repeat",
        TextureMode::Straight => "straight",
    };
    Some(Texture { name: image.name.clone(), width: image.width, height: image.height, mode })
}

/// The union of the root's boxes; empty ones are inverted and add nothing.
fn bounds(world: &World) -> Option<[[f32; 3]; 2]> {
    let root = world.shapes.nodes.first()?;
    let boxes = (0..root.child.len()).map(|lane| root.child_box(lane));
    let (lower, upper) = boxes.reduce(|(a, b), (lower, upper)| (a.min(lower), b.max(upper)))?;
    Some([lower.to_array(), upper.to_array()])
}

fn recommended(scene: &SceneDesc) -> Vec<Parameter> {
    let vpl = scene.defaults.vpl;
    let parameters = [
        ("vpl.probability", vpl.map(|vpl| vpl.probability)),
        ("vpl.min-illumination", vpl.map(|vpl| vpl.min_illumination)),
        ("vpl.attenuation", vpl.map(|vpl| vpl.attenuation)),
        ("gather.threshold", scene.defaults.threshold),
    ];
    let given = parameters.into_iter().filter_map(|(name, value)| Some((name, value?)));
    given.map(|(name, PerDevice { cpu, gpu })| Parameter { name, cpu, gpu }).collect()
}
