//! Devices: what is listed, what is taken, what is said where there is none. Tests of GPUs skip without an adapter.

use crate::support::{Folder, stderr, stdout};
use lightcuts::gpu::{DeviceChoice, adapters, choose};
use serde_json::Value;

/// Whether there is an adapter.
fn has_adapter() -> bool {
    lightcuts_testkit::has_adapter(choose(&DeviceChoice::Gpu, &adapters()))
}

/// What a command says on standard output and error where no driver is found, and its exit code.
fn without_drivers(folder: &Folder, arguments: &str) -> (String, String, Option<i32>) {
    let mut command = folder.command(arguments);
    command.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code())
}

fn stats(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.text(name)).unwrap()
}

#[test]
fn the_cpu_is_listed_and_auto_explained() {
    let folder = Folder::new();
    let listed = folder.run("devices").success().stderr("");
    let said = stdout(&listed);
    assert!(said.starts_with("CPU          ") && said.contains(" threads, "), "{said}");
    assert!(said.lines().last().unwrap().starts_with("auto         uses "), "{said}");
    let list: Value = serde_json::from_str(&stdout(&folder.run("devices --json").success())).unwrap();
    assert!(list["cpu"]["threads"].as_u64() > Some(0) && list["auto"]["why"].is_string(), "{list}");
    assert_eq!(list["adapters"].as_array().unwrap().len(), adapters().len());
    assert!(stdout(&folder.run("devices --help").success()).contains("--station-device gather=gpu"));
}

#[test]
fn a_device_that_is_not_there_is_bad_usage() {
    let folder = Folder::new();
    for arguments in ["--device nonsense", "--station-device tree=nonsense", "--device nonsense --dry-run"] {
        let said = stderr(&folder.run(&format!("render scene.txt {arguments}")).code(2));
        assert!(said.contains("there is no device `nonsense`") && said.contains("available: the CPU"), "{said}");
        assert!(!folder.has("scene.png"));
    }
    for (arguments, expected) in [
        ("--device=", "expected auto, cpu, gpu"),
        ("--station-device gpu", "expected STATION=DEVICE"),
        (
            "--station-device first=gpu",
            "`first` is not a station; expected one of place, photons, tree, gather, develop",
        ),
        ("--gpu-budget 0", "0 is not in 1..=1000"),
    ] {
        let said = stderr(&folder.run(&format!("render scene.txt {arguments}")).code(2));
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn without_drivers_the_cpu_renders() {
    let folder = Folder::new();
    let (said, noted, code) = without_drivers(&folder, "render scene.txt --size 8x8 --progress none -v");
    assert_eq!(code, Some(0), "{noted}");
    assert!(folder.has("scene.png") && !said.contains("device "), "{said}");
    assert!(noted.contains("no GPU: the CPU renders"), "{noted}");
    let (_, noted, code) = without_drivers(&folder, "render scene.txt --size 8x8 -q");
    assert_eq!((noted.as_str(), code), ("", Some(0)), "no GPU is nothing unusual");
    if cfg!(target_os = "linux") {
        let (said, _, code) = without_drivers(&folder, "devices");
        assert!(said.starts_with("CPU ") && said.contains("auto         uses the CPU"), "{said}");
        assert_eq!(code, Some(0));
        let (_, noted, code) = without_drivers(&folder, "render scene.txt --device gpu");
        assert!(noted.contains("there is no graphics adapter"), "{noted}");
        assert_eq!(code, Some(2));
    }
}

#[test]
fn a_gpu_renders_what_the_cpu_renders() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new();
    let render = "render scene.txt --size 40x32 --progress none";
    let said = stdout(&folder.run(&format!("{render} --device cpu -o cpu.exr --stats cpu.json")).success());
    assert!(!said.lines().any(|line| line.starts_with("device ")), "{said}");
    for (name, options) in [
        ("gpu", "--device gpu --gpu-budget 10"),
        ("again", "--device gpu"),
        ("mixed", "--device cpu --station-device gather=gpu"),
    ] {
        let said = stdout(&folder.run(&format!("{render} {options} -o {name}.exr --stats {name}.json")).success());
        let line = said.lines().find(|line| line.starts_with("device ")).unwrap();
        assert!(line.contains("GPU)") && line.contains("(CPU)") == (name == "mixed"), "{said}");
        let verdict = stdout(&folder.run(&format!("compare cpu.exr {name}.exr")).success());
        assert!(verdict.lines().last().unwrap().ends_with("same"), "{verdict}");
    }
    assert!(folder.bytes("gpu.exr") == folder.bytes("again.exr"), "one device, one picture, however its work is cut");
    let [cpu, gpu, mixed] = ["cpu.json", "gpu.json", "mixed.json"].map(|name| stats(&folder, name));
    assert_eq!((&gpu["vpl_count"], &gpu["device_faults"]), (&cpu["vpl_count"], &0.into()));
    assert!(gpu["gpu"][0]["submissions"].as_u64() > Some(0) && gpu["gpu"][0]["budget_s"] == 0.01, "{gpu}");
    assert!(gpu["gpu"][0]["programs"]["trace"]["dispatches"].as_u64() > Some(0), "{gpu}");
    assert!(cpu.get("gpu").is_none());
    let kinds: Vec<(&str, bool)> = mixed["devices"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| (it["station"].as_str().unwrap(), it["kind"] == "cpu"))
        .collect();
    assert_eq!(kinds, [("place", true), ("tree", true), ("gather", false)]);
}

#[test]
fn a_verbose_render_tells_of_submissions() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new();
    let said = stderr(&folder.run("-v render scene.txt --size 8x8 --device gpu --progress none").success());
    for expected in ["opened ", " submissions within ", "the budget 30 ms", " ms   "] {
        assert!(said.contains(expected), "{expected} is missing in:\n{said}");
    }
}

