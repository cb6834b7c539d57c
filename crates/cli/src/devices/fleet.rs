//! From the command line to the devices of a render.

use super::list::why_no_gpu;
use crate::args::DeviceArgs;
use crate::exit::Failure;
use lightcuts::gpu::{self, AdapterSummary, Assignment, DeviceChoice, Fleet, NoDevice};
use lightcuts::{Monitor, PerStation, Simd, World};

/// Which adapters the stations use. Fails if a requested one does not exist.
pub(crate) fn assigned(args: &DeviceArgs) -> Result<Assignment, Failure> {
    let wanted = args.wanted();
    let adapters = gpu::adapters_for(&wanted);
    let assignment = Assignment::new(&wanted, &adapters).map_err(|why| not_there(&why, &adapters))?;
    if !assignment.takes_adapters() && wanted != PerStation::all(DeviceChoice::Cpu) {
        tracing::info!("no GPU: the CPU renders; {}", why_no_gpu(&adapters));
    }
    Ok(assignment)
}

/// Lists the available devices.
fn not_there(why: &NoDevice, adapters: &[AdapterSummary]) -> Failure {
    let cpu = std::iter::once("the CPU (--device cpu)".to_owned());
    let names: Vec<String> = cpu.chain(adapters.iter().map(|adapter| format!("`{}`", adapter.name))).collect();
    Failure::usage(why.to_string(), format!("available: {}", names.join(", ")))
}

/// Opens the devices for a world.
pub(crate) fn open<'w>(
    assignment: &Assignment,
    world: &'w World,
    simd: Simd,
    args: &DeviceArgs,
    monitor: &dyn Monitor,
) -> Result<Fleet<'w>, Failure> {
    let fleet = Fleet::open(assignment, world, simd, &args.gpu_options(), &|text| monitor.note(text));
    let fleet = fleet.map_err(|why| Failure::usage(why.to_string(), "render on the CPU with --device cpu"))?;
    for gpu in fleet.gpus() {
        let adapter = gpu.adapter();
        tracing::info!("opened {} ({}, {})", adapter.name, adapter.kind.name(), adapter.api);
    }
    Ok(fleet)
}

/// Fails if a device other than the CPU was requested: nothing else renders the physical model.
pub(crate) fn require_cpu(args: &DeviceArgs) -> Result<(), Failure> {
    let is_other = |choice: &&DeviceChoice| matches!(choice, DeviceChoice::Gpu | DeviceChoice::Named(_));
    match args.wanted().each().iter().find(is_other) {
        None => Ok(()),
        Some(choice) => Err(Failure::usage(
            format!("the physical model runs on the CPU only, not on `{choice}`"),
            "leave out --device",
        )),
    }
}
