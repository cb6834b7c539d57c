//! From what the command line asks for to the devices of a render.

use super::list::why_no_gpu;
use crate::args::DeviceArgs;
use crate::exit::Failure;
use lightcuts::gpu::{self, AdapterSummary, Assignment, DeviceChoice, Fleet, NoDevice};
use lightcuts::{Monitor, PerStation, Simd, World};

/// Which adapters the stations take. Fails if one that was asked for is not there.
pub(crate) fn assigned(args: &DeviceArgs) -> Result<Assignment, Failure> {
    let wanted = args.wanted();
    let adapters = gpu::adapters_for(&wanted);
    let assignment = Assignment::new(&wanted, &adapters).map_err(|why| not_there(&why, &adapters))?;
    if !assignment.takes_adapters() && wanted != PerStation::all(DeviceChoice::Cpu) {
        tracing::info!("no GPU: the CPU renders; {}", why_no_gpu(&adapters));
    }
    Ok(assignment)
}

/// Names what is there instead.
fn not_there(why: &NoDevice, adapters: &[AdapterSummary]) -> Failure {
    let cpu = std::iter::once("the CPU (--device cpu)".to_owned());
    let names: Vec<String> = cpu.chain(adapters.iter().map(|adapter| format!("`{}`", adapter.name))).collect();
    Failure::usage(why.to_string(), format!("here are {}", names.join(", ")))
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

/// Fails if another device than the CPU was asked for: nothing else renders the physical model.
pub(crate) fn require_cpu(args: &DeviceArgs) -> Result<(), Failure> {
    let is_other = |choice: &&DeviceChoice| matches!(choice, DeviceChoice::Gpu | DeviceChoice::Named(_));
    match args.wanted().each().iter().find(is_other) {
        None => Ok(()),
        Some(choice) => Err(Failure::usage(
            format!("the physical model is rendered by the CPU only, not by `{choice}`"),
            "leave out --device and --station-device",
        )),
    }
}
