//! Progress of a whole experiment on standard error, in three styles, and cancellation by signals.

use super::text::title;
use crate::args::ProgressStyle;
use crate::progress::{JSON_PAUSE, chosen_style, tell_note};
use crate::{console, interrupt};
use indicatif::{ProgressBar, ProgressStyle as BarStyle};
use lightcuts::image::metrics::Metric;
use lightcuts::{Monitor, Stage};
use lightcuts_experiment::plan::PlannedJob;
use lightcuts_experiment::record::Row;
use lightcuts_experiment::run::{Standing, Watch};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Least time between two looks of the bar.
const BAR_PAUSE: Duration = Duration::from_millis(100);

/// Watches an experiment for the person, or the program, at the other end of standard error.
pub(super) struct Progress {
    style: ProgressStyle,
    state: Mutex<State>,
}

struct State {
    /// The current job, its run, and where it stands; none before the first.
    job: Option<(PlannedJob, Standing)>,
    /// When the experiment and the current job began.
    start: Instant,
    job_start: Instant,
    /// What is being done, for programs and for people.
    stage: String,
    label: String,
    done: u64,
    total: u64,
    told: Instant,
    bar: ProgressBar,
}

impl Progress {
    /// The style asked for, else as for a render.
    pub(super) fn new(style: Option<ProgressStyle>, quiet: bool, logs: bool) -> Self {
        let now = Instant::now();
        let state = State {
            job: None,
            start: now,
            job_start: now,
            stage: String::new(),
            label: String::new(),
            done: 0,
            total: 0,
            told: now,
            bar: ProgressBar::hidden(),
        };
        Self { style: chosen_style(style, quiet, logs), state: Mutex::new(state) }
    }

    /// Leaves the line to what comes after.
    pub(super) fn finish(&self) {
        self.with(|state| state.bar.finish_and_clear());
    }

    /// A panic elsewhere does not make the numbers wrong, so a poisoned lock is as good as any.
    fn with(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// A stage, or what comes after the last one, begins.
    fn stage(&self, stage: String, label: String, total: u64) {
        self.with(|state| {
            (state.stage, state.label, state.done, state.total) = (stage, label, 0, total);
            match self.style {
                ProgressStyle::Bar => state.show_bar(),
                ProgressStyle::Json => state.tell_json(),
                ProgressStyle::Plain | ProgressStyle::None => {}
            }
        });
    }
}

impl Monitor for Progress {
    fn begin(&self, stage: Stage, steps: u64) {
        self.stage(stage.name().to_owned(), stage.name().replace('_', " "), steps);
    }

    fn advance(&self) {
        self.with(|state| {
            state.done += 1;
            match self.style {
                ProgressStyle::Bar if state.told.elapsed() >= BAR_PAUSE => state.show_bar(),
                ProgressStyle::Json if state.told.elapsed() >= JSON_PAUSE => state.tell_json(),
                _ => {}
            }
        });
    }

    fn note(&self, text: &str) {
        tell_note(self.style, text);
    }

    fn cancelled(&self) -> bool {
        interrupt::came()
    }
}

impl Watch for Progress {
    fn job_begins(&self, job: &PlannedJob, standing: &Standing) {
        self.with(|state| {
            state.job = Some((job.clone(), *standing));
            state.job_start = Instant::now();
            (state.stage, state.label, state.done, state.total) = Default::default();
            match self.style {
                ProgressStyle::Bar => state.begin_bar(standing),
                ProgressStyle::Plain => console::note(&state.line(standing)),
                ProgressStyle::Json | ProgressStyle::None => {}
            }
        });
    }

    fn compares(&self, reference: &str, metric: Metric) {
        let title = metric.title();
        self.stage(format!("{metric} against {reference}"), format!("{title} against {reference}"), 0);
    }

    fn job_ends(&self, _row: &Row) {
        self.with(|state| state.bar.inc(1));
        if self.style == ProgressStyle::Json {
            self.stage("finished".to_owned(), String::new(), 0);
        }
    }
}

impl State {
    /// Time left at the pace of earlier jobs.
    fn left(&self) -> Option<Duration> {
        let (_, standing) = self.job.as_ref()?;
        Some(standing.this?.saturating_sub(self.job_start.elapsed()) + standing.later?)
    }

    /// The current job: scene, configuration, run.
    fn title(&self) -> String {
        self.job.as_ref().map_or(String::new(), |(job, _)| format!("{}, run {}", title(job), job.run))
    }

    fn line(&self, standing: &Standing) -> String {
        let left = self.left().map_or(String::new(), |left| format!("; about {} left", in_words(left)));
        format!("job {} of {}: {}{left}", standing.number, standing.of, self.title())
    }

    fn begin_bar(&mut self, standing: &Standing) {
        if self.bar.is_hidden() {
            self.bar = ProgressBar::new(standing.of as u64);
            if let Ok(style) = BarStyle::with_template("[{bar:20}] {pos}/{len}{prefix}  {wide_msg}") {
                self.bar.set_style(style.progress_chars("=> "));
            }
            console::share_with(&self.bar);
        }
        self.show_bar();
    }

    fn show_bar(&mut self) {
        let percent =
            (100 * self.done).checked_div(self.total).map_or(String::new(), |percent| format!(" {percent} %"));
        self.bar.set_message(format!("{}: {}{percent}", self.title(), self.label));
        self.bar.set_prefix(self.left().map_or(String::new(), |left| format!(", {} left", in_words(left))));
        self.told = Instant::now();
    }

    fn tell_json(&mut self) {
        let Some((job, standing)) = &self.job else { return };
        let line = serde_json::json!({
            "job": standing.number,
            "jobs": standing.of,
            "scene": job.scene_name,
            "configuration": job.configuration,
            "point": job.point,
            "seed": job.settings.run.seed,
            "run": job.run,
            "stage": self.stage,
            "done": self.done,
            "total": self.total,
            "elapsed_s": self.start.elapsed().as_secs_f64(),
            "remaining_s": self.left().map(|left| left.as_secs_f64()),
        });
        console::note(&line.to_string());
        self.told = Instant::now();
    }
}

/// A duration for people, to about a tenth.
fn in_words(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match seconds {
        0..=89 => format!("{seconds} s"),
        90..=5399 => format!("{} min", (seconds + 30) / 60),
        _ => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_told_in_a_fitting_unit() {
        let told = [0, 89, 90, 5399, 5400, 36_000].map(|seconds| in_words(Duration::from_secs(seconds)));
        assert_eq!(told, ["0 s", "89 s", "2 min", "90 min", "1.5 h", "10.0 h"]);
    }
}
