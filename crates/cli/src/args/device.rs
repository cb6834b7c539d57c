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
Values of `lightcuts render --device DEVICE`:

  auto  a graphics card if there is one, else the CPU; the default
  cpu   the CPU, with all cores and their vector instructions
  gpu   the best adapter, even if it is a software driver: to try the GPU code without a card
  NAME  the first adapter whose name contains NAME, ignoring case

`--station-device gather=gpu` runs one station of the render on another device.
GPUs render the thesis' model; the physical model runs on the CPU.

A graphics card is found if its driver supports Vulkan (Linux, Windows), Metal (macOS) or DX12
(Windows). If yours is not listed, install its vendor's driver and the Vulkan loader; on Debian and
Ubuntu, the packages libvulkan1 and mesa-vulkan-drivers, which include a software driver.

A software driver runs on the processor. It is meant for tests, and is slower than the CPU renderer itself.

The exit code is always 0: there is always a CPU.";

/// Which device renders.
#[derive(Debug, Args)]
pub(crate) struct DeviceArgs {
    /// Device to render on: `auto`, a graphics card if there is one, else the CPU; `cpu`; `gpu`, the best adapter; or
    /// part of an adapter's name.
    ///
    /// `lightcuts devices` lists them. GPUs render the thesis' model; the physical model runs on the CPU. A device
    /// gives the same picture every time, bit for bit; pictures of two devices differ only by rounding. Counts and
    /// random numbers are the same on all devices, also with --reproduce.
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = choice)]
    device: DeviceChoice,
    /// Another device for one station of the render, such as `gather=gpu`; may be repeated, or separated by commas
    ///
    /// The stations are `place` (the first pass), `photons` (of caustics), `tree` (over the VPLs), `gather` (the second
    /// pass) and `develop` (bloom and tone mapping). The result of one device is passed to the next, so this isolates a
    /// fault.
    #[arg(id = "station-device", long = "station-device", value_name = "STATION=DEVICE", value_delimiter = ',')]
    station_device: Vec<StationDevice>,
    /// Longest single piece of GPU work, in milliseconds: the shorter, the smoother a desktop on the same GPU [default:
    /// 30]
    #[arg(id = "gpu-budget", long = "gpu-budget", value_name = "MS", value_parser = clap::value_parser!(u16).range(1..=MAX_BUDGET_MS))]
    gpu_budget: Option<u16>,
}

/// Arguments of `devices`.
#[derive(Debug, Args)]
pub(crate) struct DevicesArgs {
    /// Print JSON for machines.
    #[arg(long)]
    pub(crate) json: bool,
}

/// A station with the device that runs it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct StationDevice {
    station: Station,
    device: DeviceChoice,
}

impl DeviceArgs {
    /// The device requested for each station; of two for one station the last counts.
    pub(crate) fn wanted(&self) -> PerStation<DeviceChoice> {
        let wanted = PerStation::all(self.device.clone());
        let own = self.station_device.iter().cloned();
        own.fold(wanted, |wanted, StationDevice { station, device }| wanted.with(station, device))
    }

    /// Whether a station was given a device of its own.
    pub(super) fn has_stations(&self) -> bool {
        !self.station_device.is_empty()
    }

    /// Whether the length of GPU work was given.
    pub(super) fn has_budget(&self) -> bool {
        self.gpu_budget.is_some()
    }

    /// How a GPU is used.
    pub(crate) fn gpu_options(&self) -> GpuOptions {
        let default = GpuOptions::default();
        let budget = self.gpu_budget.map_or(default.budget, |ms| Duration::from_millis(u64::from(ms)));
        GpuOptions { budget, ..default }
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
        return Err("expected auto, cpu, gpu or part of an adapter's name".to_owned());
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
            [("gpu", "STATION=DEVICE"), ("pass=gpu", "expected one of place, photons"), ("tree=", "auto")]
        {
            assert!(parsed(text).unwrap_err().contains(expected), "{text}");
        }
    }

    #[test]
    fn a_stations_own_device_counts_and_of_two_the_last() {
        let own = ["gather=cpu", "gather=gpu", "tree=x"].map(|text| text.parse().unwrap()).to_vec();
        let wanted = DeviceArgs { device: DeviceChoice::Auto, station_device: own, gpu_budget: None }.wanted();
        let named = DeviceChoice::Named("x".to_owned());
        let expected =
            PerStation::all(DeviceChoice::Auto).with(Station::Gather, DeviceChoice::Gpu).with(Station::Tree, named);
        assert_eq!(wanted, expected);
    }

    #[test]
    fn the_budget_is_the_one_given_else_that_of_the_help() {
        let budget = |gpu_budget| DeviceArgs { device: DeviceChoice::Auto, station_device: Vec::new(), gpu_budget };
        let told = budget(None).gpu_options().budget.as_millis();
        assert_eq!(budget(Some(7)).gpu_options().budget, Duration::from_millis(7));
        let command = crate::args::command();
        let mut options = command.find_subcommand("render").unwrap().get_arguments();
        let help = options.find(|arg| arg.get_id() == "gpu-budget").unwrap().get_help().unwrap().to_string();
        assert!(help.ends_with(&format!("same GPU (thesis) [default: {told}]")), "{help}");
    }
}
