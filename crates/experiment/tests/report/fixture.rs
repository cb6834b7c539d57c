//! Hand-made results of a small experiment: three scenes, two configurations of a CPU and two of an absent GPU, three
//! runs.

use lightcuts::image::{Image, Transfer, write_png};
use lightcuts::rendering::PassTime;
use lightcuts::{Stage, Stats};
use lightcuts_experiment::layout::{Content, Section};
use lightcuts_experiment::published::Published;
use lightcuts_experiment::record::{
    ComparisonRow, ConfigurationInfo, DeviceInfo, Header, JobInfo, Record, Row, SceneInfo,
};
use lightcuts_experiment::{Report, ReportError};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Scenes with the factor on all times.
pub(crate) const SCENES: [(&str, &str, f64); 3] =
    [("simple", "Simple", 1.0), ("venus", "Venus", 10.0), ("galleon", "Galleon", 40.0)];
/// Configurations of the CPU with first pass and second pass in processor seconds in the scene Simple, mean of the
/// runs.
pub(crate) const TIMES: [(&str, f64, f64); 2] = [("cpu", 0.04, 4.0), ("cpu-lightcuts", 0.05, 8.0)];
/// What the runs' times are multiplied by.
pub(crate) const FACTORS: [f64; 3] = [0.9, 1.0, 1.1];
/// Side of the pictures in pixels.
const SIDE: u32 = 96;

/// Results in a folder of their own.
pub(crate) struct Results {
    pub(crate) header: Header,
    pub(crate) rows: Vec<Row>,
    folder: TempDir,
}

impl Results {
    /// Every render of the CPU is done; there are no pictures and no sections.
    pub(crate) fn new() -> Self {
        let rows: Vec<Row> = SCENES
            .iter()
            .flat_map(|(scene, _, factor)| {
                TIMES.iter().map(move |(name, first, second)| (*scene, *name, *first * factor, *second * factor))
            })
            .flat_map(|(scene, name, first, second)| (1..=3).map(move |run| row(scene, name, None, run, first, second)))
            .collect();
        let mut results = Self { header: header(), rows, folder: tempfile::tempdir().unwrap() };
        results.plan_all();
        results
    }

    /// A sweep in one scene: processor seconds of the second pass of both configurations at VPL counts.
    pub(crate) fn sweep(points: &[(u64, f64, f64)]) -> Self {
        let mut results = Self::new();
        results.rows = Vec::new();
        results.header.runs = 1;
        for (vpls, plain, lightcuts) in points {
            let point = vpls.to_string();
            for (name, second) in [("cpu", plain), ("cpu-lightcuts", lightcuts)] {
                let mut row = row("simple", name, Some(&point), 1, 0.1, *second);
                row.stats.vpl_count = *vpls;
                results.rows.push(row);
            }
            results.header.points.push(point);
        }
        results.plan_all();
        results
    }

    /// Makes the rows the jobs of the plan.
    pub(crate) fn plan_all(&mut self) {
        let info = |row: &Row| JobInfo {
            job: row.job.clone(),
            scene: row.scene.clone(),
            configuration: row.configuration.clone(),
            point: row.point.clone(),
        };
        self.header.jobs = self.rows.iter().map(info).collect();
    }

    /// With rows of a GPU for both of its configurations: processor seconds are half of the CPU's for all VPLs, and as
    /// many with lightcuts.
    pub(crate) fn with_gpu(mut self, kind: &str, name: &str) -> Self {
        for (scene, _, factor) in SCENES {
            for (configuration, first, second) in [("gpu", 0.02, 2.0), ("gpu-lightcuts", 0.05, 8.0)] {
                self.rows.extend((1..=3).map(|run| {
                    let mut row = row(scene, configuration, None, run, first * factor, second * factor);
                    row.device = DeviceInfo { kind: kind.to_owned(), name: name.to_owned(), threads: 0 };
                    row
                }));
            }
        }
        self.header.configurations.iter_mut().for_each(|configuration| configuration.absent = None);
        self.plan_all();
        self
    }

