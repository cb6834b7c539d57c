//! `[[object]]`

use super::build::Builder;
use super::cuboid;
use super::document::Table;
use super::placement::{self, placement};
use super::smoothing::{CREASE_DEGREES, Crease};
use super::value::{FLAG, NUMBER, POSITION, TEXT, VECTOR};
use glam::{DAffine3, DQuat};
use lightcuts_scene::MeshId;
use lightcuts_scene::physical::{PhysicalObject, PhysicalShape};

/// Keys of every object.
const COMMON: [&str; 3] = ["name", "type", "material"];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Type {
    Mesh,
    Sphere,
    Rectangle,
    Box,
}

const TYPES: [(&str, Type); 4] =
    [("mesh", Type::Mesh), ("sphere", Type::Sphere), ("rectangle", Type::Rectangle), ("box", Type::Box)];

impl Type {
    /// How it is called, and its own keys.
    fn keys(self) -> (&'static str, [&'static [&'static str]; 2]) {
        match self {
            Self::Mesh => ("a mesh object", [&["mesh", "smooth", "crease-angle"], &placement::KEYS]),
            Self::Sphere => ("a sphere", [&["center", "radius"], &[]]),
            Self::Rectangle => ("a rectangle", [&["center", "normal", "head", "width", "height"], &[]]),
            Self::Box => ("a box", [&["center", "size"], &placement::KEYS]),
        }
    }
}

impl<'d> Builder<'d> {
    pub(super) fn object(&mut self, _index: usize, table: Table<'d>) -> Option<()> {
        let kind = self.reader.choice(table, "type", &TYPES)?;
        let (what, [own, shared]) = kind.keys();
        table.check_keys(&mut self.reader, what, &[&COMMON, own, shared])?;
        let name = self.reader.or(table, "name", TEXT, String::new())?;
        // A mesh may bring its own materials; all else has what is said here.
        let given = if kind == Type::Mesh && !table.has("material") {
            None
        } else {
            Some(self.named_material(table, "material")?)
        };
        let mut shape = match kind {
            Type::Mesh => self.instance(table)?,
            Type::Sphere => self.sphere(table)?,
            Type::Rectangle => self.rectangle(table)?,
            Type::Box => self.cuboid(table)?,
        };
        let material = match (given, &mut shape) {
            (Some(material), _) => material,
            (None, PhysicalShape::Mesh { mesh, override_material, .. }) => {
                *override_material = false;
                let own = self.own_material(table, *mesh)?;
                *mesh = own.mesh;
                own.material
            }
            (None, _) => return None,
        };
        if kind == Type::Mesh && matches!(shape, PhysicalShape::Mesh { smooth: true, .. }) {
            let crease = self.crease(table)?;
            self.models.smoothing.want(self.scene.objects.len(), crease);
        }
        let location = self.reader.locate(table);
        self.push_object(table, PhysicalObject { name, shape, material, location });
        Some(())
    }

    pub(super) fn push_object(&mut self, table: Table<'d>, object: PhysicalObject) {
        self.scene.objects.push(object);
        self.places.objects.push(table);
    }

    fn instance(&mut self, table: Table<'_>) -> Option<PhysicalShape> {
        let mesh = self.named_mesh(table)?;
        let file = placement(&mut self.reader, table)?;
        Some(PhysicalShape::Mesh {
            mesh,
            placement: self.placed(mesh, file),
            smooth: self.reader.or(table, "smooth", FLAG, true)?,
            override_material: true,
        })
    }

    /// The angle of the import, of the object, or of all objects that say nothing.
    fn crease(&mut self, table: Table<'_>) -> Option<Crease> {
        let given = self.reader.optional(table, "crease-angle", NUMBER)?;
        if let Some(degrees) = given
            && !(0.0..=180.0).contains(&degrees)
        {
            let message = format!("`crease-angle` is {degrees}");
            self.reader.error_at(table, "crease-angle", &message, "an angle from 0 to 180 degrees");
            return None;
        }
        self.reader.warn_of_radians(table, "crease-angle");
        let given = self.crease_degrees.or(given);
        Some(Crease { degrees: given.unwrap_or(CREASE_DEGREES), is_given: given.is_some() })
    }

    pub(super) fn sphere(&mut self, table: Table<'_>) -> Option<PhysicalShape> {
        Some(PhysicalShape::Sphere {
            center: self.reader.required(table, "center", POSITION)?,
            radius: self.reader.required(table, "radius", NUMBER)?,
        })
    }

    pub(super) fn rectangle(&mut self, table: Table<'_>) -> Option<PhysicalShape> {
        Some(PhysicalShape::Rectangle {
            center: self.reader.required(table, "center", POSITION)?,
            normal: self.reader.required(table, "normal", VECTOR)?,
            head: self.reader.required(table, "head", VECTOR)?,
            width: self.reader.required(table, "width", NUMBER)?,
            height: self.reader.required(table, "height", NUMBER)?,
        })
    }

    fn cuboid(&mut self, table: Table<'d>) -> Option<PhysicalShape> {
        let center = self.reader.required(table, "center", POSITION)?;
        let size = self.reader.required(table, "size", POSITION)?;
        if size.min_element() <= 0.0 {
            self.reader.error_at(table, "size", &format!("`size` is {size}"), "three lengths above 0");
            return None;
        }
        let mesh = match self.models.unit_cube {
            Some(mesh) => mesh,
            None => self.push_cube(table),
        };
        let local = DAffine3::from_scale_rotation_translation(size, DQuat::IDENTITY, center);
        let placement = placement(&mut self.reader, table)? * local;
        Some(PhysicalShape::Mesh { mesh, placement, smooth: false, override_material: true })
    }

    fn push_cube(&mut self, table: Table<'d>) -> MeshId {
        let mesh = self.push_mesh(table, cuboid::unit_cube());
        self.models.unit_cube = Some(mesh);
        mesh
    }
}
