//! Section 6: the scene that the governor is tried with.

use super::log::{Log, Work};
use super::setup::{Setup, stage_s};
use super::submissions::{of_works, verdict};
use crate::format::{block, grouped};
use crate::room::Room;
use anyhow::Result;
use lightcuts::rendering::Strategy;
use lightcuts::{Options, Settings, Stage};

/// Stream of random numbers.
const STREAM: u32 = 31;

/// How heavy.
struct Load {
    triangles: u32,
    vpls: u32,
    /// Pixels along an edge of the picture.
    edge: u32,
}

const FULL: Load = Load { triangles: 1_000_000, vpls: 100_000, edge: 24 };
const QUICK: Load = Load { triangles: 100_000, vpls: 20_000, edge: 12 };

/// One render on a device that was opened just now, so that its governor knows nothing.
pub(super) fn section(setup: &Setup, _: &mut Log) -> Result<String> {
    let load = if setup.is_quick { QUICK } else { FULL };
    let room = Room::new(load.triangles)?;
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (load.edge, load.edge);
    settings.gather.strategy = Strategy::All;
    let options = Options { vpls: Some(room.vpls(load.vpls, STREAM)), ..Options::default() };
    let gpu = setup.open(&room.world)?;
    let render = setup.render(&gpu, &room.world, &settings, &options)?;
    let work = Work::new("heavy scene".to_owned(), &gpu);
    Ok(format!(
        "{} triangles, {} VPLs, all of which light each hit, {edge} x {edge} pixels: a second pass of {:.2} s with {} shadow
rays, on a device that was opened for it.

{}
{}
{}",
        grouped(room.size()),
        grouped(u64::from(load.vpls)),
        stage_s(&render.stats, Stage::SecondPass),
        grouped(render.stats.rays.shadow),
        of_works(std::slice::from_ref(&work)),
        verdict(&work.report),
        block(&work.report.lines()),
        edge = load.edge,
    ))
}
