//! Configurations of GPUs: planned where there is an adapter, rendered on it, else absent with the reason.

use crate::support::{Folder, HEAD};
use lightcuts::device::DeviceKind;
use lightcuts::gpu::{AdapterSummary, DeviceChoice, adapters, choose};
use lightcuts_experiment::{ExperimentFile, Plan};

const DEVICES: &str = "\
[[configuration]]
name = 'plain'
[[configuration]]
name = 'gpu'
device = 'gpu'
references = ['plain']
[[configuration]]
name = 'card'
device = 'Card 9000'
references = ['plain', 'gpu']
";

fn adapter(name: &str, kind: DeviceKind) -> AdapterSummary {
    AdapterSummary { name: name.to_owned(), kind, ..AdapterSummary::default() }
}

/// The plan of a text on a machine with these adapters.
fn plan_on(folder: &Folder, adapters: &[AdapterSummary], text: &str) -> Plan {
    let file = ExperimentFile::parse("a.toml", text, &folder.at("")).unwrap();
    Plan::on(adapters.to_vec(), &file, &[]).unwrap()
}

fn text() -> String {
    format!("{HEAD}{}", DEVICES.replace("['plain', 'gpu']", "['plain']"))
}

#[test]
fn what_has_an_adapter_is_planned_and_the_rest_absent_with_the_reason() {
    let folder = Folder::new();
    let software = adapter("llvmpipe", DeviceKind::SoftwareGpu);
    let card = adapter("My Card 9000", DeviceKind::Gpu);
    let planned = |adapters: &[AdapterSummary]| {
        let plan = plan_on(&folder, adapters, &text());
        let absent: Vec<_> =
            plan.header.configurations.iter().map(|it| it.absent.clone().unwrap_or_default()).collect();
        let used: Vec<_> = plan.used_adapters().iter().map(|adapter| adapter.name.clone()).collect();
        let jobs: Vec<_> = plan.jobs.iter().map(|job| job.configuration.clone()).collect();
        (jobs, absent, used)
    };
    let (jobs, absent, used) = planned(&[]);
    assert_eq!((jobs, used), (vec!["plain".to_owned()], vec![]));
    assert!(absent[0].is_empty() && absent[1].starts_with("there is no graphics adapter"), "{absent:?}");
    assert!(absent[2].starts_with("there is no device `Card 9000`"), "{absent:?}");
    let (jobs, absent, used) = planned(std::slice::from_ref(&software));
    assert_eq!((jobs.len(), used), (2, vec!["llvmpipe".to_owned()]));
    assert!(absent[1].is_empty() && !absent[2].is_empty());
    let (jobs, absent, used) = planned(&[card, software]);
    assert_eq!((jobs.len(), used, absent.concat().as_str()), (3, vec!["My Card 9000".to_owned()], ""));
}

#[test]
fn the_hash_has_the_device_as_it_was_asked_for() {
    let folder = Folder::new();
    let adapters = [adapter("My Card 9000", DeviceKind::Gpu)];
    let hash = |device: &str| {
        let text = format!("{HEAD}[[configuration]]\nname = 'a'\n{device}");
        plan_on(&folder, &adapters, &text).jobs[0].hash.clone()
    };
    let [cpu, gpu, name] = ["", "device = 'gpu'", "device = 'card 9000'"].map(hash);
    assert!(cpu != gpu && gpu != name && name != cpu);
    assert_eq!([hash("device = 'cpu'"), hash("device = 'CPU'")], [cpu.clone(), cpu]);
    assert_eq!(hash("device = 'GPU'"), gpu);
}

#[test]
fn scenes_give_every_device_the_values_of_a_cpu_unless_asked() {
    let folder = Folder::new();
    let scene =
        crate::support::SCENE.replace("0.03)", "GPU:0.02-CPU:0.04)").replace("LC(2e-7)", "LC(GPU:3e-7-CPU:2e-7)");
    folder.write("scene.txt", scene);
    let adapters = [adapter("My Card", DeviceKind::Gpu)];
    let values = |more: &str| {
        let text = format!("{HEAD}[[configuration]]\nname = 'a'\n{more}");
        let settings = plan_on(&folder, &adapters, &text).jobs[0].settings.clone();
        (settings.vpl.attenuation, settings.gather.threshold)
    };
    assert_eq!([values(""), values("device = 'gpu'")], [(0.04, 2e-7); 2]);
    assert_eq!(values("device = 'gpu'\nscene-values = 'gpu'"), (0.02, 3e-7));
    let own = "scene-values = 'gpu'\nsettings = { vpl = { attenuation = 0.5 } }";
    assert_eq!(values(own), (0.5, 3e-7), "settings lie above what the scene recommends");
}

#[test]
fn a_gpu_renders_what_the_cpu_renders() {
    if !lightcuts_testkit::has_adapter(choose(&DeviceChoice::Gpu, &adapters())) {
        return;
    }
    let folder = Folder::new();
    let outcome = folder.run(&format!("runs = 2\n{}", text()));
    assert_eq!((outcome.rendered, outcome.interrupted), (4, false), "the runs have the same pictures");
    let rows = folder.results().rows;
    let of = |name: &str| rows.iter().find(|row| row.configuration == name).unwrap();
    let (cpu, gpu) = (of("plain"), of("gpu"));
    assert!(["gpu", "software gpu"].contains(&gpu.device.kind.as_str()) && gpu.device.threads == 0, "{:?}", gpu.device);
    assert_eq!((cpu.device.kind.as_str(), cpu.device.threads), ("cpu", 1));
    assert!(gpu.stats.devices.iter().all(|station| station.name == gpu.device.name) && gpu.stats.device_faults == 0);
    assert_eq!(gpu.stats.vpl_count, cpu.stats.vpl_count);
    assert!((gpu.stats.light_ratio_percent - cpu.stats.light_ratio_percent).abs() < 0.01);
    assert_eq!(gpu.comparisons["plain"].metrics["pdiff_px"], Some(0.0));
}
