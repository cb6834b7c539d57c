//! Renders of the physical model in this process, and targets that they have to meet.

use anyhow::{Context as _, Result, bail};
use lightcuts::import::AnyScene;
use lightcuts::rendering::Strategy;
use lightcuts::{ImportOptions, PhysicalRendering, PhysicalWorld, Settings, Simd, Unwatched};
use std::path::Path;

/// Loads a scene of the physical model.
pub(crate) fn load(path: &Path, search_paths: &[&Path]) -> Result<PhysicalWorld> {
    let search_paths = search_paths.iter().map(|path| path.to_path_buf()).collect();
    let options = ImportOptions { search_paths, ..ImportOptions::default() };
    match lightcuts::load_any(path, &options)?.scene {
        AnyScene::Physical(scene) => Ok(PhysicalWorld::new(&scene)?),
        AnyScene::Thesis(_) => bail!("{} is of the thesis' model", path.display()),
    }
}

/// Settings of a square picture with so many samples at most.
pub(crate) fn settings(size: u32, samples: u32) -> Settings {
    let mut settings = Settings::for_physical();
    (settings.image.width, settings.image.height) = (size, size);
    settings.sampling.samples = samples;
    settings.gather.strategy = Strategy::Lightcuts;
    settings
}

pub(crate) fn render(world: &PhysicalWorld, settings: &Settings) -> Result<PhysicalRendering> {
    lightcuts::render_physical(world, settings, Simd::Auto, &Unwatched).context("the settings are not sound")
}

/// Seconds that all threads were at work for, on average.
pub(crate) fn busy_s(rendering: &PhysicalRendering) -> f64 {
    rendering.stats.total_cpu_s / rayon::current_num_threads() as f64
}
