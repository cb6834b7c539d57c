//! Materials of MTL libraries in the physical model.
//!
//! | in the library | here |
//! | --- | --- |
//! | `Kd`, `map_Kd` | a matt material |
//! | `Ks` above 0, `Ns` | with `Kd` the energy-keeping Phong material, both scaled down where they exceed 1 together |
//! | `illum` 3 or 5 and a black `Kd` | a mirror of `Ks`, of 1 where it has none |
//! | `illum` 4, 6 or 7 and a black `Kd` | glass of index `Ni` and transmittance `Tf` |
//! | `Ke`, `map_Ke` | emission |
//! | `map_d`; `d` or `Tr` | a mask; nothing at all from half transparent on |
//! | `norm` | a normal map |
//!
//! `Ka` has no counterpart: interreflection takes its place. All else is ignored with a warning.

use super::build::Builder;
use super::image::ImageUse;
use super::material::{IOR, THRESHOLD};
use super::places::MaterialPlace;
use crate::obj::{Library, LibraryMaterial};
use glam::Vec3;
use lightcuts_scene::TextureMode;
use lightcuts_scene::physical::{
    AlphaMask, EmissionDesc, ImageId, PixelImage, Pixels, Scattering, SurfaceDesc, SurfaceId, Tint,
};
use std::path::Path;
use std::rc::Rc;

/// Least and greatest exponent of the Phong material.
const EXPONENTS: (f32, f32) = (1.0, 1e6);

/// Keywords that are used, or that say nothing which would be missed.
const UNDERSTOOD: [&str; 12] =
    ["Ke", "map_Ke", "illum", "d", "Tr", "map_d", "Ni", "Tf", "norm", "sharpness", "map_Ka", "map_aat"];

/// Adds the material `name` of a library to the scene; `None` if it has none of that name.
pub(super) fn material(builder: &mut Builder<'_>, library: &Rc<Library>, name: &str) -> Option<SurfaceId> {
    let found = library.get(name)?;
    let mut converter = Converter { builder, library, found };
    converter.warn_ignored();
    let scattering = converter.scattering();
    let emission = converter.emission();
    let normal_map = converter.map("norm", ImageUse::Data);
    let alpha = converter.alpha();
    let desc = SurfaceDesc { name: name.to_owned(), scattering, emission, normal_map, alpha };
    Some(builder.push_material(desc, MaterialPlace::Library(Rc::clone(library), name.to_owned())))
}

struct Converter<'b, 'd> {
    builder: &'b mut Builder<'d>,
    library: &'b Library,
    found: &'b LibraryMaterial,
}

impl Converter<'_, '_> {
    fn scattering(&mut self) -> Scattering {
        let desc = &self.found.desc;
        let has = |field: &str| self.found.gives(field);
        let image = self.diffuse_map();
        // A map alone is what is meant; the default grey would darken it.
        let diffuse = if image.is_some() && !has("diffuse") { Vec3::ONE } else { desc.diffuse };
        let (specular, exponent, has_specular) = (desc.specular, desc.exponent, has("specular"));
        let is_black = diffuse == Vec3::ZERO && image.is_none();
        match self.number("illum").map(|mode| mode as i32) {
            Some(3 | 5) if is_black => {
                let reflectance = if has_specular { specular } else { Vec3::ONE };
                return Scattering::Mirror { reflectance: reflectance.into() };
            }
            Some(4 | 6 | 7) if is_black => {
                let ior = self.number("Ni").unwrap_or(IOR);
                let transmittance = self.color("Tf").unwrap_or(Vec3::ONE);
                return Scattering::Dielectric { ior, roughness: 0.0, transmittance };
            }
            Some(3..=7) => self.warn("illum", "mirrors and glass with a diffuse colour are not known: it is opaque"),
            _ => {}
        }
        let scale = (diffuse + specular).max_element().max(1.0).recip();
        let diffuse = Tint { color: diffuse * scale, image };
        if specular == Vec3::ZERO {
            return Scattering::Lambert { albedo: diffuse };
        }
        let (least, greatest) = EXPONENTS;
        Scattering::Phong { diffuse, specular: (specular * scale).into(), exponent: exponent.clamp(least, greatest) }
    }

