//! What a picture holds.

use crate::exit::Failure;
use crate::job::{JOB_ATTRIBUTE, VERSION_ATTRIBUTE, has_extension, picture_text};
use lightcuts::image::{self, LayerData, Transfer};
use serde::Serialize;
use std::path::Path;

/// Size, layers and job of a picture.
#[derive(Debug, Serialize)]
pub(super) struct PictureInfo {
    pub(super) file: String,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) layers: Vec<Layer>,
    /// Version of the lightcuts that wrote it.
    pub(super) version: Option<String>,
    /// TOML.
    pub(super) job: Option<String>,
}

/// A layer.
#[derive(Debug, Serialize)]
pub(super) struct Layer {
    pub(super) name: String,
    pub(super) kind: &'static str,
}

impl PictureInfo {
    /// Reads the picture whole: damage shows.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let text = |keyword| picture_text(path, keyword);
        let (version, job) = (text(VERSION_ATTRIBUTE)?, text(JOB_ATTRIBUTE)?);
        let mut layers = vec![Layer { name: "beauty".to_owned(), kind: "color" }];
        let (width, height) = if has_extension(path, "exr") {
            let picture = image::read_exr(path).map_err(Failure::input)?;
            layers.extend(picture.aovs().map(|(name, data)| Layer { name: name.to_owned(), kind: kind(data) }));
            (picture.width(), picture.height())
        } else {
            let picture = image::read_png(path, Transfer::Linear).map_err(Failure::input)?;
            (picture.width(), picture.height())
        };
        Ok(Self { file: path.display().to_string(), width, height, layers, version, job })
    }
}

fn kind(data: &LayerData) -> &'static str {
    match data {
        LayerData::Color(_) => "color",
        LayerData::Vector(_) => "vector",
        LayerData::Scalar(_) => "scalar",
        LayerData::Depth(_) => "depth",
        LayerData::Id(_) => "id",
    }
}
