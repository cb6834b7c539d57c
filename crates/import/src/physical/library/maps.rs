//! Maps of MTL materials: images with their options.

use super::super::image::ImageUse;
use super::{BUMPS, Converter, LIGHT, NORMALS};
use glam::Vec3;
use lightcuts_scene::TextureMode;
use lightcuts_scene::physical::{ImageId, Tint};
use std::ops::Range;
use std::path::Path;

impl Converter<'_, '_> {
    /// `Kd` times `map_Kd`. A map alone is what is meant: the default grey would darken it.
    pub(super) fn base_color(&mut self) -> Tint {
        let image = self.found.texture.clone().and_then(|span| self.image("map_Kd", span, ImageUse::Color));
        let is_map_alone = image.is_some() && !self.found.gives("diffuse");
        let color = if is_map_alone { Vec3::ONE } else { self.color_within("Kd", self.found.desc.diffuse, LIGHT) };
        Tint { color, image }
    }

    pub(super) fn map(&mut self, keyword: &'static str, wanted: ImageUse) -> Option<ImageId> {
        let span = self.found.other(keyword)?;
        self.image(keyword, span, wanted)
    }

    /// An image that is not there leaves the rest of the material as it is.
    fn image(&mut self, keyword: &'static str, span: Range<usize>, wanted: ImageUse) -> Option<ImageId> {
        let library = self.library;
        let beside = Path::new(library.name());
        let place = || library.fault(span.clone(), "");
        let name = self.builder.files.first_found(library.map(&span).names(), beside);
        match self.builder.image_named(name, Some(beside), wanted, place) {
            Ok(image) => {
                self.follow_options(keyword, &span, wanted);
                Some(image)
            }
            Err(refusal) => {
                self.builder.reader.report.warn(|| place().with_message(&refusal.message));
                None
            }
        }
    }

    /// Keeps the placement of the material's maps, and warns about the options that are not supported.
    fn follow_options(&mut self, keyword: &'static str, span: &Range<usize>, wanted: ImageUse) {
        let library = self.library;
        let map = library.map(span);
        let mut warn = |message: &str| self.builder.reader.report.warn(|| library.fault(span.clone(), message));
        if map.mode == TextureMode::Straight {
            warn("`-clamp on` is not supported: images repeat");
        }
        if !map.unsupported.is_empty() {
            let listed: Vec<String> = map.unsupported.iter().map(|option| format!("`{option}`")).collect();
            warn(&format!("not supported, and ignored: {}", listed.join(", ")));
        }
        if map.strength != 1.0 && (NORMALS.contains(&keyword) || BUMPS.contains(&keyword)) {
            warn(&format!("`-bm {}` is not supported: normal maps have their full strength", map.strength));
        }
        let encoded = wanted == ImageUse::Color;
        if let Some(space) = map.color_space
            && space.eq_ignore_ascii_case("sRGB") != encoded
        {
            warn(&format!("`-colorspace {space}` is not supported: colours are in sRGB, other values are as they are"));
        }
        match self.placed {
            None => self.placed = Some((keyword, map.placement)),
            Some((first, placement)) if placement != map.placement => {
                warn(&format!(
                    "`-s` and `-o` differ from those of `{first}`, which are used for all maps of a material"
                ));
            }
            Some(_) => {}
        }
    }
}