    fn diffuse_map(&mut self) -> Option<ImageId> {
        let (file, mode, span) = self.found.texture.as_ref()?;
        if *mode == TextureMode::Straight {
            let message = "`-clamp on` is ignored: images are tiled";
            self.builder.reader.report.warn(|| self.library.fault(span.clone(), message));
        }
        self.image(file, span.clone(), ImageUse::Color)
    }

    fn emission(&mut self) -> Option<EmissionDesc> {
        let image = self.map("map_Ke", ImageUse::Color);
        let radiance = self.color("Ke").or(image.map(|_| Vec3::ONE))?;
        (radiance != Vec3::ZERO).then_some(EmissionDesc { radiance, image, two_sided: false })
    }

    fn alpha(&mut self) -> Option<AlphaMask> {
        if let Some(image) = self.map("map_d", ImageUse::Data) {
            return Some(AlphaMask { image, threshold: THRESHOLD });
        }
        let opacity = self.number("d").or_else(|| self.number("Tr").map(|transparency| 1.0 - transparency))?;
        let is_glass = matches!(self.number("illum").map(|mode| mode as i32), Some(4 | 6 | 7));
        if opacity >= 1.0 || is_glass {
            return None;
        }
        let keyword = if self.found.other("d").is_some() { "d" } else { "Tr" };
        let is_there = opacity >= THRESHOLD;
        let told = if is_there { "it is opaque" } else { "it is not there" };
        self.warn(keyword, &format!("surfaces that let a share of the light through are not known: {told}"));
        (!is_there).then(|| AlphaMask { image: self.nothing(keyword), threshold: THRESHOLD })
    }

    /// The image of a surface that is nowhere.
    fn nothing(&mut self, keyword: &str) -> ImageId {
        let image = PixelImage { name: String::new(), width: 1, height: 1, pixels: Pixels::Linear(vec![[0; 4]]) };
        let span = self.found.other(keyword).unwrap_or_default();
        self.builder.scene.images.push(image);
        self.builder.places.images.push(self.library.fault(span, ""));
        ImageId(self.builder.scene.images.len() as u32 - 1)
    }

    fn color(&mut self, keyword: &str) -> Option<Vec3> {
        self.library.numbers(self.found.other(keyword)?, &mut self.builder.reader.report)
    }

    fn number(&mut self, keyword: &str) -> Option<f32> {
        self.color(keyword).map(|numbers| numbers.x)
    }

    fn map(&mut self, keyword: &str, wanted: ImageUse) -> Option<ImageId> {
        let span = self.found.other(keyword)?;
        let file = self.library.file(span.clone()).to_owned();
        self.image(&file, span, wanted)
    }

    /// An image that is not there leaves the rest of the material as it is.
    fn image(&mut self, file: &str, span: std::ops::Range<usize>, wanted: ImageUse) -> Option<ImageId> {
        let place = || self.library.fault(span.clone(), "");
        match self.builder.image_named(file, Some(Path::new(self.library.name())), wanted, place) {
            Ok(image) => Some(image),
            Err(message) => {
                self.builder.reader.report.warn(|| place().with_message(&message));
                None
            }
        }
    }

    fn warn_ignored(&mut self) {
        let ignored: Vec<&str> = self.found.others().filter(|keyword| !UNDERSTOOD.contains(keyword)).collect();
        if let Some(first) = ignored.first() {
            self.warn(first, &format!("ignored of the material `{}`: {}", self.found.desc.name, ignored.join(", ")));
        }
    }

    fn warn(&mut self, keyword: &str, message: &str) {
        let span = self.found.other(keyword).unwrap_or_default();
        self.builder.reader.report.warn(|| self.library.fault(span, message));
    }
}
