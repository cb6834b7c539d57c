//! What a picture file holds: size, windows, layers.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use exr::meta::header::Header;
use exr::prelude::SampleType;

use crate::exr_color::ColorSpace;
use crate::exr_decode::{decode, headers};
use crate::exr_header::{read_attributes, text};
use crate::exr_picture::main_part;
use crate::light::{LightOptions, PictureFormat, decode_light};
use crate::png::decode_png;
use crate::{Channels, Frame, ImageError, PictureLimits};

/// Name of the picture itself.
const BEAUTY: &str = "beauty";

/// A layer of a picture file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureLayer {
    /// What `read_picture` takes.
    pub name: String,
    /// `color`, `grey`, `vector`, `scalar`, `depth` or `id`.
    pub kind: &'static str,
}

/// What a picture file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Inventory {
    /// Told by content.
    pub format: PictureFormat,
    /// Where the pixels lie.
    pub frame: Frame,
    /// The picture itself first, if there is one, then the others by name.
    pub layers: Vec<PictureLayer>,
    /// What a user must know of how the numbers are taken.
    pub remarks: Vec<String>,
    /// The texts of an EXR's part that holds the picture.
    pub attributes: BTreeMap<String, String>,
}

/// What the picture file at `path` holds, of every format that [`read_picture`](crate::read_picture) reads, and of EXR files
/// whatever their channels. The file is decoded whole, so that damage shows.
///
/// Fails as `read_picture`.
pub fn picture_inventory(path: impl AsRef<Path>) -> Result<Inventory, ImageError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| ImageError::io("read", path, source))?;
    let unknown = || ImageError::malformed(path, "it is no EXR, PNG, PFM or Radiance HDR file");
    let format = PictureFormat::of(&bytes).ok_or_else(unknown)?;
    if format == PictureFormat::Exr {
        return of_exr(path, &bytes);
    }
    let (frame, channels, remarks) = if let Some(light) = decode_light(path, &bytes, &LightOptions::default()) {
        light.map(|light| (light.frame, light.channels, light.remarks))?
    } else {
        let png = decode_png(path, &bytes, &PictureLimits::default())?;
        (Frame::whole(png.codes.width(), png.codes.height()), png.channels, Vec::new())
    };
    let kind = if channels.without_alpha() == Channels::Grey { "grey" } else { "color" };
    let layers = vec![PictureLayer { name: BEAUTY.to_owned(), kind }];
    Ok(Inventory { format, frame, layers, remarks, attributes: BTreeMap::new() })
}

fn of_exr(path: &Path, bytes: &[u8]) -> Result<Inventory, ImageError> {
    let headers = headers(path, bytes)?;
    let main = main_part(&headers).unwrap_or(0);
    let limits = PictureLimits::default();
    let mut frame = Frame::whole(0, 0);
    for part in 0..headers.len() {
        let decoded = decode(path, bytes, part, &limits, |_| true)?;
        if part == main {
            frame = decoded.frame;
        }
    }
    let attributes =
        read_attributes(&mut &bytes[..], main).map_err(|error| ImageError::malformed(path, error.to_string()))?;
    let space = ColorSpace::read(path, bytes, main)?;
    let mut layers: Vec<PictureLayer> =
        headers.iter().enumerate().flat_map(|(part, header)| layers_of(header, part, part == main)).collect();
    // The picture stands first, whatever its name.
    layers.sort_by(|a, b| (a.name != BEAUTY).cmp(&(b.name != BEAUTY)).then_with(|| a.name.cmp(&b.name)));
    let remarks = space.remarks(true, false);
    Ok(Inventory { format: PictureFormat::Exr, frame, layers, remarks, attributes })
}

