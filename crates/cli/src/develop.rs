//! The command `develop`: a PNG of the light of a finished picture, without rendering.

use crate::args::DevelopArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use crate::job::{VERSION_ATTRIBUTE, require_picture, resolve};
use crate::outputs::check_png;
use crate::render::start_threads;
use lightcuts::Settings;
use lightcuts::image::{self, Exposure, Image, Light, LightOptions};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Runs the command.
pub(crate) fn run(args: &DevelopArgs) -> Result<Exit, Failure> {
    start_threads(&args.threads)?;
    let mut settings = resolve(&Settings::for_physical(), &[], &args.flags.settings())?;
    require_picture(&args.picture)?;
    let output = args.output.clone().unwrap_or_else(|| default_output(args));
    check_png(&output, &args.picture, "picture")?;
    let options = LightOptions { layer: args.layer.as_deref(), ..LightOptions::default() };
    let light = image::read_light(&args.picture, &options).map_err(Failure::input)?;
    warn(&args.picture, &light);
    let bloom = &settings.bloom;
    let light = if bloom.enabled { image::bloom(&light.image, bloom.radius, bloom.weight) } else { light.image };
    let is_automatic = settings.display.exposure == Exposure::Auto;
    let factor = settings.display.exposure.factor(&light);
    settings.display.exposure = Exposure::Factor(factor);
    let shown = settings.display.develop(&light);
    let texts = [(VERSION_ATTRIBUTE, env!("CARGO_PKG_VERSION"))];
    image::write_png_with_text(&output, &shown, settings.display.transfer, &texts).map_err(Failure::output)?;
    if !args.quiet {
        console::print(summary(args, factor, is_automatic, &shown, &output).as_bytes())?;
    }
    Ok(Exit::Done)
}

fn default_output(args: &DevelopArgs) -> PathBuf {
    let stem = args.picture.file_stem().unwrap_or("picture".as_ref()).to_string_lossy();
    PathBuf::from(format!("{stem}.png"))
}

/// Says how the numbers were taken, and which of them are none.
fn warn(path: &Path, light: &Light) {
    let window = (!light.frame.is_whole()).then(|| format!("its pixels are {}; the rest is left out", light.frame));
    let broken = light.image.pixels().iter().filter(|pixel| !pixel.iter().all(|value| value.is_finite())).count();
    let broken = (broken > 0).then(|| format!("{broken} of its pixels hold a NaN or an infinity"));
    for remark in light.remarks.iter().chain(&window).chain(&broken) {
        console::warn(&format!("{}: {remark}", path.display()));
    }
}

fn summary(args: &DevelopArgs, factor: f32, is_automatic: bool, shown: &Image, output: &Path) -> String {
    let pixels = shown.pixels();
    let share = |is_above: fn(&&[f32; 3]) -> bool| {
        100.0 * pixels.iter().filter(is_above).count() as f64 / pixels.len().max(1) as f64
    };
    let white = share(|pixel| pixel.iter().all(|value| *value > 1.0));
    let clipped = share(|pixel| pixel.iter().any(|value| *value > 1.0));
    let automatic = if is_automatic { " (auto)" } else { "" };
    let mut text = String::new();
    // Writing to a String cannot fail.
    let mut line = |name: &str, value: &str| {
        let _ = writeln!(text, "{name:<12} {value}");
    };
    line("picture", &format!("{}, {} x {}", args.picture.display(), shown.width(), shown.height()));
    line("exposure", &format!("{factor}{automatic}"));
    line("above white", &format!("{white:.2} % of the pixels; {clipped:.2} % in at least one channel"));
    line("wrote", &output.display().to_string());
    text
}
