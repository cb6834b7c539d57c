//! The devices of a render: the processor, and adapters where stations want some.
//!
//! This takes two steps: an [`Assignment`] needs no world, so that a name that matches no adapter is reported before a
//! scene is read; a [`Fleet`] opens the assigned devices.

use crate::adapter::{AdapterSummary, DeviceChoice, adapters, choose};
use crate::device::{GpuDevice, GpuOptions};
use lightcuts_render::device::{CpuDevice, Device, DeviceFault};
use lightcuts_render::{PerStation, Simd, Stations};
use lightcuts_world::World;
use std::collections::BTreeMap;
use std::path::Path;

/// Device files, of which Linux has at least one if there is a graphics card: of the kernel's own drivers, NVIDIA,
/// Tegra, WSL, ARM and Qualcomm.
const CARD_FILES: [&str; 6] =
    ["/dev/dri", "/dev/nvidiactl", "/dev/nvhost-gpu", "/dev/dxg", "/dev/mali0", "/dev/kgsl-3d0"];

/// The adapters that the requested devices may be among. Drivers are loaded only if needed, as that takes memory and a
/// good part of a second: not if only the CPU is requested, nor to look for a card where there is none.
pub fn adapters_for(wanted: &PerStation<DeviceChoice>) -> Vec<AdapterSummary> {
    let needs_drivers = |choice: &DeviceChoice| match choice {
        DeviceChoice::Cpu => false,
        DeviceChoice::Auto => may_have_a_card(),
        DeviceChoice::Gpu | DeviceChoice::Named(_) => true,
    };
    if wanted.each().iter().any(needs_drivers) { adapters() } else { Vec::new() }
}

/// Whether this machine may have a graphics card, as far as can be known without its driver.
fn may_have_a_card() -> bool {
    !cfg!(target_os = "linux") || CARD_FILES.iter().any(|file| Path::new(file).exists())
}

/// A requested device is not available; the text says why.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoDevice(pub String);

impl From<DeviceFault> for NoDevice {
    fn from(fault: DeviceFault) -> Self {
        match fault {
            // It says by itself what failed.
            DeviceFault::Failed(why) => Self(why),
            fault => Self(fault.to_string()),
        }
    }
}

/// Which adapter each station uses, if any.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assignment(PerStation<Seat>);

/// The device requested for a station, and its index in the list of adapters; the CPU has none.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Seat {
    choice: DeviceChoice,
    adapter: Option<usize>,
}

impl Assignment {
    /// Finds the requested devices among the adapters, which include at least those of [`adapters_for`]. Fails if one
    /// is not there.
    pub fn new(wanted: &PerStation<DeviceChoice>, adapters: &[AdapterSummary]) -> Result<Self, NoDevice> {
        let seat = |choice: &DeviceChoice| {
            let adapter = choose(choice, adapters)?;
            Ok::<_, NoDevice>(Seat { choice: choice.clone(), adapter })
        };
        wanted.map(seat).transpose().map(Self)
    }

    /// Whether any station uses an adapter.
    pub fn takes_adapters(&self) -> bool {
        self.0.each().iter().any(|seat| seat.adapter.is_some())
    }
}

/// Open devices for one world.
pub struct Fleet<'w> {
    cpu: CpuDevice<'w>,
    /// By their index in the list of adapters; those that did not open, with the reason.
    gpus: BTreeMap<usize, Result<GpuDevice<'w>, NoDevice>>,
    adapters: PerStation<Option<usize>>,
}

impl<'w> Fleet<'w> {
    /// Opens the assigned devices, each adapter once. An adapter that does not open is an error if it was requested;
    /// with `Auto`, falls back to the CPU and reports through `note`.
    pub fn open(
        assignment: &Assignment,
        world: &'w World,
        simd: Simd,
        options: &GpuOptions,
        note: &dyn Fn(&str),
    ) -> Result<Self, NoDevice> {
        let mut gpus = BTreeMap::new();
        let adapters = assignment.0.map(|seat| {
            let Some(place) = seat.adapter else { return Ok(None) };
            let is_first = !gpus.contains_key(&place);
            match gpus.entry(place).or_insert_with(|| GpuDevice::at(place, world, options).map_err(NoDevice::from)) {
                Ok(_) => Ok(Some(place)),
                Err(why) if seat.choice != DeviceChoice::Auto => Err(why.clone()),
                Err(why) => {
                    if is_first {
                        note(&format!("the GPU cannot be used, so the CPU renders: {why}"));
                    }
                    Ok(None)
                }
            }
        });
        Ok(Self { cpu: CpuDevice::new(world, simd), gpus, adapters: adapters.transpose()? })
    }

