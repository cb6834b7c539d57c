//! Whole renders, checked against the thesis, against each other and against closed forms.

mod closed_form;
mod invariants;
mod stations;
mod thesis;

use lightcuts_import::{ImportOptions, load};
use lightcuts_render::{Options, Rendering, Settings, Unwatched, render};
use lightcuts_testkit::project_root;
use lightcuts_world::World;
use std::path::PathBuf;

/// A scene of the project with the settings it recommends.
fn scene(name: &str, search_paths: Vec<PathBuf>) -> (World, Settings) {
    let path = project_root().join("scenes").join(name);
    let imported = load(&path, &ImportOptions { search_paths, ..ImportOptions::default() }).expect("the scene loads");
    let world = World::new(&imported.scene).expect("the scene is sound");
    (world, Settings::for_scene(&imported.scene))
}

/// A scene of the project for a small picture.
fn small_scene(name: &str) -> (World, Settings) {
    let (world, mut settings) = scene(name, Vec::new());
    (settings.image.width, settings.image.height) = (96, 80);
    (world, settings)
}

fn run(world: &World, settings: &Settings) -> Rendering {
    render(world, settings, &Options::default(), &Unwatched).expect("the settings are valid")
}
