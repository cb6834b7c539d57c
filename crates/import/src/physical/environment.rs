//! `[environment]`

use super::build::Builder;
use super::document::Table;
use super::image::ImageUse;
use super::value::{COLOR, NUMBER};
use glam::Vec3;
use lightcuts_scene::physical::EnvironmentDesc;

const KEYS: [&str; 3] = ["radiance", "image", "rotate"];

pub(super) fn environment<'d>(builder: &mut Builder<'d>, table: Table<'d>) -> Option<EnvironmentDesc> {
    table.check_keys(&mut builder.reader, "the environment", &[&KEYS])?;
    Some(EnvironmentDesc {
        radiance: builder.reader.or(table, "radiance", COLOR, Vec3::ONE)?,
        image: builder.optional_image(table, "image", ImageUse::Color)?,
        degrees: builder.reader.or(table, "rotate", NUMBER, 0.0)?,
        location: builder.reader.locate(table),
    })
}
