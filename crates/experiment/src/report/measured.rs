//! The rows that count, by scene, configuration and point, and their means.

use crate::layout::Time;
use crate::record::{ConfigurationInfo, Header, Row, SceneInfo};
use crate::results::Results;
use lightcuts::Stage;
use std::collections::HashSet;

/// A header with the rows that it asks for.
#[derive(Debug)]
pub(super) struct Measured<'a> {
    pub(super) header: &'a Header,
    /// Those of one scene, configuration and point in the order of seed and run.
    rows: Vec<&'a Row>,
}

/// What there is of a configuration in a scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Found<'a> {
    /// Its rows; never empty.
    Rows(Vec<&'a Row>),
    /// There is no such device, for this reason.
    Absent(&'a str),
    /// It is planned, but was not rendered yet.
    Pending,
    /// It is not planned.
    Unplanned,
}

/// Several values of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    pub(super) mean: f64,
    pub(super) least: f64,
    pub(super) greatest: f64,
    pub(super) count: usize,
}

impl Spread {
    /// Of values in a fixed order; `None` without any.
    pub(super) fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let count = values.len();
        (count > 0).then(|| Self {
            mean: values.iter().sum::<f64>() / count as f64,
            least: values.iter().copied().fold(f64::INFINITY, f64::min),
            greatest: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            count,
        })
    }
}

impl<'a> Measured<'a> {
    /// Of the last header: rows that are not of its jobs are of earlier plans.
    pub(super) fn new(header: &'a Header, results: &'a Results) -> Self {
        let jobs: HashSet<&str> = header.jobs.iter().map(|job| job.job.as_str()).collect();
        let counts = |row: &&Row| jobs.contains(row.job.as_str()) && row.stats.complete;
        let mut rows: Vec<&Row> = results.current().into_values().filter(counts).collect();
        rows.sort_by(|a, b| a.key().cmp(&b.key()));
        Self { header, rows }
    }

    /// Every row that counts.
    pub(super) fn rows(&self) -> &[&'a Row] {
        &self.rows
    }

    /// The points at which a scene is rendered, in the order of the sweep; a single `None` without one.
    pub(super) fn points(&self, scene: &SceneInfo) -> Vec<Option<&'a str>> {
        let jobs: HashSet<Option<&str>> =
            self.header.jobs.iter().filter(|job| job.scene == scene.name).map(|job| job.point.as_deref()).collect();
        let points = self.header.points.iter().map(|point| Some(point.as_str()));
        let points: Vec<Option<&str>> = points.filter(|point| jobs.contains(point)).collect();
        if points.is_empty() { vec![None] } else { points }
    }

    /// The last point of the sweep: as a rule the one with most VPLs.
    pub(super) fn last_point(&self, scene: &SceneInfo) -> Option<&'a str> {
        self.points(scene).pop().flatten()
    }

    /// The scene of this name; the message says that there is none.
    pub(super) fn scene(&self, name: &str) -> Result<&'a SceneInfo, String> {
        let found = self.header.scenes.iter().find(|scene| scene.name == name);
        found.ok_or_else(|| format!("it names the scene `{name}`, which the experiment does not have"))
    }

    /// The configuration of this name; the message says that there is none.
    pub(super) fn configuration(&self, name: &str) -> Result<&'a ConfigurationInfo, String> {
        let found = self.header.configurations.iter().find(|configuration| configuration.name == name);
        found.ok_or_else(|| format!("it names the configuration `{name}`, which the experiment does not have"))
    }

    /// The configurations of these names.
    pub(super) fn configurations(&self, names: &[String]) -> Result<Vec<&'a ConfigurationInfo>, String> {
        names.iter().map(|name| self.configuration(name)).collect()
    }

    /// The rows of a configuration in a scene at a point.
    pub(super) fn find(
        &self,
        scene: &SceneInfo,
        configuration: &'a ConfigurationInfo,
        point: Option<&str>,
    ) -> Found<'a> {
        let fits =
            |name: &str, of: &str, at: Option<&str>| name == scene.name && of == configuration.name && at == point;
        let of_it = |row: &&&Row| fits(&row.scene, &row.configuration, row.point.as_deref());
        let rows: Vec<&Row> = self.rows.iter().filter(of_it).copied().collect();
        let mut jobs = self.header.jobs.iter();
        if !rows.is_empty() {
            Found::Rows(rows)
        } else if let Some(reason) = &configuration.absent {
            Found::Absent(reason)
        } else if jobs.any(|job| fits(&job.scene, &job.configuration, job.point.as_deref())) {
            Found::Pending
        } else {
            Found::Unplanned
        }
    }
}

impl<'a> Found<'a> {
    /// The rows, or none.
    pub(super) fn rows(&self) -> &[&'a Row] {
        match self {
            Self::Rows(rows) => rows,
            _ => &[],
        }
    }

    /// The word in place of a figure, where there is none.
    pub(super) fn word(&self) -> &'static str {
        match self {
            Self::Rows(_) | Self::Unplanned => "-",
            Self::Absent(_) => "absent",
            Self::Pending => "not yet",
        }
    }

    /// Why there are no figures, for a note.
    pub(super) fn note(&self) -> Option<String> {
        match self {
            Self::Absent(reason) => Some(format!("Absent: {reason}.")),
            Self::Pending => Some("Not rendered yet; lightcuts experiment continues where it stopped.".to_owned()),
            Self::Rows(_) | Self::Unplanned => None,
        }
    }

    /// Over the rows.
    pub(super) fn spread(&self, quantity: impl Fn(&Row) -> f64) -> Option<Spread> {
        Spread::of(self.rows().iter().map(|row| quantity(row)))
    }
}

/// A time of a render: processor seconds over all threads and elapsed seconds.
pub(super) fn seconds(row: &Row, time: Time) -> (f64, f64) {
    let mut sum = (0.0, 0.0);
    for pass in &row.stats.passes {
        let is_first = pass.name == Stage::FirstPass.name();
        if time == Time::Total || is_first == (time == Time::FirstPass) {
            sum = (sum.0 + pass.cpu_s, sum.1 + pass.wall_s);
        }
    }
    sum
}

/// What was rendered in place of a scene, for a note.
pub(super) fn stand_in_note(scene: &SceneInfo) -> Option<String> {
    let said = scene.stand_in.as_ref()?;
    Some(format!("{} is a stand-in: {said}. Its figures cannot be compared with published ones.", scene.title))
}
