//! The project's own scene format: TOML, for scenes of the physical model. `docs/formats/scene.md` describes it.
//!
//! ```toml
//! format = "lightcuts-scene"
//! version = 1
//! [camera]
//! position = [0, 1, 5]
//! target = [0, 1, 0]
//! [[material]]
//! name = "clay"
//! type = "lambert"
//! albedo = [0.7, 0.5, 0.4]
//! [[object]]
//! type = "sphere"
//! material = "clay"
//! center = [0, 1, 0]
//! radius = 1
//! [[light]]
//! type = "point"
//! position = [2, 4, 3]
//! power = 100
//! ```
//!
//! A text is read in four steps: `document` makes tables of it that know their places, and values of these; `build` walks
//! through the tables, one module per kind of table; `PhysicalScene::validate` says what cannot be rendered; `places` finds
//! the key that is to blame.

mod build;
mod camera;
mod cuboid;
mod document;
mod environment;
mod image;
mod library;
mod light;
mod material;
mod mesh;
mod metal;
mod object;
mod placement;
mod places;
mod proportion;
mod reader;
mod smoothing;
mod value;
mod words;

use crate::resolver::Resolver;
use crate::source::Source;
use crate::{ImportError, Imported, Limits};
use lightcuts_scene::physical::PhysicalScene;

/// Reads a scene of the physical model from `text`, in TOML; `name` stands for the file in messages, and its stem becomes the
/// scene's name if the text gives none.
///
/// `resolver` finds the models and images that the scene names. Fails with all errors found, at most 20.
pub fn parse_physical(
    text: &str,
    name: &str,
    resolver: &dyn Resolver,
    limits: &Limits,
) -> Result<Imported<PhysicalScene>, ImportError> {
    parse_creased(text, name, resolver, limits, None)
}

/// The same with an angle in degrees that takes the place of every object's `crease-angle`.
pub(crate) fn parse_creased(
    text: &str,
    name: &str,
    resolver: &dyn Resolver,
    limits: &Limits,
    crease_degrees: Option<f32>,
) -> Result<Imported<PhysicalScene>, ImportError> {
    let source = Source::new(name, text.strip_prefix('\u{feff}').unwrap_or(text));
    let document = document::parse(&source, limits)?;
    let document = document::Table::of(&document);
    build::Builder::new(&source, resolver, limits, crease_degrees).run(document, name)
}
