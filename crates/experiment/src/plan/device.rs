//! Devices of configurations: which are requested, and whether they are available.

use super::file::Document;
use lightcuts::PerStation;
use lightcuts::gpu::{AdapterSummary, Assignment, DeviceChoice, adapters_for};
use serde::{Deserialize, Deserializer};

/// Whether each configuration has a device on this machine, by its number in the file.
#[derive(Debug)]
pub(super) struct Devices {
    /// Why there is none.
    absent: Vec<Option<String>>,
}

impl Devices {
    pub(super) fn new(document: &Document, adapters: &[AdapterSummary]) -> Self {
        let absent = |choice: &DeviceChoice| Assignment::new(&PerStation::all(choice.clone()), adapters).err();
        let tables = document.configuration.iter();
        Self { absent: tables.map(|table| absent(&table.device).map(|why| why.to_string())).collect() }
    }

    /// Why a configuration cannot be rendered; `None` if it can.
    pub(super) fn absent(&self, configuration: usize) -> Option<&str> {
        self.absent[configuration].as_deref()
    }
}

/// The adapters of this machine, as far as a document needs to know them.
pub(super) fn adapters(document: &Document) -> Vec<AdapterSummary> {
    let needs_adapters = document.configuration.iter().any(|table| table.device != DeviceChoice::Cpu);
    adapters_for(&PerStation::all(if needs_adapters { DeviceChoice::Gpu } else { DeviceChoice::Cpu }))
}

/// The key `device`: any text is a choice.
pub(super) fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<DeviceChoice, D::Error> {
    let Ok(choice) = String::deserialize(deserializer)?.parse();
    Ok(choice)
}

/// The device of a configuration that names none.
pub(super) fn cpu() -> DeviceChoice {
    DeviceChoice::Cpu
}