/// The layers of a part; of those beside the picture's, plain channels have the part's name.
fn layers_of(header: &Header, part: usize, is_main: bool) -> Vec<PictureLayer> {
    let mut groups: BTreeMap<String, BTreeMap<String, SampleType>> = BTreeMap::new();
    for channel in &header.channels.list {
        let name = text(channel.name.as_slice().to_vec());
        let (prefix, suffix) = name.rsplit_once('.').unwrap_or(("", &name));
        groups.entry(prefix.to_owned()).or_default().insert(suffix.to_owned(), channel.sample_type);
    }
    let part_name = header.own_attributes.layer_name.as_ref().map(|name| text(name.as_slice().to_vec()));
    let part_name = part_name.unwrap_or_else(|| format!("part {}", part + 1));
    let named = |(prefix, group): (String, BTreeMap<String, SampleType>)| match (prefix.is_empty(), is_main) {
        (true, true) => of_group(BEAUTY, "", group),
        (true, false) => of_group(&part_name, "", group),
        (false, _) => of_group(&prefix, &format!("{prefix}."), group),
    };
    groups.into_iter().flat_map(named).collect()
}

/// What channels under one prefix make together, and those that are left, each by its full name.
fn of_group(name: &str, prefix: &str, mut group: BTreeMap<String, SampleType>) -> Vec<PictureLayer> {
    let layer = |name: &str, kind| PictureLayer { name: name.to_owned(), kind };
    let mut layers = Vec::new();
    let is_alone = group.len() == 1;
    let together: [(&[&str], &str); 3] = [
        (&["R", "G", "B"], "color"),
        (&["X", "Y", "Z"], "vector"),
        (&["Y"], if prefix.is_empty() { "grey" } else { "scalar" }),
    ];
    let found = together.into_iter().find(|(suffixes, _)| suffixes.iter().all(|suffix| group.contains_key(*suffix)));
    if let Some((suffixes, kind)) = found.filter(|(suffixes, _)| suffixes.len() > 1 || is_alone || prefix.is_empty()) {
        group.retain(|suffix, _| !suffixes.contains(&suffix.as_str()));
        layers.push(layer(name, kind));
    } else if is_alone && ["Z", "ID"].iter().any(|suffix| group.contains_key(*suffix)) && !prefix.is_empty() {
        let (suffix, kind) = group.pop_first().unwrap_or((String::new(), SampleType::F32));
        layers.push(layer(name, single(&suffix, kind)));
    }
    layers.extend(group.into_iter().map(|(suffix, kind)| layer(&format!("{prefix}{suffix}"), single(&suffix, kind))));
    layers
}

fn single(suffix: &str, kind: SampleType) -> &'static str {
    match (suffix, kind) {
        (_, SampleType::U32) | ("ID", _) => "id",
        ("Z", _) => "depth",
        _ => "scalar",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The layers that channels make, each with its kind.
    fn told(name: &str, prefix: &str, channels: &[(&str, SampleType)]) -> String {
        let group = channels.iter().map(|(suffix, kind)| ((*suffix).to_owned(), *kind)).collect();
        let layers = of_group(name, prefix, group);
        layers.iter().map(|layer| format!("{} {}", layer.name, layer.kind)).collect::<Vec<_>>().join(", ")
    }

    #[test]
    fn channels_make_layers() {
        const F: SampleType = SampleType::F32;
        const U: SampleType = SampleType::U32;
        assert_eq!(
            told("beauty", "", &[("A", F), ("B", F), ("G", F), ("R", F), ("Z", F)]),
            "beauty color, A scalar, Z depth"
        );
        assert_eq!(told("beauty", "", &[("B", U), ("G", U), ("R", U)]), "beauty color");
        assert_eq!(told("beauty", "", &[("A", F), ("Y", F)]), "beauty grey, A scalar");
        assert_eq!(told("beauty", "", &[("Z", F)]), "Z depth");
        assert_eq!(told("n", "n.", &[("X", F), ("Y", F), ("Z", F)]), "n vector");
        assert_eq!(told("d", "d.", &[("Z", F)]), "d depth");
        assert_eq!(told("o", "o.", &[("ID", F)]), "o id");
        assert_eq!(told("s", "s.", &[("Y", F)]), "s scalar");
        assert_eq!(told("m", "m.", &[("ID", U), ("Y", F)]), "m.ID id, m.Y scalar");
    }
}
