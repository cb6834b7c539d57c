//! How far two pictures differ.
//!
//! [`compare`] measures a test [`Picture`](crate::Picture) against a reference with any of the [`Metric`]s, each of
//! which reads the linear light or the code values of the display ([`Metric::domain`]). The parts can be used alone:
//! the error sums of [`deviation`], [`ssim`](fn@ssim), [`PerceptualDiff`], [`flip`], [`Bias`], [`count_fireflies`].
//!
//! Everything runs on all cores and gives the same bits on any number of them: rows are summed in f64 and the rows'
//! sums added from the top. Pictures without pixels differ by 0; sizes that differ are
//! [`ImageError::SizeMismatch`](crate::ImageError::SizeMismatch).

mod bias;
mod comparison;
pub mod deviation;
pub mod difference;
mod fireflies;
pub mod flip;
mod metric;
mod non_finite;
mod pdiff;
mod ssim;

pub use bias::{Bias, Region, RegionTest};
pub use comparison::{Comparison, Measured, MetricOptions, compare};
pub use fireflies::count_fireflies;
pub use metric::{Better, Domain, Metric, UnknownMetric};
pub use non_finite::NonFinite;
pub use pdiff::{PdiffOutcome, PerceptualDiff};
pub use ssim::ssim;
