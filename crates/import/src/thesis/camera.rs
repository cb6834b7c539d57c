//! `S` and `C`: background and view.

use super::field::{Reader, Spec, Value, scalar, to_vec3, vector};
use glam::Vec3;
use lightcuts_scene::{CameraDesc, Projection, SamplerKind};

const BACKGROUND: Spec = vector("BK", "a background colour such as BK{0, 0, 0}");
const DISTANCE: Spec = scalar("PERS", "the eye's distance from the view plane such as PERS(10)");
const CENTER: Spec = vector("C", "the view plane's centre such as C{0, 0, 960}");
const VIEW: Spec = vector("V", "a view direction such as V{0, 0, -1}");
const UP: Spec = vector("U", "an up direction such as U{0, 1, 0}");

const SAMPLERS: [(&str, SamplerKind); 3] = [
    ("STRAT", SamplerKind::Stratified),
    ("LOW_DISC", SamplerKind::LowDiscrepancy),
    ("BEST_CANDID", SamplerKind::BestCandidate),
];

/// How a camera line is written.
pub(super) const CAMERA_EXAMPLE: &str =
    "a line such as `C | STRAT | PERS(10) | C{0, 0, 960} | V{0, 0, -1} | U{0, 1, 0}`";

/// The background of an `S` directive; black if it names none.
pub(super) fn background(reader: &mut Reader<'_, '_>) -> Option<Vec3> {
    reader.optional(BACKGROUND, Vec3::ZERO, to_vec3)
}

/// The view of a `C` directive. The sampler may be left out.
pub(super) fn camera(reader: &mut Reader<'_, '_>) -> Option<CameraDesc> {
    Some(CameraDesc {
        sampler: reader.directive.take_word(&SAMPLERS).unwrap_or_default(),
        projection: projection(reader)?,
        center: reader.vector(CENTER)?,
        view: reader.vector(VIEW)?,
        up: reader.vector(UP)?,
    })
}

fn projection(reader: &mut Reader<'_, '_>) -> Option<Projection> {
    let named = |name: &str| reader.directive.fields.iter().any(|field| field.is(name));
    if named("PERS") {
        return Some(Projection::Perspective { distance: reader.scalar(DISTANCE)? });
    }
    if let Some(field) = reader.directive.take(|field| field.is("ORTHO")) {
        if field.value != Value::Word {
            reader.warn(field.span.clone(), "ORTHO takes no value: its rays are parallel");
        }
        return Some(Projection::Orthographic);
    }
    reader.missing("the projection", "PERS(distance), such as PERS(10), or ORTHO");
    None
}
