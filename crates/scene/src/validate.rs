//! What must hold of a scene before it is rendered, said once for every importer and for scenes built in code.

use crate::{LightKind, MeshDesc, Projection, SceneDesc, ShapeDesc, Transform};
use glam::{DVec3, Vec3};
use std::fmt;

/// Largest magnitude of a coordinate or length, in scene units: its cube still fits a 32-bit float.
pub const MAX_COORDINATE: f32 = 1e9;

/// Largest number of hemisphere lights that one area light may be cut into.
pub const MAX_EMITTERS: u64 = 1 << 20;

/// Largest magnitude of a colour, ratio or exponent.
const MAX_FACTOR: f32 = 1e6;

/// Greatest radiance, intensity or irradiance, and greatest texel of an image of light.
pub const MAX_LIGHT: f32 = 1e15;

/// Least squared length of a direction; and of the sine between two directions that must not be parallel.
const MIN_DIRECTION_SQ: f32 = 1e-12;

/// The part of a scene that an [`Issue`] is about; indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The scene as a whole.
    Scene,
    /// The camera.
    Camera,
    /// The environment.
    Environment,
    /// A light.
    Light(usize),
    /// An object.
    Object(usize),
    /// A material.
    Material(usize),
    /// An image.
    Image(usize),
    /// A mesh.
    Mesh(usize),
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene => write!(f, "the scene"),
            Self::Camera => write!(f, "the camera"),
            Self::Environment => write!(f, "the environment"),
            Self::Light(i) => write!(f, "light {}", i + 1),
            Self::Object(i) => write!(f, "object {}", i + 1),
            Self::Material(i) => write!(f, "material {}", i + 1),
            Self::Image(i) => write!(f, "image {}", i + 1),
            Self::Mesh(i) => write!(f, "mesh {}", i + 1),
        }
    }
}

/// A reason why a scene cannot be rendered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{subject}: {field} {message}")]
pub struct Issue {
    /// What it is about.
    pub subject: Subject,
    /// The offending field, by the name it has in this crate.
    pub field: &'static str,
    /// What is wrong and what was expected, to follow the field's name.
    pub message: String,
}

impl SceneDesc {
    /// Checks everything that rendering relies on and returns all issues, in scene order. An empty list means that
    /// every number is finite and in range, every direction has a length and every index points at something.
    pub fn validate(&self) -> Vec<Issue> {
        let mut check = Check::new();
        check.color("background", self.background);
        check.subject = Subject::Camera;
        self.validate_camera(&mut check);
        for (i, light) in self.lights.iter().enumerate() {
            check.subject = Subject::Light(i);
            check.factor("attenuation", light.attenuation);
            check.color("specular", light.specular);
            check.color("diffuse", light.diffuse);
            check.color("ambient", light.ambient);
            check.light_kind(&light.kind);
        }
        for (i, object) in self.objects.iter().enumerate() {
            check.subject = Subject::Object(i);
            check.index("material", object.material.0, self.materials.len());
            check.shape(&object.shape, self.meshes.len());
        }
        self.validate_assets(&mut check);
        check.issues
    }

    fn validate_camera(&self, check: &mut Check) {
        let camera = &self.camera;
        check.point("center", camera.center);
        check.frame(("view", camera.view), ("up", camera.up));
        if let Projection::Perspective { distance } = camera.projection {
            check.length("distance", distance);
        }
    }

    fn validate_assets(&self, check: &mut Check) {
        for (i, material) in self.materials.iter().enumerate() {
            check.subject = Subject::Material(i);
            check.color("specular", material.specular);
            check.color("diffuse", material.diffuse);
            check.color("ambient", material.ambient);
            check.factor("exponent", material.exponent);
            check.factor("reflection", material.reflection);
            check.factor("refraction", material.refraction);
            check.factor("refraction_ratio", material.refraction_ratio);
            check.factor("local", material.local);
            if let Some(texture) = material.texture {
                check.index("texture", texture.image.0, self.images.len());
            }
        }
        for (i, image) in self.images.iter().enumerate() {
            check.subject = Subject::Image(i);
            let texels = u64::from(image.width) * u64::from(image.height);
            if texels == 0 || texels != image.texels.len() as u64 {
                check.issue("texels", format!("must be {} x {} and at least one", image.width, image.height));
            }
        }
        for (i, mesh) in self.meshes.iter().enumerate() {
            check.subject = Subject::Mesh(i);
            check.mesh(mesh, self.materials.len());
        }
    }
}

/// Collects the issues of one subject after the other.
pub(crate) struct Check {
    pub(crate) issues: Vec<Issue>,
    pub(crate) subject: Subject,
}

