//! What the command says of an experiment on standard output.

use lightcuts::device::DeviceKind;
use lightcuts_experiment::Outcome;
use lightcuts_experiment::plan::{Plan, PlannedJob};
use lightcuts_experiment::record::Row;
use lightcuts_experiment::results::FILE_NAME;
use std::fmt::Write;
use std::path::Path;

/// The plan: what would be rendered, and how much of it is finished.
pub(super) fn plan(plan: &Plan, selection: &[usize], finished: &[Option<Row>], results: &Path) -> String {
    let mut text = Lines::of(plan);
    let done = selection.iter().filter(|&&i| finished[i].is_some()).count();
    text.line("threads", &plan.threads.to_string());
    text.line("jobs", &format!("{}: {done} finished, {} to render", selection.len(), selection.len() - done));
    text.line("results", &results.display().to_string());
    for &first in selection.iter().filter(|&&i| plan.jobs[i].first_run == i) {
        let runs: Vec<usize> = selection.iter().copied().filter(|&i| plan.jobs[i].first_run == first).collect();
        let done = runs.iter().filter(|&&i| finished[i].is_some()).count();
        text.line("", &format!("{}: {done} of {} runs finished", title(&plan.jobs[first]), runs.len()));
    }
    text.0
}

/// What was done, and what to type next.
pub(super) fn summary(plan: &Plan, outcome: &Outcome, directory: &Path) -> String {
    let mut text = Lines::of(plan);
    let results = directory.join(FILE_NAME);
    let report = directory.join("report");
    text.line("rendered", &format!("{} jobs; {} had been finished before", outcome.rendered, outcome.skipped));
    text.line("results", &results.display().to_string());
    text.line("next", &format!("lightcuts report {} -o {}", quoted(&results), quoted(&report)));
    text.0
}

/// What is left of an interrupted experiment, and how it continues.
pub(super) fn interrupted(outcome: &Outcome, of: usize, directory: &Path) -> String {
    format!(
        "lightcuts: the current render was discarded; {} of {of} jobs are finished in {}; the same command continues",
        outcome.rendered + outcome.skipped,
        directory.join(FILE_NAME).display()
    )
}

/// Scene, configuration, point and seed.
pub(super) fn title(job: &PlannedJob) -> String {
    let mut title = format!("{}, {}", job.scene_name, job.configuration);
    // Writing to a String cannot fail.
    let _ = job.point.iter().try_for_each(|point| write!(title, ", {point}"));
    if job.settings.run.seed != lightcuts::Settings::default().run.seed {
        let _ = write!(title, ", seed {}", job.settings.run.seed);
    }
    title
}

/// A path quoted for a shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/\\:._-+".contains(c);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

/// Lines of a name and a value.
struct Lines(String);

impl Lines {
    /// What the experiment is: its name, stand-ins, GPUs, what is absent.
    fn of(plan: &Plan) -> Self {
        let mut text = Self(String::new());
        text.line("experiment", &plan.header.name);
        for (info, scene) in plan.header.scenes.iter().zip(&plan.scenes) {
            if let Some(note) = &info.stand_in {
                let missing = scene.missing.join(", ");
                let file = scene.file.display();
                text.line("stand-in", &format!("{}: {file}, {note} ({missing} was not found)", info.name));
            }
        }
        for adapter in plan.used_adapters() {
            let slow = match adapter.kind {
                DeviceKind::SoftwareGpu => ": a driver that runs on the processor, slower than the CPU renderer",
                DeviceKind::Cpu | DeviceKind::Gpu => "",
            };
            text.line("GPU", &format!("{}{slow}", adapter.name));
        }
        for configuration in &plan.header.configurations {
            if let Some(why) = &configuration.absent {
                text.line("absent", &format!("{}: {why}", configuration.name));
            }
        }
        text
    }

    fn line(&mut self, name: &str, value: &str) {
        let _ = writeln!(self.0, "{name:<12} {value}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_can_be_pasted_into_a_shell() {
        assert_eq!(quoted(Path::new("out/thesis/report")), "out/thesis/report");
        assert_eq!(quoted(Path::new("my out/a")), "'my out/a'");
        assert_eq!(quoted(Path::new("it's")), "'it'\\''s'");
    }
}
