//! A folder with an experiment.

use lightcuts::image::metrics::Metric;
use lightcuts::{Monitor, Unwatched};
use lightcuts_experiment::plan::PlannedJob;
use lightcuts_experiment::record::Row;
use lightcuts_experiment::{ExperimentFile, Outcome, Plan, PlanError, Results, RunError, Runner, Watch};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use tempfile::TempDir;

/// A room with a ball and a model: 24 x 16 pixels have some VPLs.
pub(crate) const SCENE: &str = "\
# VPL(0.002/0.5/0.03) LC(2e-7)
S BK{0.1, 0.2, 0.3}
C STRAT|PERS(10)|C{0, 0, 960}|V{0, 0, -1}|U{0, 1, 0}
L OMNI|POS{0, 100, 300}|ATTEN(1)|S{1, 1, 1}|D{1, 1, 1}|A{1, 1, 1}
P SPH|FRKE{0.2, 0, 0.7, 1}|C{60, -100, 0}R(80)|S{0.2, 0.2, 0.2}|D{0.3, 0.5, 0.3}|A{0.1, 0.1, 0.1}|SH(20)
P SQU|FRKE{0, 0, 0.6, 1}|C{-200, 0, 0}N{1, 0, 0}H{0, 1, 0}|W400:H400|S{0, 0, 0}|D{0.9, 0.05, 0.05}|A{0, 0, 0}|SH(20)
";

/// One more line for the scene: a model beside it.
pub(crate) const MESH: &str = "O FRKE{0,0,1,1}|PATH:a.obj|SMTH(0)|MAT(0)|S{0,0,0}|D{1,1,1}|A{0,0,0}|SH(20)\n";
pub(crate) const MODEL: &str = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 50 0 0\nv 0 50 0\nf 1 2 3\n";
pub(crate) const LIBRARY: &str = "newmtl m\nKd 0.5 0.6 0.7\n";

/// The head of an experiment with small pictures of one scene.
pub(crate) const HEAD: &str = "\
name = 'small'
[settings]
image = { width = 24, height = 16 }
[[scene]]
name = 'room'
file = 'scene.txt'
";

/// Two configurations, the second compared with the first.
pub(crate) const PAIR: &str = "\
[[configuration]]
name = 'cuts'
references = ['plain']
settings = { gather = { strategy = 'lightcuts', threshold = 1e-5 } }
[[configuration]]
name = 'plain'
settings = { gather = { strategy = 'all' } }
";

pub(crate) struct Folder(TempDir);

impl Folder {
    /// With a scene in it.
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("scene.txt", SCENE);
        folder
    }

    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.at(name), content).unwrap();
    }

    pub(crate) fn out(&self) -> PathBuf {
        self.at("out")
    }

    pub(crate) fn try_plan(&self, text: &str) -> Result<Plan, PlanError> {
        let file = ExperimentFile::parse("a.toml", text, self.0.path())?;
        Plan::new(&file, &file.search_path())
    }

    pub(crate) fn plan(&self, text: &str) -> Plan {
        self.try_plan(text).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Runs the whole plan of `text`.
    pub(crate) fn run(&self, text: &str) -> Outcome {
        self.run_watched(text, &Unwatched).unwrap()
    }

    pub(crate) fn run_watched(&self, text: &str, watch: &dyn Watch) -> Result<Outcome, RunError> {
        let plan = self.plan(text);
        let all: Vec<usize> = (0..plan.jobs.len()).collect();
        Runner::open(&plan, &self.out())?.run(&all, &no_texts, watch)
    }

    pub(crate) fn results(&self) -> Results {
        Results::read(&self.out().join("results.jsonl")).unwrap()
    }
}

pub(crate) fn no_texts(_job: &PlannedJob, _path: &Path) -> Vec<(&'static str, String)> {
    Vec::new()
}

/// `line:column: message` of a fault in a plan's text.
pub(crate) fn complaint(error: &PlanError) -> String {
    let PlanError::Text(fault) = error else { return error.to_string() };
    let before = &fault.text[..fault.span.start];
    let line = before.matches('\n').count() + 1;
    let column = before.len() - before.rfind('\n').map_or(0, |i| i + 1) + 1;
    format!("{}:{line}:{column}: {} ({})", fault.file, fault.message, fault.label)
}

/// Stops an experiment after a number of jobs.
pub(crate) struct StopAfter {
    pub(crate) jobs: usize,
    done: AtomicUsize,
}

impl StopAfter {
    pub(crate) fn new(jobs: usize) -> Self {
        Self { jobs, done: AtomicUsize::new(0) }
    }
}

impl Monitor for StopAfter {
    fn cancelled(&self) -> bool {
        self.done.load(Ordering::SeqCst) >= self.jobs
    }
}

impl Watch for StopAfter {
    fn compares(&self, reference: &str, metric: Metric) {
        assert!(!reference.is_empty() && Metric::ALL.contains(&metric));
    }

    fn job_ends(&self, _row: &Row) {
        self.done.fetch_add(1, Ordering::SeqCst);
    }
}
