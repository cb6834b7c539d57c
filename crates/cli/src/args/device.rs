//! Which device renders, as a whole and by stations; arguments of `devices`.

use clap::Args;
use lightcuts::gpu::{DeviceChoice, GpuOptions};
use lightcuts::{PerStation, Station};
use std::str::FromStr;
use std::time::Duration;

/// Longest piece of GPU work that can be asked for, in milliseconds: half of what a watchdog of two seconds lets pass.
const MAX_BUDGET_MS: i64 = 1000;

/// What the help of `devices` ends with.
pub(super) const AFTER_HELP: &str = "\
`lightcuts render --device DEVICE` takes

  auto  a graphics card if there is one, else the CPU; the default
  cpu   the CPU, with all cores and their vector instructions
  gpu   the best adapter, even if it is a software driver: to try the GPU's programs without a card
  NAME  the first adapter whose name contains this, in any case of letters

and `--station-device gather=gpu` one station of the render elsewhere than the others.

A graphics card is seen if its driver offers Vulkan (Linux, Windows), Metal (macOS) or DX12 (Windows). If yours is not
listed, install its vendor's driver and Vulkan's loader; on Debian and Ubuntu the packages libvulkan1 and
mesa-vulkan-drivers, which bring a software driver too.

A software driver computes on the processor. It is there for tests, and slower than the CPU renderer itself.

This command always ends with 0: the CPU is always there.";

/// Which device renders.
#[derive(Debug, Args)]
pub(crate) struct DeviceArgs {
    /// What renders: `auto` is a graphics card if there is one, else the CPU; `cpu`; `gpu`, the best adapter; or NAME, a part
    /// of an adapter's name.
    ///
    /// `lightcuts devices` lists them. One device gives the same picture every time, bit for bit; pictures of two devices
    /// differ by rounding alone. Counts and random numbers are the same on all, with --reproduce too.
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = choice)]
    device: DeviceChoice,
    /// Another device for one station of the render, such as `gather=gpu`; may be repeated, or separated by commas.
    ///
    /// The stations are `place` (the first pass), `photons` (of caustics), `tree` (over the VPLs), `gather` (the second pass)
    /// and `develop` (bloom and tone mapping). A result of one device is used on another, so this isolates a fault.
    #[arg(long, value_name = "STATION=DEVICE", value_delimiter = ',')]
    station_device: Vec<StationDevice>,
    /// Milliseconds that a piece of a GPU's work may take: the fewer, the smoother a desktop on the same GPU.
    #[arg(long, value_name = "MS", default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=MAX_BUDGET_MS))]
    gpu_budget: u16,
}

/// Arguments of `devices`.
#[derive(Debug, Args)]
pub(crate) struct DevicesArgs {
    /// Print JSON for machines.
    #[arg(long)]
    pub(crate) json: bool,
}

/// A station with the device that it takes.
#[derive(Debug, Clone, PartialEq, Eq)]
struct StationDevice {
    station: Station,
    device: DeviceChoice,
}

impl DeviceArgs {
    /// What each station asks for; of two devices for one station the last counts.
    pub(crate) fn wanted(&self) -> PerStation<DeviceChoice> {
        let wanted = PerStation::all(self.device.clone());
        let own = self.station_device.iter().cloned();
        own.fold(wanted, |wanted, StationDevice { station, device }| wanted.with(station, device))
    }

    /// How a GPU is used.
    pub(crate) fn gpu_options(&self) -> GpuOptions {
        GpuOptions { budget: Duration::from_millis(u64::from(self.gpu_budget)), ..GpuOptions::default() }
    }
}

impl FromStr for StationDevice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (station, device) = text.split_once('=').ok_or("expected STATION=DEVICE, such as gather=gpu")?;
        Ok(Self { station: station.parse()?, device: choice(device)? })
    }
}

fn choice(text: &str) -> Result<DeviceChoice, String> {
    if text.trim().is_empty() {
        return Err("expected auto, cpu, gpu or a part of an adapter's name".to_owned());
    }
    let Ok(choice) = text.parse();
    Ok(choice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_take_devices() {
        let parsed = |text: &str| text.parse::<StationDevice>();
        assert_eq!(parsed("gather=GPU"), Ok(StationDevice { station: Station::Gather, device: DeviceChoice::Gpu }));
        let card = DeviceChoice::Named("My Card".to_owned());
        assert_eq!(parsed("tree=My Card"), Ok(StationDevice { station: Station::Tree, device: card }));
        for (text, expected) in
            [("gpu", "STATION=DEVICE"), ("pass=gpu", "expected some of place, photons"), ("tree=", "auto")]
        {
            assert!(parsed(text).unwrap_err().contains(expected), "{text}");
        }
    }

    #[test]
    fn a_stations_own_device_counts_and_of_two_the_last() {
        let own = ["gather=cpu", "gather=gpu", "tree=x"].map(|text| text.parse().unwrap()).to_vec();
        let wanted = DeviceArgs { device: DeviceChoice::Auto, station_device: own, gpu_budget: 30 }.wanted();
        let named = DeviceChoice::Named("x".to_owned());
        let expected =
            PerStation::all(DeviceChoice::Auto).with(Station::Gather, DeviceChoice::Gpu).with(Station::Tree, named);
        assert_eq!(wanted, expected);
    }
}