    /// With a section.
    pub(crate) fn with(mut self, id: &str, content: Content) -> Self {
        let (id, text) = (id.to_owned(), String::new());
        self.header.sections.push(Section { title: format!("Section {id}"), id, text, content });
        self
    }

    /// With the figures that the project ships.
    pub(crate) fn with_thesis_figures(mut self) -> Self {
        let file = |name| lightcuts_testkit::project_root().join("experiments").join(name);
        let (times, accelerations) = (file("thesis_tables.csv"), file("thesis_derived.csv"));
        self.header.published = Published::read("the thesis".to_owned(), Some(&times), Some(&accelerations)).unwrap();
        self
    }

    /// With a small picture and a FLIP map for each row.
    pub(crate) fn with_pictures(self) -> Self {
        fs::create_dir(self.folder().join("images")).unwrap();
        let wave = |x: usize, y: usize, k: f32| 0.5 + 0.5 * ((x as f32 * 0.2 + k).sin() * (y as f32 * 0.15).cos());
        for row in &self.rows {
            let shift = if row.configuration == "cpu" { 0.0 } else { 0.8 };
            let picture = Image::from_fn(SIDE as usize, SIDE as usize, |x, y| {
                [wave(x, y, shift), wave(y, x, 1.0), 0.3 + 0.3 * wave(x, x + y, shift)]
            });
            write_png(self.folder().join(&row.png), &picture, Transfer::Linear).unwrap();
            for comparison in row.comparisons.values() {
                let map =
                    Image::from_fn(SIDE as usize, SIDE as usize, |x, y| [wave(x, y, 2.0), wave(x, y, 2.0) * 0.5, 0.2]);
                write_png(self.folder().join(&comparison.flip_map), &map, Transfer::Linear).unwrap();
            }
        }
        self
    }

    pub(crate) fn scene(&mut self, name: &str) -> &mut SceneInfo {
        self.header.scenes.iter_mut().find(|scene| scene.name == name).unwrap()
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Writes `results.jsonl`.
    pub(crate) fn write(&self) -> PathBuf {
        let header = Record::Header(Box::new(self.header.clone()));
        let rows = self.rows.iter().map(|row| Record::Run(Box::new(row.clone())));
        let lines = std::iter::once(header).chain(rows).map(|record| serde_json::to_string(&record).unwrap() + "\n");
        let path = self.folder().join("results.jsonl");
        fs::write(&path, lines.collect::<String>()).unwrap();
        path
    }

    pub(crate) fn try_report(&self) -> Result<Report, ReportError> {
        Report::read(&self.write())
    }

    pub(crate) fn report(&self) -> Files {
        Files(self.try_report().unwrap())
    }
}

/// A report with its files by name.
pub(crate) struct Files(pub(crate) Report);

impl Files {
    pub(crate) fn text(&self, name: &str) -> &str {
        let found = self.0.files.iter().find(|(path, _)| path == Path::new(name));
        std::str::from_utf8(&found.unwrap_or_else(|| panic!("there is no {name}")).1).unwrap()
    }

    pub(crate) fn page(&self) -> &str {
        self.text("index.html")
    }

    /// The rows of a table by the names of their columns.
    pub(crate) fn table(&self, id: &str) -> Vec<BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_reader(self.text(&format!("tables/{id}.csv")).as_bytes());
        reader.deserialize().map(|row| row.unwrap()).collect()
    }

    /// The row of a table with these values.
    pub(crate) fn row(&self, id: &str, wanted: &[(&str, &str)]) -> BTreeMap<String, String> {
        let fits = |row: &BTreeMap<String, String>| wanted.iter().all(|(column, value)| row[*column] == *value);
        self.table(id).into_iter().find(fits).unwrap_or_else(|| panic!("{id} has no row with {wanted:?}"))
    }
}

/// A field as a number.
pub(crate) fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} is `{}`", row[column]))
}

/// Whether two numbers are equal but for rounding.
pub(crate) fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1e-3), "{found} instead of {expected}");
}

pub(crate) fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(ToString::to_string).collect()
}

