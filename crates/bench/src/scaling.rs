//! `cargo xtask bench scaling`: how the work of cuts grows with the number of VPLs, against the sum over all of them.

use crate::physical::{load, render, settings};
use crate::place;
use crate::record;
use crate::table::{Table, verdict};
use anyhow::{Result, ensure};
use lightcuts::image::Image;
use lightcuts::rendering::Strategy;
use lightcuts::{PhysicalRendering, PhysicalWorld};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Error of a cluster, relative to the pixel's light.
const CUT_ERROR: f32 = 0.02;
/// Clusters of a cut: more than any needs, so that the error alone ends it.
const MAX_CUT: u32 = 100_000;

/// Speed-up at [`COMPARED`] VPLs, and the relative error that it may cost.
const LEAST_SPEED_UP: f64 = 100.0;
const MOST_ERROR: f64 = 0.02;
const COMPARED: u32 = 100_000;
/// How much longer a pixel may take with [`MANY`] VPLs than with [`FEW`].
const MOST_GROWTH: f64 = 2.5;
const FEW: u32 = 10_000;
const MANY: u32 = 1_000_000;
/// CPU seconds of building the tree over [`MANY`] VPLs, and bytes per VPL with its share of the tree.
const MOST_TREE_S: f64 = 2.0;
const MOST_BYTES: f64 = 128.0;

const HEADER: [&str; 10] = [
    "VPLs",
    "cut",
    "ms per pixel",
    "all, ms per pixel",
    "speed-up",
    "with VPLs and tree",
    "relative RMSE",
    "of indirect light",
    "tree, CPU s",
    "bytes per VPL",
];

const REMARKS: &str = "
CPU seconds over all threads, of one sample per pixel. `ms per pixel` is gathering with everything that belongs to a sample;
tracing VPLs, building the tree and the look at the picture that comes before are left out, and stand in the column after the
speed-up. The relative RMSE compares pixels through cuts with pixels through the same VPLs all together: of all of their light, to
which the cuts' error is relative, and of indirect light alone.
";

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Scene of the physical model.
    #[arg(long, value_name = "FILE", default_value = "scenes/physical/room.toml")]
    scene: PathBuf,
    /// Width and height of the picture in pixels.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(8..=512))]
    size: u32,
    /// Append the table to benches/LOG.md, with the date, the processor and the git revision.
    #[arg(long)]
    append: bool,
}

/// One number of VPLs.
#[derive(Debug, Clone, Copy)]
struct Row {
    wanted: u32,
    vpls: u64,
    cut: f64,
    /// CPU seconds per pixel, and with everything before.
    pixel_s: f64,
    whole_s: f64,
    all: Option<Compared>,
    tree_s: f64,
    bytes: f64,
}

/// The sum over all VPLs of the same set.
#[derive(Debug, Clone, Copy)]
struct Compared {
    pixel_s: f64,
    whole_s: f64,
    error: f64,
    indirect_error: f64,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let world = load(&place::root().join(&args.scene), &[])?;
    let mut rows = Vec::new();
    for vpls in [1_000, FEW, COMPARED, MANY] {
        eprintln!("about {vpls} VPLs");
        rows.push(measure(&world, args.size, vpls)?);
    }
    let text = table(&rows) + REMARKS + &targets(&rows);
    println!("\n{text}");
    if args.append {
        let subject = format!("cuts in {}, {} x {}", args.scene.display(), args.size, args.size);
        record::append_to_log(&subject, &text)?;
    }
    Ok(())
}

fn measure(world: &PhysicalWorld, size: u32, vpls: u32) -> Result<Row> {
    let once = |strategy| {
        let mut settings = settings(size, 1);
        settings.gather.strategy = strategy;
        let physical = &mut settings.physical;
        (physical.vpls, physical.cut_error, physical.max_cut) = (vpls, CUT_ERROR, MAX_CUT);
        render(world, &settings)
    };
    let cut = once(Strategy::Lightcuts)?;
    let all = if vpls <= COMPARED { Some(once(Strategy::All)?) } else { None };
    let stats = &cut.stats;
    let compare = |all: &PhysicalRendering| {
        ensure!(all.stats.vpl_count == stats.vpl_count, "one seed gave two sets of VPLs");
        let (pixel_s, whole_s) = (pixel_s(all), all.stats.total_cpu_s);
        let error = relative_rmse(&all.beauty, &cut.beauty);
        Ok(Compared {
            pixel_s,
            whole_s,
            error,
            indirect_error: relative_rmse(&all.aovs().indirect, &cut.aovs().indirect),
        })
    };
    Ok(Row {
        wanted: vpls,
        vpls: stats.vpl_count,
        cut: stats.tree.selected as f64 / stats.tree.shaded_hits.max(1) as f64,
        pixel_s: pixel_s(&cut),
        whole_s: stats.total_cpu_s,
        all: all.as_ref().map(compare).transpose()?,
        tree_s: stats.vpl_work.tree.cpu_s,
        bytes: stats.vpl_work.bytes as f64 / stats.vpl_count.max(1) as f64,
    })
}

