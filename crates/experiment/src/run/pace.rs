//! How long jobs take, from those that are finished.

use super::Standing;
use crate::plan::{Plan, PlannedJob};
use crate::record::Row;
use std::collections::HashMap;
use std::time::Duration;

/// Mean times of finished jobs, by how much a job has in common with them.
#[derive(Debug, Default)]
pub(super) struct Pace {
    means: HashMap<Alike, (Duration, u32)>,
}

/// What jobs have in common, the more the better: scene, configuration, point.
type Alike = (Option<String>, Option<String>, Option<String>);

impl Pace {
    /// From rows of earlier sessions, which do not include the time of comparisons.
    pub(super) fn of<'r>(rows: impl Iterator<Item = &'r Row>) -> Self {
        let mut pace = Self::default();
        for row in rows {
            pace.add(row, Duration::try_from_secs_f64(row.stats.total_wall_s).unwrap_or_default());
        }
        pace
    }

    /// A job took `time`, its comparisons included.
    pub(super) fn add(&mut self, row: &Row, time: Duration) {
        for alike in alike(&row.scene, &row.configuration, row.point.as_ref()) {
            let (sum, count) = self.means.entry(alike).or_default();
            *sum = sum.saturating_add(time);
            *count += 1;
        }
    }

    /// Where the next of the jobs `todo` stands when `done` of them are finished.
    pub(super) fn standing(&self, plan: &Plan, todo: &[usize], done: usize) -> Standing {
        let expected = |jobs: &[usize]| self.expected(jobs.iter().map(|&i| &plan.jobs[i]));
        let (this, later) = (expected(&todo[done..=done]), expected(&todo[done + 1..]));
        Standing { number: done + 1, of: todo.len(), this, later }
    }

    /// Time that jobs will probably take; unknown while nothing is finished.
    fn expected<'j>(&self, jobs: impl Iterator<Item = &'j PlannedJob>) -> Option<Duration> {
        jobs.map(|job| {
            let alike = alike(&job.scene_name, &job.configuration, job.point.as_ref());
            let (sum, count) = alike.iter().find_map(|alike| self.means.get(alike))?;
            Some(*sum / *count)
        })
        .sum()
    }
}

/// From the nearest to the farthest relatives.
fn alike(scene: &str, configuration: &str, point: Option<&String>) -> [Alike; 4] {
    let (scene, configuration) = (Some(scene.to_owned()), Some(configuration.to_owned()));
    [
        (scene.clone(), configuration.clone(), point.cloned()),
        (scene.clone(), configuration, None),
        (scene, None, None),
        (None, None, None),
    ]
}
