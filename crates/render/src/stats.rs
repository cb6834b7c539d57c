//! What a render counted and how long it took.

use crate::monitor::Stage;
use cpu_time::ProcessTime;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::time::Instant;

/// Statistics of a render; serialised, the body of a `--stats` file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Stats {
    /// Number of VPLs.
    pub vpl_count: u64,
    /// Mean share of the VPLs that lit a shaded hit of the second pass, in percent. With `reproduce` a float32 running
    /// sum, as in the original.
    pub light_ratio_percent: f64,
    /// Stages in order.
    pub passes: Vec<PassTime>,
    /// Sum of the passes' elapsed times, in seconds.
    pub total_wall_s: f64,
    /// Sum of the passes' processor times over all threads, in seconds.
    pub total_cpu_s: f64,
    /// Rays by kind.
    pub rays: Rays,
    /// Work of choosing VPLs.
    pub tree: TreeVisits,
    /// Photons stored for caustics.
    pub photons_stored: u64,
    /// Pixels that got adaptive samples in either pass.
    pub adaptive_pixels: u64,
    /// Whether the render ran to its end: false if somebody broke it off.
    pub complete: bool,
    /// Why no more samples were taken.
    #[serde(default)]
    pub end: End,
    /// Samples of a pixel, on average; of the thesis' model those of the first pass. What a pixel shows of a
    /// neighbour's does not count.
    #[serde(default)]
    pub samples_per_pixel: f64,
    /// Samples of every pixel that were asked for; none where only time, noise or a person ends the render.
    #[serde(default)]
    pub samples_wanted: Option<u64>,
    /// Pixels of the physical model that show the nearest one that has a sample, because the first pass was broken off.
    #[serde(default)]
    pub unsampled_pixels: u64,
    /// Of the physical model: relative standard error of the pixels, as a root mean square, estimated from how much
    /// their samples vary; of large pictures from a part of the rows. None where no pixel has two samples.
    #[serde(default)]
    pub relative_error: Option<f64>,
    /// What ran each station, in the order place, photons, tree, gather, develop; only those that ran.
    #[serde(default)]
    pub devices: Vec<StationDevice>,
    /// How often a device did not return a result, so that its work was done again.
    #[serde(default)]
    pub device_faults: u32,
    /// What the physical model's VPLs cost before they were gathered.
    #[serde(default)]
    pub vpl_work: VplWork,
}

/// What ends a render.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// All samples are taken.
    #[default]
    Samples,
    /// The limit of time.
    Time,
    /// The noise is as low as it was to be.
    Noise,
    /// A person, or a program, that would not wait.
    Interrupted,
}

/// Parts of the physical model's passes, all passes together.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct VplWork {
    /// Learning how bright pixels are and how many VPLs a light path leaves.
    pub pilot: PartTime,
    /// Tracing light paths.
    pub placing: PartTime,
    /// Building trees.
    pub tree: PartTime,
    /// Memory of the largest pass's VPLs with their tree, in bytes.
    pub bytes: u64,
}

/// Time of a part of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PartTime {
    /// Elapsed time in seconds.
    pub wall_s: f64,
    /// Processor time over all threads, in seconds.
    pub cpu_s: f64,
}

impl PartTime {
    /// Does some work and adds its time.
    pub(crate) fn add<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), ProcessTime::try_now().ok());
        let result = work();
        let wall_s = wall.elapsed().as_secs_f64();
        self.wall_s += wall_s;
        self.cpu_s += cpu.and_then(|start| start.try_elapsed().ok()).map_or(wall_s, |d| d.as_secs_f64());
        result
    }
}

/// The device that finished a station.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StationDevice {
    /// `place`, `photons`, `tree`, `gather` or `develop`.
    pub station: String,
    /// `cpu`, `gpu` or `software gpu`.
    pub kind: String,
    /// Name of the processor or card.
    pub name: String,
}

/// Time of one stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PassTime {
    /// [`Stage::name`].
    pub name: Cow<'static, str>,
    /// Elapsed time in seconds.
    pub wall_s: f64,
    /// Processor time over all threads, in seconds.
    pub cpu_s: f64,
}

/// Rays by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Rays {
    /// From the camera, in both passes.
    pub primary: u64,
    /// Mirrored and refracted.
    pub secondary: u64,
    /// To lights and VPLs.
    pub shadow: u64,
    /// Of ambient occlusion.
    pub occlusion: u64,
    /// Of photons.
    pub photon: u64,
}

/// Work of choosing VPLs in the second pass.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct TreeVisits {
    /// Hits that VPLs were chosen for.
    pub shaded_hits: u64,
    /// Clusters whose bounds were computed.
    pub nodes: u64,
    /// VPLs whose relevance was computed.
    pub lights: u64,
    /// VPLs chosen.
    pub selected: u64,
    /// Clusters and VPLs visited per hit; testing every light would visit `vpl_count`.
    pub visits_per_hit: f64,
}

impl TreeVisits {
    /// Adds another's counts.
    pub fn add(&mut self, other: &Self) {
        self.shaded_hits += other.shaded_hits;
        self.nodes += other.nodes;
        self.lights += other.lights;
        self.selected += other.selected;
    }
}

impl Rays {
    /// Adds another's counts.
    pub fn add(&mut self, other: &Self) {
        self.primary += other.primary;
        self.secondary += other.secondary;
        self.shadow += other.shadow;
        self.occlusion += other.occlusion;
        self.photon += other.photon;
    }
}

/// Runs a stage and records its time.
pub(crate) fn timed<T>(passes: &mut Vec<PassTime>, stage: Stage, work: impl FnOnce() -> T) -> T {
    let mut time = PartTime::default();
    let result = time.add(work);
    passes.push(PassTime { name: stage.name().into(), wall_s: time.wall_s, cpu_s: time.cpu_s });
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_older_versions_are_read() {
        let stats = Stats { vpl_count: 290, ..Stats::default() };
        let mut old = toml::Table::try_from(&stats).unwrap();
        for key in ["devices", "device_faults", "end", "samples_per_pixel", "unsampled_pixels"] {
            assert!(old.remove(key).is_some(), "{key}");
        }
        assert_eq!(old.try_into::<Stats>().unwrap(), stats);
    }
}
