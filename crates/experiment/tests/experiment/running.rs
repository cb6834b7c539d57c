//! Running plans: what is rendered, what is not rendered again, what the rows say.

use crate::support::{Folder, HEAD, PAIR, StopAfter};
use lightcuts::Monitor;
use lightcuts::image::metrics::{Metric, MetricOptions, compare};
use lightcuts::image::{Layers, Picture, Transfer, read_exr, read_png, write_exr};
use lightcuts_experiment::Watch;
use lightcuts_experiment::plan::PlannedJob;
use lightcuts_experiment::record::Row;
use lightcuts_experiment::run::Standing;
use std::fs;
use std::sync::Mutex;
use std::time::Duration;

fn text(runs: u32) -> String {
    format!("runs = {runs}\n{HEAD}{PAIR}")
}

fn row<'r>(rows: &'r [Row], configuration: &str, run: u32) -> &'r Row {
    rows.iter().rev().find(|row| row.configuration == configuration && row.run == run).unwrap()
}

#[test]
fn rows_tell_what_was_rendered() {
    let folder = Folder::new();
    let outcome = folder.run(&text(2));
    assert_eq!((outcome.rendered, outcome.skipped, outcome.interrupted), (4, 0, false));
    let rows = folder.results().rows;
    let plain = row(&rows, "plain", 1);
    assert_eq!((plain.width, plain.height, plain.seed, plain.stand_in), (24, 16, 1, false));
    assert_eq!((plain.device.kind.as_str(), plain.device.threads), ("cpu", 1));
    assert!(plain.stats.complete && plain.stats.vpl_count > 0 && !plain.device.name.is_empty());
    assert!(plain.finished.len() == 20 && plain.finished.ends_with('Z'), "{}", plain.finished);
    assert!(!plain.revision.is_empty() && plain.version == env!("CARGO_PKG_VERSION"));
    assert_eq!((plain.png.as_str(), plain.exr.as_str()), ("images/room--plain.png", "images/room--plain.exr"));
    for run in [1, 2] {
        assert_eq!(row(&rows, "cuts", run).exr, "images/room--cuts.exr");
        assert_eq!(row(&rows, "cuts", run).comparisons, row(&rows, "cuts", 1).comparisons);
    }
    assert_ne!(row(&rows, "cuts", 1).job, row(&rows, "cuts", 2).job);
    let exr = read_exr(folder.out().join(&plain.exr)).unwrap();
    assert_eq!(exr.aovs().len(), 0, "the beauty alone");
    let png = read_png(folder.out().join(&plain.png), Transfer::Linear).unwrap();
    assert!(lightcuts::image::max_abs_difference(exr.beauty(), &png).unwrap() <= 0.51 / 255.0);
}

#[test]
fn comparisons_are_those_of_the_pictures_on_the_disk() {
    let folder = Folder::new();
    let same =
        "[[configuration]]\nname = 'same'\nreferences = ['plain']\nsettings = { gather = { strategy = 'all' } }\n";
    folder.run(&format!("{}{same}", text(1)));
    let rows = folder.results().rows;
    let picture = |name: &str| {
        let beauty = read_exr(folder.out().join(&row(&rows, name, 1).exr)).unwrap().into_beauty();
        Picture::from_linear(beauty, Transfer::Linear)
    };
    let (reference, test) = (picture("plain"), picture("cuts"));
    let expected = compare(&reference, &test, &Metric::ALL, &MetricOptions::default(), &|_| {}).unwrap();
    let comparison = &row(&rows, "cuts", 1).comparisons["plain"];
    assert_eq!(comparison.metrics.len(), Metric::ALL.len());
    for metric in Metric::ALL {
        assert_eq!(comparison.metrics[metric.key()], expected.value(metric), "{metric}");
    }
    assert!(comparison.metrics["bias"].unwrap() < 0.0, "VPLs that are not chosen leave it darker");
    assert!(folder.out().join(&comparison.flip_map).is_file());
    let same = &row(&rows, "same", 1).comparisons["plain"];
    assert_eq!(
        (same.metrics["mse"], same.metrics["flip_ldr"], same.metrics["pdiff_px"]),
        (Some(0.0), Some(0.0), Some(0.0))
    );
    assert_eq!(same.metrics["psnr"], None, "infinite");
    assert!(row(&rows, "plain", 1).comparisons.is_empty());
}

