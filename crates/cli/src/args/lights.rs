//! Flags of the VPLs and of choosing among them.

use super::value::negated;
use clap::Args;
use serde::Serialize;

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "VPLs")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct VplFlags {
    /// Nominal probability that a hit of the first pass becomes a VPL, 0 to 1 [default: the scene's, else 0.0001]
    ///
    /// It applies to 512 x 512 pixels with one sample each; other pictures divide it among their camera rays, so that
    /// the number of VPLs does not depend on size and samples. The effective probability is about 30.5 times as high,
    /// as in the original: (floor(p 10^6) + 1) / 32768. More VPLs give smoother indirect light and a brighter picture
    /// (the thesis does not divide by their number): to keep the brightness, lower --vpl-attenuation, a factor on their
    /// light, in proportion.
    #[arg(id = "vpl.probability", long = "vpl-probability", value_name = "P")]
    probability: Option<f32>,
    /// Minimum r + g + b of a hit's colour for it to become a VPL, 0 to 3 [default: the scene's, else 0.7]
    ///
    /// Lower it if dim surfaces should light others too; there will be more VPLs.
    #[arg(id = "vpl.min-illumination", long = "vpl-min-illumination", value_name = "X")]
    min_illumination: Option<f32>,
    /// Factor on every VPL's light [default: the scene's, else 0.075]
    ///
    /// It sets the brightness of all indirect light. Halve it if there are twice as many VPLs.
    #[arg(id = "vpl.attenuation", long = "vpl-attenuation", value_name = "X")]
    attenuation: Option<f32>,
    /// Render the first pass only: direct light, mirrors and refraction; VPLs are placed, for --write-vpls, but not
    /// used [default: false]
    #[arg(id = "vpl.enabled", long = "no-second-pass", value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    #[serde(serialize_with = "negated")]
    enabled: Option<bool>,
}

#[derive(Debug, Default, Args, Serialize)]
#[command(next_help_heading = "Gather")]
#[serde(rename_all = "kebab-case")]
pub(crate) struct GatherFlags {
    /// Which VPLs light a point [default: lightcuts]
    ///
    /// In the thesis' model: `lightcuts`, the VPLs whose relevance reaches --threshold, found through a light tree with
    /// bounds; `lightcuts-exhaustive`, the same VPLs, and so the same picture, found by testing every VPL, to compare
    /// times with; `all`, every VPL, the picture to compare with. In the physical model: `lightcuts`, clusters by error
    /// bound (Walter et al. 2005); `stochastic`, a few VPLs sampled from the tree; `all`; and `auto`, which measures
    /// these three and chooses among them in each tile.
    #[arg(id = "gather.strategy", long = "gather", value_name = "STRATEGY", value_parser = ["all", "lightcuts", "lightcuts-exhaustive", "stochastic", "auto"])]
    strategy: Option<String>,
    /// Minimum relevance of a chosen VPL; not for `--gather all` [default: the scene's, else 0.000001]
    ///
    /// Relevance is intensity x cosine / squared distance, so it depends on the scene's scale. A higher threshold is
    /// faster and darker; the summary's light ratio is the share of VPLs that remain. 0 chooses every VPL.
    #[arg(id = "gather.threshold", long = "threshold", value_name = "X")]
    threshold: Option<f32>,
}
