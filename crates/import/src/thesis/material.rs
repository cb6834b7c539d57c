//! The fields that lights and surfaces share: colours, the Phong exponent, `FRKE` and `TEX`.

use super::field::{Bracket, Reader, Spec, Value, scalar, vector};
use glam::Vec3;
use lightcuts_scene::{MaterialDesc, TextureMode};
use std::ops::Range;

pub(super) const SPECULAR: Spec = vector("S", "a specular colour such as S{0.2, 0.2, 0.2}");
pub(super) const DIFFUSE: Spec = vector("D", "a diffuse colour such as D{0.5, 0.5, 0.5}");
pub(super) const AMBIENT: Spec = vector("A", "an ambient colour such as A{0, 0, 0}");
const EXPONENT: Spec = scalar("SH", "a Phong exponent such as SH(20)");
pub(super) const RATIOS: Spec = Spec {
    name: "FRKE",
    bracket: Bracket::Curly,
    count: 4,
    example: "reflection, refraction, index ratio and local share such as FRKE{0, 0, 1, 1}",
};

/// A texture as a directive names it.
#[derive(Debug, Clone)]
pub(super) struct TextureField<'t> {
    pub(super) file: &'t str,
    pub(super) mode: TextureMode,
    pub(super) span: Range<usize>,
}

/// `S{}`, `D{}`, `A{}`.
pub(super) fn colors(reader: &mut Reader<'_, '_>) -> Option<(Vec3, Vec3, Vec3)> {
    Some((reader.vector(SPECULAR)?, reader.vector(DIFFUSE)?, reader.vector(AMBIENT)?))
}

/// `FRKE{}` and the Phong material, without texture.
pub(super) fn material(reader: &mut Reader<'_, '_>) -> Option<MaterialDesc> {
    let ratios = reader.required(RATIOS)?.numbers();
    let (specular, diffuse, ambient) = colors(reader)?;
    Some(MaterialDesc {
        name: String::new(),
        specular,
        diffuse,
        ambient,
        exponent: reader.scalar(EXPONENT)?,
        reflection: ratios[0].value,
        refraction: ratios[1].value,
        refraction_ratio: ratios[2].value,
        local: ratios[3].value,
        texture: None,
    })
}

/// `TEX:file mode`, if there.
pub(super) fn texture<'t>(reader: &Reader<'_, 't>) -> Option<TextureField<'t>> {
    let field = reader.directive.take(|field| field.is("TEX"))?;
    let Value::Text { text, mode } = field.value else { return None };
    let mode = mode.map_or_else(TextureMode::default, |word| {
        let modes = [("REPEAT", TextureMode::Repeat), ("STRAIGHT", TextureMode::Straight)];
        modes
            .into_iter()
            .find(|(name, _)| name.eq_ignore_ascii_case(word))
            .map_or(TextureMode::Stretch, |(_, mode)| mode)
    });
    Some(TextureField { file: text, mode, span: field.span.clone() })
}