#[test]
fn only_the_metrics_asked_for_are_told() {
    let folder = Folder::new();
    folder.run(&format!("metrics = ['ssim', 'mae']\n{}", text(1)));
    let rows = folder.results().rows;
    let comparison = &row(&rows, "cuts", 1).comparisons["plain"];
    assert_eq!(comparison.metrics.keys().collect::<Vec<_>>(), ["mae", "ssim"]);
    assert!(folder.out().join(&comparison.flip_map).is_file(), "the map is there all the same");
}

#[test]
fn a_second_call_renders_nothing_and_writes_nothing() {
    let folder = Folder::new();
    folder.run(&text(2));
    let before = fs::read(folder.out().join("results.jsonl")).unwrap();
    let outcome = folder.run(&text(2));
    assert_eq!((outcome.rendered, outcome.skipped), (0, 4));
    assert!(before == fs::read(folder.out().join("results.jsonl")).unwrap());
}

#[test]
fn a_header_with_published_figures_is_recognised_again() {
    let folder = Folder::new();
    let columns = "table,scene,run,config,first_pass_s,second_pass_s,total_s,light_ratio_percent,vpl_count";
    // Shortest decimal forms that a hasty reader of floats gets wrong in the last bit are among these.
    let row = |i: i32| format!("5.1,room,{i},plain,{},0.1,0.{i}7,68.31301450729{i},290", 1.0 / f64::from(i));
    let rows = (1..200).map(row).collect::<Vec<_>>().join("\n");
    folder.write("t.csv", format!("{columns}\n{rows}\n"));
    let text = format!("published = {{ source = 'x', times = 't.csv' }}\n{}", text(1));
    folder.run(&text);
    folder.run(&text);
    let lines = fs::read_to_string(folder.out().join("results.jsonl")).unwrap();
    assert_eq!(lines.matches("\"kind\":\"header\"").count(), 1);
    assert_eq!(folder.results().header.unwrap().published.times.len(), 199);
}

#[test]
fn a_broken_off_experiment_goes_on_where_it_was() {
    let folder = Folder::new();
    for done in 1..=2 {
        let outcome = folder.run_watched(&text(2), &StopAfter::new(1)).unwrap();
        assert_eq!((outcome.rendered, outcome.skipped, outcome.interrupted), (1, done - 1, true));
    }
    let outcome = folder.run(&text(2));
    assert_eq!((outcome.rendered, outcome.skipped, outcome.interrupted), (2, 2, false));
    let results = folder.results();
    assert_eq!((results.rows.len(), results.current().len()), (4, 4), "each job once");
}

#[test]
fn the_time_left_follows_from_finished_jobs() {
    let folder = Folder::new();
    let first = Standings::default();
    folder.run_watched(&text(1), &first).unwrap();
    let first = first.0.into_inner().unwrap();
    assert_eq!(first.iter().map(|it| (it.number, it.of)).collect::<Vec<_>>(), [(1, 2), (2, 2)]);
    assert_eq!((first[0].this, first[0].later), (None, None), "nothing is known");
    assert!(first[1].this.unwrap() > Duration::ZERO, "from the other configuration");
    assert_eq!(first[1].later, Some(Duration::ZERO));
    let further = Standings::default();
    folder.run_watched(&text(2), &further).unwrap();
    let further = further.0.into_inner().unwrap();
    let told: Vec<_> =
        folder.results().rows.iter().map(|row| Duration::from_secs_f64(row.stats.total_wall_s)).collect();
    assert_eq!(further[0].this, Some(told[0]), "from its own run 1");
    assert_eq!(further[0].later, Some(told[1]));
}

/// Keeps what it is told at the beginning of each job.
#[derive(Default)]
struct Standings(Mutex<Vec<Standing>>);

