//! Materials of MTL libraries in the physical model; `docs/formats/scene.md` has the table.
//!
//! `classic` reads a material as the format's paper has it, `principled` as Blender and the writers of `Pr` and `Pm` mean it.
//! `Ka` has no counterpart: interreflection takes its place. What is not supported is ignored with a warning; no value that the
//! format allows refuses a scene.

mod classic;
mod maps;
mod principled;

use super::build::Builder;
use super::image::ImageUse;
use super::material::{IOR, THRESHOLD};
use super::places::MaterialPlace;
use crate::obj::{Library, LibraryMaterial, MapPlacement, Writer};
use glam::Vec3;
use lightcuts_scene::MAX_LIGHT;
use lightcuts_scene::physical::{
    AlphaMask, EmissionDesc, ImageId, PixelImage, Pixels, Scattering, SurfaceDesc, SurfaceId,
};
use std::fmt::Display;
use std::rc::Rc;

/// Keywords that are used, or that say nothing which would be missed.
const UNDERSTOOD: [&str; 12] =
    ["Ke", "map_Ke", "illum", "d", "Tr", "map_d", "Ni", "Tf", "norm", "sharpness", "map_aat", "map_norm"];

/// Keywords of materials that have a roughness and a metalness: they are used there.
const PRINCIPLED: [&str; 2] = ["Pr", "Pm"];

/// Keywords that say nothing where they, or the ones that they depend on, are 0.
const NEUTRAL_AT_ZERO: [(&str, &str); 5] =
    [("Ps", "Ps"), ("Pc", "Pc"), ("Pcr", "Pc"), ("aniso", "aniso"), ("anisor", "aniso")];

/// Keywords of normal maps.
const NORMALS: [&str; 2] = ["norm", "map_norm"];

/// Keywords of height maps, under which Blender names normal maps.
const BUMPS: [&str; 3] = ["map_Bump", "map_bump", "bump"];

/// Least and greatest refractive index of glass and coats, and how near to 1 nothing is refracted.
const IORS: (f32, f32) = (1.0 / 3.0, 3.0);
const MIN_CONTRAST: f32 = 2e-3;

/// Shares of light, roughness and the like.
const SHARE: (f32, f32) = (0.0, 1.0);

/// Radiances, and reflectances before they are scaled down to what a surface can reflect.
const LIGHT: (f32, f32) = (0.0, MAX_LIGHT);

/// A material that was added to the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Converted {
    pub(super) id: SurfaceId,
    /// What its maps want to be done to texture coordinates.
    pub(super) placement: MapPlacement,
}

/// Adds the material `name` of a library to the scene; `None` if it has none of that name.
pub(super) fn material(builder: &mut Builder<'_>, library: &Rc<Library>, name: &str) -> Option<Converted> {
    let found = library.get(name)?;
    let mut converter = Converter { builder, library, found, placed: None };
    converter.warn_ignored();
    let scattering = if converter.is_principled() { converter.principled() } else { converter.classic() };
    let emission = converter.emission();
    let normal_map = converter.normal_map();
    let alpha = converter.alpha(&scattering);
    let placement = converter.placed.map_or_else(MapPlacement::default, |(_, placement)| placement);
    let desc = SurfaceDesc { name: name.to_owned(), scattering, emission, normal_map, alpha };
    Some(Converted { id: converter.push(desc), placement })
}

struct Converter<'b, 'd> {
    builder: &'b mut Builder<'d>,
    library: &'b Rc<Library>,
    found: &'b LibraryMaterial,
    /// The first map that was used, and how it is placed.
    placed: Option<(&'static str, MapPlacement)>,
}

impl Converter<'_, '_> {
    fn push(&mut self, desc: SurfaceDesc) -> SurfaceId {
        let place = MaterialPlace::Library(Rc::clone(self.library), self.found.desc.name.clone());
        self.builder.push_material(desc, place)
    }

    fn is_of_blender(&self) -> bool {
        self.library.writer() != Writer::Other
    }

    /// Whether `Kd` is the base colour of a material with roughness and metalness.
    fn is_principled(&mut self) -> bool {
        let is_glass = !self.is_of_blender() && self.is_glass();
        !is_glass && (self.is_of_blender() || PRINCIPLED.iter().any(|keyword| self.found.other(keyword).is_some()))
    }

    /// Blender's emitters shine both ways, those of the format on the normal's side.
    fn emission(&mut self) -> Option<EmissionDesc> {
        let image = self.map("map_Ke", ImageUse::Color);
        let radiance = self.color("Ke").or(image.map(|_| Vec3::ONE))?;
        let radiance = self.color_within("Ke", radiance, LIGHT);
        let two_sided = self.is_of_blender();
        (radiance != Vec3::ZERO).then_some(EmissionDesc { radiance, image, two_sided })
    }

