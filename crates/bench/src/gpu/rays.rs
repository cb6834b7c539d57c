//! Section 3: how many rays per second, in rooms of three sizes.

use super::batches::{LIGHTS, VPLS, batches, number};
use super::log::{Log, Work, merged, seconds as seconds_of, since};
use super::setup::{CPU_THREADS, Render, Setup, stage_s};
use crate::format::{grouped, millions_per_second, seconds};
use crate::measure::middle;
use crate::room::Room;
use crate::table::Table;
use anyhow::{Result, ensure};
use lightcuts::gpu::GpuDevice;
use lightcuts::gpu::records::ProbeRay;
use lightcuts::rendering::Strategy;
use lightcuts::{Options, Settings, Stage};
use lightcuts_kernel::Rules;
use std::time::Instant;

/// Triangles of the rooms: as few as the thesis' scenes have, and more than caches hold.
const TRIANGLES: [u32; 3] = [1_400, 100_000, 1_000_000];
const HEADER: [&str; 8] =
    ["triangles", "rays", "on", "number", "hit, %", "device, s", "Mrays/s", "Mrays/s with transfer"];

const REMARKS: &str = "
* Primary rays are neighbours: those of a camera, row by row; the nearest hit is wanted.
* Incoherent rays connect random points of the surfaces; whether anything is in between is wanted.
* Rays to lights connect each of neighbouring points with the same 1024 VPLs, point by point, of which some lie behind the
  surface.
* Passes are second passes with the strategy `all` and 1024 VPLs: what a render makes of rays, shading included. Only those
  VPLs count whose light can arrive. They compare the GPU with the CPU's renderer.
";

pub(super) fn section(setup: &Setup, log: &mut Log) -> Result<String> {
    let mut table = Table::new(&HEADER);
    for triangles in TRIANGLES {
        eprintln!("rays among {triangles} triangles");
        let room = Room::new(triangles)?;
        let gpu = setup.open(&room.world)?;
        for (title, is_any, rays) in batches(&room, number(setup)) {
            let traced = Traced::new(setup, &gpu, &rays, is_any)?;
            table.push(traced.row(&room, title));
        }
        passes(setup, &gpu, &room)?.into_iter().for_each(|row| table.push(row));
        log.works.push(Work::new(format!("rays, {} triangles", grouped(room.size())), &gpu));
    }
    Ok(table.markdown() + REMARKS)
}

/// What tracing a batch took.
struct Traced {
    number: usize,
    hits: usize,
    device_s: f64,
    wall_s: f64,
}

impl Traced {
    /// The middle one of some runs, after one that compiles the program and lets the governor learn.
    fn new(setup: &Setup, gpu: &GpuDevice<'_>, rays: &[ProbeRay], is_any: bool) -> Result<Self> {
        Self::once(gpu, rays, is_any)?;
        let runs = (0..setup.runs()).map(|_| Self::once(gpu, rays, is_any)).collect::<Result<_>>()?;
        Ok(middle(runs, |run: &Self| run.device_s))
    }

    fn once(gpu: &GpuDevice<'_>, rays: &[ProbeRay], is_any: bool) -> Result<Self> {
        let (before, start) = (merged(&gpu.reports()), Instant::now());
        let hits = gpu.trace(rays, Rules::Repaired, is_any)?;
        let (wall_s, after) = (start.elapsed().as_secs_f64(), merged(&gpu.reports()));
        let program = if is_any { "any_hits" } else { "closest_hits" };
        let device_s = seconds_of(&since(&before, &after), &[program]);
        Ok(Self { number: rays.len(), hits: hits.iter().filter(|hit| hit.is_some()).count(), device_s, wall_s })
    }

    fn row(&self, room: &Room, title: &str) -> [String; 8] {
        let number = self.number as u64;
        [
            grouped(room.size()),
            title.to_owned(),
            "this GPU".to_owned(),
            grouped(number),
            format!("{:.1}", self.hits as f64 / number as f64 * 100.0),
            seconds(self.device_s),
            millions_per_second(number, self.device_s),
            millions_per_second(number, self.wall_s),
        ]
    }
}

/// Rows of second passes on both devices.
fn passes(setup: &Setup, gpu: &GpuDevice<'_>, room: &Room) -> Result<[[String; 8]; 2]> {
    let mut settings = Settings::default();
    let edge = if setup.is_quick { 32 } else { 64 };
    (settings.image.width, settings.image.height) = (edge, edge);
    settings.gather.strategy = Strategy::All;
    let options = Options { vpls: Some(room.vpls(LIGHTS, VPLS)), ..Options::default() };
    let gather_s = |render: &Render| seconds_of(&render.stages, &["gather_all"]);
    let on_gpu = setup.middle_render(gpu, &room.world, [&settings; 2], &options, gather_s)?;
    let on_cpu = setup.render_on_cpu(&room.world, &settings, &options)?;
    let shadow = on_gpu.stats.rays.shadow;
    ensure!(shadow > 0, "no VPL of the room lights what is seen");
    let row = |on: String, rays: u64, device_s: Option<f64>, wall_s: f64| {
        let of_device = |text: &dyn Fn(f64) -> String| device_s.map_or_else(|| "-".to_owned(), text);
        let (device, rate) = (of_device(&seconds), of_device(&|s| millions_per_second(rays, s)));
        let (size, wall) = (grouped(room.size()), millions_per_second(rays, wall_s));
        [size, "of a pass with `all`".to_owned(), on, grouped(rays), "-".to_owned(), device, rate, wall]
    };
    let wall_s = stage_s(&on_gpu.stats, Stage::SecondPass);
    let cpu = format!("CPU, {CPU_THREADS} threads");
    Ok([
        row("this GPU".to_owned(), shadow, Some(gather_s(&on_gpu)), wall_s),
        row(cpu, on_cpu.rays.shadow, None, stage_s(&on_cpu, Stage::SecondPass)),
    ])
}
