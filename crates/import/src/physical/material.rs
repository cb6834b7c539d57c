//! `[[material]]`

use super::build::Builder;
use super::document::Table;
use super::image::ImageUse;
use super::metal::{METALS, Metal};
use super::value::{COLOR, FLAG, NUMBER, TEXT, VECTOR, Value};
use glam::Vec3;
use lightcuts_scene::physical::{AlphaMask, EmissionDesc, Scattering, SurfaceDesc, Tint};
use toml::de::DeValue;

/// Keys of every material.
const COMMON: [&str; 5] = ["name", "type", "emission", "normal-map", "alpha"];

/// Refractive index of glass, dielectrics and coats, where none is given.
pub(super) const IOR: f32 = 1.5;

/// Roughness of a coat where none is given.
const COAT_ROUGHNESS: f32 = 0.1;

/// Share from which on a masked surface is there.
pub(super) const THRESHOLD: f32 = 0.5;

/// Colour of diffuse materials where none is given.
const GREY: Vec3 = Vec3::splat(0.5);

#[derive(Debug, Clone, Copy)]
enum Type {
    Lambert,
    Phong,
    Conductor,
    Dielectric,
    Plastic,
    Mirror,
    Mix,
}

const TYPES: [(&str, Type); 7] = [
    ("lambert", Type::Lambert),
    ("phong", Type::Phong),
    ("conductor", Type::Conductor),
    ("dielectric", Type::Dielectric),
    ("plastic", Type::Plastic),
    ("mirror", Type::Mirror),
    ("mix", Type::Mix),
];

impl Type {
    /// How it is called, and its own keys.
    fn keys(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Lambert => ("a lambert material", &["albedo"]),
            Self::Phong => ("a phong material", &["diffuse", "specular", "exponent"]),
            Self::Conductor => ("a conductor", &["eta", "k", "reflectance", "metal", "roughness"]),
            Self::Dielectric => ("a dielectric", &["ior", "roughness", "transmittance"]),
            Self::Plastic => ("a plastic material", &["albedo", "ior", "roughness"]),
            Self::Mirror => ("a mirror", &["reflectance"]),
            Self::Mix => ("a mix", &["first", "second", "weight"]),
        }
    }
}

impl<'d> Builder<'d> {
    /// Material number `index`.
    pub(super) fn material(&mut self, index: usize, table: Table<'d>) -> Option<()> {
        let kind = self.reader.choice(table, "type", &TYPES)?;
        let (what, keys) = kind.keys();
        table.check_keys(&mut self.reader, what, &[&COMMON, keys])?;
        self.scene.materials[index] = SurfaceDesc {
            name: self.reader.or(table, "name", TEXT, String::new())?,
            scattering: self.scattering(kind, table)?,
            emission: self.emission(table)?,
            normal_map: self.optional_image(table, "normal-map", ImageUse::Data)?,
            alpha: self.alpha(table)?,
        };
        Some(())
    }

    fn scattering(&mut self, kind: Type, table: Table<'_>) -> Option<Scattering> {
        Some(match kind {
            Type::Lambert => Scattering::Lambert { albedo: self.tint(table, "albedo", Some(GREY))? },
            Type::Phong => Scattering::Phong {
                diffuse: self.tint(table, "diffuse", None)?,
                specular: self.tint(table, "specular", None)?,
                exponent: self.reader.required(table, "exponent", NUMBER)?,
            },
            Type::Conductor => {
                let Metal { eta, k } = self.metal(table)?;
                Scattering::Conductor { eta, k, roughness: self.reader.or(table, "roughness", NUMBER, 0.0)? }
            }
            Type::Dielectric => Scattering::Dielectric {
                ior: self.reader.or(table, "ior", NUMBER, IOR)?,
                roughness: self.reader.or(table, "roughness", NUMBER, 0.0)?,
                transmittance: self.reader.or(table, "transmittance", COLOR, Vec3::ONE)?,
            },
            Type::Plastic => Scattering::Plastic {
                albedo: self.tint(table, "albedo", Some(GREY))?,
                ior: self.reader.or(table, "ior", NUMBER, IOR)?,
                roughness: self.reader.or(table, "roughness", NUMBER, COAT_ROUGHNESS)?,
            },
            Type::Mirror => Scattering::Mirror { reflectance: self.tint(table, "reflectance", Some(Vec3::ONE))? },
            Type::Mix => self.mix(table)?,
        })
    }

