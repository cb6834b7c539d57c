//! The closed list of metrics, with their names.

use std::fmt;
use std::str::FromStr;

/// A number that says how far a test picture lies from a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Metric {
    /// Pixels with a NaN or an infinity in either picture.
    NonFinite,
    /// Pixels that differ visibly by Perceptual Image Diff.
    PdiffPx,
    /// The verdict of Perceptual Image Diff: 1 passes, 0 fails.
    PdiffPass,
    /// Mean FLIP of the pictures as displayed.
    FlipLdr,
    /// Mean HDR-FLIP of the light.
    FlipHdr,
    /// Mean squared error.
    Mse,
    /// Root of the mean squared error.
    Rmse,
    /// Mean absolute error.
    Mae,
    /// Mean of the squared error over the squared reference.
    RelMse,
    /// Mean of the squared relative error.
    Mrse,
    /// Symmetric mean absolute percentage error, as a fraction.
    Smape,
    /// Structural similarity.
    Ssim,
    /// Peak signal to noise ratio.
    Psnr,
    /// Signed mean difference.
    Bias,
    /// Its magnitude over the mean of the reference.
    RelBias,
    /// Isolated pixels far too bright.
    Fireflies,
}

/// Which values of a metric are the better ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Better {
    /// The smaller, the more alike.
    Lower,
    /// The greater, the more alike.
    Higher,
    /// The nearer to 0, from either side, the more alike.
    NearZero,
}

/// Which plane of a [`Picture`](crate::Picture) a metric reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Linear light.
    Light,
    /// Code values of a display.
    Display,
}

/// A name that no metric has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no metric {name:?}; the metrics are {}, in short {}", Metric::ALL.map(Metric::key).join(", "), short())]
pub struct UnknownMetric {
    /// The name.
    pub name: String,
}

/// The short names with what they are short for.
fn short() -> String {
    Metric::SHORT.map(|(name, metric)| format!("{name} ({metric})")).join(", ")
}

impl Metric {
    /// Every metric, in the order of reports.
    pub const ALL: [Self; 16] = [
        Self::NonFinite,
        Self::PdiffPx,
        Self::PdiffPass,
        Self::FlipLdr,
        Self::FlipHdr,
        Self::Mse,
        Self::Rmse,
        Self::Mae,
        Self::RelMse,
        Self::Mrse,
        Self::Smape,
        Self::Ssim,
        Self::Psnr,
        Self::Bias,
        Self::RelBias,
        Self::Fireflies,
    ];

    /// Short names of the first of each kind.
    pub const SHORT: [(&'static str, Self); 2] = [("flip", Self::FlipLdr), ("pdiff", Self::PdiffPx)];

    /// The name in commands and in JSON.
    pub fn key(self) -> &'static str {
        match self {
            Self::NonFinite => "non_finite",
            Self::PdiffPx => "pdiff_px",
            Self::PdiffPass => "pdiff_pass",
            Self::FlipLdr => "flip_ldr",
            Self::FlipHdr => "flip_hdr",
            Self::Mse => "mse",
            Self::Rmse => "rmse",
            Self::Mae => "mae",
            Self::RelMse => "relmse",
            Self::Mrse => "mrse",
            Self::Smape => "smape",
            Self::Ssim => "ssim",
            Self::Psnr => "psnr",
            Self::Bias => "bias",
            Self::RelBias => "relbias",
            Self::Fireflies => "fireflies",
        }
    }

    /// The name in tables.
    pub fn title(self) -> &'static str {
        match self {
            Self::NonFinite => "Non-finite pixels",
            Self::PdiffPx => "Perceptual Image Diff",
            Self::PdiffPass => "Perceptual Image Diff verdict",
            Self::FlipLdr => "FLIP",
            Self::FlipHdr => "HDR-FLIP",
            Self::Mse => "MSE",
            Self::Rmse => "RMSE",
            Self::Mae => "MAE",
            Self::RelMse => "relMSE",
            Self::Mrse => "MRSE",
            Self::Smape => "SMAPE",
            Self::Ssim => "SSIM",
            Self::Psnr => "PSNR",
            Self::Bias => "Bias",
            Self::RelBias => "Relative bias",
            Self::Fireflies => "Fireflies",
        }
    }

