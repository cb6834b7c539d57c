//! Pictures of the differences: which kind goes to which file, checked before anything is read.

use super::inputs::Inputs;
use super::text::number;
use crate::args::CompareArgs;
use crate::exit::Failure;
use crate::job::has_extension;
use crate::outputs::check_files;
use lightcuts::image::metrics::{Comparison, Metric};
use lightcuts::image::{self, HeatMap, Image, Plane, Transfer, heat_map, luminance};
use std::path::{Path, PathBuf};

/// What a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// FLIP of what is shown.
    Flip,
    /// HDR-FLIP of the light.
    FlipHdr,
    /// The pixels that Perceptual Image Diff sees.
    Pdiff,
    /// Luminance of the test less that of the reference.
    Difference,
    /// The squared error over the squared reference.
    RelMse,
    /// The absolute error.
    Absolute,
}

/// A map to write.
#[derive(Debug, PartialEq)]
pub(super) struct Map {
    pub(super) kind: Kind,
    pub(super) path: PathBuf,
}

impl Kind {
    const ALL: [Self; 6] = [Self::Flip, Self::FlipHdr, Self::Pdiff, Self::Difference, Self::RelMse, Self::Absolute];

    fn name(self) -> &'static str {
        match self {
            Self::Flip => "flip",
            Self::FlipHdr => "flip-hdr",
            Self::Pdiff => "pdiff",
            Self::Difference => "difference",
            Self::RelMse => "relmse",
            Self::Absolute => "absolute",
        }
    }

    /// The kind of this name; `_` is as good as `-`, as in the metrics' keys.
    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name.replace('_', "-"))
    }

    /// The kind whose name the file has, or else FLIP.
    fn of_file(path: &Path) -> Self {
        path.file_stem().and_then(|stem| Self::named(&stem.to_string_lossy())).unwrap_or(Self::Flip)
    }

    /// The metric that makes the map on its way, if one does.
    pub(super) fn metric(self) -> Option<Metric> {
        match self {
            Self::Flip => Some(Metric::FlipLdr),
            Self::FlipHdr => Some(Metric::FlipHdr),
            Self::Pdiff => Some(Metric::PdiffPx),
            Self::Difference | Self::RelMse | Self::Absolute => None,
        }
    }
}

impl Map {
    /// Of `KIND=FILE` or `FILE`. A `=` behind a path separator belongs to the file's name.
    fn parse(argument: &Path) -> Result<Self, Failure> {
        let text = argument.to_string_lossy();
        let split = text.split_once('=').filter(|(kind, _)| !kind.contains(std::path::is_separator));
        let (kind, path) = match split {
            Some((name, file)) => (Kind::named(name).ok_or_else(|| unknown_kind(name))?, PathBuf::from(file)),
            None => (Kind::of_file(argument), argument.to_path_buf()),
        };
        if !has_extension(&path, "png") {
            let message = format!("{} is no map that can be written", path.display());
            return Err(Failure::usage(message, "expected a name that ends in .png"));
        }
        Ok(Self { kind, path })
    }
}

fn unknown_kind(name: &str) -> Failure {
    let kinds = Kind::ALL.map(Kind::name).join(", ");
    Failure::usage(format!("there is no map {name:?}"), format!("expected one of {kinds}; or write ./{name}=..."))
}

/// The maps of the command line, each of which can be written.
pub(super) fn maps(args: &CompareArgs) -> Result<Vec<Map>, Failure> {
    let maps: Vec<Map> = args.output.maps.iter().map(|map| Map::parse(map)).collect::<Result<_, _>>()?;
    let inputs = [args.reference.clone(), args.test.clone()];
    check_files(maps.iter().map(|map| map.path.as_path()), &inputs, "comparison", "--map")?;
    Ok(maps)
}

/// Writes each map, going on after a failure; returns the files written and the first failure.
pub(super) fn write<'a>(maps: &'a [Map], inputs: &Inputs, comparison: &Comparison) -> (Vec<&'a Path>, Option<Failure>) {
    let (mut written, mut first) = (Vec::new(), None);
    for map in maps {
        let picture = map.kind.picture(inputs, comparison);
        match image::write_png(&map.path, &picture, Transfer::Linear) {
            Ok(()) => written.push(map.path.as_path()),
            Err(error) => first = first.or(Some(Failure::output(error))),
        }
    }
    (written, first)
}

impl Kind {
    /// The map in false colours, with its scale. Code values.
    fn picture(self, inputs: &Inputs, comparison: &Comparison) -> Image {
        let (values, style) = self.values(inputs, comparison);
        heat_map(&values, &style)
    }