    /// A metal by its indices, its reflectance or its name.
    fn metal(&mut self, table: Table<'_>) -> Option<Metal> {
        Some(match self.reader.exactly_one(table, &["eta", "reflectance", "metal"])? {
            "eta" => {
                Metal { eta: self.reader.required(table, "eta", VECTOR)?, k: self.reader.required(table, "k", VECTOR)? }
            }
            other if table.has("k") => {
                self.reader.error_at(table, "k", &format!("`k` beside `{other}`"), "`k` beside `eta` alone");
                return None;
            }
            "reflectance" => {
                let reflectance = self.reader.required(table, "reflectance", COLOR)?;
                if !reflectance.to_array().iter().all(|share| (0.0..=1.0).contains(share)) {
                    let message = format!("`reflectance` is {reflectance}");
                    self.reader.error_at(table, "reflectance", &message, "three numbers from 0 to 1");
                    return None;
                }
                Metal::of_reflectance(reflectance)
            }
            _ => self.reader.choice(table, "metal", &METALS)?,
        })
    }

    /// `weight` is a number, or an image with a factor.
    fn mix(&mut self, table: Table<'_>) -> Option<Scattering> {
        let first = self.named_material(table, "first")?;
        let second = self.named_material(table, "second")?;
        let (weight, image) = match table.get("weight").and_then(Value::table) {
            None => (self.reader.required(table, "weight", NUMBER)?, None),
            Some(inner) => {
                inner.check_keys(&mut self.reader, "a weight", &[&["image", "factor"]])?;
                let image = self.required_image(inner, "image", ImageUse::Data)?;
                (self.reader.or(inner, "factor", NUMBER, 1.0)?, Some(image))
            }
        };
        Some(Scattering::Mix { first, second, weight, image })
    }

    /// A colour: a number or three, the name of an image, or an image with a factor. Required without `default`.
    fn tint(&mut self, table: Table<'_>, key: &'static str, default: Option<Vec3>) -> Option<Tint> {
        let Some(value) = table.get(key) else {
            return default.map(Tint::from).or_else(|| self.reader.required(table, key, COLOR).map(Tint::from));
        };
        if let Some(inner) = value.table() {
            inner.check_keys(&mut self.reader, "a colour", &[&["image", "factor"]])?;
            let image = Some(self.required_image(inner, "image", ImageUse::Color)?);
            return Some(Tint { color: self.reader.or(inner, "factor", COLOR, Vec3::ONE)?, image });
        }
        if let DeValue::String(_) = value.content {
            return Some(Tint { color: Vec3::ONE, image: Some(self.image(value, ImageUse::Color)?) });
        }
        self.reader.read(value, COLOR).map(Tint::from)
    }

    /// Black light is none.
    #[allow(clippy::option_option, reason = "the outer one is an error, as everywhere here")]
    fn emission(&mut self, table: Table<'_>) -> Option<Option<EmissionDesc>> {
        let Some(value) = table.get("emission") else { return Some(None) };
        let emission = match value.table() {
            None => EmissionDesc { radiance: self.reader.read(value, COLOR)?, image: None, two_sided: false },
            Some(inner) => {
                inner.check_keys(&mut self.reader, "an emission", &[&["radiance", "image", "two-sided"]])?;
                EmissionDesc {
                    radiance: self.reader.or(inner, "radiance", COLOR, Vec3::ONE)?,
                    image: self.optional_image(inner, "image", ImageUse::Color)?,
                    two_sided: self.reader.or(inner, "two-sided", FLAG, false)?,
                }
            }
        };
        Some((emission.radiance != Vec3::ZERO).then_some(emission))
    }

    /// The name of an image, or an image with a threshold.
    #[allow(clippy::option_option, reason = "the outer one is an error, as everywhere here")]
    fn alpha(&mut self, table: Table<'_>) -> Option<Option<AlphaMask>> {
        let Some(value) = table.get("alpha") else { return Some(None) };
        let (image, threshold) = match value.table() {
            None => (self.image(value, ImageUse::Data)?, THRESHOLD),
            Some(inner) => {
                inner.check_keys(&mut self.reader, "a mask", &[&["image", "threshold"]])?;
                let image = self.required_image(inner, "image", ImageUse::Data)?;
                (image, self.reader.or(inner, "threshold", NUMBER, THRESHOLD)?)
            }
        };
        Some(Some(AlphaMask { image, threshold }))
    }
}
