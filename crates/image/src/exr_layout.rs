//! Which channels of an EXR file make up which layer, and back.

use std::collections::BTreeMap;
use std::path::Path;

use crate::exr_header::SampleKind;
use crate::{Image, ImageError, LayerData, Layers, Plane};

const RGB: [&str; 3] = ["R", "G", "B"];
const XYZ: [&str; 3] = ["X", "Y", "Z"];
/// Suffix of ids.
const ID: &str = "ID";
/// Up to here every whole number is a float: 2^24.
const MAX_EXACT_ID: u32 = 1 << 24;

/// A channel to be written: a full name and where its samples are.
pub(crate) struct Channel<'a> {
    /// `R` or `albedo.R`.
    pub(crate) name: String,
    source: Source<'a>,
}

enum Source<'a> {
    Component(&'a Image, usize),
    F32(&'a Plane<f32>),
    /// Ids that floats hold exactly.
    SmallIds(&'a Plane<u32>),
    U32(&'a Plane<u32>),
}

impl Channel<'_> {
    /// The type of the samples.
    pub(crate) fn kind(&self) -> SampleKind {
        match self.source {
            Source::Component(..) | Source::F32(_) | Source::SmallIds(_) => SampleKind::F32,
            Source::U32(_) => SampleKind::U32,
        }
    }

    /// Appends the samples of row `y` in the machine's byte order.
    pub(crate) fn append_row(&self, y: usize, bytes: &mut Vec<u8>) {
        match self.source {
            Source::Component(image, c) => bytes.extend(image.row(y).iter().flat_map(|rgb| rgb[c].to_le_bytes())),
            Source::F32(plane) => bytes.extend(plane.row(y).iter().flat_map(|value| value.to_le_bytes())),
            Source::SmallIds(plane) => bytes.extend(plane.row(y).iter().flat_map(|id| (*id as f32).to_le_bytes())),
            Source::U32(plane) => bytes.extend(plane.row(y).iter().flat_map(|value| value.to_le_bytes())),
        }
    }
}

/// The channels of `layers` sorted by name, as the format asks for: the beauty as plain `R`, `G`, `B`.
pub(crate) fn channels_of(layers: &Layers) -> Vec<Channel<'_>> {
    let mut channels = components("", layers.beauty(), RGB);
    for (name, data) in layers.aovs() {
        let prefix = format!("{name}.");
        let single = |suffix, source| vec![Channel { name: format!("{prefix}{suffix}"), source }];
        channels.extend(match data {
            LayerData::Color(image) => components(&prefix, image, RGB),
            LayerData::Vector(image) => components(&prefix, image, XYZ),
            LayerData::Scalar(plane) => single("Y", Source::F32(plane)),
            LayerData::Depth(plane) => single("Z", Source::F32(plane)),
            LayerData::Id(plane) if plane.pixels().iter().all(|id| *id <= MAX_EXACT_ID) => {
                single(ID, Source::SmallIds(plane))
            }
            LayerData::Id(plane) => single(ID, Source::U32(plane)),
        });
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    channels
}

fn components<'a>(prefix: &str, image: &'a Image, suffixes: [&str; 3]) -> Vec<Channel<'a>> {
    let component = |(c, suffix)| Channel { name: format!("{prefix}{suffix}"), source: Source::Component(image, c) };
    suffixes.into_iter().enumerate().map(component).collect()
}

/// The samples of one channel as read; half floats have become floats.
#[derive(Clone, Debug)]
pub(crate) enum Samples {
    /// Floats, row by row from the top.
    F32(Vec<f32>),
    /// Integers, row by row from the top.
    U32(Vec<u32>),
}

/// The channels that share what stands before their last dot, by what stands after it.
type Group = BTreeMap<String, Samples>;

