//! `O`: where a mesh is and how it is placed.

use super::field::{Bracket, Reader, Spec, Value, scalar, to_vec3, vector};
use glam::Vec3;
use lightcuts_scene::Transform;
use std::ops::Range;

const SMOOTH: Spec = scalar("SMTH", "SMTH(0) or SMTH(1)");
const TRANSLATION: Spec = vector("TRAN", "a translation such as TRAN{0, 0, 0}");
const SCALE: Spec = vector("SCAL", "a scale such as SCAL{1, 1, 1}");
const AXIS: Spec = vector("ROT", "a rotation such as ROT{0, 1, 0}:45");
const OVERRIDE: Spec = scalar("MAT", "MAT(0) or MAT(1)");

/// A mesh as its directive asks for it.
#[derive(Debug)]
pub(super) struct MeshFields<'t> {
    pub(super) file: &'t str,
    pub(super) file_span: Range<usize>,
    pub(super) transform: Transform,
    pub(super) smooth: bool,
    pub(super) override_material: bool,
}

/// The fields of an `O` directive, without its material.
pub(super) fn mesh<'t>(reader: &mut Reader<'_, 't>) -> Option<MeshFields<'t>> {
    let path = reader.directive.take(|field| field.is("PATH"));
    let Some((Value::Text { text, .. }, span)) = path.map(|field| (&field.value, field.span.clone())) else {
        reader.missing("PATH", "a model file such as PATH:model.obj");
        return None;
    };
    let (axis, degrees) = rotation(reader)?;
    Some(MeshFields {
        file: text,
        file_span: span,
        smooth: reader.switch(SMOOTH)?,
        override_material: reader.switch(OVERRIDE)?,
        transform: Transform {
            axis,
            degrees,
            scale: scale(reader)?,
            translation: reader.optional(TRANSLATION, Vec3::ZERO, to_vec3)?,
        },
    })
}

/// `SCAL{x, y, z}`, or one factor for all axes: `SCAL(s)`.
fn scale(reader: &mut Reader<'_, '_>) -> Option<Vec3> {
    let uniform = Spec { bracket: Bracket::Round, count: 1, ..SCALE };
    if reader.directive.fields.iter().any(|field| field.matches(uniform) && field.numbers().len() == 1) {
        return reader.scalar(uniform).map(Vec3::splat);
    }
    reader.optional(SCALE, Vec3::ONE, to_vec3)
}

/// Axis and degrees of `ROT{axis}:degrees`.
fn rotation(reader: &mut Reader<'_, '_>) -> Option<(Vec3, f32)> {
    let none = Transform::default();
    if !reader.directive.fields.iter().any(|field| field.is("ROT")) {
        return Some((none.axis, none.degrees));
    }
    let field = reader.required(AXIS)?;
    if let Value::Numbers { numbers, angle: Some(angle), .. } = &field.value {
        return Some((to_vec3(numbers), angle.value));
    }
    reader.error(field.span.clone(), "ROT has no angle", AXIS.example);
    None
}
