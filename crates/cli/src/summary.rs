//! What a finished render says of itself: JSON for machines, a few lines for people.

use crate::exit::Failure;
use crate::memory;
use crate::plan::Plan;
use lightcuts::{Rendering, Settings, Stats};
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
    settings: &'a Settings,
}

impl<'a> Statistics<'a> {
    /// Of a render that just ended: the memory is that of the process so far.
    pub(crate) fn new(plan: &'a Plan, rendering: &'a Rendering) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: &plan.scene.name,
            scene_file: plan.job.scene.display().to_string(),
            threads: rayon::current_num_threads(),
            peak_memory_bytes: memory::peak_bytes(),
            stats: &rendering.stats,
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
    line("VPLs", &stats.vpl_count.to_string());
    line("light ratio", &format!("{:.4} %", stats.light_ratio_percent));
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
