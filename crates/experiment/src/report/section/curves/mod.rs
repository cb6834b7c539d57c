//! A quantity against the number of VPLs, a curve per configuration, with the place where one falls below another.

mod quantity;
mod table;

pub(super) use quantity::Kind;

use super::crossover::{Crossover, crossover};
use crate::record::{ConfigurationInfo, SceneInfo};
use crate::report::chart::curves::{Line, LogChart, Mark, Point};
use crate::report::document::{Block, Chart, Notice};
use crate::report::measured::{Found, Measured, Spread, stand_in_note};
use crate::report::number::{integer, significant};
use table::table;

/// What a section asks for.
pub(super) struct Request<'a> {
    pub(super) id: &'a str,
    pub(super) scene: &'a SceneInfo,
    pub(super) configurations: Vec<&'a ConfigurationInfo>,
    pub(super) quantity: Kind,
    pub(super) crossover: Option<&'a [String; 2]>,
}

/// The values of a configuration.
struct Series<'a> {
    configuration: &'a ConfigurationInfo,
    /// At every point of the sweep.
    samples: Vec<Sample<'a>>,
}

/// The values at a point.
struct Sample<'a> {
    point: Option<&'a str>,
    found: Found<'a>,
    vpls: Option<Spread>,
    /// Of the runs: the value that stands for them, and their range.
    value: Option<(f64, Spread)>,
}

impl Series<'_> {
    /// The places of the curve by VPL count; a value of 0 has none on a logarithmic axis.
    fn points(&self) -> Vec<Point> {
        let point = |sample: &Sample<'_>| {
            let (x, (y, Spread { least, greatest, .. })) = (sample.vpls?.mean, sample.value?);
            (x > 0.0 && least > 0.0).then_some(Point { x, y, least, greatest })
        };
        let mut points: Vec<Point> = self.samples.iter().filter_map(point).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        points
    }

    fn curve(&self) -> Vec<(f64, f64)> {
        self.points().iter().map(|point| (point.x, point.y)).collect()
    }
}

/// The words about the crossover, the chart and the table of its values.
pub(super) fn blocks(measured: &Measured<'_>, request: &Request<'_>) -> Result<Vec<Block>, String> {
    let all: Vec<Series<'_>> =
        request.configurations.iter().map(|configuration| series(measured, request, configuration)).collect();
    let mut blocks: Vec<Block> =
        stand_in_note(request.scene).map(|note| Block::Notice(Notice::warning(note))).into_iter().collect();
    let mut mark = None;
    if let Some(names) = request.crossover {
        let pair = measured.configurations(names)?;
        let [first, second] = [0, 1].map(|i| series(measured, request, pair[i]));
        let found = crossover(&first.curve(), &second.curve());
        let (notice, place) = told(found, &first, &second, request.quantity);
        blocks.push(Block::Notice(notice));
        mark = place;
    }
    if all.iter().any(|series| !series.points().is_empty()) {
        blocks.push(Block::Chart(chart(request, &all, mark)?));
    }
    blocks.push(Block::Table(table(request, &all)));
    Ok(blocks)
}

fn series<'a>(measured: &Measured<'a>, request: &Request<'a>, configuration: &'a ConfigurationInfo) -> Series<'a> {
    let sample = |point| {
        let found = measured.find(request.scene, configuration, point);
        let vpls = found.spread(|row| row.stats.vpl_count as f64);
        let values = found.rows().iter().filter_map(|row| request.quantity.of_row(row, configuration));
        let value = Spread::of(values).map(|spread| (request.quantity.of_runs(&spread), spread));
        Sample { point, found, vpls, value }
    };
    Series { configuration, samples: measured.points(request.scene).into_iter().map(sample).collect() }
}

/// A crossover in words, and its place in the chart.
fn told(found: Crossover, first: &Series<'_>, second: &Series<'_>, quantity: Kind) -> (Notice, Option<Mark>) {
    let (a, b) = (&first.configuration.title, &second.configuration.title);
    let smaller = quantity.smaller();
    let range = common_range(first, second);
    let text = match found {
        Crossover::At { x, y } => {
            let mark = Mark { x, y, label: format!("{} VPLs", significant(x)) };
            let text = format!(
                "From about {} VPLs on, {b} is {smaller} than {a}. There both have {}; the place is interpolated between \
                 measured points, in logarithms.",
                significant(x),
                quantity.value(y)
            );
            return (Notice::finding(text), Some(mark));
        }
        Crossover::SecondThroughout => {
            format!("There is no crossover in the measured range{range}: {b} is {smaller} than {a} throughout.")
        }
        Crossover::FirstThroughout => {
            format!("There is no crossover in the measured range{range}: {b} is nowhere {smaller} than {a}.")
        }
        Crossover::FirstAtTheEnd => {
            let for_good = format!("{b} is {smaller} than {a} in a part of the measured range{range} only");
            format!("There is no crossover for good: {for_good}, and not at its end.")
        }
        Crossover::NoCommonRange => {
            return (Notice::warning(format!("There is no range yet in which both {a} and {b} were measured.")), None);
        }
    };
    (Notice::finding(text), None)
}

fn common_range(first: &Series<'_>, second: &Series<'_>) -> String {
    let (first, second) = (first.curve(), second.curve());
    let end = |curve: &[(f64, f64)], last: bool| if last { curve.last().copied() } else { curve.first().copied() };
    let ends = [false, true].map(|last| Some((end(&first, last)?.0, end(&second, last)?.0)));
    match ends {
        [Some(from), Some(to)] => {
            format!(", {} to {} VPLs", integer(from.0.max(from.1)), integer(to.0.min(to.1)))
        }
        _ => String::new(),
    }
}

fn chart(request: &Request<'_>, all: &[Series<'_>], mark: Option<Mark>) -> Result<Chart, String> {
    let title = request.quantity.title();
    let marked = if mark.is_some() { " The circle marks the crossover." } else { "" };
    let lines: Vec<Line> =
        all.iter().map(|series| Line { title: series.configuration.title.clone(), points: series.points() }).collect();
    let said = lines.iter().filter(|line| !line.points.is_empty()).map(|line| {
        let places = line.points.iter().map(|p| format!("{} at {} VPLs", significant(p.y), integer(p.x)));
        format!(" {}: {}.", line.title, places.collect::<Vec<_>>().join(", "))
    });
    let alternative = format!("Chart of {title} against the number of VPLs.{}", said.collect::<String>());
    let chart = LogChart { x_title: "Number of VPLs".to_owned(), y_title: title.clone(), lines, mark };
    Ok(Chart {
        id: request.id.to_owned(),
        caption: format!(
            "{}: {} against the number of VPLs; both axes are logarithmic.{marked}",
            request.scene.title,
            request.quantity.name()
        ),
        alternative,
        svg: chart.to_svg()?,
    })
}
