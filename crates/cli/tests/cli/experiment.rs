//! Experiments with the real binary: what is said, what is rendered once and only once, whatever ends the process.

use crate::support::{Folder, stderr, stdout};
use lightcuts_experiment::Results;
use std::collections::HashSet;
use std::fs;

/// Six jobs of small pictures.
const EXPERIMENT: &str = "\
name = 'small'
runs = 2
[settings]
image = { width = 24, height = 16 }
[[scene]]
name = 'room'
file = 'scene.txt'
[[configuration]]
name = 'cuts'
references = ['plain']
[[configuration]]
name = 'plain'
settings = { gather = { strategy = 'all' } }
[[configuration]]
name = 'gpu'
device = 'a card that nobody has'
[[configuration]]
name = 'tested'
references = ['plain']
settings = { gather = { strategy = 'lightcuts-exhaustive' } }
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("e.toml", EXPERIMENT);
    folder
}

fn results(folder: &Folder) -> Results {
    Results::read(&folder.at("out/small/results.jsonl")).unwrap()
}

#[test]
fn an_experiment_is_rendered_once() {
    let folder = folder();
    let said = stdout(&folder.run("experiment e.toml").success());
    for expected in [
        "experiment   small",
        "absent       gpu: there is no device `a card that nobody has`",
        "rendered     6 jobs; 0 had been finished before",
        "next         lightcuts report out/small/results.jsonl -o out/small/report",
    ] {
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
    let before = folder.bytes("out/small/results.jsonl");
    assert!(
        stdout(&folder.run("experiment e.toml").success()).contains("rendered     0 jobs; 6 had been finished before")
    );
    assert!(before == folder.bytes("out/small/results.jsonl"));
    assert_eq!(results(&folder).rows.len(), 6);
    folder.run("experiment e.toml -q --progress none").success().stdout("").stderr("");
}

#[test]
fn a_dry_run_tells_what_is_left_and_leaves_no_trace() {
    let folder = folder();
    let said = stdout(&folder.run("experiment e.toml --dry-run").success());
    assert!(said.contains("6: 0 finished, 6 to render") && said.contains("room, cuts: 0 of 2 runs finished"), "{said}");
    folder.run("experiment e.toml --dry-run -q").success().stdout("").stderr("");
    assert!(!folder.has("out"));
    folder.run("experiment e.toml -o elsewhere --only plain").success();
    let said = stdout(&folder.run("experiment e.toml -o elsewhere --dry-run").success());
    assert!(
        said.contains("6: 2 finished, 4 to render") && said.contains("room, plain: 2 of 2 runs finished"),
        "{said}"
    );
    let said = stdout(&folder.run("experiment e.toml -o elsewhere --dry-run --only cuts").success());
    assert!(said.contains("3: 1 finished, 2 to render"), "with run 1 of the reference: {said}");
}

#[test]
fn pictures_can_be_rendered_again() {
    let folder = folder();
    folder.run("experiment e.toml -q --only cuts").success();
    folder.run("render out/small/images/room--cuts.exr -o again.exr -q").success();
    let beauty = |name: &str| lightcuts::image::read_exr(folder.at(name)).unwrap().into_beauty();
    assert!(beauty("again.exr") == beauty("out/small/images/room--cuts.exr"));
    assert!(folder.job_of("out/small/images/room--cuts.exr").starts_with("scene = \"../../../scene.txt\"\n"));
}

#[test]
fn faults_have_their_place_and_exit_code() {
    let folder = folder();
    let cases = [
        (EXPERIMENT.replace("runs = 2", "rusn = 2"), 2, "e.toml:2:1: unknown key `rusn`"),
        (EXPERIMENT.replace("width = 24", "width = 0"), 2, "e.toml:4:19: image.width is 0; expected 1 to 65536"),
        (EXPERIMENT.replace("['plain']", "['plian']"), 2, "did you mean `plain`?"),
        (EXPERIMENT.replace("scene.txt", "none.txt"), 2, "e.toml:7:8: "),
        (EXPERIMENT.replace("scene.txt", "e.toml"), 2, "e.toml:7:8: experiments render the thesis' model only"),
        (EXPERIMENT.replace("scene.txt", "bad.txt"), 3, "bad.txt"),
    ];
    folder.write("bad.txt", "P SPH|C{}");
    for (text, code, expected) in cases {
        folder.write("e.toml", text);
        let said = stderr(&folder.run("experiment e.toml").code(code));
        assert!(said.contains(expected) && !said.contains("panicked"), "{expected} is missing in:\n{said}");
        assert!(!folder.has("out"), "{expected}");
        folder.write("e.toml", EXPERIMENT);
    }
    assert!(stderr(&folder.run("experiment none.toml").code(2)).contains("none.toml"));
    assert!(stderr(&folder.run("experiment e.toml --only nobody").code(2)).contains("expected one of room, cuts"));
    folder.write("taken", "");
    assert!(stderr(&folder.run("experiment e.toml -o taken").code(1)).contains("taken"));
    fs::create_dir_all(folder.at("out/small")).unwrap();
    folder.write("out/small/results.jsonl", "nonsense\n");
    for command in ["experiment e.toml", "experiment e.toml --dry-run"] {
        assert!(stderr(&folder.run(command).code(3)).contains("results.jsonl:1: this is not a record"));
    }
}

#[test]
fn progress_goes_over_the_whole_plan() {
    let folder = folder();
    let said = stderr(&folder.run("experiment e.toml -q --progress json").success());
    let lines: Vec<serde_json::Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let finished: Vec<_> = lines.iter().filter(|line| line["stage"] == "finished").map(|line| &line["job"]).collect();
    assert_eq!(finished, [1, 2, 3, 4, 5, 6].iter().collect::<Vec<_>>());
    let help = stdout(&folder.run("experiment --help").success());
    let (_, told) = help.split_once("A JSON object per line, with ").unwrap();
    let told: Vec<&str> = told.split_once("- none").unwrap().0.split([',', ';', ' ', '\n']).collect();
    for key in lines.iter().flat_map(|line| line.as_object().unwrap().keys()) {
        assert!(told.contains(&key.as_str()), "{key} is missing in {told:?}");
    }
    assert!(lines.iter().all(|line| line["jobs"] == 6 && line["scene"] == "room"));
    assert!(lines.iter().any(|line| line["stage"] == "second_pass"));
    assert!(lines.iter().any(|line| line["stage"] == "pdiff_px against plain"));
    assert!(lines.first().unwrap()["remaining_s"].is_null() && lines.last().unwrap()["remaining_s"].is_number());
    fs::remove_dir_all(folder.at("out")).unwrap();
    let said = stderr(&folder.run("experiment e.toml --progress plain").success());
    assert!(
        said.starts_with("job 1 of 6: room, plain, run 1\n") && said.contains("job 6 of 6: room, tested, run 2; about")
    );
}

/// Experiments that are stopped from outside.
#[cfg(unix)]
mod stopped {
    use super::*;
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Child, ChildStderr, Command, Stdio};

    fn start(folder: &Folder, experiment: &str) -> (Child, BufReader<ChildStderr>) {
        let arguments = format!("experiment {experiment} --progress json");
        let mut child = folder.command(&arguments).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        (child, stderr)
    }

    /// Waits for a line that holds `part`.
    fn wait_for(stderr: &mut BufReader<ChildStderr>, part: &str) {
        let mut said = String::new();
        while !said.contains(part) {
            said.clear();
            assert!(stderr.read_line(&mut said).unwrap() > 0, "it ended before {part}");
        }
    }

    fn signal(child: &Child, name: &str) {
        let sent = Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status().unwrap();
        assert!(sent.success());
    }

    #[test]
    fn a_killed_experiment_keeps_every_finished_row() {
        let folder = folder();
        // Enough of them that none of the processes comes to an end by itself.
        folder.write("e.toml", EXPERIMENT.replace("runs = 2", "runs = 30"));
        let mut kept: Vec<String> = Vec::new();
        for _ in 0..3 {
            let (mut child, mut stderr) = start(&folder, "e.toml");
            wait_for(&mut stderr, "\"stage\":\"finished\"");
            signal(&child, "KILL");
            child.wait().unwrap();
            let lines = folder.text("out/small/results.jsonl");
            let whole: Vec<String> =
                lines.split_inclusive('\n').filter(|line| line.ends_with('\n')).map(str::to_owned).collect();
            assert!(whole.len() > kept.len() && whole.starts_with(&kept), "finished rows stay as they are");
            kept = whole;
        }
        folder.run("experiment e.toml -q").success();
        assert!(folder.text("out/small/results.jsonl").starts_with(&kept.concat()));
        let rows = results(&folder).rows;
        let jobs: HashSet<_> = rows.iter().map(|row| row.job.clone()).collect();
        assert_eq!((rows.len(), jobs.len()), (90, 90), "all are there, none was rendered again");
    }

    #[test]
    fn an_interrupted_experiment_ends_in_good_order_and_goes_on() {
        let folder = folder();
        // The second render would take hours.
        let slow = EXPERIMENT.replace(
            "'lightcuts-exhaustive' }",
            "'all' }, sampling = { samples = 4096 }, image = { width = 512, height = 512 }",
        );
        let slow = slow.replace("name = 'tested'\nreferences = ['plain']", "name = 'tested'");
        folder.write("slow.toml", slow);
        for name in ["INT", "TERM"] {
            let (mut child, mut stderr) = start(&folder, "slow.toml");
            wait_for(&mut stderr, "\"configuration\":\"tested\"");
            signal(&child, name);
            let mut said = String::new();
            stderr.read_to_string(&mut said).unwrap();
            assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
            assert!(said.contains("1 of 6 jobs are finished in out/small/results.jsonl"), "{said}");
            assert!(said.contains("the same command continues"), "{said}");
            assert_eq!(results(&folder).rows.len(), 1);
        }
        let said = stdout(&folder.run("experiment e.toml").success());
        assert!(said.contains("rendered     5 jobs; 1 had been finished before"), "{said}");
    }

    #[test]
    fn a_second_experiment_in_the_same_folder_is_refused() {
        let folder = folder();
        let slow = EXPERIMENT.replace("[settings]", "[settings]\nsampling = { samples = 4096 }").replace("24", "512");
        folder.write("slow.toml", slow.replace("16", "512"));
        let (mut child, mut stderr) = start(&folder, "slow.toml");
        wait_for(&mut stderr, "first_pass");
        let said = super::stderr(&folder.run("experiment e.toml").code(2));
        assert!(said.contains("is in use by another `lightcuts experiment`"), "{said}");
        signal(&child, "KILL");
        child.wait().unwrap();
        folder.run("experiment e.toml -q").success();
    }
}
