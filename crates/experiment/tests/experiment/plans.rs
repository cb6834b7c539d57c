//! Plans: which jobs, in which order, with which settings.

use crate::support::{Folder, HEAD, PAIR};
use lightcuts::rendering::Strategy;
use lightcuts_experiment::plan::PlannedJob;
use lightcuts_experiment::{ExperimentFile, Plan};

fn names(plan: &Plan) -> Vec<String> {
    plan.jobs.iter().map(|job| format!("{} {}", job.stem(), job.run)).collect()
}

fn job<'p>(plan: &'p Plan, stem: &str) -> &'p PlannedJob {
    plan.jobs.iter().find(|job| job.stem() == stem).unwrap_or_else(|| panic!("{stem} in {:?}", names(plan)))
}

#[test]
fn later_tables_win_key_by_key() {
    let folder = Folder::new();
    let text = "\
name = 'order'
[settings]
image = { width = 24, height = 16 }
vpl = { probability = 0.01, attenuation = 0.5, min-illumination = 0.25 }
sampling = { samples = 2 }
[[scene]]
name = 'room'
file = 'scene.txt'
settings = { vpl = { attenuation = 0.6, min-illumination = 0.5 }, image = { width = 32 } }
[[configuration]]
name = 'a'
settings = { vpl = { min-illumination = 0.75 }, sampling = { samples = 4 } }
[[point]]
name = 'p'
settings = { sampling = { samples = 8 } }
[[point]]
name = 'q'
";
    let plan = folder.plan(text);
    let settings = &job(&plan, "room--a--p").settings;
    assert_eq!((settings.image.width, settings.image.height), (32, 16));
    let vpl = &settings.vpl;
    assert_eq!((vpl.probability, vpl.attenuation, vpl.min_illumination), (0.01, 0.6, 0.75));
    assert_eq!(settings.sampling.samples, 8);
    assert_eq!(job(&plan, "room--a--q").settings.sampling.samples, 4);
    // The scene file's recommendation, which nothing overrides, and a default.
    assert_eq!((settings.gather.threshold, settings.run.max_depth), (2e-7, 4));
}

#[test]
fn references_come_first_and_runs_last() {
    let plan = Folder::new().plan(&format!("runs = 2\nseeds = [1, 5]\n{HEAD}{PAIR}"));
    let expected = ["room--plain 1", "room--cuts 1", "room--plain--seed-5 1", "room--cuts--seed-5 1"];
    let again = expected.map(|name| name.replace(" 1", " 2"));
    assert_eq!(names(&plan), [expected.map(str::to_owned), again].concat());
    for (i, job) in plan.jobs.iter().enumerate() {
        assert_eq!(job.first_run, i % 4);
        assert_eq!(job.references, if i % 2 == 1 { vec![i % 4 - 1] } else { vec![] }, "of run 1, same seed");
        assert_eq!(job.settings.run.seed, if i % 4 < 2 { 1 } else { 5 });
    }
    assert_eq!(plan.jobs[0].settings.gather.strategy, Strategy::All);
}

#[test]
fn a_reference_at_the_last_point_is_compared_with_every_point() {
    let text = format!(
        "seeds = [1, 5]\n{HEAD}\
        [[configuration]]\nname = 'cuts'\nreferences = ['all']\n\
        [[configuration]]\nname = 'all'\nat = 'last-point'\n\
        [[point]]\nname = 'p'\n[[point]]\nname = 'q'\n"
    );
    let plan = Folder::new().plan(&text);
    let stems: Vec<_> = plan.jobs.iter().map(PlannedJob::stem).collect();
    let cuts = ["room--cuts--p", "room--cuts--p--seed-5", "room--cuts--q", "room--cuts--q--seed-5"];
    assert_eq!(stems[..2], ["room--all--q", "room--all--q--seed-5"]);
    assert_eq!(stems[2..], cuts);
    let references: Vec<_> = plan.jobs.iter().map(|job| job.references.clone()).collect();
    assert_eq!(references, [vec![], vec![], vec![0], vec![1], vec![0], vec![1]], "the reference of the same seed");
}