impl Check {
    pub(crate) fn new() -> Self {
        Self { issues: Vec::new(), subject: Subject::Scene }
    }

    pub(crate) fn issue(&mut self, field: &'static str, message: impl Into<String>) {
        self.issues.push(Issue { subject: self.subject, field, message: message.into() });
    }

    pub(crate) fn factor(&mut self, field: &'static str, value: f32) {
        if !(0.0..=MAX_FACTOR).contains(&value) {
            self.issue(field, format!("is {value}; expected a number from 0 to {MAX_FACTOR:e}"));
        }
    }

    /// Light in a physical unit.
    pub(crate) fn light(&mut self, field: &'static str, value: Vec3) {
        if !value.to_array().iter().all(|c| (0.0..=MAX_LIGHT).contains(c)) {
            self.issue(field, format!("is {value}; expected three numbers from 0 to {MAX_LIGHT:e}"));
        }
    }

    pub(crate) fn color(&mut self, field: &'static str, value: Vec3) {
        if !value.to_array().iter().all(|c| (0.0..=MAX_FACTOR).contains(c)) {
            self.issue(field, format!("is {value}; expected three numbers from 0 to {MAX_FACTOR:e}"));
        }
    }

    pub(crate) fn point(&mut self, field: &'static str, value: impl Into<DVec3> + fmt::Display + Copy) {
        if !value.into().to_array().iter().all(|c| c.abs() <= f64::from(MAX_COORDINATE)) {
            self.issue(field, format!("is {value}; expected coordinates of at most {MAX_COORDINATE:e} in magnitude"));
        }
    }

    pub(crate) fn length(&mut self, field: &'static str, value: f32) {
        if !(value > 0.0 && value <= MAX_COORDINATE) {
            self.issue(field, format!("is {value}; expected a length above 0 and at most {MAX_COORDINATE:e}"));
        }
    }

    /// Whether `value` can be normalised.
    pub(crate) fn direction(&mut self, field: &'static str, value: Vec3) -> bool {
        let good =
            value.to_array().iter().all(|c| c.abs() <= MAX_COORDINATE) && value.length_squared() >= MIN_DIRECTION_SQ;
        if !good {
            self.issue(field, format!("is {value}; expected a direction of non-zero length"));
        }
        good
    }

    pub(crate) fn frame(&mut self, (first_field, first): (&'static str, Vec3), (field, second): (&'static str, Vec3)) {
        if self.direction(first_field, first) & self.direction(field, second)
            && first.normalize().cross(second.normalize()).length_squared() < MIN_DIRECTION_SQ
        {
            self.issue(field, format!("is {second}, parallel to {first_field}; expected another direction"));
        }
    }

    pub(crate) fn index(&mut self, field: &'static str, index: u32, count: usize) {
        if index as usize >= count {
            self.issue(field, format!("is number {index}, but there are {count}"));
        }
    }

    fn light_kind(&mut self, kind: &LightKind) {
        match *kind {
            LightKind::Omni { position } => self.point("position", position),
            LightKind::Hemisphere { position, direction } => {
                self.point("position", position);
                self.direction("direction", direction);
            }
            LightKind::Directional { direction } => {
                self.direction("direction", direction);
            }
            LightKind::Area { center, normal, head, width, height, spacing } => {
                self.point("center", center);
                self.frame(("normal", normal), ("head", head));
                self.length("width", width);
                self.length("height", height);
                self.length("spacing", spacing);
                let cells = kind.subdivision().map_or(0, |(across, along)| across.saturating_mul(along));
                if cells > MAX_EMITTERS {
                    self.issue(
                        "spacing",
                        format!("cuts the light into {cells} points; at most {MAX_EMITTERS} are possible"),
                    );
                }
            }
        }
    }

    fn shape(&mut self, shape: &ShapeDesc, meshes: usize) {
        match *shape {
            ShapeDesc::Sphere { center, radius } => {
                self.point("center", center);
                self.length("radius", radius);
            }
            ShapeDesc::Square { center, normal, head, width, height } => {
                self.point("center", center);
                self.frame(("normal", normal), ("head", head));
                self.length("width", width);
                self.length("height", height);
            }
            ShapeDesc::Cube { center, vertical, horizontal, length, width, height } => {
                self.point("center", center);
                self.frame(("vertical", vertical), ("horizontal", horizontal));
                self.length("length", length);
                self.length("width", width);
                self.length("height", height);
            }
            ShapeDesc::Mesh { mesh, ref transform, .. } => {
                self.index("mesh", mesh.0, meshes);
                self.transform(transform);
            }
        }
    }