    fn values(self, inputs: &Inputs, comparison: &Comparison) -> (Plane<f32>, HeatMap) {
        let light = |of: fn([f32; 3], [f32; 3]) -> f32| per_pixel(inputs.reference.linear(), inputs.test.linear(), of);
        match self {
            Self::Flip => {
                let found = comparison.flip_ldr.as_ref().expect("a map's metric is measured");
                (found.map.clone(), HeatMap::flip(format!("FLIP, mean {}", number(found.mean))))
            }
            Self::FlipHdr => {
                let found = comparison.flip_hdr.as_ref().expect("a map's metric is measured");
                (found.map.clone(), HeatMap::flip(format!("HDR-FLIP, mean {}", number(found.mean))))
            }
            Self::Pdiff => {
                let found = comparison.pdiff.as_ref().expect("a map's metric is measured");
                let label = format!("Perceptual Image Diff, {} pixels differ visibly", found.pixels);
                (found.mask.map(|differs| f32::from(u8::from(differs))), HeatMap::flip(label))
            }
            Self::Difference => {
                let values = light(|reference, test| luminance(test) - luminance(reference));
                let style = HeatMap::signed(&values, "luminance, test - reference");
                (values, style)
            }
            Self::RelMse => {
                let values = light(relative_squared_error);
                let style = HeatMap::magnitude(&values, "squared error / (reference^2 + 0.01)");
                (values, style)
            }
            Self::Absolute => {
                let values = light(absolute_error);
                let style = HeatMap::magnitude(&values, "absolute error");
                (values, style)
            }
        }
    }
}

/// A number for each pair of pixels.
fn per_pixel(reference: &Image, test: &Image, of: fn([f32; 3], [f32; 3]) -> f32) -> Plane<f32> {
    Plane::from_fn(reference.width(), reference.height(), |x, y| of(reference.get(x, y), test.get(x, y)))
}

/// The term of a pixel in [`relmse`](lightcuts::image::metrics::deviation::relmse).
fn relative_squared_error(reference: [f32; 3], test: [f32; 3]) -> f32 {
    let channel = |channel: usize| {
        let (reference, test) = (reference[channel], test[channel]);
        (test - reference).powi(2) / (reference * reference + 0.01)
    };
    (channel(0) + channel(1) + channel(2)) / 3.0
}

/// The term of a pixel in [`mae`](lightcuts::image::metrics::deviation::mae).
fn absolute_error(reference: [f32; 3], test: [f32; 3]) -> f32 {
    (0..3).map(|channel| (test[channel] - reference[channel]).abs()).sum::<f32>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts::image::metrics::deviation;

    fn parsed(text: &str) -> Map {
        Map::parse(Path::new(text)).unwrap()
    }

    #[test]
    fn kinds_are_given_or_guessed() {
        let cases = [
            ("flip.png", Kind::Flip, "flip.png"),
            ("out/difference.PNG", Kind::Difference, "out/difference.PNG"),
            ("flip_hdr.png", Kind::FlipHdr, "flip_hdr.png"),
            ("a.png", Kind::Flip, "a.png"),
            ("pdiff=a.png", Kind::Pdiff, "a.png"),
            ("relmse=flip.png", Kind::RelMse, "flip.png"),
            ("./x=1.png", Kind::Flip, "./x=1.png"),
            ("absolute=out/x=1.png", Kind::Absolute, "out/x=1.png"),
        ];
        for (text, kind, path) in cases {
            assert_eq!(parsed(text), Map { kind, path: path.into() }, "{text}");
        }
        for wrong in ["flip", "a.exr", "flop=a.png", "=a.png", "flip=", "x=1.png"] {
            assert!(Map::parse(Path::new(wrong)).is_err(), "{wrong}");
        }
    }

    #[test]
    fn maps_have_the_mean_of_their_metric() {
        let reference = Image::from_fn(9, 7, |x, y| [0.1 * x as f32, 0.3 * y as f32, 0.5]);
        let test = Image::from_fn(9, 7, |x, y| [0.4, 0.01 * (x * y) as f32, 0.1 * y as f32]);
        let mean = |of| per_pixel(&reference, &test, of).pixels().iter().copied().map(f64::from).sum::<f64>() / 63.0;
        let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-5, "{found}, {expected}");
        close(mean(relative_squared_error), deviation::relmse(&reference, &test).unwrap());
        close(mean(absolute_error), deviation::mae(&reference, &test).unwrap());
    }
}