    /// One sentence: what it is, its unit and its source.
    pub fn summary(self) -> &'static str {
        match self {
            Self::NonFinite => "Number of pixels with a NaN or an infinity, in both pictures together.",
            Self::PdiffPx => "Number of pixels whose difference a viewer would see (Yee 2004).",
            Self::PdiffPass => "1 where fewer pixels than the threshold differ visibly, else 0 (Yee 2004).",
            Self::FlipLdr => {
                "Mean difference seen when flipping between the displayed pictures, 0 to 1 (Andersson et al. 2020)."
            }
            Self::FlipHdr => {
                "Mean over pixels of the greatest FLIP over a range of exposures, 0 to 1 (Andersson et al. 2021)."
            }
            Self::Mse => {
                "Mean squared difference of light over channels and pixels, in the square of the light's unit."
            }
            Self::Rmse => "Root of the mean squared difference, in the unit of the light.",
            Self::Mae => "Mean absolute difference, in the unit of the light.",
            Self::RelMse => "Mean of difference^2 / (reference^2 + 0.01), a ratio (Rousselle et al. 2011).",
            Self::Mrse => {
                "Mean of (difference / (reference + 0.01))^2, a ratio (mean relative squared error as in pbrt)."
            }
            Self::Smape => "Mean of |difference| / (|reference| + |test| + 0.01), 0 to 1 (as in Vogels et al. 2018).",
            Self::Ssim => "Structural similarity of the displayed pictures, up to 1 for equal ones (Wang et al. 2004).",
            Self::Psnr => {
                "10 log10 (1 / mean squared difference of code values in 0..1), in dB; infinite for equal pictures."
            }
            Self::Bias => "Signed mean of test - reference, in the unit of the light; with z-tests over regions.",
            Self::RelBias => "|mean of test - reference| / mean of |reference|, a ratio; 1 for twice the light.",
            Self::Fireflies => "Number of isolated pixels far brighter than the reference and than their neighbours.",
        }
    }

    /// The unit of the value; empty for ratios.
    pub fn unit(self) -> &'static str {
        match self {
            Self::NonFinite | Self::PdiffPx | Self::Fireflies => "px",
            Self::Psnr => "dB",
            Self::Mse => "light^2",
            Self::Rmse | Self::Mae | Self::Bias => "light",
            Self::PdiffPass
            | Self::FlipLdr
            | Self::FlipHdr
            | Self::RelMse
            | Self::Mrse
            | Self::Smape
            | Self::Ssim
            | Self::RelBias => "",
        }
    }

    /// Which values are the better ones.
    pub fn better(self) -> Better {
        match self {
            Self::PdiffPass | Self::Ssim | Self::Psnr => Better::Higher,
            Self::Bias => Better::NearZero,
            _ => Better::Lower,
        }
    }

    /// Which plane of a picture it reads.
    pub fn domain(self) -> Domain {
        match self {
            Self::PdiffPx | Self::PdiffPass | Self::FlipLdr | Self::Ssim | Self::Psnr => Domain::Display,
            _ => Domain::Light,
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.key())
    }
}

impl FromStr for Metric {
    type Err = UnknownMetric;

    /// A metric by its key or its short name.
    fn from_str(name: &str) -> Result<Self, UnknownMetric> {
        let mut named = Self::ALL.map(|metric| (metric.key(), metric)).into_iter().chain(Self::SHORT);
        let found = named.find(|(known, _)| *known == name).map(|(_, metric)| metric);
        found.ok_or_else(|| UnknownMetric { name: name.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_the_commands_and_lead_back_to_their_metrics() {
        let keys = "non_finite, pdiff_px, pdiff_pass, flip_ldr, flip_hdr, mse, rmse, mae, relmse, mrse, smape, ssim, \
                    psnr, bias, relbias, fireflies";
        assert_eq!(Metric::ALL.map(Metric::key).join(", "), keys);
        for metric in Metric::ALL {
            assert_eq!(metric.to_string().parse(), Ok(metric));
        }
        assert_eq!("flip".parse(), Ok(Metric::FlipLdr));
        assert_eq!("pdiff".parse(), Ok(Metric::PdiffPx));
        let error = "ssimm".parse::<Metric>().unwrap_err().to_string();
        assert_eq!(
            error,
            format!("there is no metric \"ssimm\"; the metrics are {keys}, in short flip (flip_ldr), pdiff (pdiff_px)")
        );
    }

    #[test]
    fn the_list_has_the_order_of_the_enum() {
        assert!(Metric::ALL.is_sorted());
    }
}