/// CPU seconds of a pixel's samples alone.
fn pixel_s(rendering: &PhysicalRendering) -> f64 {
    let (stats, pixels) = (&rendering.stats, rendering.beauty.pixels().len());
    let before = stats.vpl_work.pilot.cpu_s + stats.vpl_work.placing.cpu_s + stats.vpl_work.tree.cpu_s;
    (stats.total_cpu_s - before) / pixels as f64
}

/// Root mean square of the pixels' relative differences, in their sums of channels; pixels without light do not count.
fn relative_rmse(all: &Image, cut: &Image) -> f64 {
    let sum = |pixel: &[f32; 3]| f64::from(pixel.iter().sum::<f32>());
    let pairs = all.pixels().iter().zip(cut.pixels()).map(|(a, b)| (sum(a), sum(b)));
    let squares: Vec<f64> = pairs.filter(|&(all, _)| all > 0.0).map(|(all, cut)| (cut / all - 1.0).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

fn table(rows: &[Row]) -> String {
    let mut table = Table::new(&HEADER);
    for row in rows {
        let of_all = |show: &dyn Fn(&Compared) -> String| row.all.as_ref().map_or_else(|| "-".to_owned(), show);
        table.push([
            row.vpls.to_string(),
            format!("{:.0}", row.cut),
            format!("{:.3}", row.pixel_s * 1e3),
            of_all(&|all| format!("{:.3}", all.pixel_s * 1e3)),
            of_all(&|all| format!("{:.1}", all.pixel_s / row.pixel_s)),
            of_all(&|all| format!("{:.1}", all.whole_s / row.whole_s)),
            of_all(&|all| format!("{:.2} %", all.error * 100.0)),
            of_all(&|all| format!("{:.2} %", all.indirect_error * 100.0)),
            format!("{:.3}", row.tree_s),
            format!("{:.0}", row.bytes),
        ]);
    }
    table.markdown()
}

fn targets(rows: &[Row]) -> String {
    let of = |wanted| rows.iter().find(|row| row.wanted == wanted);
    let mut text = "\n".to_owned();
    let mut line = |what: String, met| {
        let _ = writeln!(text, "* {what}: {}", verdict(met));
    };
    if let Some((row, all)) = of(COMPARED).and_then(|row| Some((row, row.all?))) {
        let speed_up = all.pixel_s / row.pixel_s;
        line(
            format!("speed-up at {COMPARED} VPLs {speed_up:.1}, at least {LEAST_SPEED_UP}"),
            speed_up >= LEAST_SPEED_UP,
        );
        // Which light the target is of was never said, so both are judged: cuts promise their error of all light only.
        for (what, error) in [("all light", all.error), ("indirect light", all.indirect_error)] {
            let (found, most) = (error * 100.0, MOST_ERROR * 100.0);
            line(format!("its relative RMSE of {what} {found:.2} %, at most {most:.0} %"), error <= MOST_ERROR);
        }
    }
    if let (Some(few), Some(many)) = (of(FEW), of(MANY)) {
        let growth = many.pixel_s / few.pixel_s;
        line(
            format!("time per pixel from {FEW} to {MANY} VPLs x {growth:.2}, at most {MOST_GROWTH}"),
            growth <= MOST_GROWTH,
        );
        line(
            format!("tree of {MANY} VPLs {:.2} CPU s, less than {MOST_TREE_S}", many.tree_s),
            many.tree_s < MOST_TREE_S,
        );
        line(format!("bytes per VPL {:.0}, at most {MOST_BYTES}", many.bytes), many.bytes <= MOST_BYTES);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_met_or_missed() {
        let all = Compared { pixel_s: 0.2, whole_s: 9.0, error: 0.01, indirect_error: 0.05 };
        let row = |wanted, pixel_s, all| Row {
            wanted,
            vpls: u64::from(wanted),
            cut: 200.0,
            pixel_s,
            whole_s: 1.0,
            all,
            tree_s: 1.5,
            bytes: 112.0,
        };
        let rows = [row(FEW, 1e-3, None), row(COMPARED, 1e-3, Some(all)), row(MANY, 3e-3, None)];
        let text = targets(&rows);
        let verdicts: Vec<&str> = text.lines().filter_map(|line| line.rsplit(": ").next()).collect();
        assert_eq!(verdicts[1..], ["met", "met", "missed", "missed", "met", "met"], "{text}");
        assert!(table(&rows).contains("| 200.0 "), "{}", table(&rows));
    }
}
