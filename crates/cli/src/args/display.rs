//! Flags of bloom and of how PNGs are displayed.

use clap::Args;
use lightcuts::image::Exposure;
use serde::Serialize;

#[derive(Debug, Default, Clone, Args, Serialize)]
#[command(next_help_heading = "Bloom")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct BloomFlags {
    /// Add a glow around bright areas, before tone mapping [default: false]
    #[arg(id = "bloom.enabled", long = "bloom", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    enabled: Option<bool>,
    /// Radius of the glow in pixels, 0 to 1024; scale it with the picture to keep the look [default: 12]
    #[arg(id = "bloom.radius", long = "bloom-radius", value_name = "PIXELS")]
    radius: Option<f32>,
    /// Weight of the blurred picture, 0 to 1 [default: 0.7]
    #[arg(id = "bloom.weight", long = "bloom-weight", value_name = "X")]
    weight: Option<f32>,
}

#[derive(Debug, Default, Clone, Args, Serialize)]
#[command(next_help_heading = "Display")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct DisplayFlags {
    /// Factor on the light of a PNG, or `auto` [default: 1]
    ///
    /// A plain factor, not stops: 2 is twice as bright. With 1 a radiance of 1 is white. `auto` maps the geometric mean
    /// luminance, ignoring the darkest and brightest 5 % of lit pixels, to middle grey (0.18).
    #[arg(id = "display.exposure", long = "exposure", value_name = "FACTOR")]
    exposure: Option<Exposure>,
    /// Tone mapping operator for PNG; an EXR always holds linear light [default: none]
    ///
    /// `none`: values as they are; above 1 is clipped to white. `global`: one curve for the whole picture (the
    /// thesis'). `local`: a curve per pixel that preserves local contrast (Reinhard et al. 2002).
    #[arg(id = "display.tone-mapping", long = "tone-mapping", value_name = "OPERATOR", value_parser = ["none", "global", "local"])]
    tone_mapping: Option<String>,
    /// Transfer function of PNG values [default: thesis linear, physical srgb]
    ///
    /// `linear` stores values as they are, as the thesis shows its pictures. `srgb` encodes light for displays:
    /// brighter mid-tones.
    #[arg(id = "display.transfer", long = "transfer", value_name = "CURVE", value_parser = ["linear", "srgb"])]
    transfer: Option<String>,
    #[command(flatten)]
    global: GlobalFlags,
    #[command(flatten)]
    local: LocalFlags,
}

#[derive(Debug, Default, Clone, Args, Serialize)]
#[serde(rename_all = "kebab-case")]
struct GlobalFlags {
    /// With `--tone-mapping global`: peak luminance of the display in cd/m^2; higher is darker [default: 683]
    #[arg(id = "display.global.max-display-luminance", long = "global-luminance", value_name = "X")]
    max_display_luminance: Option<f32>,
}

#[derive(Debug, Default, Clone, Args, Serialize)]
#[serde(rename_all = "kebab-case")]
struct LocalFlags {
    /// With `--tone-mapping local`: key value, what the log-average luminance is scaled to before the curve; higher is
    /// brighter [default: 0.18]
    #[arg(id = "display.local.key", long = "local-key", value_name = "X")]
    key: Option<f32>,
    /// With `--tone-mapping local`: sharpening; higher favours small neighbourhoods [default: 8]
    #[arg(id = "display.local.phi", long = "local-phi", value_name = "X")]
    phi: Option<f32>,
    /// With `--tone-mapping local`: number of neighbourhood sizes, 1 to 24 [default: 8]
    #[arg(id = "display.local.scales", long = "local-scales", value_name = "N")]
    scales: Option<u32>,
    /// With `--tone-mapping local`: ratio of each size to the previous one, above 1, at most 4 [default: 1.6]
    #[arg(id = "display.local.ratio", long = "local-ratio", value_name = "X")]
    ratio: Option<f32>,
    /// With `--tone-mapping local`: contrast up to which a neighbourhood counts as uniform [default: 0.05]
    #[arg(id = "display.local.epsilon", long = "local-epsilon", value_name = "X")]
    epsilon: Option<f32>,
}
