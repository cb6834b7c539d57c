//! How a job's picture differs from those of its references.

use super::pictures::{self, flip_map_name};
use super::{RunError, Watch};
use crate::plan::{Plan, PlannedJob};
use crate::record::{ComparisonRow, Row};
use lightcuts::image::metrics::{Comparison, Metric, compare};
use lightcuts::image::{HeatMap, Picture, Transfer, heat_map, write_png};
use std::collections::BTreeMap;
use std::path::Path;

/// Measures `test` against the picture of a finished reference and writes the map of FLIP.
pub(super) fn with_reference(
    plan: &Plan,
    directory: &Path,
    job: &PlannedJob,
    test: &Picture,
    reference: (&PlannedJob, &Row),
    watch: &dyn Watch,
) -> Result<ComparisonRow, RunError> {
    let (reference_job, reference_row) = reference;
    let name = &reference_job.configuration;
    let reference = pictures::read(&directory.join(&reference_row.exr), &reference_job.settings.display)?;
    // The map is shown whether or not the mean of it is.
    let mut metrics = plan.metrics.clone();
    metrics.push(Metric::FlipLdr);
    let told = |metric| watch.compares(name, metric);
    let comparison = compare(&reference, test, &metrics, &plan.metric_options, &told)?;
    let flip_map = flip_map_name(job, name);
    if let Some(flip) = &comparison.flip_ldr {
        let style = HeatMap::flip(format!("FLIP, {} against {name}", job.configuration));
        write_png(directory.join(&flip_map), &heat_map(&flip.map, &style), Transfer::Linear)?;
    }
    Ok(ComparisonRow { metrics: values(&comparison, &plan.metrics), flip_map })
}

/// The values of metrics by key. JSON has no number for infinity; `null` stands for it.
fn values(comparison: &Comparison, metrics: &[Metric]) -> BTreeMap<String, Option<f64>> {
    let value = |metric: &Metric| comparison.value(*metric).filter(|value| value.is_finite());
    metrics.iter().map(|metric| (metric.key().to_owned(), value(metric))).collect()
}
