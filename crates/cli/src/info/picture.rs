//! What a picture holds.

use crate::console;
use crate::exit::Failure;
use crate::job::{COMPLETE_ATTRIBUTE, JOB_ATTRIBUTE, VERSION_ATTRIBUTE, has_extension, require_picture};
use lightcuts::image::{self, Frame, Inventory, PictureFormat, PictureLayer, Window};
use serde::Serialize;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Endings of pictures: what has one is no scene, whatever it holds.
const EXTENSIONS: [&str; 5] = ["exr", "png", "hdr", "pic", "pfm"];
/// Bytes at the front of a file that tell its format.
const SIGNATURE_BYTES: u64 = 16;

/// Size, layers and job of a picture.
#[derive(Debug, Serialize)]
pub(super) struct PictureInfo {
    pub(super) file: String,
    pub(super) format: &'static str,
    pub(super) width: usize,
    pub(super) height: usize,
    /// Where an EXR's pixels lie in its display window, unless they fill it.
    pub(super) window: Option<Windows>,
    pub(super) layers: Vec<Layer>,
    /// Version of the lightcuts that wrote it.
    pub(super) version: Option<String>,
    /// Whether its render came to an end, as far as the picture tells.
    pub(super) complete: bool,
    /// TOML.
    pub(super) job: Option<String>,
    /// How its numbers are taken, where that has to be known.
    pub(super) warnings: Vec<String>,
}

/// A layer.
#[derive(Debug, Serialize)]
pub(super) struct Layer {
    pub(super) name: String,
    pub(super) kind: &'static str,
}

/// The two windows of an EXR.
#[derive(Debug, Serialize)]
pub(super) struct Windows {
    pub(super) data: Rectangle,
    pub(super) display: Rectangle,
}

#[derive(Debug, Serialize)]
pub(super) struct Rectangle {
    pub(super) x: i32,
    pub(super) y: i32,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// Whether a file is a picture, by its name or its first bytes.
pub(super) fn is_picture(path: &Path) -> bool {
    let mut start = Vec::new();
    let mut read = || File::open(path).and_then(|file| file.take(SIGNATURE_BYTES).read_to_end(&mut start)).is_ok();
    EXTENSIONS.iter().any(|extension| has_extension(path, extension))
        || (path.is_file() && read() && PictureFormat::of(&start).is_some())
}

impl PictureInfo {
    /// Reads the picture whole: damage shows. Warnings go to standard error.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        require_picture(path)?;
        let Inventory { format, frame, layers, remarks, mut attributes } =
            image::picture_inventory(path).map_err(Failure::input)?;
        for remark in &remarks {
            console::warn(&format!("{}: {remark}", path.display()));
        }
        let mut text = |keyword: &str| match format {
            PictureFormat::Png => image::read_png_text(path, keyword).map_err(Failure::input),
            _ => Ok(attributes.remove(keyword)),
        };
        Ok(Self {
            file: path.display().to_string(),
            format: format.name(),
            width: frame.data.width,
            height: frame.data.height,
            window: windows(frame),
            layers: layers.into_iter().map(|PictureLayer { name, kind }| Layer { name, kind }).collect(),
            version: text(VERSION_ATTRIBUTE)?,
            complete: text(COMPLETE_ATTRIBUTE)?.is_none_or(|told| told != "false"),
            job: text(JOB_ATTRIBUTE)?,
            warnings: remarks,
        })
    }
}

fn windows(frame: Frame) -> Option<Windows> {
    let of = |Window { x, y, width, height }: Window| Rectangle { x, y, width, height };
    (!frame.is_whole()).then(|| Windows { data: of(frame.data), display: of(frame.display) })
}
