//! The physical model: path tracing, and indirect light from virtual point lights through error-bounded cuts.

mod bundle;
mod caustics;
mod cluster_tree;
mod develop;
mod direct;
mod emission;
mod gather;
mod in_order;
mod job;
mod light_path;
mod lightcuts;
mod mixture;
mod pass;
mod path;
mod placing;
mod plan;
mod randoms;
mod rejection;
mod rendering;
mod scene;
mod sketch;
mod sums;
mod task;
mod technique;
#[cfg(test)]
mod tests;
mod ties;
mod vpls;
mod watch;

pub use rendering::{Aovs, PhysicalRendering};

use crate::cpu::Simd;
use crate::monitor::Monitor;
use crate::settings::{Model, Settings, SettingsError};
use lightcuts_world::PhysicalWorld;

/// Renders a physical world on the threads of the current rayon pool; `settings.physical` says how. Fails only if a
/// parameter is out of range. A monitor that cancels gets what there is, with `stats.complete` false.
pub fn render_physical(
    world: &PhysicalWorld,
    settings: &Settings,
    simd: Simd,
    monitor: &dyn Monitor,
) -> Result<PhysicalRendering, SettingsError> {
    settings.validate()?;
    settings.require_model(Model::Physical)?;
    Ok(job::PhysicalJob::new(world, settings, simd, monitor).run())
}
