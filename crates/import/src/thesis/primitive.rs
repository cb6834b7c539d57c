//! `P`: spheres, squares and cubes.

use super::field::{Reader, Spec, scalar, vector};
use super::light::{CENTER, HEAD, HEIGHT, NORMAL, WIDTH};
use lightcuts_scene::ShapeDesc;

const RADIUS: Spec = scalar("R", "a radius such as R(60)");
const LENGTH: Spec = scalar("L", "a length such as L(100)");
const VERTICAL: Spec = vector("V", "the vertical axis such as V{0, 1, 0}");
const HORIZONTAL: Spec = vector("H", "the horizontal axis such as H{1, 0, 0}");

#[derive(Debug, Clone, Copy)]
enum Kind {
    Sphere,
    Square,
    Cube,
}

const KINDS: [(&str, Kind); 3] = [("SPH", Kind::Sphere), ("SQU", Kind::Square), ("CUB", Kind::Cube)];

/// The surface of a `P` directive.
pub(super) fn shape(reader: &mut Reader<'_, '_>) -> Option<ShapeDesc> {
    let Some(kind) = reader.directive.take_word(&KINDS) else {
        reader.missing("the kind of primitive", "SPH, SQU or CUB after the P");
        return None;
    };
    Some(match kind {
        Kind::Sphere => ShapeDesc::Sphere { center: reader.vector(CENTER)?, radius: reader.scalar(RADIUS)? },
        Kind::Square => ShapeDesc::Square {
            center: reader.vector(CENTER)?,
            normal: reader.vector(NORMAL)?,
            head: reader.vector(HEAD)?,
            width: reader.scalar(WIDTH)?,
            height: reader.scalar(HEIGHT)?,
        },
        Kind::Cube => ShapeDesc::Cube {
            length: reader.scalar(LENGTH)?,
            width: reader.scalar(WIDTH)?,
            height: reader.scalar(HEIGHT)?,
            center: reader.vector(CENTER)?,
            vertical: reader.vector(VERTICAL)?,
            horizontal: reader.vector(HORIZONTAL)?,
        },
    })
}
