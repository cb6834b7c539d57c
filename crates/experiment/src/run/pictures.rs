//! The pictures of a job as files.

use super::{IMAGES, RunError, Texts};
use crate::plan::PlannedJob;
use crate::record::Row;
use lightcuts::image::{
    Image, ImageError, Layers, Picture, Transfer, read_exr, read_exr_attributes, write_exr, write_png_with_text,
};
use lightcuts::rendering::Display;
use std::path::Path;

/// Name of the text in an EXR that holds the hash of its picture, as the row has it.
const PICTURE_ATTRIBUTE: &str = "lightcuts:picture";

/// Paths of a job's pictures, relative to the experiment's folder.
pub(super) struct Names {
    pub(super) png: String,
    pub(super) exr: String,
}

impl Names {
    pub(super) fn of(job: &PlannedJob) -> Self {
        let stem = job.stem();
        Self { png: format!("{IMAGES}/{stem}.png"), exr: format!("{IMAGES}/{stem}.exr") }
    }
}

/// Path of a FLIP map, relative to the experiment's folder.
pub(super) fn flip_map_name(job: &PlannedJob, reference: &str) -> String {
    format!("{IMAGES}/{}--{reference}--flip.png", job.stem())
}

/// Whether the files of a row are there and its EXR holds its picture.
pub(super) fn are_of(directory: &Path, row: &Row) -> bool {
    let maps = row.comparisons.values().map(|comparison| &comparison.flip_map);
    let there = [&row.png].into_iter().chain(maps).all(|path| directory.join(path).is_file());
    let picture = || read_exr_attributes(directory.join(&row.exr)).ok()?.remove(PICTURE_ATTRIBUTE);
    there && picture().is_some_and(|picture| picture == row.picture)
}

/// Writes what a display shows of a picture: the code values that are measured.
pub(super) fn write_displayed(
    path: &Path,
    picture: &Picture,
    job: &PlannedJob,
    texts: &Texts<'_>,
) -> Result<(), ImageError> {
    let texts = texts(job, path);
    let texts: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (*name, text.as_str())).collect();
    write_png_with_text(path, picture.display(), Transfer::Linear, &texts)
}

/// Writes the picture's light and its hash. Of all files of a job this is the last: it vouches for the others.
pub(super) fn write_light(
    path: &Path,
    linear: Image,
    hash: &str,
    job: &PlannedJob,
    texts: &Texts<'_>,
) -> Result<(), RunError> {
    let mut layers = Layers::new(linear);
    for (name, text) in texts(job, path) {
        layers.set_attribute(name, text)?;
    }
    layers.set_attribute(PICTURE_ATTRIBUTE, hash)?;
    Ok(write_exr(path, &layers)?)
}

/// Reads the light of a picture and develops it.
pub(super) fn read(path: &Path, display: &Display) -> Result<Picture, ImageError> {
    developed(read_exr(path)?.into_beauty(), display)
}

/// A picture as metrics see it; the same for pictures from memory and from files.
pub(super) fn developed(linear: Image, display: &Display) -> Result<Picture, ImageError> {
    let shown = display.develop(&linear);
    Picture::developed(linear, &shown, display.transfer)
}
