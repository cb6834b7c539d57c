//! How an object is placed: `scale`, then `rotate`, then `translate`; or a `matrix`.

use super::document::Table;
use super::reader::Reader;
use super::value::{FACTORS, MATRIX, NUMBER, POSITION, Value};
use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

pub(super) const KEYS: [&str; 4] = ["translate", "rotate", "scale", "matrix"];

/// The placement of an object; none leaves it where it is.
pub(super) fn placement(reader: &mut Reader<'_>, table: Table<'_>) -> Option<DAffine3> {
    if table.has("matrix") {
        if let Some(other) = KEYS[..3].iter().find(|key| table.has(key)) {
            let message = format!("`{other}` beside `matrix`");
            reader.error_at(table, other, &message, "one of them alone: the matrix holds all of the placement");
            return None;
        }
        return matrix(reader, table);
    }
    let scale = reader.or(table, "scale", FACTORS, DVec3::ONE)?;
    let translation = reader.or(table, "translate", POSITION, DVec3::ZERO)?;
    let rotation = match table.get("rotate") {
        Some(value) => rotations(reader, value)?,
        None => DQuat::IDENTITY,
    };
    Some(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}

fn matrix(reader: &mut Reader<'_>, table: Table<'_>) -> Option<DAffine3> {
    let rows = reader.required(table, "matrix", MATRIX)?.map(DVec4::from_array);
    if rows[3] != DVec4::W {
        let message = format!("the last row of `matrix` is {}", rows[3]);
        reader.error_at(table, "matrix", &message, "[0, 0, 0, 1]: other matrices distort");
        return None;
    }
    let [x, y, z] = [rows[0], rows[1], rows[2]].map(DVec4::truncate);
    let translation = DVec3::new(rows[0].w, rows[1].w, rows[2].w);
    // The rows of a matrix are the columns of its transpose.
    Some(DAffine3 { matrix3: DMat3::from_cols(x, y, z).transpose(), translation })
}

/// One rotation, or several in the order in which they turn the object.
fn rotations(reader: &mut Reader<'_>, value: Value<'_>) -> Option<DQuat> {
    let Some(items) = value.items() else { return rotation(reader, value) };
    items.into_iter().try_fold(DQuat::IDENTITY, |turned, item| Some(rotation(reader, item)? * turned))
}

/// `{ axis = [0, 1, 0], degrees = 45 }`, by the right-hand rule.
fn rotation(reader: &mut Reader<'_>, value: Value<'_>) -> Option<DQuat> {
    let Some(table) = value.table() else {
        let example = "a rotation such as { axis = [0, 1, 0], degrees = 45 }, or a list of such";
        reader.error(value.span(), "`rotate` is not a table", example);
        return None;
    };
    table.check_keys(reader, "a rotation", &[&["axis", "degrees"]])?;
    let axis = reader.required(table, "axis", POSITION)?;
    let degrees = reader.required(table, "degrees", NUMBER)?;
    let Some(axis) = axis.try_normalize() else {
        reader.error_at(table, "axis", &format!("`axis` is {axis}"), "a direction of non-zero length");
        return None;
    };
    Some(DQuat::from_axis_angle(axis, f64::from(degrees).to_radians()))
}
