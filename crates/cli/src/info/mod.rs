//! The command `info`: what was understood of a scene, what a picture holds.

mod physical;
mod physical_text;
mod picture;
mod scene;
mod text;

use crate::args::InfoArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use crate::plan::{load, refuse_crease_angle, search_path};
use lightcuts::{AnyScene, Imported, PhysicalWorld, World};
use serde::Serialize;

/// Runs the command.
pub(crate) fn run(args: &InfoArgs) -> Result<Exit, Failure> {
    if picture::is_picture(&args.path) {
        let info = picture::PictureInfo::read(&args.path)?;
        return show(&info, args.json, text::of_picture);
    }
    let imported = load(&args.path, &search_path(&args.search, std::iter::empty()), args.crease.angle)?;
    refuse_crease_angle(&imported.scene, &args.crease, &[])?;
    let Imported { scene, warnings, files } = imported;
    match scene {
        AnyScene::Thesis(scene) => {
            let world = World::new(&scene).map_err(Failure::input)?;
            let info = scene::SceneInfo::new(&Imported { scene, warnings, files }, &world);
            show(&info, args.json, text::of_scene)
        }
        AnyScene::Physical(scene) => {
            let world = PhysicalWorld::new(&scene).map_err(Failure::input)?;
            let info = physical::PhysicalInfo::new(&Imported { scene, warnings, files }, &world);
            show(&info, args.json, physical_text::of_physical)
        }
    }
}

fn show<T: Serialize>(info: &T, as_json: bool, text: impl Fn(&T) -> String) -> Result<Exit, Failure> {
    let text = if as_json {
        serde_json::to_string_pretty(info).map_err(|error| Failure::output(error.to_string()))? + "\n"
    } else {
        text(info)
    };
    console::print(text.as_bytes()).map(|()| Exit::Done)
}