/// Puts channels together again: `R`, `G`, `B` are the beauty, and a prefix with `R G B`, `X Y Z`, `Y`, `Z` or `ID` is a
/// layer of that kind. Any other channel becomes a layer of its own under its full name, such as `A`.
///
/// Fails with [`ImageError::Malformed`] where there is no beauty or a name comes twice.
pub(crate) fn layers_of(
    path: &Path,
    width: usize,
    height: usize,
    channels: Vec<(String, Samples)>,
) -> Result<Layers, ImageError> {
    let mut groups = grouped(path, channels)?;
    let mut plain = groups.remove("").unwrap_or_default();
    let beauty = take_three(&mut plain, RGB).ok_or_else(|| no_beauty(path))?;
    let mut layers = Layers::new(interleaved(width, height, &beauty)?);
    push_rest(&mut layers, "", plain)?;
    for (prefix, group) in groups {
        push_group(&mut layers, &prefix, group)?;
    }
    Ok(layers)
}

/// The error of a file without a picture in it.
pub(crate) fn no_beauty(path: &Path) -> ImageError {
    ImageError::malformed(path, "no part has the channels R, G and B")
}

fn grouped(path: &Path, channels: Vec<(String, Samples)>) -> Result<BTreeMap<String, Group>, ImageError> {
    let mut groups: BTreeMap<String, Group> = BTreeMap::new();
    for (name, samples) in channels {
        let (prefix, suffix) = name.rsplit_once('.').unwrap_or(("", &name));
        let group = groups.entry(prefix.to_owned()).or_default();
        if group.insert(suffix.to_owned(), samples).is_some() {
            return Err(ImageError::malformed(path, format!("channel {name} comes twice")));
        }
    }
    Ok(groups)
}

fn push_group(layers: &mut Layers, prefix: &str, mut group: Group) -> Result<(), ImageError> {
    let (width, height) = (layers.width(), layers.height());
    if let Some(colour) = take_three(&mut group, RGB) {
        layers.push(prefix, LayerData::Color(interleaved(width, height, &colour)?))?;
    } else if let Some(vector) = take_three(&mut group, XYZ) {
        layers.push(prefix, LayerData::Vector(interleaved(width, height, &vector)?))?;
    } else if group.len() == 1 && group.keys().all(|suffix| ["Y", "Z", ID].contains(&suffix.as_str())) {
        for (suffix, samples) in group {
            layers.push(prefix, single(&suffix, width, height, samples)?)?;
        }
        return Ok(());
    }
    push_rest(layers, &format!("{prefix}."), group)
}

/// Channels that form no known kind, each under its full name.
fn push_rest(layers: &mut Layers, prefix: &str, group: Group) -> Result<(), ImageError> {
    let (width, height) = (layers.width(), layers.height());
    for (suffix, samples) in group {
        let data = single(&suffix, width, height, samples)?;
        layers.push(format!("{prefix}{suffix}"), data)?;
    }
    Ok(())
}

fn single(suffix: &str, width: usize, height: usize, samples: Samples) -> Result<LayerData, ImageError> {
    Ok(match samples {
        Samples::U32(ids) => LayerData::Id(Plane::from_pixels(width, height, ids)?),
        Samples::F32(values) if suffix == ID && values.iter().all(|value| is_id(*value)) => {
            let ids = values.iter().map(|value| *value as u32).collect();
            LayerData::Id(Plane::from_pixels(width, height, ids)?)
        }
        Samples::F32(values) if suffix == "Z" => LayerData::Depth(Plane::from_pixels(width, height, values)?),
        Samples::F32(values) => LayerData::Scalar(Plane::from_pixels(width, height, values)?),
    })
}

/// Whether a float is an id that was stored as one.
fn is_id(value: f32) -> bool {
    (0.0..=MAX_EXACT_ID as f32).contains(&value) && value.fract() == 0.0
}

/// Takes three float channels out of a group if it has all of them.
fn take_three(group: &mut Group, suffixes: [&str; 3]) -> Option<[Vec<f32>; 3]> {
    if !suffixes.iter().all(|suffix| matches!(group.get(*suffix), Some(Samples::F32(_)))) {
        return None;
    }
    Some(suffixes.map(|suffix| match group.remove(suffix) {
        Some(Samples::F32(values)) => values,
        _ => Vec::new(), // cannot be: all three were just seen
    }))
}

