//! `L`: light sources.

use super::field::{Reader, Spec, scalar, vector};
use super::material::colors;
use lightcuts_scene::{LightDesc, LightKind, Location};

pub(super) const POSITION: Spec = vector("POS", "a position such as POS{0, 100, 0}");
pub(super) const DIRECTION: Spec = vector("DIR", "a direction such as DIR{0, -1, 0}");
const ATTENUATION: Spec = scalar("ATTEN", "a factor on the light such as ATTEN(1)");
pub(super) const CENTER: Spec = vector("C", "a centre such as C{0, 0, 0}");
pub(super) const NORMAL: Spec = vector("N", "a normal such as N{0, 1, 0}");
pub(super) const HEAD: Spec = vector("H", "the direction of an edge such as H{0, 0, 1}");
pub(super) const WIDTH: Spec = scalar("W", "a width such as W(400)");
pub(super) const HEIGHT: Spec = scalar("H", "a height such as H(400)");
const SPACING: Spec = scalar("DS", "the spacing of its points such as DS(20)");

#[derive(Debug, Clone, Copy)]
enum Kind {
    Omni,
    Hemisphere,
    Directional,
    Area,
}

const KINDS: [(&str, Kind); 4] =
    [("OMNI", Kind::Omni), ("DIRP", Kind::Hemisphere), ("DIR", Kind::Directional), ("SQU_A", Kind::Area)];

/// The light of an `L` directive.
pub(super) fn light(reader: &mut Reader<'_, '_>, location: Location) -> Option<LightDesc> {
    let Some(kind) = reader.directive.take_word(&KINDS) else {
        reader.missing("the kind of light", "OMNI, DIRP, DIR or SQU_A after the L");
        return None;
    };
    let kind = light_kind(reader, kind)?;
    let attenuation = reader.scalar(ATTENUATION)?;
    let (specular, diffuse, ambient) = colors(reader)?;
    Some(LightDesc { kind, attenuation, specular, diffuse, ambient, location })
}

fn light_kind(reader: &mut Reader<'_, '_>, kind: Kind) -> Option<LightKind> {
    Some(match kind {
        Kind::Omni => {
            // The format lists a direction for every point light; this kind has no use for it.
            reader.directive.take(|field| field.matches(DIRECTION));
            LightKind::Omni { position: reader.vector(POSITION)? }
        }
        Kind::Hemisphere => {
            LightKind::Hemisphere { position: reader.vector(POSITION)?, direction: reader.vector(DIRECTION)? }
        }
        Kind::Directional => LightKind::Directional { direction: reader.vector(DIRECTION)? },
        Kind::Area => LightKind::Area {
            center: reader.vector(CENTER)?,
            normal: reader.vector(NORMAL)?,
            head: reader.vector(HEAD)?,
            width: reader.scalar(WIDTH)?,
            height: reader.scalar(HEIGHT)?,
            spacing: reader.scalar(SPACING)?,
        },
    })
}
