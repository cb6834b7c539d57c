//! The devices at work on a render, and what happens when one does not return a result.
//!
//! A device that faults is revived once per render and asked again; after that the CPU does its work here and at every
//! later station. What was finished before stays, so the picture is always complete.

use crate::cpu::CpuDevice;
use crate::device::{Device, DeviceFault, Pass, Tile, TileResult};
use crate::monitor::{Monitor, RetryMonitor};
use crate::stations::{Station, Stations};
use crate::stats::StationDevice;

/// Who finished a station.
#[derive(Debug, Clone, Copy)]
enum Finisher {
    /// The device that was wanted there.
    Wanted,
    /// The CPU that took over.
    Cpu,
}

/// The devices at work on a render.
pub(crate) struct Crew<'a> {
    stations: Stations<'a>,
    /// Takes over from the others.
    cpu: CpuDevice<'a>,
    revived: Vec<&'a dyn Device>,
    dismissed: Vec<&'a dyn Device>,
    /// Who finished each station that ran, by its number.
    finished: [Option<Finisher>; Station::ALL.len()],
    pub(crate) faults: u32,
}

impl<'a> Crew<'a> {
    pub(crate) fn new(stations: &Stations<'a>, cpu: CpuDevice<'a>) -> Self {
        let finished = [None; Station::ALL.len()];
        Self { stations: *stations, cpu, revived: Vec::new(), dismissed: Vec::new(), finished, faults: 0 }
    }

    /// The device that runs a station now.
    pub(crate) fn at(&self, station: Station) -> &dyn Device {
        self.standing(station).map_or(&self.cpu, |device| device)
    }

    /// Runs a station on its device until there is a result. Progress that it reports twice is reported once.
    pub(crate) fn run<T>(
        &mut self,
        station: Station,
        monitor: &dyn Monitor,
        mut work: impl FnMut(&dyn Device, &dyn Monitor) -> Result<T, DeviceFault>,
    ) -> T {
        let mut monitor = RetryMonitor::new(monitor);
        loop {
            if let Some(result) = self.attempt(station, &mut monitor, &mut work) {
                return result;
            }
        }
    }

    /// Renders tiles, in batches of the device's preferred size, and hands the results over in order. Returns whether
    /// all were rendered: not if the monitor cancels.
    pub(crate) fn render_tiles(
        &mut self,
        station: Station,
        pass: &Pass<'_>,
        tiles: &[Tile],
        monitor: &dyn Monitor,
        mut merge: impl FnMut(TileResult),
    ) -> bool {
        let mut monitor = RetryMonitor::new(monitor);
        let mut rest = tiles;
        while !rest.is_empty() {
            let (batch, later) = rest.split_at(self.at(station).batch().clamp(1, rest.len()));
            let render = |device: &dyn Device, monitor: &dyn Monitor| render_batch(device, pass, batch, monitor);
            // After a fault the batches are divided again: another device may prefer another size.
            let Some(results) = self.attempt(station, &mut monitor, render) else { continue };
            rest = later;
            let complete = results.iter().all(Option::is_some);
            results.into_iter().flatten().for_each(&mut merge);
            if !complete {
                return false;
            }
        }
        true
    }

    /// Lets a station's device work once. `None` after a fault: then the device was revived, or the CPU stands at the
    /// station.
    fn attempt<T>(
        &mut self,
        station: Station,
        monitor: &mut RetryMonitor<'_>,
        work: impl FnOnce(&dyn Device, &dyn Monitor) -> Result<T, DeviceFault>,
    ) -> Option<T> {
        monitor.begin_attempt();
        let Some(device) = self.standing(station) else {
            self.finished[station as usize] = Some(Finisher::Cpu);
            return Some(work(&self.cpu, monitor).expect("the CPU does not fault"));
        };
        match work(device, monitor) {
            Ok(result) => {
                self.finished[station as usize] = Some(Finisher::Wanted);
                Some(result)
            }
            Err(fault) => {
                monitor.rewind();
                self.recover(station, device, &fault, monitor);
                None
            }
        }
    }

    /// The wanted device of a station, unless it was dismissed.
    fn standing(&self, station: Station) -> Option<&'a dyn Device> {
        let wanted = *self.stations.at(station);
        (!holds(&self.dismissed, wanted)).then_some(wanted)
    }

    /// Revives a device that faulted, or dismisses it.
    fn recover(&mut self, station: Station, device: &'a dyn Device, fault: &DeviceFault, monitor: &dyn Monitor) {
        self.faults += 1;
        let outcome = if holds(&self.revived, device) {
            self.dismissed.push(device);
            "it faulted before, so the CPU does the rest of its work".to_owned()
        } else if let Err(gone) = self.revive(device) {
            self.dismissed.push(device);
            format!("it cannot be reopened ({gone}), so the CPU does the rest of its work")
        } else {
            "it was reopened and continues where it stopped".to_owned()
        };
        monitor.note(&format!("{} on {}: {fault}; {outcome}", station.name(), device.info().name));
    }

    /// Revives a device, for the only time in this render.
    fn revive(&mut self, device: &'a dyn Device) -> Result<(), DeviceFault> {
        self.revived.push(device);
        device.revive()
    }

    /// What finished each station that ran, in order.
    pub(crate) fn record(&self) -> Vec<StationDevice> {
        let ran = Station::ALL.into_iter().filter_map(|station| Some((station, self.finished[station as usize]?)));
        ran.map(|(station, finisher)| {
            let info = match finisher {
                Finisher::Wanted => self.stations.at(station).info(),
                Finisher::Cpu => self.cpu.info(),
            };
            StationDevice { station: station.name().to_owned(), kind: info.kind.name().to_owned(), name: info.name }
        })
        .collect()
    }
}

/// Renders tiles on a device; a device that returns results of some only has failed.
fn render_batch(
    device: &dyn Device,
    pass: &Pass<'_>,
    batch: &[Tile],
    monitor: &dyn Monitor,
) -> Result<Vec<Option<TileResult>>, DeviceFault> {
    let results = device.render_tiles(pass, batch, monitor)?;
    if results.len() == batch.len() {
        Ok(results)
    } else {
        Err(DeviceFault::Failed(format!("{} results for {} tiles", results.len(), batch.len())))
    }
}

/// Whether a device is among some: the very same, not an equal one.
fn holds(devices: &[&dyn Device], device: &dyn Device) -> bool {
    devices.iter().any(|other| std::ptr::addr_eq(std::ptr::from_ref(*other), std::ptr::from_ref(device)))
}
