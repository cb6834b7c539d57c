//! Flags of ambient occlusion and caustics.

use clap::Args;
use serde::Serialize;

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Ambient occlusion")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct AmbientOcclusionFlags {
    /// Darken corners and crevices in the first pass [default: false]
    #[arg(id = "ao", long = "ao", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    enabled: Option<bool>,
    /// Half angle of the cone of rays about the normal, in degrees, 0 to 90 [default: 50]
    ///
    /// A narrow cone darkens only what is covered from above.
    #[arg(id = "ao-angle", long = "ao-angle", value_name = "DEGREES")]
    angle: Option<f32>,
    /// Step of the grid of rays in degrees: (2 angle / step + 1)^2 rays per hit [default: 4]
    ///
    /// Halve it against noise: four times as many rays.
    #[arg(id = "ao-step", long = "ao-step", value_name = "DEGREES")]
    step: Option<f32>,
    /// Distance from which on a surface no longer occludes, in scene units [default: 90]
    ///
    /// The default suits rooms of about 400 units; keep the proportion.
    #[arg(id = "ao-range", long = "ao-range", value_name = "UNITS")]
    range: Option<f32>,
    /// Factor on the result; above 1 brightens what is open [default: 1]
    #[arg(id = "ao-factor", long = "ao-factor", value_name = "X")]
    factor: Option<f32>,
}

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Caustics")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct CausticsFlags {
    /// Shoot photons at mirrors and glass and gather them in the second pass [default: false]
    ///
    /// In the physical model: photons of all lights, anew in each pass, gathered in disks that shrink. The options below
    /// do not matter there.
    #[arg(id = "caustics", long = "caustics", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    enabled: Option<bool>,
    /// Spacing of the photons on the disk through a target's bounding sphere, in scene units [default: 1]
    ///
    /// Halve it for finer caustics: four times as many photons.
    #[arg(id = "caustics-step", long = "caustics-step", value_name = "UNITS")]
    step: Option<f32>,
    /// Radius within which photons are gathered, in scene units [default: 4]
    ///
    /// Larger is smoother and more blurred.
    #[arg(id = "caustics-radius", long = "caustics-radius", value_name = "UNITS")]
    radius: Option<f32>,
    /// Fewest photons within the radius that count [default: 10]
    #[arg(id = "caustics-min-photons", long = "caustics-min-photons", value_name = "N")]
    min_photons: Option<u32>,
    /// Least mirror ratio F of an object to be shot at [default: 0.2]
    #[arg(id = "caustics-min-reflection", long = "caustics-min-reflection", value_name = "X")]
    min_reflection: Option<f32>,
    /// Least refraction ratio R of an object to be shot at [default: 0.1]
    #[arg(id = "caustics-min-refraction", long = "caustics-min-refraction", value_name = "X")]
    min_refraction: Option<f32>,
    /// Least r + g + b of a diffuse colour that catches photons [default: 0.9]
    ///
    /// Lower it if caustics are missing from dark surfaces.
    #[arg(id = "caustics-min-diffuse", long = "caustics-min-diffuse", value_name = "X")]
    min_diffuse: Option<f32>,
}
