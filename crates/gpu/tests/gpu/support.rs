//! What the tests share: the adapter, and scenes.

use lightcuts_gpu::{DeviceChoice, GpuDevice, GpuOptions, adapters, choose};
use lightcuts_import::{ImportOptions, load};
use lightcuts_render::{Options, Rendering, Settings, Stations, Unwatched, render, render_on};
use lightcuts_testkit::project_root;
use lightcuts_world::World;
use std::path::PathBuf;

/// Whether there is an adapter.
pub(crate) fn has_adapter() -> bool {
    lightcuts_testkit::has_adapter(choose(&DeviceChoice::Gpu, &adapters()))
}

/// The best adapter with a world on it.
pub(crate) fn open<'w>(world: &'w World, options: &GpuOptions) -> GpuDevice<'w> {
    GpuDevice::open(&DeviceChoice::Gpu, world, options).expect("the adapter opens").expect("a GPU is no CPU")
}

/// A scene of the project with the settings it recommends.
pub(crate) fn scene(name: &str, search_paths: Vec<PathBuf>) -> (World, Settings) {
    let path = project_root().join("scenes").join(name);
    let imported = load(&path, &ImportOptions { search_paths, ..ImportOptions::default() }).expect("the scene loads");
    let world = World::new(&imported.scene).expect("the scene is sound");
    (world, Settings::for_scene(&imported.scene))
}

/// A scene of the project for a small picture.
pub(crate) fn small_scene(name: &str) -> (World, Settings) {
    let (world, mut settings) = scene(name, Vec::new());
    (settings.image.width, settings.image.height) = (96, 80);
    (world, settings)
}

pub(crate) fn on_cpu(world: &World, settings: &Settings) -> Rendering {
    render(world, settings, &Options::default(), &Unwatched).expect("the settings are valid")
}

/// The same with every station on the GPU, which must not fail.
pub(crate) fn on_gpu(device: &GpuDevice<'_>, world: &World, settings: &Settings) -> Rendering {
    on_stations(&Stations::all(device), world, settings)
}

pub(crate) fn on_stations(stations: &Stations<'_>, world: &World, settings: &Settings) -> Rendering {
    let options = Options::default();
    let rendering = render_on(world, settings, &options, stations, &Unwatched).expect("the settings are valid");
    assert_eq!(rendering.stats.device_faults, 0, "{:?}", rendering.stats.devices);
    rendering
}
