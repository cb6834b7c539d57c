//! The command `info`: what was understood of a scene, what a picture holds.

mod picture;
mod scene;
mod text;

use crate::args::InfoArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use crate::job::has_extension;
use crate::plan::{load, search_path};
use lightcuts::World;
use serde::Serialize;

/// Runs the command.
pub(crate) fn run(args: &InfoArgs) -> Result<Exit, Failure> {
    if has_extension(&args.path, "exr") || has_extension(&args.path, "png") {
        let info = picture::PictureInfo::read(&args.path)?;
        return show(&info, args.json, text::of_picture);
    }
    let imported = load(&args.path, &search_path(&args.search, std::iter::empty()))?;
    let world = World::new(&imported.scene).map_err(Failure::input)?;
    show(&scene::SceneInfo::new(&imported, &world), args.json, text::of_scene)
}

fn show<T: Serialize>(info: &T, as_json: bool, text: impl Fn(&T) -> String) -> Result<Exit, Failure> {
    let text = if as_json {
        serde_json::to_string_pretty(info).map_err(|error| Failure::output(error.to_string()))? + "\n"
    } else {
        text(info)
    };
    console::print(text.as_bytes()).map(|()| Exit::Done)
}