    /// `norm`; Blender, which has no height maps, writes normal maps as bump maps.
    fn normal_map(&mut self) -> Option<ImageId> {
        let bumps = if self.is_of_blender() { &BUMPS[..] } else { &[] };
        let keyword = NORMALS.iter().chain(bumps).find(|keyword| self.found.other(keyword).is_some())?;
        self.map(keyword, ImageUse::Data)
    }

    fn alpha(&mut self, scattering: &Scattering) -> Option<AlphaMask> {
        if let Some(image) = self.map("map_d", ImageUse::Data) {
            return Some(AlphaMask { image, threshold: THRESHOLD });
        }
        let (keyword, value) = ["d", "Tr"].into_iter().find_map(|keyword| Some((keyword, self.number(keyword)?)))?;
        let value = self.within(keyword, value, SHARE);
        let opacity = if keyword == "d" { value } else { 1.0 - value };
        // Of glass it is part of what makes it glass.
        let is_glass = !self.is_of_blender() && matches!(scattering, Scattering::Dielectric { .. });
        if opacity >= 1.0 || is_glass {
            return None;
        }
        let is_there = opacity >= THRESHOLD;
        let told = if is_there { "opaque" } else { "left out" };
        self.warn(
            keyword,
            &format!("partly transparent surfaces are not supported: `{}` is {told}", self.found.desc.name),
        );
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

    /// The illumination model, 0 to 10.
    fn illumination(&mut self) -> Option<u8> {
        let mode = self.number("illum")?;
        let known = (0..=10_u8).find(|known| f32::from(*known) == mode);
        if known.is_none() {
            self.warn("illum", &format!("illumination model {mode} is unknown; expected 0 to 10; 2 is used"));
        }
        known
    }

    /// `Ks`, as much as a scene may have.
    fn specular(&mut self) -> Vec3 {
        self.color_within("Ks", self.found.desc.specular, LIGHT)
    }

    /// A value within a range that the renderer can have; others are warned about.
    fn within(&mut self, keyword: &str, value: f32, (least, greatest): (f32, f32)) -> f32 {
        self.used(keyword, value, value.clamp(least, greatest))
    }

    /// The same for each channel.
    fn color_within(&mut self, keyword: &str, value: Vec3, (least, greatest): (f32, f32)) -> Vec3 {
        self.used(keyword, value, value.clamp(Vec3::splat(least), Vec3::splat(greatest)))
    }

    /// What is used in place of a value, with a warning if it is another one.
    fn used<T: PartialEq + Display + Copy>(&mut self, keyword: &str, value: T, used: T) -> T {
        if used != value {
            let name = &self.found.desc.name;
            self.warn(keyword, &format!("`{keyword}` of the material `{name}` is {value}: {used} is used"));
        }
        used
    }

    /// The refractive index; `None`, with a warning, where it is so near to 1 that nothing is refracted. An index of 0 is none.
    fn ior(&mut self) -> Option<f32> {
        let ior = match self.number("Ni") {
            None => return Some(IOR),
            Some(ior) if ior <= 0.0 => self.within("Ni", ior, (IOR, IOR)),
            Some(ior) => self.within("Ni", ior, IORS),
        };
        ((ior - 1.0).abs() >= MIN_CONTRAST).then_some(ior)
    }

    fn warn_ignored(&mut self) {
        let mut ignored: Vec<&'static str> = Vec::new();
        let others: Vec<&'static str> = self.found.others().filter(|keyword| !UNDERSTOOD.contains(keyword)).collect();
        for keyword in others {
            let is_used = (keyword == "map_Ka" && self.found.texture.is_some())
                || PRINCIPLED.contains(&keyword)
                || (self.is_of_blender() && BUMPS.contains(&keyword));
            let depends_on = NEUTRAL_AT_ZERO.iter().find(|(known, _)| *known == keyword).map(|(_, on)| *on);
            let is_neutral = depends_on.is_some_and(|on| self.number(on).unwrap_or(0.0) == 0.0);
            if !is_used && !is_neutral {
                ignored.push(keyword);
            }
        }
        if let Some(first) = ignored.first() {
            let listed: Vec<String> = ignored.iter().map(|keyword| format!("`{keyword}`")).collect();
            let message =
                format!("not supported, and ignored in the material `{}`: {}", self.found.desc.name, listed.join(", "));
            self.warn(first, &message);
        }
    }

    /// A warning at the line of a keyword.
    fn warn(&mut self, keyword: &str, message: &str) {
        let (library, name) = (self.library, &self.found.desc.name);
        self.builder.reader.report.warn(|| library.field_fault(name, keyword, message));
    }
}
