//! What a finished render says of itself: JSON for machines, a few lines for people.

use crate::devices::GpuWork;
use crate::exit::Failure;
use crate::memory;
use crate::plan::Plan;
use lightcuts::device::DeviceKind;
use lightcuts::rendering::{End, Model, StationDevice};
use lightcuts::{Settings, Stage, Stats};
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
    let samples = samples(stats, settings.run.model);
    line("picture", &format!("{} x {}, samples {samples}", size.width, size.height));
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

/// How many samples pixels have, why there are no more of them, and how far they may be from the truth.
fn samples(stats: &Stats, model: Model) -> String {
    let mut parts = vec![number(stats.samples_per_pixel)];
    parts.extend(stats.samples_wanted.filter(|_| stats.end != End::Samples).map(|wanted| format!(" of {wanted}")));
    parts.extend(match stats.end {
        End::Samples => None,
        End::Time => Some(", time was up".to_owned()),
        End::Noise => Some(", noise low enough".to_owned()),
        End::Interrupted => Some(", interrupted".to_owned()),
    });
    if stats.end == End::Interrupted && model == Model::Thesis {
        let mut stages = stats.passes.iter().rev().map(|pass| &*pass.name);
        let last = stages.find(|&name| name != Stage::Develop.name());
        parts.extend(last.map(|name| format!(" in the stage {}", name.replace('_', " "))));
    }
    parts.extend(stats.relative_error.map(|error| format!("; relative error {}", three_digits(error))));
    if stats.unsampled_pixels > 0 {
        parts.push(format!("; {} pixels without one show the nearest of a coarse preview", stats.unsampled_pixels));
    }
    parts.concat()
}

/// A mean number of samples: whole, or to about a tenth.
fn number(mean: f64) -> String {
    match mean {
        _ if mean.fract() == 0.0 => format!("{mean:.0}"),
        0.1..100.0 => format!("{mean:.1}"),
        ..0.1 => format!("{mean:.4}"),
        _ => format!("{mean:.0}"),
    }
}

/// A small number to about three digits.
fn three_digits(value: f64) -> String {
    let digits = (2.0 - value.max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
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
    format!("a device failed {times}; its work was redone and the picture is complete")
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts::rendering::PassTime;

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
    fn samples_are_told_with_their_end() {
        let told = |stats: Stats| samples(&stats, Model::Physical);
        let whole = Stats { samples_per_pixel: 64.0, samples_wanted: Some(64), ..Stats::default() };
        assert_eq!(told(Stats { relative_error: Some(0.021_34), ..whole.clone() }), "64; relative error 0.0213");
        let timed = Stats { end: End::Time, samples_per_pixel: 7.81, ..whole };
        assert_eq!(told(Stats { samples_wanted: Some(100_000), ..timed.clone() }), "7.8 of 100000, time was up");
        assert_eq!(told(Stats { samples_wanted: None, ..timed.clone() }), "7.8, time was up");
        let short = Stats { samples_per_pixel: 0.01563, unsampled_pixels: 12, ..timed.clone() };
        assert_eq!(
            told(short),
            "0.0156 of 64, time was up; 12 pixels without one show the nearest of a coarse preview"
        );
        let low = Stats { end: End::Noise, samples_per_pixel: 1234.56, relative_error: Some(0.5), ..timed };
        assert_eq!(told(low), "1235 of 64, noise low enough; relative error 0.500");
        let passes = ["first_pass", "develop"].map(|name| PassTime { name: name.into(), wall_s: 0.0, cpu_s: 0.0 });
        let cut = Stats { end: End::Interrupted, samples_per_pixel: 0.25, samples_wanted: Some(4), ..Stats::default() };
        let cut = Stats { passes: passes.to_vec(), ..cut };
        assert_eq!(samples(&cut, Model::Thesis), "0.2 of 4, interrupted in the stage first pass");
    }

    #[test]
    fn faults_are_counted_in_words() {
        assert!(faults(1).contains("once;") && faults(2).contains("2 times;"));
    }
}
