//! Images that a scene names, each file read once.

use super::build::Builder;
use super::document::Table;
use super::value::{FILE, Value};
use crate::Fault;
use crate::files::{AssetError, Files};
pub(super) use crate::texture::ImageUse;
use crate::texture::{self, Bounds, Decoded, Texels};
use lightcuts_scene::MAX_LIGHT;
use lightcuts_scene::physical::{ImageId, PixelImage, Pixels};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The greatest value of a texel on a surface: the greatest 16-bit float.
const MAX_ON_SURFACES: f32 = 65504.0;

/// What an image can be, to follow the word "expected".
const FILES: &str = "a PNG, JPEG, EXR, HDR or PFM file beside the scene or in a search path";

/// The images of a scene.
#[derive(Debug, Default)]
pub(super) struct Images {
    /// By the identity of their files; why not, for those that cannot be read.
    known: HashMap<PathBuf, Result<Uses, Refusal>>,
    /// What all of them take in memory.
    bytes: u64,
}

/// The images made of one file: for colours, and for data. They are one where the file holds light of Rec. 709.
#[derive(Debug, Clone, Copy, Default)]
struct Uses {
    color: Option<ImageId>,
    data: Option<ImageId>,
    has_alpha: bool,
}

/// Why a file is no image.
#[derive(Debug, Clone)]
pub(super) struct Refusal {
    pub(super) message: String,
    /// To follow the word "expected"; may be empty.
    expected: &'static str,
}

impl From<AssetError> for Refusal {
    fn from(error: AssetError) -> Self {
        Self { message: error.to_string(), expected: error.expected(FILES) }
    }
}

/// An image, and what is to be said of it at its first use.
struct Found {
    id: ImageId,
    remarks: Vec<String>,
}

impl Uses {
    fn of(&mut self, wanted: ImageUse) -> &mut Option<ImageId> {
        match wanted {
            ImageUse::Color => &mut self.color,
            ImageUse::Data => &mut self.data,
        }
    }
}

impl Images {
    /// The image in file `name`, read at its first use.
    fn load(
        &mut self,
        files: &mut Files<'_>,
        list: &mut Vec<PixelImage>,
        (name, beside): (&str, Option<&Path>),
        wanted: ImageUse,
    ) -> Result<Found, Refusal> {
        let path = files.find("image", name, beside)?;
        let identity = files.identity(&path);
        let mut uses = match self.known.get(&identity) {
            Some(known) => known.clone()?,
            None => Uses::default(),
        };
        if let Some(id) = *uses.of(wanted) {
            return Ok(Found { id, remarks: Vec::new() });
        }
        let outcome = self.push_use(files, list, (name, &path), &mut uses, wanted);
        self.known.insert(identity, outcome.as_ref().map(|_| uses).map_err(Clone::clone));
        outcome
    }

    /// The image of a file for a use that it is not there for yet.
    fn push_use(
        &mut self,
        files: &mut Files<'_>,
        list: &mut Vec<PixelImage>,
        (name, path): (&str, &Path),
        uses: &mut Uses,
        wanted: ImageUse,
    ) -> Result<Found, Refusal> {
        let there = uses.color.or(uses.data).and_then(|id| list.get(id.0 as usize));
        let codes = there.and_then(|image| match &image.pixels {
            Pixels::Srgb(texels) | Pixels::Linear(texels) => Some((image.width, image.height, texels.clone())),
            Pixels::Float(_) => None,
        });
        if let Some((width, height, texels)) = codes {
            let pixels = pixels(texels, uses.has_alpha, wanted);
            let image = PixelImage { name: name.to_owned(), width, height, pixels };
            let id = self.push_other_use(files, list, image)?;
            *uses.of(wanted) = Some(id);
            return Ok(Found { id, remarks: Vec::new() });
        }
        // A file's first use, or light whose colours are of other primaries: it is read once more for the other use.
        let mut decoded = checked(name, self.decode(files, name, path, wanted)?)?;
        let remarks = std::mem::take(&mut decoded.remarks);
        let id = self.push_file(list, name, decoded, uses, wanted);
        Ok(Found { id, remarks })
    }

    fn decode(&self, files: &mut Files<'_>, name: &str, path: &Path, wanted: ImageUse) -> Result<Decoded, Refusal> {
        let limits = files.limits;
        let bytes = files.read("image", path, limits.texture_bytes)?;
        let bounds = Bounds { side: limits.texture_side, bytes: limits.image_bytes.saturating_sub(self.bytes) };
        let decoded = texture::decode(&bytes, bounds, wanted).map_err(|error| AssetError::Content {
            what: "image",
            name: name.to_owned(),
            reason: error.to_string(),
        });
        Ok(decoded?)
    }

    fn push_file(
        &mut self,
        list: &mut Vec<PixelImage>,
        name: &str,
        decoded: Decoded,
        uses: &mut Uses,
        wanted: ImageUse,
    ) -> ImageId {
        let Decoded { width, height, texels, uses_differ, .. } = decoded;
        let id = ImageId(list.len() as u32);
        let pixels = match texels {
            Texels::Bytes(texels) => {
                uses.has_alpha = texels.iter().any(|texel| texel[3] != u8::MAX);
                pixels(texels, uses.has_alpha, wanted)
            }
            Texels::Light(texels) => {
                if !uses_differ {
                    (uses.color, uses.data) = (Some(id), Some(id));
                }
                Pixels::Float(texels)
            }
        };
        *uses.of(wanted) = Some(id);
        self.push(list, PixelImage { name: name.to_owned(), width, height, pixels })
    }

