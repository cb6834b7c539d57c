//! The stations of the renderer: place VPLs, build the light tree, gather, develop.
//!
//! [`render`] takes a [`World`] and [`Settings`] and returns a [`Rendering`]; [`render_physical`] does so in the
//! physical model. The same settings give the same picture bit for bit on any number of threads, with or without SIMD,
//! except where the physical model depends on measured times: [`Integrator::Auto`], [`Strategy::Auto`] and a time
//! limit.

mod cpu;
mod crew;
pub mod device;
mod film;
mod filter;
mod job;
mod light_node;
mod light_ratio;
mod light_tree;
mod monitor;
mod occlusion;
mod original;
mod original_pass;
mod original_rows;
mod packed_tree;
mod pass;
mod photon_map;
mod physical;
mod ray_tree;
mod rendering;
mod sampler;
mod settings;
mod shade;
mod stations;
mod stats;
mod vpl_csv;

pub use cpu::Simd;
pub use lightcuts_kernel::light::Vpl;
pub use monitor::{Monitor, Stage, Unwatched};
pub use physical::{Aovs, PhysicalRendering, render_physical};
pub use rendering::Rendering;
pub use settings::{
    AmbientOcclusion, Bloom, Caustics, Display, Filter, FilterKind, Gather, ImageSize, Integrator, Model, Physical,
    Run, Sampling, Scope, Settings, SettingsError, Strategy, TomlFault, ToneMappingKind, VplPlacement, keys_of,
    overlay, value_at, value_in,
};
pub use stations::{PerStation, Station, Stations};
pub use stats::{End, PartTime, PassTime, Rays, StationDevice, Stats, TreeVisits, VplWork};
pub use vpl_csv::{VplCsvError, vpls_from_csv, vpls_to_csv};

use cpu::CpuDevice;
use lightcuts_world::World;

/// Options of a render that are not part of its settings.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// VPLs to use instead of placing new ones.
    pub vpls: Option<Vec<Vpl>>,
    /// Whether SIMD instructions are used.
    pub simd: Simd,
}

/// Renders a world in the thesis' model of light on the threads of the current rayon pool. Fails only if a parameter is
/// out of range. If the monitor cancels, the partial picture is returned, with `stats.complete` false.
pub fn render(
    world: &World,
    settings: &Settings,
    options: &Options,
    monitor: &dyn Monitor,
) -> Result<Rendering, SettingsError> {
    let cpu = CpuDevice::new(world, options.simd);
    render_on(world, settings, options, &Stations::all(&cpu), monitor)
}

/// [`render`] with each station on a device. If a device fails, the CPU does its work, so that the picture is complete;
/// the monitor gets a note.
pub fn render_on(
    world: &World,
    settings: &Settings,
    options: &Options,
    stations: &Stations<'_>,
    monitor: &dyn Monitor,
) -> Result<Rendering, SettingsError> {
    settings.validate()?;
    settings.require_model(Model::Thesis)?;
    // On a thread of the pool: from another one each of many small steps would be handed over and waited for.
    Ok(rayon::scope(|_| job::Job::new(world, settings, options, stations, monitor).run()))
}
