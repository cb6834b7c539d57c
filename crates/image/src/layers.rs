//! What an EXR file holds: the beauty, the AOVs by name, and text attributes.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use crate::exr_header::RESERVED_ATTRIBUTES;
use crate::primaries::{Matrix, convert};
use crate::{Image, ImageError, Plane};

/// Longest name that an EXR file stores, in bytes; a channel adds at most three for its suffix.
const MAX_NAME_BYTES: usize = 255;
const MAX_SUFFIX_BYTES: usize = 3;

/// The pixels of one AOV. The kind decides the channel names: layer `albedo` of kind `Color` is `albedo.R`, `.G`, `.B`.
#[derive(Clone, Debug, PartialEq)]
pub enum LayerData {
    /// Linear RGB, channels `R`, `G`, `B`.
    Color(Image),
    /// A direction or a point, channels `X`, `Y`, `Z`.
    Vector(Image),
    /// A number per pixel, channel `Y`.
    Scalar(Plane<f32>),
    /// A distance in scene units, channel `Z`.
    Depth(Plane<f32>),
    /// An id per pixel, channel `ID`; see [`write_exr`](crate::write_exr) for its type in a file.
    Id(Plane<u32>),
}

/// A render with everything that belongs to it: the beauty FIRST, then AOVs in the order of their names.
///
/// All have one size. The order of AOVs is that of their names because an EXR file sorts its channels and keeps no
/// other order; so a file that is written and read back equals what was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    beauty: Image,
    aovs: BTreeMap<String, LayerData>,
    attributes: BTreeMap<String, String>,
}

impl Layers {
    /// A render of which only the beauty is known.
    pub fn new(beauty: Image) -> Self {
        Self { beauty, aovs: BTreeMap::new(), attributes: BTreeMap::new() }
    }

    /// Width of every layer in pixels.
    pub fn width(&self) -> usize {
        self.beauty.width()
    }

    /// Height of every layer in pixels.
    pub fn height(&self) -> usize {
        self.beauty.height()
    }

    /// The picture itself, linear RGB.
    pub fn beauty(&self) -> &Image {
        &self.beauty
    }

    /// The picture itself, without the rest.
    pub fn into_beauty(self) -> Image {
        self.beauty
    }

    /// Adds an AOV, such as `first_pass` or `normal`.
    ///
    /// Fails with [`ImageError::SizeMismatch`] unless it has the beauty's size, and with [`ImageError::Name`] where the
    /// name is empty, contains a NUL, is longer than 252 bytes or is taken.
    pub fn push(&mut self, name: impl Into<String>, data: LayerData) -> Result<(), ImageError> {
        let name = name.into();
        check_name("layer", &name, MAX_NAME_BYTES - MAX_SUFFIX_BYTES)?;
        self.check_size(&name, &data)?;
        match self.aovs.entry(name) {
            Entry::Vacant(entry) => entry.insert(data),
            Entry::Occupied(entry) => {
                return Err(ImageError::Name { what: "layer", name: entry.key().clone(), reason: "is taken" });
            }
        };
        Ok(())
    }

    fn check_size(&self, name: &str, data: &LayerData) -> Result<(), ImageError> {
        let what = format!("layer {name}");
        match data {
            LayerData::Color(image) | LayerData::Vector(image) => self.beauty.expect_size_of(image, &what),
            LayerData::Scalar(plane) | LayerData::Depth(plane) => self.beauty.expect_size_of(plane, &what),
            LayerData::Id(plane) => self.beauty.expect_size_of(plane, &what),
        }
    }

    /// The AOV of this name.
    pub fn get(&self, name: &str) -> Option<&LayerData> {
        self.aovs.get(name)
    }

    /// The AOVs in the order of their names, without the beauty.
    pub fn aovs(&self) -> impl ExactSizeIterator<Item = (&str, &LayerData)> {
        self.aovs.iter().map(|(name, data)| (name.as_str(), data))
    }

    /// Sets a text attribute of the file, such as `lightcuts:job`; any length, any text. Replaces an older value.
    ///
    /// Fails with [`ImageError::Name`] where the name is empty, contains a NUL, is longer than 255 bytes, or is one that
    /// the format itself uses, such as `dataWindow`.
    pub fn set_attribute(&mut self, name: impl Into<String>, value: impl Into<String>) -> Result<(), ImageError> {
        let name = name.into();
        check_name("attribute", &name, MAX_NAME_BYTES)?;
        if RESERVED_ATTRIBUTES.contains(&name.as_str()) {
            return Err(ImageError::Name { what: "attribute", name, reason: "is used by the EXR format" });
        }
        self.attributes.insert(name, value.into());
        Ok(())
    }

    /// The text attribute of this name.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).map(String::as_str)
    }

    /// All text attributes by name.
    pub fn attributes(&self) -> &BTreeMap<String, String> {
        &self.attributes
    }

    /// Applies a matrix to the beauty and to every layer of colours.
    pub(crate) fn convert_colors(&mut self, matrix: &Matrix) {
        convert(&mut self.beauty, matrix);
        for data in self.aovs.values_mut() {
            if let LayerData::Color(image) = data {
                convert(image, matrix);
            }
        }
    }

    /// Replaces all text attributes by those read from a file.
    pub(crate) fn with_attributes(self, attributes: BTreeMap<String, String>) -> Self {
        Self { attributes, ..self }
    }
}

fn check_name(what: &'static str, name: &str, max_bytes: usize) -> Result<(), ImageError> {
    let reason = match name {
        "" => "is empty",
        _ if name.contains('\0') => "contains a NUL",
        _ if name.len() > max_bytes => "is too long",
        _ => return Ok(()),
    };
    Err(ImageError::Name { what, name: name.to_owned(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_sizes_are_checked() {
        let mut layers = Layers::new(Image::new(2, 2));
        let depth = |width, height| LayerData::Depth(Plane::new(width, height));
        layers.push("depth", depth(2, 2)).unwrap();
        assert!(layers.push("depth", depth(2, 2)).unwrap_err().to_string().contains("is taken"));
        assert!(layers.push("", depth(2, 2)).is_err());
        assert!(layers.push("a\0b", depth(2, 2)).is_err());
        assert!(layers.push("a".repeat(253), depth(2, 2)).is_err());
        assert!(layers.push("small", depth(2, 1)).unwrap_err().to_string().contains("layer small"));
        assert!(layers.set_attribute("dataWindow", "x").is_err());
        layers.set_attribute("comments", "free text").unwrap();
        assert_eq!(layers.attribute("comments"), Some("free text"));
    }

    #[test]
    fn aovs_come_by_name() {
        let mut layers = Layers::new(Image::new(1, 1));
        for name in ["normal", "albedo", "second_pass"] {
            layers.push(name, LayerData::Color(Image::new(1, 1))).unwrap();
        }
        assert_eq!(layers.aovs().map(|(name, _)| name).collect::<Vec<_>>(), ["albedo", "normal", "second_pass"]);
    }
}