fn interleaved(width: usize, height: usize, [r, g, b]: &[Vec<f32>; 3]) -> Result<Image, ImageError> {
    let pixels = r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b]).collect();
    Image::from_pixels(width, height, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(names: &[(&str, bool)]) -> Result<Layers, ImageError> {
        let samples = |is_id| if is_id { Samples::U32(vec![7]) } else { Samples::F32(vec![1.0]) };
        let channels = names.iter().map(|(name, is_id)| ((*name).to_owned(), samples(*is_id))).collect();
        layers_of(Path::new("a.exr"), 1, 1, channels)
    }

    const BEAUTY: [(&str, bool); 3] = [("B", false), ("G", false), ("R", false)];

    #[test]
    fn unknown_channels_become_layers_under_their_full_names() {
        let layers =
            read(&[&BEAUTY[..], &[("A", false), ("Z", false), ("d.R", false), ("d.ID", true)]].concat()).unwrap();
        assert_eq!(layers.aovs().map(|(name, _)| name).collect::<Vec<_>>(), ["A", "Z", "d.ID", "d.R"]);
        assert!(matches!(layers.get("Z"), Some(LayerData::Depth(_))));
        assert!(matches!(layers.get("d.ID"), Some(LayerData::Id(_))));
    }

    #[test]
    fn ids_are_floats_as_far_as_floats_are_exact() {
        let kinds = |greatest: u32| {
            let mut layers = Layers::new(Image::new(2, 1));
            let ids = Plane::from_pixels(2, 1, vec![0, greatest]).unwrap();
            layers.push("object_id", LayerData::Id(ids)).unwrap();
            let channels = channels_of(&layers);
            let mut row = Vec::new();
            let id = channels.iter().find(|channel| channel.name == "object_id.ID").unwrap();
            id.append_row(0, &mut row);
            (id.kind(), row[4..].to_vec())
        };
        assert_eq!(kinds(3), (SampleKind::F32, 3.0_f32.to_le_bytes().to_vec()));
        assert_eq!(kinds(1 << 24), (SampleKind::F32, 16_777_216.0_f32.to_le_bytes().to_vec()));
        let beyond = (1 << 24) + 1;
        assert_eq!(kinds(beyond), (SampleKind::U32, beyond.to_le_bytes().to_vec()));
    }

    #[test]
    fn floats_and_integers_are_read_as_ids_and_other_numbers_are_kept() {
        let of = |samples| {
            let beauty = ["B", "G", "R"].map(|name| (name.to_owned(), Samples::F32(vec![0.0; 2])));
            let channels = beauty.into_iter().chain([("o.ID".to_owned(), samples)]).collect();
            layers_of(Path::new("a.exr"), 2, 1, channels).unwrap().get("o").cloned()
        };
        let ids = |ids| Some(LayerData::Id(Plane::from_pixels(2, 1, ids).unwrap()));
        assert_eq!(of(Samples::F32(vec![0.0, 16_777_216.0])), ids(vec![0, 1 << 24]));
        assert_eq!(of(Samples::U32(vec![7, u32::MAX])), ids(vec![7, u32::MAX]));
        for odd in [0.5, -1.0, 16_777_218.0, f32::NAN, f32::INFINITY] {
            assert!(matches!(of(Samples::F32(vec![1.0, odd])), Some(LayerData::Scalar(_))), "{odd}");
        }
    }

    #[test]
    fn an_ambiguous_name_is_refused_and_a_missing_beauty_too() {
        assert!(read(&[&BEAUTY[..], &[("d.A", false), ("d.A.Y", false)]].concat()).is_err());
        assert!(read(&[&BEAUTY[..], &[("R", false)]].concat()).is_err());
        assert!(read(&BEAUTY[..2]).unwrap_err().to_string().contains("R, G and B"));
        assert!(read(&[("B", true), ("G", true), ("R", true)]).is_err(), "ids are no picture");
    }
}
