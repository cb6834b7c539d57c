//! Section 4: choosing some of very many VPLs, and building the tree for that.

use super::log::{Log, Stages, Work, seconds as seconds_of};
use super::setup::{CPU_THREADS, Render, Setup, stage_s};
use crate::format::{grouped, mebibytes, millions_per_second, milliseconds, seconds};
use crate::room::Room;
use crate::scatter::Point;
use crate::table::Table;
use anyhow::Result;
use lightcuts::gpu::GpuDevice;
use lightcuts::rendering::{Strategy, Vpl};
use lightcuts::{Options, Settings, Stage, Stats};

/// Numbers of VPLs.
const VPLS: [u32; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// VPLs that a hit is to have chosen, in the mean.
const CHOSEN: usize = 200;
/// Pixels along an edge of the picture that the threshold is found with.
const PROBES: u32 = 4;
/// Triangles of the room.
const TRIANGLES: u32 = 100_000;
/// Stream of random numbers.
const STREAM: u32 = 21;

/// Programs that bring VPLs into order, and those that build nodes over them.
const SORTING: [&str; 6] = ["morton_keys", "count_digits", "scan_blocks", "add_block_sums", "scatter", "reorder"];
const BUILDING: [&str; 2] = ["build_leaves", "build_level"];

const HEADER: [&str; 12] = [
    "VPLs",
    "threshold",
    "hits",
    "chosen / hit",
    "nodes / hit",
    "tested / hit",
    "gather_cut, s",
    "M VPLs/s",
    "CPU, M VPLs/s",
    "sort, ms",
    "nodes, ms",
    "tree, ms with transfer",
];

pub(super) fn section(setup: &Setup, log: &mut Log) -> Result<String> {
    let room = Room::new(TRIANGLES)?;
    let gpu = setup.open(&room.world)?;
    let (mut table, mut bytes, mut stages) = (Table::new(&HEADER), Vec::new(), Stages::new());
    for count in VPLS {
        eprintln!("choice among {count} VPLs");
        let measured = Measured::new(setup, &gpu, &room, count)?;
        table.push(measured.row());
        stages = measured.gpu.stages;
        bytes.push(format!("{} with {} VPLs", mebibytes(gpu.allocated_bytes()), grouped(u64::from(count))));
    }
    // Of the most VPLs.
    log.renders.push(("choice of VPLs".to_owned(), stages));
    log.works.push(Work::new("choice of VPLs".to_owned(), &gpu));
    Ok(table.markdown() + &remarks(&bytes))
}

fn remarks(bytes: &[String]) -> String {
    format!(
        "
* `M VPLs/s` is how many millions of VPLs are considered per second: hits times VPLs, by the seconds of `gather_cut`, which
  include shadow rays and shading of those chosen. The CPU's is by the wall seconds of its second pass, on {CPU_THREADS}
  threads with a tree of its own.
* `tested` are VPLs whose relevance was computed, because bounds could not decide.
* `sort` are the programs {}; `nodes` are {}.
* Bytes on the device: {}.
",
        SORTING.join(", "),
        BUILDING.join(", "),
        bytes.join(", ")
    )
}

/// The middle run with a number of VPLs.
struct Measured {
    settings: Settings,
    gpu: Render,
    cpu: Stats,
}

impl Measured {
    fn new(setup: &Setup, gpu: &GpuDevice<'_>, room: &Room, count: u32) -> Result<Self> {
        let vpls = room.vpls(count, STREAM);
        let mut settings = Settings::default();
        let edge = if setup.is_quick { 32 } else { 64 };
        (settings.image.width, settings.image.height) = (edge, edge);
        settings.gather.strategy = Strategy::Lightcuts;
        settings.gather.threshold = threshold(&room.seen(&room.camera_rays(PROBES, PROBES)), &vpls);
        let options = Options { vpls: Some(vpls), ..Options::default() };
        let gather_s = |render: &Render| seconds_of(&render.stages, &["gather_cut"]);
        let middle = setup.middle_render(gpu, &room.world, [&settings; 2], &options, gather_s)?;
        let cpu = setup.render_on_cpu(&room.world, &settings, &options)?;
        Ok(Self { settings, gpu: middle, cpu })
    }

    fn row(&self) -> [String; 12] {
        let (stats, stages) = (&self.gpu.stats, &self.gpu.stages);
        let (hits, gather_s) = (stats.tree.shaded_hits, seconds_of(stages, &["gather_cut"]));
        let per_hit = |count: u64| format!("{:.1}", count as f64 / hits.max(1) as f64);
        let considered = hits * stats.vpl_count;
        [
            grouped(stats.vpl_count),
            format!("{:.2e}", self.settings.gather.threshold),
            grouped(hits),
            format!("{:.1}", stats.light_ratio_percent / 100.0 * stats.vpl_count as f64),
            per_hit(stats.tree.nodes),
            per_hit(stats.tree.lights),
            seconds(gather_s),
            millions_per_second(considered, gather_s),
            millions_per_second(considered, stage_s(&self.cpu, Stage::SecondPass)),
            milliseconds(seconds_of(stages, &SORTING)),
            milliseconds(seconds_of(stages, &BUILDING)),
            milliseconds(stage_s(stats, Stage::LightTree)),
        ]
    }
}

/// The threshold with which points choose [`CHOSEN`] of the VPLs in the mean.
fn threshold(points: &[Point], vpls: &[Vpl]) -> f32 {
    let mut relevances: Vec<f32> =
        points.iter().flat_map(|point| vpls.iter().map(|vpl| relevance(vpl, point))).collect();
    let place = (CHOSEN * points.len()).min(relevances.len()) - 1;
    *relevances.select_nth_unstable_by(place, |a, b| b.total_cmp(a)).1
}

/// The thesis' relevance (Eq. 4.2): cosine at the light times intensity over squared distance.
fn relevance(vpl: &Vpl, point: &Point) -> f32 {
    let to_light = vpl.position - point.position;
    (-vpl.direction.dot(to_light.normalize_or_zero())).max(0.0) * vpl.intensity() / to_light.length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::light_tree::is_relevant;

    #[test]
    fn the_threshold_chooses_as_many_as_wanted() {
        let room = Room::new(1_400).unwrap();
        let (points, vpls) = (room.seen(&room.camera_rays(PROBES, PROBES)), room.vpls(5_000, STREAM));
        let threshold = threshold(&points, &vpls);
        let is_chosen = |point: &Point, vpl: &Vpl| is_relevant(vpl, vpl.intensity(), point.position, threshold);
        let chosen: usize = points.iter().map(|point| vpls.iter().filter(|vpl| is_chosen(point, vpl)).count()).sum();
        assert!(chosen.abs_diff(CHOSEN * points.len()) <= 2, "{chosen}");
    }
}