impl Monitor for Standings {}

impl Watch for Standings {
    fn job_begins(&self, _job: &PlannedJob, standing: &Standing) {
        self.0.lock().unwrap().push(*standing);
    }
}

#[test]
fn more_runs_and_other_sections_only_add_to_it() {
    let folder = Folder::new();
    folder.run(&text(1));
    let section = "[[section]]\nid = 'x'\ntitle = 'x'\nshows = 'text'\n";
    let outcome = folder.run(&format!("{}{section}", text(3)));
    assert_eq!((outcome.rendered, outcome.skipped), (4, 2));
    let lines = fs::read_to_string(folder.out().join("results.jsonl")).unwrap();
    assert_eq!(lines.matches("\"kind\":\"header\"").count(), 2);
    assert_eq!(folder.results().header.unwrap().runs, 3, "the last header counts");
}

#[test]
fn changed_settings_are_rendered_and_changed_back_again() {
    let folder = Folder::new();
    folder.run(&text(1));
    let bytes = || fs::read(folder.out().join("images/room--cuts.png")).unwrap();
    let before = bytes();
    let outcome = folder.run(&text(1).replace("1e-5", "1e-3"));
    assert_eq!((outcome.rendered, outcome.skipped), (1, 1));
    assert!(before != bytes());
    let outcome = folder.run(&text(1));
    assert_eq!((outcome.rendered, outcome.skipped), (1, 1), "the picture on the disk is another one now");
    assert!(before == bytes());
    let results = folder.results();
    assert_eq!(results.rows.len(), 4);
    let current = results.current();
    let last = current[&results.rows[3].key()];
    assert_eq!(last.job, results.rows[1].job, "of the rows of one key the last one counts");
}

#[test]
fn lost_pictures_are_rendered_again_with_what_depends_on_them() {
    let folder = Folder::new();
    folder.run(&text(1));
    for (lost, rendered) in [
        ("images/room--cuts.png", 1),
        ("images/room--cuts.exr", 1),
        ("images/room--cuts--plain--flip.png", 1),
        ("images/room--plain.exr", 2),
    ] {
        fs::remove_file(folder.out().join(lost)).unwrap();
        assert_eq!(folder.run(&text(1)).rendered, rendered, "{lost}");
        assert!(folder.out().join(lost).is_file());
    }
    fs::write(folder.out().join("images/room--cuts.exr"), "torn").unwrap();
    assert_eq!(folder.run(&text(1)).rendered, 1);
}

#[test]
fn threads_change_the_job_but_not_the_picture() {
    let folder = Folder::new();
    folder.run(&text(1));
    let outcome = folder.run(&format!("threads = 3\n{}", text(1)));
    assert_eq!(outcome.rendered, 2);
    let rows = folder.results().rows;
    assert!(rows[0].picture == rows[2].picture && rows[1].picture == rows[3].picture);
    assert!(rows[0].picture != rows[1].picture && rows[0].picture.len() == 64);
    assert_eq!((rows[0].device.threads, rows[2].device.threads), (1, 3));
}

/// As if run 1 had been rendered by a program with another picture of the same job.
#[test]
fn another_picture_of_the_same_job_ends_the_experiment() {
    let folder = Folder::new();
    folder.run(&text(1));
    let path = folder.out().join("results.jsonl");
    let picture = folder.results().rows[0].picture.clone();
    let forged = "0".repeat(64);
    fs::write(&path, fs::read_to_string(&path).unwrap().replace(&picture, &forged)).unwrap();
    let exr = folder.out().join("images/room--plain.exr");
    let mut layers = Layers::new(read_exr(&exr).unwrap().into_beauty());
    layers.set_attribute("lightcuts:picture", forged).unwrap();
    write_exr(&exr, &layers).unwrap();
    let error = folder.run_watched(&text(2), &StopAfter::new(usize::MAX)).unwrap_err().to_string();
    assert!(error.starts_with("run 2 of `room--plain` gives another picture than run 1"), "{error}");
    assert_eq!(folder.results().rows.len(), 2, "its row is not written");
}
