//! Flags of bloom and of the picture for eyes.

use clap::Args;
use lightcuts::image::Exposure;
use serde::Serialize;

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Bloom")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct BloomFlags {
    /// Let bright places glow, in EXR and PNG [default: false]
    #[arg(id = "bloom", long = "bloom", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    enabled: Option<bool>,
    /// Radius of the glow in pixels, 0 to 1024; grows with the picture's size to look the same [default: 12]
    #[arg(id = "bloom-radius", long = "bloom-radius", value_name = "PIXELS")]
    radius: Option<f32>,
    /// Share of the blurred picture, 0 to 1 [default: 0.7]
    #[arg(id = "bloom-weight", long = "bloom-weight", value_name = "X")]
    weight: Option<f32>,
}

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Display")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct DisplayFlags {
    /// Factor on the light of a PNG, or `auto` [default: 1]
    ///
    /// A plain factor, not stops: 2 is twice as bright. With 1 a radiance of 1 is white. `auto`: the geometric mean of the
    /// picture's luminance becomes middle grey, 0.18, without the darkest and the brightest twentieth of what is lit.
    #[arg(long, value_name = "FACTOR")]
    exposure: Option<Exposure>,
    /// Compress brightness for PNG; an EXR always holds linear light [default: none]
    ///
    /// `none`: values as they are, as the thesis shows them; above 1 is white. `global`: one curve for the whole picture.
    /// `local`: a curve per pixel that keeps local contrast (Reinhard et al. 2002).
    #[arg(long, value_parser = ["none", "global", "local"])]
    tone_mapping: Option<String>,
    /// Transfer curve of PNG values [default: linear; srgb of the physical model and of develop]
    ///
    /// `linear` stores values as they are, as the thesis shows its pictures. `srgb` is what displays expect of light: brighter
    /// mid-tones.
    #[arg(long, value_parser = ["linear", "srgb"])]
    transfer: Option<String>,
    #[command(flatten)]
    global: GlobalFlags,
    #[command(flatten)]
    local: LocalFlags,
}

#[derive(Debug, Default, Args, Serialize)]
#[serde(rename_all = "kebab-case")]
struct GlobalFlags {
    /// `--tone-mapping global`: luminance of the display's white in cd/m^2; higher is darker [default: 683]
    #[arg(id = "global-luminance", long = "global-luminance", value_name = "X")]
    max_display_luminance: Option<f32>,
}

#[derive(Debug, Default, Args, Serialize)]
#[serde(rename_all = "kebab-case")]
struct LocalFlags {
    /// `--tone-mapping local`: the grey that the mean becomes; higher is brighter [default: 0.18]
    #[arg(id = "local-key", long = "local-key", value_name = "X")]
    key: Option<f32>,
    /// `--tone-mapping local`: sharpening; higher prefers small surroundings [default: 8]
    #[arg(id = "local-phi", long = "local-phi", value_name = "X")]
    phi: Option<f32>,
    /// `--tone-mapping local`: number of sizes of surroundings, 1 to 24 [default: 8]
    #[arg(id = "local-scales", long = "local-scales", value_name = "N")]
    scales: Option<u32>,
    /// `--tone-mapping local`: ratio of one size to the one before, above 1 to 4 [default: 1.6]
    #[arg(id = "local-ratio", long = "local-ratio", value_name = "X")]
    ratio: Option<f32>,
    /// `--tone-mapping local`: greatest difference that still counts as even [default: 0.05]
    #[arg(id = "local-epsilon", long = "local-epsilon", value_name = "X")]
    epsilon: Option<f32>,
}
