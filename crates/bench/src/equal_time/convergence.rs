//! `cargo xtask bench convergence`: error against time, with and without what gives back the clamp's share.

use super::case::Case;
use super::{Scene, error, on_threads, reference};
use crate::physical::{busy_s, render, settings};
use crate::place;
use anyhow::{Context as _, Result, anyhow};
use lightcuts_experiment::report::{Line, LogChart, Point};
use std::fs;
use std::path::Path;

/// Where the chart is kept.
const CHART: &str = "docs/images/convergence.svg";

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Samples per pixel of the longest renders; the others have a quarter each time.
    #[arg(long, default_value_t = 1024)]
    samples: u32,
    #[command(flatten)]
    reference: reference::Args,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    on_threads(|| {
        let mut lines = Vec::new();
        for scene in [Scene::Open, Scene::Occluded] {
            let Some(case) = Case::new(scene, Path::new(""), &args.reference)? else { continue };
            for compensation in [true, false] {
                let line = line(&case, compensation, args.samples)?;
                println!("{}", line.title);
                line.points.iter().for_each(|point| println!("  {:8.2} s  {:.2e}", point.x, point.y));
                lines.push(line);
            }
        }
        let chart =
            LogChart { x_title: "seconds of two threads".to_owned(), y_title: "relMSE".to_owned(), lines, mark: None };
        let svg = chart.to_svg().map_err(|reason| anyhow!(reason))?;
        fs::write(place::root().join(CHART), svg).with_context(|| format!("cannot write {CHART}"))?;
        println!("the chart is in {CHART}");
        Ok(())
    })
}

fn line(case: &Case, compensation: bool, samples: u32) -> Result<Line> {
    let mut points = Vec::new();
    let numbers = std::iter::successors(Some(samples), |n| (*n > 1).then_some((n / 4).max(1)));
    for (k, samples) in numbers.collect::<Vec<_>>().into_iter().rev().enumerate() {
        let mut settings = settings(case.size, samples);
        settings.physical.compensation = compensation;
        // Seeds of their own: the points of a curve do not share their luck.
        settings.run.seed = 20 + k as u32;
        let rendering = render(&case.world, &settings)?;
        let (x, y) = (busy_s(&rendering), error(case, &rendering)?);
        points.push(Point { x, y, least: y, greatest: y });
    }
    points.retain(|point| point.y > 0.0);
    let title = format!("{}, {}", case.title, if compensation { "with compensation" } else { "without" });
    Ok(Line { title, points })
}