#[test]
fn what_has_no_device_is_absent_and_no_reference() {
    let gpu = "[[configuration]]\nname = 'gpu'\ndevice = 'a card that nobody has'\n";
    let text = format!("{HEAD}{}{gpu}", PAIR.replace("['plain']", "['gpu', 'plain']"));
    let plan = Folder::new().plan(&text);
    assert_eq!(names(&plan), ["room--plain 1", "room--cuts 1"]);
    assert_eq!(plan.jobs[1].references, [0]);
    let absent: Vec<_> = plan.header.configurations.iter().map(|it| it.absent.as_deref()).collect();
    assert_eq!(absent[..2], [None, None]);
    assert!(absent[2].unwrap().starts_with("there is no device `a card that nobody has`"), "{absent:?}");
    assert_eq!(plan.header.configurations[0].references, ["gpu", "plain"]);
}

#[test]
fn scenes_have_their_own_points_and_configurations() {
    let more = "\
[[scene]]
name = 'hall'
file = 'scene.txt'
[[scene]]
name = 'yard'
file = 'scene.txt'
[[configuration]]
name = 'extra'
scenes = ['hall']
[[point]]
name = '64'
scenes = ['room']
[[point]]
name = '128'
scenes = ['room', 'hall']
[[point]]
name = '64'
scenes = ['hall']
settings = { sampling = { samples = 3 } }
";
    let plan = Folder::new().plan(&format!("{HEAD}{PAIR}{more}"));
    let of = |scene: &str| names(&plan).into_iter().filter(|name| name.starts_with(scene)).collect::<Vec<_>>();
    assert_eq!(of("room"), ["room--plain--64 1", "room--cuts--64 1", "room--plain--128 1", "room--cuts--128 1"]);
    assert_eq!(of("hall").len(), 6);
    assert_eq!(of("yard"), ["yard--plain 1", "yard--cuts 1"], "without points of its own: as it is");
    assert_eq!(plan.header.points, ["64", "128"]);
    assert_eq!(job(&plan, "room--plain--64").settings.sampling.samples, 1);
    assert_eq!(job(&plan, "hall--plain--64").settings.sampling.samples, 3);
}

#[test]
fn a_selection_has_the_references_that_it_needs() {
    let more = "[[scene]]\nname = 'hall'\nfile = 'scene.txt'\n[[point]]\nname = 'p'\n[[point]]\nname = 'q'\n";
    let plan = Folder::new().plan(&format!("{HEAD}{PAIR}{more}"));
    let chosen = |patterns: &[&str]| {
        let patterns: Vec<String> = patterns.iter().map(|&pattern| pattern.to_owned()).collect();
        plan.select(&patterns).unwrap().iter().map(|&i| plan.jobs[i].stem()).collect::<Vec<_>>()
    };
    assert_eq!(chosen(&[]).len(), 8);
    assert_eq!(chosen(&["hall", "plain", "p"]), ["hall--plain--p"]);
    assert_eq!(chosen(&["hall", "c*", "q"]), ["hall--plain--q", "hall--cuts--q"]);
    assert_eq!(chosen(&["room", "hall", "plain"]).len(), 4);
    let error = plan.select(&["halls".to_owned()]).unwrap_err();
    assert!(error.to_string().contains("`halls`") && error.known.contains(&"hall".to_owned()));
}

#[test]
fn every_experiment_of_the_project_makes_a_plan() {
    let folder = lightcuts_testkit::project_root().join("experiments");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<_> = entries.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect();
    assert!(!files.is_empty());
    for path in files {
        let file = ExperimentFile::read(&path).unwrap_or_else(|error| panic!("{}", crate::support::complaint(&error)));
        let plan = Plan::new(&file, &[]).unwrap_or_else(|error| panic!("{}", crate::support::complaint(&error)));
        assert!(!plan.jobs.is_empty() && !plan.header.sections.is_empty(), "{}", path.display());
    }
}

#[test]
fn the_examples_of_the_documents_make_plans() {
    let root = lightcuts_testkit::project_root();
    let mut plans = 0;
    for document in ["docs/guide/experiment.md", "docs/formats/experiment.md"] {
        let text = std::fs::read_to_string(root.join(document)).unwrap();
        let examples = text.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
        for example in examples.filter(|example| example.contains("[[scene]]")) {
            let file = ExperimentFile::parse(document, example, &root).unwrap();
            let plan = Plan::new(&file, &[]).unwrap_or_else(|error| panic!("{}", crate::support::complaint(&error)));
            assert!(!plan.header.sections.is_empty(), "{document}");
            plans += 1;
        }
    }
    assert_eq!(plans, 2);
}