/// Times of all four configurations in a scene.
pub(crate) fn times(scene: &str, published: Option<&str>) -> Content {
    Content::Times {
        scene: scene.to_owned(),
        configurations: names(&["cpu", "cpu-lightcuts", "gpu", "gpu-lightcuts"]),
        published: published.map(str::to_owned),
        every_run: false,
    }
}

fn header() -> Header {
    let configuration = |name: &str, title: &str, references: &[&str]| ConfigurationInfo {
        name: name.to_owned(),
        title: title.to_owned(),
        absent: name.starts_with("gpu").then(|| "there is no graphics adapter".to_owned()),
        references: names(references),
    };
    Header {
        format: lightcuts_experiment::record::FORMAT,
        name: "small".to_owned(),
        title: "A small experiment".to_owned(),
        description: "What *came out*.".to_owned(),
        scenes: SCENES
            .map(|(name, title, _)| SceneInfo { name: name.to_owned(), title: title.to_owned(), stand_in: None })
            .to_vec(),
        configurations: vec![
            configuration("cpu", "CPU", &[]),
            configuration("cpu-lightcuts", "CPU, lightcuts", &["cpu"]),
            configuration("gpu", "GPU", &["cpu"]),
            configuration("gpu-lightcuts", "GPU, lightcuts", &["cpu"]),
        ],
        points: Vec::new(),
        runs: 3,
        seeds: vec![1],
        sections: Vec::new(),
        published: Published::default(),
        jobs: Vec::new(),
    }
}

/// A finished render. Elapsed times are half of processor times; the second pass is shared out over its stages.
pub(crate) fn row(scene: &str, configuration: &str, point: Option<&str>, run: u32, first: f64, second: f64) -> Row {
    let factor = FACTORS[(run as usize - 1) % FACTORS.len()];
    let pass = |stage: Stage, cpu_s: f64| PassTime {
        name: stage.name().into(),
        wall_s: cpu_s * factor / 2.0,
        cpu_s: cpu_s * factor,
    };
    let passes = vec![
        pass(Stage::FirstPass, first),
        pass(Stage::LightTree, second * 0.25),
        pass(Stage::SecondPass, second * 0.5),
        pass(Stage::Develop, second * 0.25),
    ];
    let is_cut = configuration.ends_with("lightcuts");
    let name = [Some(scene), Some(configuration), point].into_iter().flatten().collect::<Vec<_>>().join("--");
    let comparison = ComparisonRow { metrics: metrics(9569.0, 0.0), flip_map: format!("images/{name}--cpu--flip.png") };
    Row {
        job: format!("{name}-{run}"),
        scene: scene.to_owned(),
        configuration: configuration.to_owned(),
        point: point.map(str::to_owned),
        seed: 1,
        run,
        stand_in: false,
        finished: format!("2026-11-22T21:21:{run:02}Z"),
        version: "0.1.0".to_owned(),
        revision: "0123456789abcdef".to_owned(),
        device: DeviceInfo { kind: "cpu".to_owned(), name: "Test Processor".to_owned(), threads: 1 },
        width: SIDE,
        height: SIDE,
        stats: Stats {
            vpl_count: 290,
            light_ratio_percent: if is_cut { 68.3131 } else { 100.0 },
            total_wall_s: passes.iter().map(|pass| pass.wall_s).sum(),
            total_cpu_s: passes.iter().map(|pass| pass.cpu_s).sum(),
            passes,
            complete: true,
            ..Stats::default()
        },
        picture: "0".repeat(64),
        png: format!("images/{name}.png"),
        exr: format!("images/{name}.exr"),
        comparisons: if is_cut { BTreeMap::from([("cpu".to_owned(), comparison)]) } else { BTreeMap::new() },
    }
}

/// Some metrics of a comparison.
pub(crate) fn metrics(pixels: f64, pass: f64) -> BTreeMap<String, Option<f64>> {
    let values = [
        ("pdiff_px", Some(pixels)),
        ("pdiff_pass", Some(pass)),
        ("flip_ldr", Some(0.0625)),
        ("rmse", Some(0.0125)),
        ("psnr", None),
    ];
    values.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
