//! `[camera]`

use super::document::Table;
use super::reader::Reader;
use super::value::{NUMBER, POSITION, VECTOR};
use glam::{DVec3, Vec3};
use lightcuts_scene::physical::{PhysicalCamera, View};

/// What a camera looks like, to follow the word "expected".
pub(super) const EXAMPLE: &str = "a table `[camera]` with `position` and `target`";

const KEYS: [&str; 10] =
    ["position", "target", "direction", "up", "fov", "height", "near", "lens-radius", "focus-distance", "focus"];

pub(super) fn camera(reader: &mut Reader<'_>, table: Table<'_>) -> Option<PhysicalCamera> {
    table.check_keys(reader, "the camera", &[&KEYS])?;
    let default = PhysicalCamera::default();
    let position = reader.required(table, "position", POSITION)?;
    let direction = match reader.exactly_one(table, &["target", "direction"])? {
        "target" => (reader.required(table, "target", POSITION)? - position).as_vec3(),
        direction => reader.required(table, direction, VECTOR)?,
    };
    Some(PhysicalCamera {
        position,
        direction,
        up: reader.or(table, "up", VECTOR, default.up)?,
        view: view(reader, table, default.view)?,
        near: reader.or(table, "near", NUMBER, default.near)?,
        lens_radius: reader.or(table, "lens-radius", NUMBER, default.lens_radius)?,
        focus_distance: focus_distance(reader, table, (position, direction), default.focus_distance)?,
    })
}

fn view(reader: &mut Reader<'_>, table: Table<'_>, default: View) -> Option<View> {
    Some(match reader.at_most_one(table, &["fov", "height"])? {
        Some("height") => View::Orthographic { height: reader.required(table, "height", NUMBER)? },
        Some(fov) => {
            reader.warn_of_radians(table, fov);
            View::Perspective { degrees: reader.required(table, fov, NUMBER)? }
        }
        None => default,
    })
}

/// Along the view direction. Without a word about it the target is sharp.
fn focus_distance(
    reader: &mut Reader<'_>,
    table: Table<'_>,
    (position, direction): (DVec3, Vec3),
    default: f32,
) -> Option<f32> {
    match reader.at_most_one(table, &["focus-distance", "focus"])? {
        Some("focus") => {
            let point = reader.required(table, "focus", POSITION)?;
            Some((point - position).as_vec3().dot(direction.normalize_or_zero()))
        }
        Some(distance) => reader.required(table, distance, NUMBER),
        // A target at the position has no direction either, which is what should be said then.
        None if table.has("target") => {
            Some(direction.length()).map(|length| if length > 0.0 { length } else { default })
        }
        None => Some(default),
    }
}