    fn transform(&mut self, transform: &Transform) {
        self.point("translation", transform.translation);
        self.point("scale", transform.scale);
        if transform.scale.to_array().contains(&0.0) {
            self.issue("scale", format!("is {}; expected no factor of 0", transform.scale));
        }
        if !transform.degrees.is_finite() {
            self.issue("degrees", format!("is {}; expected an angle", transform.degrees));
        } else if transform.degrees != 0.0 {
            self.direction("axis", transform.axis);
        }
    }

    pub(crate) fn mesh(&mut self, mesh: &MeshDesc, materials: usize) {
        let finite = |v: &Vec3| v.to_array().iter().all(|c| c.abs() <= MAX_COORDINATE);
        if let Some(i) = mesh.positions.iter().position(|p| !finite(p)) {
            self.issue("positions", format!("hold {} at vertex {}", mesh.positions[i], i + 1));
        }
        let corner_ok = |indices: Option<[u32; 3]>, count: usize| {
            indices.is_none_or(|corners| corners.iter().all(|&i| (i as usize) < count))
        };
        let bad = mesh.triangles.iter().position(|t| {
            !(corner_ok(Some(t.positions), mesh.positions.len())
                && corner_ok(t.normals, mesh.normals.len())
                && corner_ok(t.texture_coordinates, mesh.texture_coordinates.len())
                && t.material.is_none_or(|m| (m.0 as usize) < materials))
        });
        if let Some(i) = bad {
            self.issue("triangles", format!("point at something that does not exist in triangle {}", i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MaterialDesc, MaterialId, MeshId, MeshTriangle, ObjectDesc};

    fn scene(shape: ShapeDesc) -> SceneDesc {
        SceneDesc {
            materials: vec![MaterialDesc::default()],
            meshes: vec![MeshDesc {
                positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
                triangles: vec![MeshTriangle {
                    positions: [0, 1, 2],
                    normals: None,
                    texture_coordinates: None,
                    material: None,
                }],
                ..MeshDesc::default()
            }],
            objects: vec![ObjectDesc {
                name: String::new(),
                shape,
                material: MaterialId(0),
                location: crate::Location::default(),
            }],
            ..SceneDesc::default()
        }
    }

    fn fields(scene: &SceneDesc) -> Vec<&'static str> {
        scene.validate().iter().map(|i| i.field).collect()
    }

    #[test]
    fn a_sound_scene_has_no_issues() {
        let shape = ShapeDesc::Sphere { center: Vec3::ZERO, radius: 1.0 };
        assert_eq!(scene(shape).validate(), []);
    }

    #[test]
    fn each_fault_is_named() {
        let bad_sphere = ShapeDesc::Sphere { center: Vec3::NAN, radius: -1.0 };
        assert_eq!(fields(&scene(bad_sphere)), ["center", "radius"]);
        let parallel =
            ShapeDesc::Square { center: Vec3::ZERO, normal: Vec3::Y, head: Vec3::Y * 3.0, width: 0.0, height: 1.0 };
        assert_eq!(fields(&scene(parallel)), ["head", "width"]);
        let transform =
            Transform { degrees: 5.0, axis: Vec3::ZERO, scale: Vec3::new(1.0, 0.0, 1.0), ..Transform::default() };
        let mesh = ShapeDesc::Mesh { mesh: MeshId(3), transform, smooth: true, override_material: true };
        assert_eq!(fields(&scene(mesh)), ["mesh", "scale", "axis"]);
    }

    #[test]
    fn dangling_indices_are_found() {
        let mut s = scene(ShapeDesc::Sphere { center: Vec3::ZERO, radius: 1.0 });
        s.objects[0].material = MaterialId(9);
        s.meshes[0].triangles[0].positions[2] = 3;
        assert_eq!(fields(&s), ["material", "triangles"]);
    }

    #[test]
    fn area_lights_are_bounded() {
        let kind = LightKind::Area {
            center: Vec3::ZERO,
            normal: Vec3::Y,
            head: Vec3::X,
            width: 1e6,
            height: 1e6,
            spacing: 1e-3,
        };
        let mut s = scene(ShapeDesc::Sphere { center: Vec3::ZERO, radius: 1.0 });
        s.lights.push(crate::LightDesc {
            kind,
            attenuation: f32::INFINITY,
            specular: Vec3::ONE,
            diffuse: Vec3::ONE,
            ambient: Vec3::ONE,
            location: crate::Location::default(),
        });
        assert_eq!(fields(&s), ["attenuation", "spacing"]);
    }
}
