//! Flags of ambient occlusion and caustics.

use clap::Args;
use serde::Serialize;

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Ambient occlusion")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct AmbientOcclusionFlags {
    /// Darken corners and crevices in the first pass [default: false]
    #[arg(id = "ambient-occlusion.enabled", long = "ao", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    enabled: Option<bool>,
    /// Half angle of the cone of rays around the normal, in degrees, 0 to 90 [default: 50]
    ///
    /// A narrow cone darkens only what is covered from above.
    #[arg(id = "ambient-occlusion.angle", long = "ao-angle", value_name = "DEGREES")]
    angle: Option<f32>,
    /// Step of the grid of rays in degrees: (2 angle / step + 1)^2 rays per hit [default: 4]
    ///
    /// Half the step means less noise and four times as many rays.
    #[arg(id = "ambient-occlusion.step", long = "ao-step", value_name = "DEGREES")]
    step: Option<f32>,
    /// Distance beyond which surfaces do not occlude, in scene units [default: 90]
    ///
    /// The default suits rooms of about 400 units; scale it with the room.
    #[arg(id = "ambient-occlusion.range", long = "ao-range", value_name = "UNITS")]
    range: Option<f32>,
    /// Factor on the result; above 1 brightens open areas [default: 1]
    #[arg(id = "ambient-occlusion.factor", long = "ao-factor", value_name = "X")]
    factor: Option<f32>,
}

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Caustics")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct CausticsFlags {
    /// Render caustics by photon mapping [default: false]
    ///
    /// In the thesis' model, photons are shot at mirrors and glass and gathered in the second pass. In the physical
    /// model, every pass shoots new photons from all lights, and the gather radius shrinks from pass to pass
    /// (progressive photon mapping).
    #[arg(id = "caustics.enabled", long = "caustics", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    enabled: Option<bool>,
    /// Spacing of the photons on the disk across the bounding sphere of an object that photons are shot at, in scene
    /// units [default: 1]
    ///
    /// Half the spacing means finer caustics and four times as many photons.
    #[arg(id = "caustics.step", long = "caustics-step", value_name = "UNITS")]
    step: Option<f32>,
    /// Radius within which photons are gathered, in scene units [default: 4]
    ///
    /// A larger radius gives smoother and blurrier caustics.
    #[arg(id = "caustics.radius", long = "caustics-radius", value_name = "UNITS")]
    radius: Option<f32>,
    /// Minimum number of photons within the radius; fewer are ignored [default: 10]
    #[arg(id = "caustics.min-photons", long = "caustics-min-photons", value_name = "N")]
    min_photons: Option<u32>,
    /// Minimum mirror ratio F of the objects that photons are shot at [default: 0.2]
    #[arg(id = "caustics.min-reflection", long = "caustics-min-reflection", value_name = "X")]
    min_reflection: Option<f32>,
    /// Minimum refraction ratio R of the objects that photons are shot at [default: 0.1]
    #[arg(id = "caustics.min-refraction", long = "caustics-min-refraction", value_name = "X")]
    min_refraction: Option<f32>,
    /// Minimum r + g + b of a diffuse colour on which photons are stored [default: 0.9]
    ///
    /// Lower it if caustics are missing on dark surfaces.
    #[arg(id = "caustics.min-diffuse", long = "caustics-min-diffuse", value_name = "X")]
    min_diffuse: Option<f32>,
}