#[test]
fn drivers_are_silent_where_there_is_no_desktop() {
    if !has_adapter() {
        return;
    }
    let folder = Folder::new();
    let mut command = folder.command("render scene.txt --size 8x8 --device gpu -q");
    let output = command.env_remove("XDG_RUNTIME_DIR").output().unwrap();
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn the_device_is_no_part_of_the_job() {
    let folder = Folder::new();
    folder.run("render scene.txt --size 8x8 --device cpu --write-job job.toml -o a.exr -q").success();
    assert!(!folder.text("job.toml").contains("device") && !folder.job_of("a.exr").contains("device"));
}

#[test]
fn an_experiment_renders_on_a_gpu_or_says_why_not() {
    let folder = Folder::new();
    folder.write(
        "e.toml",
        "name = 'small'\nruns = 2\n[settings]\nimage = { width = 24, height = 16 }\n\
         [[scene]]\nname = 'room'\nfile = 'scene.txt'\n\
         [[configuration]]\nname = 'cpu'\n\
         [[configuration]]\nname = 'gpu'\ndevice = 'gpu'\nreferences = ['cpu']\n\
         [[section]]\nid = 't'\ntitle = 'T'\nshows = 'times'\nscene = 'room'\nconfigurations = ['cpu', 'gpu']\n",
    );
    let (said, _, _) = without_drivers(&folder, "experiment e.toml --dry-run");
    if cfg!(target_os = "linux") {
        assert!(said.contains("absent       gpu: there is no graphics adapter"), "{said}");
        assert!(said.contains("2: 0 finished, 2 to render"), "{said}");
    }
    if !has_adapter() {
        return;
    }
    let said = stdout(&folder.run("experiment e.toml --progress none").success().stderr(""));
    assert!(said.contains("GPU          ") && said.contains("rendered     4 jobs"), "{said}");
    folder.run("report out/small/results.jsonl -q").success();
    let report = folder.text("out/small/report/report.md");
    assert!(report.contains("of GPUs elapsed seconds") && report.contains("Rendered on "), "{report}");
}
