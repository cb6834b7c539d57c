//! The command `heatmap`: a layer of a picture in false colours, with a scale.

use crate::args::HeatmapArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use crate::job::{require_picture, require_regular};
use crate::outputs::check_png;
use lightcuts::image::{self, ColorMap, HeatMap, Image, LayerData, Layers, Plane, Transfer, heat_map, luminance};
use std::path::{Path, PathBuf};

/// Name of the picture itself among its layers.
const BEAUTY: &str = "beauty";

/// Runs the command.
pub(crate) fn run(args: &HeatmapArgs) -> Result<Exit, Failure> {
    require_picture(&args.picture).map_err(|failure| swapped(args).unwrap_or(failure))?;
    let Some(layer) = args.layer.as_deref() else {
        let layers = image::read_exr(&args.picture).map_err(Failure::input)?;
        return Err(wrong_layer(&layers, "no layer is named"));
    };
    let output = args.output.clone().unwrap_or_else(|| default_output(&args.picture, layer));
    check_png(&output, &args.picture, "heat map")?;
    let layers = image::read_exr(&args.picture).map_err(Failure::input)?;
    let values = values(&layers, layer)?;
    let shown = if args.log { values.map(|value| value.max(f32::MIN_POSITIVE).log10()) } else { values };
    let picture = heat_map(&shown, &style(&shown, args, layer));
    image::write_png(&output, &picture, Transfer::Linear).map_err(Failure::output)?;
    if !args.quiet {
        console::print(format!("wrote        {}\n", output.display()).as_bytes())?;
    }
    Ok(Exit::Done)
}

/// The error for swapped arguments, if the name of the layer is that of a file.
fn swapped(args: &HeatmapArgs) -> Option<Failure> {
    let (picture, layer) = (args.picture.display(), args.layer.as_deref()?);
    require_regular(Path::new(layer)).ok()?;
    let message = format!("the picture and its layer seem to be swapped: {layer} is a file, {picture} is none");
    Some(Failure::usage(message, format!("lightcuts heatmap {layer} {picture}")))
}

fn default_output(picture: &Path, layer: &str) -> PathBuf {
    let stem = picture.file_stem().unwrap_or("picture".as_ref()).to_string_lossy();
    PathBuf::from(format!("{stem}-{layer}.png"))
}

/// The error that lists the layers.
fn wrong_layer(layers: &Layers, message: impl Into<String>) -> Failure {
    let names: Vec<&str> = std::iter::once(BEAUTY).chain(layers.aovs().map(|(name, _)| name)).collect();
    Failure::usage(message, format!("expected one of {}", names.join(", ")))
}

/// A number for each pixel.
fn values(layers: &Layers, name: &str) -> Result<Plane<f32>, Failure> {
    let length = |[x, y, z]: [f32; 3]| (x * x + y * y + z * z).sqrt();
    let light = |picture: &Image| picture.map(luminance);
    if name == BEAUTY {
        return Ok(light(layers.beauty()));
    }
    match layers.get(name) {
        Some(LayerData::Color(picture)) => Ok(light(picture)),
        Some(LayerData::Vector(picture)) => Ok(picture.map(length)),
        Some(LayerData::Scalar(plane) | LayerData::Depth(plane)) => Ok(plane.clone()),
        Some(LayerData::Id(plane)) => Ok(plane.map(|id| id as f32)),
        None => Err(wrong_layer(layers, format!("the picture has no layer `{name}`"))),
    }
}

fn style(values: &Plane<f32>, args: &HeatmapArgs, layer: &str) -> HeatMap {
    let label = if args.log { format!("log10 of {layer}") } else { layer.to_owned() };
    if let Some(range) = args.range {
        return HeatMap { map: ColorMap::Viridis, low: range.low, high: range.high, label };
    }
    if !args.log {
        return HeatMap::magnitude(values, label);
    }
    // Whole powers of ten around the values that are above 0.
    let least = f32::MIN_POSITIVE.log10();
    let finite = values.pixels().iter().copied().filter(|v| v.is_finite() && *v > least);
    let (low, high) = finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    HeatMap { map: ColorMap::Viridis, low: low.floor(), high: high.ceil(), label }
}
