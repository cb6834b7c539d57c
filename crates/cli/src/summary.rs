//! What a finished render says of itself: JSON for machines, a few lines for people.

use crate::devices::GpuWork;
use crate::exit::Failure;
use crate::memory;
use crate::plan::Plan;
use lightcuts::device::DeviceKind;
use lightcuts::rendering::{Model, StationDevice};
use lightcuts::{Settings, Stats};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// The content of a `--stats` file: these, and every field of [`Stats`] beside them.
#[derive(Debug, Serialize)]
pub(crate) struct Statistics<'a> {
    version: &'static str,
    scene: &'a str,
    scene_file: String,
    threads: usize,
    /// Most memory that the process had at once; unknown outside Linux.
    peak_memory_bytes: Option<u64>,
    #[serde(flatten)]
    stats: &'a Stats,
    /// What GPUs were given to do, if there were any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    gpu: Vec<GpuWork>,
    settings: &'a Settings,
}

impl<'a> Statistics<'a> {
    /// Of a render that just ended: the memory is that of the process so far.
    pub(crate) fn new(plan: &'a Plan, stats: &'a Stats, gpu: Vec<GpuWork>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: plan.scene_name(),
            scene_file: plan.job.scene.display().to_string(),
            threads: rayon::current_num_threads(),
            peak_memory_bytes: memory::peak_bytes(),
            stats,
            gpu,
            settings: &plan.job.settings,
        }
    }

    /// As JSON, for reading by people too.
    pub(crate) fn to_json(&self) -> Result<String, Failure> {
        let refuse = |error| Failure::output(format!("cannot write the statistics: {error}"));
        serde_json::to_string_pretty(self).map(|text| text + "\n").map_err(refuse)
    }
}

/// The lines on standard output after a render.
pub(crate) fn summary(statistics: &Statistics<'_>, written: &[&Path]) -> String {
    let Statistics { stats, settings, .. } = statistics;
    let size = settings.image;
    let mut text = String::new();
    // Writing to a String cannot fail.
    let mut line = |name: &str, value: &str| {
        let _ = writeln!(text, "{name:<12} {value}");
    };
    line("scene", &format!("{} ({})", statistics.scene, statistics.scene_file));
    line("picture", &format!("{} x {}, samples {}", size.width, size.height, settings.sampling.samples));
    if settings.run.model == Model::Thesis {
        line("VPLs", &stats.vpl_count.to_string());
        line("light ratio", &format!("{:.4} %", stats.light_ratio_percent));
    } else if stats.tree.shaded_hits > 0 {
        let cut = stats.tree.selected as f64 / stats.tree.shaded_hits as f64;
        line("VPLs", &format!("{} in the last pass, {cut:.0} in a cut", stats.vpl_count));
    }
    if let Some(devices) = devices(&stats.devices) {
        line("device", &devices);
    }
    if stats.device_faults > 0 {
        line("faults", &faults(stats.device_faults));
    }
    for pass in &stats.passes {
        line(&pass.name.replace('_', " "), &format!("{:.2} s, CPU {:.2} s", pass.wall_s, pass.cpu_s));
    }
    let memory = statistics.peak_memory_bytes.map_or(String::new(), |bytes| format!(", {} MiB", bytes >> 20));
    line("total", &format!("{:.2} s, CPU {:.2} s{memory}", stats.total_wall_s, stats.total_cpu_s));
    for path in written {
        line("wrote", &path.display().to_string());
    }
    text
}

/// What rendered, unless the CPU did all of it: one device, or each with its stations.
fn devices(stations: &[StationDevice]) -> Option<String> {
    let mut groups: Vec<(&StationDevice, Vec<&str>)> = Vec::new();
    for device in stations {
        let same =
            |(other, _): &&mut (&StationDevice, Vec<&str>)| other.kind == device.kind && other.name == device.name;
        match groups.iter_mut().find(same) {
            Some((_, names)) => names.push(&device.station),
            None => groups.push((device, vec![&device.station])),
        }
    }
    let named = |device: &StationDevice| format!("{} ({})", device.name, kind_in_words(&device.kind));
    match groups.as_slice() {
        [] => None,
        [(device, _)] => (device.kind != DeviceKind::Cpu.name()).then(|| named(device)),
        groups => {
            let told = groups.iter().map(|(device, names)| format!("{} on {}", names.join(", "), named(device)));
            Some(told.collect::<Vec<_>>().join("; "))
        }
    }
}

/// `software GPU` of `software gpu`.
fn kind_in_words(kind: &str) -> String {
    kind.replace("gpu", "GPU").replace("cpu", "CPU")
}

fn faults(count: u32) -> String {
    let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
    format!("a device did not return its result {times}; that work was done again, and the picture is whole")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(station: &str, kind: &str, name: &str) -> StationDevice {
        StationDevice { station: station.to_owned(), kind: kind.to_owned(), name: name.to_owned() }
    }

    #[test]
    fn devices_are_told_unless_it_is_the_cpu_alone() {
        let cpu = |name: &str| station(name, "cpu", "Processor");
        let gpu = |name: &str| station(name, "software gpu", "llvmpipe");
        assert_eq!(devices(&[]), None);
        assert_eq!(devices(&[cpu("place"), cpu("gather")]), None);
        assert_eq!(devices(&[gpu("place"), gpu("gather")]).unwrap(), "llvmpipe (software GPU)");
        assert_eq!(
            devices(&[cpu("place"), cpu("tree"), gpu("gather")]).unwrap(),
            "place, tree on Processor (CPU); gather on llvmpipe (software GPU)"
        );
    }

    #[test]
    fn faults_are_counted_in_words() {
        assert!(faults(1).contains("once;") && faults(2).contains("2 times;"));
    }
}
