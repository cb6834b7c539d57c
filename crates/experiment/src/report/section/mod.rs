//! From what a section asks for to its text, tables, charts and pictures.

mod acceleration;
mod agreement;
mod arithmetic;
mod crossover;
mod curves;
mod images;
mod times;

use super::document::{Block, Part};
use super::measured::Measured;
use crate::layout::{Content, Section};

/// Makes a section. The message says what it names that the experiment does not have.
pub(super) fn part(measured: &Measured<'_>, section: &Section) -> Result<Part, String> {
    Ok(Part {
        id: section.id.clone(),
        title: section.title.clone(),
        text: section.text.clone(),
        blocks: blocks(measured, section)?,
    })
}

fn blocks(measured: &Measured<'_>, section: &Section) -> Result<Vec<Block>, String> {
    let id = section.id.as_str();
    match &section.content {
        Content::Text => Ok(Vec::new()),
        Content::Times { scene, configurations, published, every_run } => {
            let request = times::Request {
                id,
                scene: measured.scene(scene)?,
                configurations: measured.configurations(configurations)?,
                table: published.as_deref(),
                every_run: *every_run,
            };
            Ok(times::blocks(measured, &request))
        }
        Content::Acceleration { rows, published, chart } => {
            acceleration::blocks(measured, &acceleration::Request { id, rows, table: published.as_deref(), chart })
        }
        Content::Images { scene, configurations, point } => {
            let scene = measured.scene(scene)?;
            let request = images::Request {
                scene,
                configurations: measured.configurations(configurations)?,
                point: point.as_deref().or(measured.last_point(scene)),
            };
            Ok(images::blocks(measured, &request))
        }
        Content::Agreement { configurations, metrics, published_pass } => {
            let scenes: Result<Vec<_>, _> = published_pass.iter().map(|scene| measured.scene(scene)).collect();
            let request = agreement::Request {
                id,
                configurations: measured.configurations(configurations)?,
                metrics: metrics.iter().map(|key| metric(key)).collect::<Result<_, _>>()?,
                published_pass: scenes?,
            };
            agreement::blocks(measured, &request)
        }
        Content::Curves { scene, configurations, quantity, crossover } => {
            let request = curves::Request {
                id,
                scene: measured.scene(scene)?,
                configurations: measured.configurations(configurations)?,
                quantity: curves::Kind::of(quantity)?,
                crossover: crossover.as_ref(),
            };
            curves::blocks(measured, &request)
        }
        Content::PublishedArithmetic => Ok(arithmetic::blocks(measured, id)),
    }
}

fn metric(key: &str) -> Result<lightcuts::image::metrics::Metric, String> {
    key.parse().map_err(|error: lightcuts::image::metrics::UnknownMetric| error.to_string())
}

/// `a`, `a and b` or `a, b and c`.
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// `1 run`, `3 runs`.
fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