    /// An image that is there for another use once more for this one.
    fn push_other_use(
        &mut self,
        files: &Files<'_>,
        list: &mut Vec<PixelImage>,
        image: PixelImage,
    ) -> Result<ImageId, Refusal> {
        if self.bytes.saturating_add(size(&image.pixels)) > files.limits.image_bytes {
            let message = format!("the images take more than {} bytes of memory", files.limits.image_bytes);
            return Err(Refusal { message, expected: "fewer or smaller images" });
        }
        Ok(self.push(list, image))
    }

    fn push(&mut self, list: &mut Vec<PixelImage>, image: PixelImage) -> ImageId {
        self.bytes = self.bytes.saturating_add(size(&image.pixels));
        list.push(image);
        ImageId(list.len() as u32 - 1)
    }
}

/// Bytes in memory.
fn size(pixels: &Pixels) -> u64 {
    match pixels {
        Pixels::Srgb(texels) | Pixels::Linear(texels) => size_of_val(texels.as_slice()) as u64,
        Pixels::Float(texels) => size_of_val(texels.as_slice()) as u64,
    }
}

/// A mask's values are in alpha; where that is opaque everywhere, or the file has none, they are those of red.
fn pixels(mut texels: Vec<[u8; 4]>, has_alpha: bool, wanted: ImageUse) -> Pixels {
    if !has_alpha {
        for texel in &mut texels {
            texel[3] = if wanted == ImageUse::Data { texel[0] } else { u8::MAX };
        }
    }
    match wanted {
        ImageUse::Color => Pixels::Srgb(texels),
        ImageUse::Data => Pixels::Linear(texels),
    }
}

/// Light with nothing in it that cannot be: what is a little below zero, as filters leave it, is 0.
fn checked(name: &str, mut decoded: Decoded) -> Result<Decoded, Refusal> {
    if let Texels::Light(texels) = &mut decoded.texels {
        let bad = texels.iter().position(|texel| !texel.iter().all(|value| value.abs() <= MAX_LIGHT));
        if let Some(i) = bad {
            let (row, column) = (i as u32 / decoded.width + 1, i as u32 % decoded.width + 1);
            let message = format!("the image `{name}` holds {:?} in row {row}, column {column}", texels[i]);
            return Err(Refusal { message, expected: "finite numbers of at most 1e15" });
        }
        texels.iter_mut().flatten().for_each(|value| *value = value.max(0.0));
    }
    Ok(decoded)
}

impl Builder<'_> {
    /// Warns about emission whose images are brighter than surfaces can show them.
    pub(super) fn warn_of_clipped_images(&mut self) {
        let emission = self.scene.materials.iter().filter_map(|material| material.emission.as_ref()?.image);
        let mut images: Vec<ImageId> = emission.collect();
        images.sort_unstable_by_key(|id| id.0);
        images.dedup();
        for id in images {
            let image = &self.scene.images[id.0 as usize];
            let Pixels::Float(texels) = &image.pixels else { continue };
            if texels.iter().flatten().any(|value| *value > MAX_ON_SURFACES) {
                let message = format!(
                    "the image `{}` holds values above {MAX_ON_SURFACES}, which surfaces show as that; scale the image \
                     down and its `radiance` up",
                    image.name
                );
                self.reader.report.warn(|| self.places.images[id.0 as usize].clone().with_message(&message));
            }
        }
    }

    /// The image that the value of `key` names, if there is one.
    #[allow(clippy::option_option, reason = "the outer one is an error, as everywhere here")]
    pub(super) fn optional_image(
        &mut self,
        table: Table<'_>,
        key: &'static str,
        wanted: ImageUse,
    ) -> Option<Option<ImageId>> {
        table.get(key).map_or(Some(None), |value| self.image(value, wanted).map(Some))
    }

    /// The image that the value of `key` names; there must be one.
    pub(super) fn required_image(&mut self, table: Table<'_>, key: &'static str, wanted: ImageUse) -> Option<ImageId> {
        match table.get(key) {
            Some(value) => self.image(value, wanted),
            None => self.reader.required(table, key, FILE).and(None),
        }
    }

    /// The image that a value names.
    pub(super) fn image(&mut self, value: Value<'_>, wanted: ImageUse) -> Option<ImageId> {
        let name = self.reader.read(value, FILE)?;
        let source = self.reader.source;
        match self.image_named(&name, None, wanted, || source.fault(value.span(), "")) {
            Ok(id) => Some(id),
            Err(Refusal { message, expected }) => {
                self.reader.error(value.span(), &message, expected);
                None
            }
        }
    }

    /// The image in file `name` beside the file `beside` (`None`: beside the scene); `place` says where it is named.
    pub(super) fn image_named(
        &mut self,
        name: &str,
        beside: Option<&Path>,
        wanted: ImageUse,
        place: impl FnOnce() -> Fault,
    ) -> Result<ImageId, Refusal> {
        let found = self.images.load(&mut self.files, &mut self.scene.images, (name, beside), wanted)?;
        if self.scene.images.len() > self.places.images.len() {
            let place = place();
            for remark in &found.remarks {
                let message = format!("the image `{name}`: {remark}");
                self.reader.report.warn(|| place.clone().with_message(&message));
            }
            self.places.images.push(place);
        }
        Ok(found.id)
    }
}
