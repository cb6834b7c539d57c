//! `[[light]]`

use super::build::Builder;
use super::document::Table;
use super::places::MaterialPlace;
use super::value::{COLOR, FLAG, NUMBER, POSITION, VECTOR};
use glam::Vec3;
use lightcuts_scene::physical::{
    EmissionDesc, EmitterDesc, EmitterKind, PhysicalObject, PhysicalShape, Scattering, SurfaceDesc,
};
use std::f32::consts::PI;

#[derive(Debug, Clone, Copy)]
enum Type {
    Point,
    Spot,
    Directional,
    Rectangle,
    Sphere,
}

const TYPES: [(&str, Type); 5] = [
    ("point", Type::Point),
    ("spot", Type::Spot),
    ("directional", Type::Directional),
    ("rectangle", Type::Rectangle),
    ("sphere", Type::Sphere),
];

impl Type {
    /// How it is called, and its own keys.
    fn keys(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Point => ("a point light", &["position", "intensity", "power"]),
            Self::Spot => ("a spot light", &["position", "direction", "target", "intensity", "inner", "outer"]),
            Self::Directional => ("a directional light", &["direction", "irradiance"]),
            Self::Rectangle => (
                "a rectangle light",
                &["center", "normal", "head", "width", "height", "radiance", "power", "two-sided"],
            ),
            Self::Sphere => ("a sphere light", &["center", "radius", "radiance", "power"]),
        }
    }
}

impl<'d> Builder<'d> {
    pub(super) fn light(&mut self, _index: usize, table: Table<'d>) -> Option<()> {
        let kind = self.reader.choice(table, "type", &TYPES)?;
        let (what, keys) = kind.keys();
        table.check_keys(&mut self.reader, what, &[&["type"], keys])?;
        let emitter = match kind {
            Type::Point => self.point(table)?,
            Type::Spot => self.spot(table)?,
            Type::Directional => EmitterKind::Directional {
                direction: self.reader.required(table, "direction", VECTOR)?,
                irradiance: self.reader.required(table, "irradiance", COLOR)?,
            },
            Type::Rectangle => return self.emissive_rectangle(table),
            Type::Sphere => return self.emissive_sphere(table),
        };
        self.scene.lights.push(EmitterDesc { kind: emitter, location: self.reader.locate(table) });
        self.places.lights.push(table);
        Some(())
    }

    fn point(&mut self, table: Table<'_>) -> Option<EmitterKind> {
        // The same intensity in all directions of the sphere.
        let intensity = self.strength(table, "intensity", 1.0 / (4.0 * PI))?;
        Some(EmitterKind::Point { position: self.reader.required(table, "position", POSITION)?, intensity })
    }

    fn spot(&mut self, table: Table<'_>) -> Option<EmitterKind> {
        let position = self.reader.required(table, "position", POSITION)?;
        let direction = match self.reader.exactly_one(table, &["direction", "target"])? {
            "target" => (self.reader.required(table, "target", POSITION)? - position).as_vec3(),
            direction => self.reader.required(table, direction, VECTOR)?,
        };
        self.reader.warn_of_radians(table, "outer");
        Some(EmitterKind::Spot {
            position,
            direction,
            intensity: self.reader.required(table, "intensity", COLOR)?,
            inner_degrees: self.reader.required(table, "inner", NUMBER)?,
            outer_degrees: self.reader.required(table, "outer", NUMBER)?,
        })
    }

    fn emissive_rectangle(&mut self, table: Table<'d>) -> Option<()> {
        let shape = self.rectangle(table)?;
        let two_sided = self.reader.or(table, "two-sided", FLAG, false)?;
        let PhysicalShape::Rectangle { width, height, .. } = shape else { return None };
        let sides = if two_sided { 2.0 } else { 1.0 };
        // The same radiance in all directions leaves pi times as much power per area.
        let radiance = self.strength(table, "radiance", 1.0 / (PI * width * height * sides))?;
        self.push_emissive(table, shape, radiance, two_sided);
        Some(())
    }

    fn emissive_sphere(&mut self, table: Table<'d>) -> Option<()> {
        let shape = self.sphere(table)?;
        let PhysicalShape::Sphere { radius, .. } = shape else { return None };
        let radiance = self.strength(table, "radiance", 1.0 / (4.0 * PI * PI * radius * radius))?;
        self.push_emissive(table, shape, radiance, false);
        Some(())
    }

    /// The value of `key`, or that of `power`, in watts, times `per_watt`.
    fn strength(&mut self, table: Table<'_>, key: &'static str, per_watt: f32) -> Option<Vec3> {
        let given = self.reader.exactly_one(table, &[key, "power"])?;
        let value = self.reader.required(table, given, COLOR)?;
        // Of a size that cannot be, the size is to blame.
        let factor = if per_watt.is_finite() && per_watt > 0.0 { per_watt } else { 0.0 };
        Some(if given == key { value } else { value * factor })
    }

    /// An emissive surface is an object that is black but for its own light.
    fn push_emissive(&mut self, table: Table<'d>, shape: PhysicalShape, radiance: Vec3, two_sided: bool) {
        let black = SurfaceDesc {
            scattering: Scattering::Lambert { albedo: Vec3::ZERO.into() },
            emission: Some(EmissionDesc { radiance, image: None, two_sided }),
            ..SurfaceDesc::default()
        };
        let material = self.push_material(black, MaterialPlace::Table(table));
        let location = self.reader.locate(table);
        self.push_object(table, PhysicalObject { name: String::new(), shape, material, location });
    }
}
