//! One picture out of an EXR file of any program: its beauty, or a layer by name.

use std::path::Path;

use exr::meta::header::Header;
use rayon::prelude::*;

use crate::exr_color::ColorSpace;
use crate::exr_decode::{Decoded, decode, headers};
use crate::exr_header::text;
use crate::exr_layout::Samples;
use crate::primaries::convert;
use crate::{Channels, Image, ImageError, Light, LightOptions};

/// The name of the picture itself, as `lightcuts info` tells it.
const BEAUTY: &str = "beauty";
/// Channels that make a `Y` beside them part of a vector, or the luminance of a picture with chroma.
const NOT_BESIDE_GREY: [&str; 3] = ["X", "RY", "BY"];
/// Most names that a message tells.
const MAX_NAMES: usize = 20;

/// Where a picture is in a file.
#[derive(Debug, PartialEq)]
struct Place {
    /// Index of the part.
    part: usize,
    /// The full names of its one or three channels, without alpha.
    names: Vec<String>,
    channels: Channels,
}

/// The picture of an EXR file, or its layer of this name.
///
/// The beauty is the first part with `R`, `G` and `B`, or else with `Y` alone. A layer `name` has the channels
/// `name.R`, `.G`, `.B`, or `.X`, `.Y`, `.Z`, or `.Y`, or `.Z`, or `.ID`; or it is the channel `name`, or the part of that
/// name. Halves and unsigned integers become floats; an `A` beside the colours is told and dropped. Colours become Rec. 709
/// unless data are wanted.
///
/// Fails as [`read_exr`](crate::read_exr), and where there is no such picture.
pub(crate) fn decode_exr_picture(path: &Path, bytes: &[u8], options: &LightOptions<'_>) -> Result<Light, ImageError> {
    let headers = headers(path, bytes)?;
    let parts: Vec<Part> = headers.iter().map(Part::new).collect();
    let layer = options.layer;
    let place = find(&parts, layer).ok_or_else(|| absent(path, &parts, layer))?;
    let space = ColorSpace::read(path, bytes, place.part)?;
    let is_wanted = |name: &str| place.names.iter().any(|wanted| wanted == name);
    let decoded = decode(path, bytes, place.part, &options.limits, is_wanted)?;
    let mut image = image(&decoded, &place.names)?;
    let is_color = place.names.first().is_some_and(|name| name.rsplit('.').next() == Some("R"));
    let matrix = space.matrix.as_ref().filter(|_| is_color);
    if let Some(matrix) = matrix
        && !options.is_data
    {
        convert(&mut image, matrix);
    }
    Ok(Light {
        image,
        channels: place.channels,
        frame: decoded.frame,
        has_other_primaries: matrix.is_some(),
        remarks: space.remarks(is_color, options.is_data),
    })
}

/// The part that holds the picture itself, if one does.
pub(crate) fn main_part(headers: &[Header]) -> Option<usize> {
    let parts: Vec<Part> = headers.iter().map(Part::new).collect();
    find(&parts, None).map(|place| place.part)
}

/// The full names of the one or three channels of a picture in its part, without alpha, and what they are.
type Found = (Vec<String>, Channels);

/// The names in a part.
struct Part {
    name: Option<String>,
    channels: Vec<String>,
}

impl Part {
    fn new(header: &Header) -> Self {
        let name = header.own_attributes.layer_name.as_ref().map(|name| text(name.as_slice().to_vec()));
        let channels = header.channels.list.iter().map(|channel| text(channel.name.as_slice().to_vec())).collect();
        Self { name, channels }
    }

    /// Whether there is a channel of this full name.
    fn has(&self, name: &str) -> bool {
        self.channels.iter().any(|channel| channel == name)
    }

    /// The names `prefix` + suffix, if all are there.
    fn names(&self, prefix: &str, suffixes: &[&str]) -> Option<Vec<String>> {
        let names: Vec<String> = suffixes.iter().map(|suffix| format!("{prefix}{suffix}")).collect();
        names.iter().all(|name| self.has(name)).then_some(names)
    }

    /// The colours under `prefix`: `R`, `G`, `B`, or else `Y` that is no component of something else.
    fn colours(&self, prefix: &str) -> Option<Found> {
        let has_alpha = self.has(&format!("{prefix}A"));
        if let Some(names) = self.names(prefix, &["R", "G", "B"]) {
            return Some((names, Channels::Rgb.with_alpha(has_alpha)));
        }
        let is_component = NOT_BESIDE_GREY.iter().any(|other| self.has(&format!("{prefix}{other}")));
        let names = self.names(prefix, &["Y"]).filter(|_| !is_component)?;
        Some((names, Channels::Grey.with_alpha(has_alpha)))
    }

    /// Whatever can be measured under `prefix`: colours, a vector, a depth or numbers of objects.
    fn any(&self, prefix: &str) -> Option<Found> {
        let vector = || Some((self.names(prefix, &["X", "Y", "Z"])?, Channels::Rgb));
        let single = |suffix| Some((self.names(prefix, &[suffix])?, Channels::Grey));
        self.colours(prefix).or_else(vector).or_else(|| single("Z")).or_else(|| single("ID"))
    }

    /// The layer of this name.
    fn layer(&self, name: &str) -> Option<Found> {
        let single = || Some((self.names("", &[name])?, Channels::Grey));
        let whole_part = || if self.name.as_deref() == Some(name) { self.any("") } else { None };
        self.any(&format!("{name}.")).or_else(single).or_else(whole_part)
    }
}