    /// Which device runs which station.
    pub fn stations(&self) -> Stations<'_> {
        self.adapters.map(|&adapter| self.at(adapter))
    }

    /// The GPUs that are open, the best first.
    pub fn gpus(&self) -> impl Iterator<Item = &GpuDevice<'w>> {
        self.gpus.values().filter_map(|gpu| gpu.as_ref().ok())
    }

    fn at(&self, adapter: Option<usize>) -> &dyn Device {
        match adapter.and_then(|place| self.gpus.get(&place)) {
            Some(Ok(gpu)) => gpu,
            _ => &self.cpu,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_render::Station;
    use lightcuts_render::device::DeviceKind;
    use lightcuts_scene::SceneDesc;
    use std::cell::RefCell;

    fn adapter(name: &str, kind: DeviceKind) -> AdapterSummary {
        AdapterSummary { name: name.to_owned(), kind, ..AdapterSummary::default() }
    }

    #[test]
    fn each_station_takes_the_adapter_that_it_asked_for() {
        let adapters = [adapter("Card", DeviceKind::Gpu), adapter("llvmpipe", DeviceKind::SoftwareGpu)];
        let wanted = PerStation::all(DeviceChoice::Auto)
            .with(Station::Tree, DeviceChoice::Cpu)
            .with(Station::Gather, DeviceChoice::Named("LLVM".to_owned()));
        let Assignment(seats) = Assignment::new(&wanted, &adapters).unwrap();
        assert_eq!(seats.map(|seat| seat.adapter).each().to_owned(), [Some(0), Some(0), None, Some(1), Some(0)]);
        assert!(!Assignment::new(&PerStation::all(DeviceChoice::Auto), &adapters[1..]).unwrap().takes_adapters());
    }

    #[test]
    fn what_is_not_there_is_named() {
        let wanted = PerStation::all(DeviceChoice::Named("Card".to_owned()));
        let why = Assignment::new(&wanted, &[]).unwrap_err().to_string();
        assert!(why.starts_with("there is no device `Card`"), "{why}");
    }

    /// The adapter is on the list and not in the machine, as if it was pulled out in between.
    #[test]
    fn an_adapter_that_does_not_open_is_an_error_only_where_it_was_asked_for() {
        let world = World::new(&SceneDesc::default()).unwrap();
        let told = RefCell::new(Vec::new());
        let note = |text: &str| told.borrow_mut().push(text.to_owned());
        let open = |choice: DeviceChoice| {
            let seat = Seat { choice, adapter: Some(usize::MAX) };
            Fleet::open(&Assignment(PerStation::all(seat)), &world, Simd::Auto, &GpuOptions::default(), &note)
        };
        assert!(open(DeviceChoice::Named("no such card".to_owned())).is_err());
        assert!(told.borrow().is_empty());
        let fleet = open(DeviceChoice::Auto).unwrap();
        assert_eq!((fleet.gpus().count(), told.borrow().len()), (0, 1), "{told:?}");
        assert_eq!(fleet.stations().at(Station::Gather).info().kind, DeviceKind::Cpu);
    }

    #[test]
    fn the_processor_needs_no_adapter() {
        assert_eq!(adapters_for(&PerStation::all(DeviceChoice::Cpu)), []);
        let world = World::new(&SceneDesc::default()).unwrap();
        let assignment = Assignment::new(&PerStation::all(DeviceChoice::Cpu), &[]).unwrap();
        let fleet = Fleet::open(&assignment, &world, Simd::Auto, &GpuOptions::default(), &|_| ()).unwrap();
        assert_eq!(fleet.gpus().count(), 0);
        assert_eq!(fleet.stations().at(Station::Gather).info().kind, DeviceKind::Cpu);
    }
}
