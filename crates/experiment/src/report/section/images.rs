//! Pictures of configurations in one scene, with sliders and FLIP maps.

use super::agreement;
use crate::record::{ConfigurationInfo, Row, SceneInfo};
use crate::report::document::{Block, Map, Notice, Pair, Picture, Pictures};
use crate::report::measured::{Found, Measured, stand_in_note};
use lightcuts::image::metrics::Metric;
use std::path::PathBuf;

/// What a section asks for.
pub(super) struct Request<'a> {
    pub(super) scene: &'a SceneInfo,
    pub(super) configurations: Vec<&'a ConfigurationInfo>,
    /// Point of the sweep.
    pub(super) point: Option<&'a str>,
}

/// The pictures; before them what limits them.
pub(super) fn blocks<'a>(measured: &Measured<'a>, request: &Request<'a>) -> Vec<Block> {
    let scene = request.scene;
    let mut blocks: Vec<Block> =
        stand_in_note(scene).map(|note| Block::Notice(Notice::warning(note))).into_iter().collect();
    let (mut pictures, mut shown) = (Pictures { items: Vec::new(), pairs: Vec::new(), absent: Vec::new() }, Vec::new());
    for &configuration in &request.configurations {
        match measured.find(scene, configuration, request.point) {
            Found::Rows(rows) => {
                pictures.items.push(picture(request, configuration, rows[0]));
                shown.push((configuration, rows));
            }
            found => {
                let reason = found.note().unwrap_or("It is not part of the plan.".to_owned());
                pictures.absent.push((configuration.title.clone(), reason));
            }
        }
    }
    // The left side of every slider is the first configuration, or nothing.
    let is_first = |configuration: &&ConfigurationInfo| Some(configuration) == request.configurations.first();
    if let Some(((left, _), others)) = shown.split_first().filter(|((configuration, _), _)| is_first(configuration)) {
        for (i, (configuration, rows)) in others.iter().enumerate() {
            pictures.pairs.push(Pair {
                left: pictures.items[0].clone(),
                right: pictures.items[i + 1].clone(),
                map: map(measured, scene, left, configuration, rows),
            });
        }
    }
    blocks.push(Block::Pictures(pictures));
    blocks
}

fn picture(request: &Request<'_>, configuration: &ConfigurationInfo, row: &Row) -> Picture {
    let at = request.point.map_or(String::new(), |point| format!(", {point}"));
    Picture {
        path: PathBuf::from(&row.png),
        title: format!("{}{at}", configuration.title),
        alternative: format!("{}, {}{at}", request.scene.title, configuration.title),
    }
}

/// The FLIP map against the left configuration, or else against the first reference that there is one of.
fn map(
    measured: &Measured<'_>,
    scene: &SceneInfo,
    left: &ConfigurationInfo,
    configuration: &ConfigurationInfo,
    rows: &[&Row],
) -> Option<Map> {
    let references = std::iter::once(&left.name).chain(&configuration.references);
    let found =
        references.filter_map(|name| rows.iter().find_map(|row| Some((*row, row.comparisons.get_key_value(name)?))));
    let (row, (name, comparison)) = found.into_iter().next()?;
    let reference = measured.configuration(name).map_or(name.as_str(), |reference| reference.title.as_str());
    Some(Map {
        picture: Picture {
            path: PathBuf::from(&comparison.flip_map),
            title: "FLIP map".to_owned(),
            alternative: format!("FLIP map of {}, {} against {reference}", scene.title, configuration.title),
        },
        mean: agreement::value(row, name, Metric::FlipLdr),
        against: (*name != left.name).then(|| reference.to_owned()),
    })
}
