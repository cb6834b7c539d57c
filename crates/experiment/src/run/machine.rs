//! What rendered, and when.

use crate::record::DeviceInfo;
use lightcuts::device::processor_name;
use lightcuts::gpu::{Fleet, GpuDevice};
use std::time::SystemTime;

/// Git revision that the program was built from, with `-dirty` if its sources were changed; `unknown` outside a
/// checkout.
pub const fn revision() -> &'static str {
    env!("LIGHTCUTS_REVISION")
}

/// The device of a configuration: its GPU if it has one, else the processor.
pub(super) fn device(fleet: &Fleet<'_>, threads: usize) -> DeviceInfo {
    match fleet.gpus().next().map(GpuDevice::adapter) {
        Some(adapter) => DeviceInfo { kind: adapter.kind.name().to_owned(), name: adapter.name.clone(), threads: 0 },
        None => DeviceInfo { kind: "cpu".to_owned(), name: processor_name(), threads: threads as u32 },
    }
}

/// The time in UTC, to the second: `2026-11-22T21:21:32Z`.
pub(super) fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}
