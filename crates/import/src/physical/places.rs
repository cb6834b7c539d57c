//! From the issues of a finished scene back to the keys that caused them.

use super::document::Table;
use super::value::Value;
use crate::Fault;
use crate::obj::Library;
use crate::source::Source;
use lightcuts_scene::{Issue, Subject};
use std::rc::Rc;

/// Where the parts of a scene were described.
#[derive(Default)]
pub(super) struct Places<'d> {
    pub(super) camera: Option<Table<'d>>,
    pub(super) environment: Option<Table<'d>>,
    pub(super) lights: Vec<Table<'d>>,
    pub(super) objects: Vec<Table<'d>>,
    pub(super) meshes: Vec<Table<'d>>,
    pub(super) materials: Vec<MaterialPlace<'d>>,
    /// Where each image is named first, without a message.
    pub(super) images: Vec<Fault>,
}

/// Where a material was described.
pub(super) enum MaterialPlace<'d> {
    Table(Table<'d>),
    /// In a library, under this name.
    Library(Rc<Library>, String),
}

/// Keys that become a field of the scene where they are not spelled like it, the likeliest first.
const KEYS: [(&str, &[&str]); 12] = [
    ("degrees", &["fov", "rotate"]),
    ("inner_degrees", &["inner"]),
    ("outer_degrees", &["outer"]),
    ("direction", &["direction", "target"]),
    ("focus_distance", &["focus-distance", "focus", "target"]),
    ("intensity", &["intensity", "power"]),
    ("radiance", &["radiance", "emission", "power"]),
    ("placement", &["matrix", "scale", "translate", "rotate"]),
    ("threshold", &["alpha"]),
    ("image", &["image", "weight"]),
    ("positions", &["file"]),
    ("triangles", &["file"]),
];

/// The same for materials of a library.
const LIBRARY_KEYS: [(&str, &str); 6] = [
    ("albedo", "diffuse"),
    ("reflectance", "specular"),
    ("radiance", "Ke"),
    ("ior", "Ni"),
    ("transmittance", "Tf"),
    ("alpha", "map_d"),
];

impl Places<'_> {
    /// The error that an issue means.
    pub(super) fn fault(&self, issue: &Issue, source: &Source<'_>) -> Fault {
        let (message, expected) = issue.message.split_once("; expected ").unwrap_or((&issue.message, ""));
        self.fault_about(issue, message, source).expected(expected)
    }

    fn fault_about(&self, issue: &Issue, message: &str, source: &Source<'_>) -> Fault {
        let table = match issue.subject {
            Subject::Scene => None,
            Subject::Camera => self.camera,
            Subject::Environment => self.environment,
            Subject::Light(i) => self.lights.get(i).copied(),
            Subject::Object(i) => self.objects.get(i).copied(),
            Subject::Mesh(i) => self.meshes.get(i).copied(),
            Subject::Image(i) => {
                if let Some(place) = self.images.get(i) {
                    return place.clone().with_message(&format!("the image's {} {message}", issue.field));
                }
                None
            }
            Subject::Material(i) => match self.materials.get(i) {
                Some(MaterialPlace::Table(table)) => Some(*table),
                Some(MaterialPlace::Library(library, name)) => {
                    let known = LIBRARY_KEYS.iter().find(|(field, _)| *field == issue.field);
                    let field = known.map_or(issue.field, |(_, key)| key);
                    return library.field_fault(name, field, &format!("{} {message}", issue.field));
                }
                None => None,
            },
        };
        let Some(table) = table else {
            return source.fault(0..0, &format!("{}: {} {message}", issue.subject, issue.field));
        };
        let spelled = issue.field.replace('_', "-");
        let others = KEYS.iter().find(|(known, _)| *known == issue.field).map_or(&[][..], |(_, keys)| keys);
        let value = others.iter().find_map(|key| table.get(key)).or_else(|| table.get(&spelled));
        let subject = match value {
            Some(value) if value.key != spelled => format!("`{}`: {}", value.key, issue.field.replace('_', " ")),
            _ => format!("`{spelled}`"),
        };
        source.fault(value.map_or(table.span(), Value::span), &format!("{subject} {message}"))
    }
}