fn find(parts: &[Part], layer: Option<&str>) -> Option<Place> {
    let first = |of: &dyn Fn(&Part) -> Option<Found>| {
        let found = parts.iter().enumerate().find_map(|(part, names)| Some((part, of(names)?)));
        found.map(|(part, (names, channels))| Place { part, names, channels })
    };
    // A part in colours stands before one in grey.
    let is_colour = |found: &Found| found.1.without_alpha() == Channels::Rgb;
    let beauty = || first(&|part| part.colours("").filter(is_colour)).or_else(|| first(&|part| part.colours("")));
    match layer {
        None => beauty(),
        Some(BEAUTY) => first(&|part| part.layer(BEAUTY)).or_else(beauty),
        Some(name) => first(&|part| part.layer(name)),
    }
}

/// The error of a file without such a picture, with what the file has.
fn absent(path: &Path, parts: &[Part], layer: Option<&str>) -> ImageError {
    let names: Vec<&str> = parts.iter().flat_map(|part| &part.channels).map(String::as_str).collect();
    let told = names.iter().take(MAX_NAMES).map(|name| name.escape_debug().to_string()).collect::<Vec<_>>().join(", ");
    let more = if names.len() > MAX_NAMES { ", ..." } else { "" };
    let missing = match layer {
        None => "it has neither the channels R, G and B nor Y alone".to_owned(),
        Some(layer) => format!("it has no layer {layer} that can be measured"),
    };
    ImageError::malformed(path, format!("{missing}; its channels are {told}{more}"))
}

fn image(decoded: &Decoded, names: &[String]) -> Result<Image, ImageError> {
    let of_name = |name: &String| decoded.channels.iter().find(|(found, _)| found == name).map(|(_, samples)| samples);
    let samples: Vec<&Samples> = names.iter().filter_map(of_name).collect();
    let value = |channel: usize, at: usize| match samples[channel.min(samples.len() - 1)] {
        Samples::F32(values) => values[at],
        Samples::U32(values) => values[at] as f32,
    };
    let pixels = (0..decoded.width * decoded.height).into_par_iter();
    let pixels = pixels.map(|at| std::array::from_fn(|channel| value(channel, at))).collect();
    Image::from_pixels(decoded.width, decoded.height, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(name: Option<&str>, channels: &[&str]) -> Part {
        Part { name: name.map(str::to_owned), channels: channels.iter().map(|name| (*name).to_owned()).collect() }
    }

    /// The channels that were found, and what they are.
    fn found(channels: &[&str], layer: Option<&str>) -> String {
        let told = |place: Place| format!("{} is {}", place.names.join(" "), place.channels);
        find(&[part(None, channels)], layer).map_or("none".to_owned(), told)
    }

    #[test]
    fn the_beauty_is_colour_or_grey() {
        assert_eq!(found(&["B", "G", "R"], None), "R G B is R, G, B");
        assert_eq!(found(&["A", "B", "G", "R", "Z"], None), "R G B is R, G, B, A");
        assert_eq!(found(&["Y"], None), "Y is Y");
        assert_eq!(found(&["A", "Y", "Z"], None), "Y is Y, A", "a depth does not disturb");
        assert_eq!(found(&["BY", "RY", "Y"], None), "none", "luminance and chroma");
        assert_eq!(found(&["albedo.B", "albedo.G", "albedo.R"], None), "none");
        let parts = [part(Some("y"), &["Y"]), part(Some("rgb"), &["B", "G", "R"])];
        assert_eq!(find(&parts, None).unwrap().part, 1, "colours stand before grey");
    }

    #[test]
    fn layers_are_found_by_prefix_channel_or_part() {
        let channels =
            ["R", "G", "B", "a.b.R", "a.b.G", "a.b.B", "a.b.A", "n.X", "n.Y", "n.Z", "d.Z", "o.ID", "s.Y", "Z"];
        let of = |layer| found(&channels, Some(layer));
        assert_eq!(of("a.b"), "a.b.R a.b.G a.b.B is R, G, B, A");
        assert_eq!(of("n"), "n.X n.Y n.Z is R, G, B");
        assert_eq!(of("d"), "d.Z is Y");
        assert_eq!(of("o"), "o.ID is Y");
        assert_eq!(of("s"), "s.Y is Y");
        assert_eq!(of("Z"), "Z is Y");
        assert_eq!(of("n.X"), "n.X is Y");
        assert_eq!(of("beauty"), "R G B is R, G, B");
        assert_eq!([of("a"), of("none"), of("")], ["none"; 3]);
        let parts = [part(Some("main"), &["R", "G", "B"]), part(Some("albedo"), &["R", "G", "B", "A"])];
        let place = find(&parts, Some("albedo")).unwrap();
        assert_eq!((place.part, place.channels), (1, Channels::Rgba));
        assert_eq!(find(&[part(Some("n"), &["X", "Y", "Z"])], Some("n")).unwrap().names, ["X", "Y", "Z"]);
    }

    #[test]
    fn what_is_absent_is_told_with_what_is_there() {
        let names: Vec<String> = (0..30).map(|i| format!("c{i}.ID")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let told = absent(Path::new("a.exr"), &[part(None, &names)], Some("x")).to_string();
        assert!(
            told.contains("no layer x") && told.contains("c0.ID, c1.ID") && told.ends_with("c19.ID, ..."),
            "{told}"
        );
    }
}
