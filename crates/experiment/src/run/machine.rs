//! What rendered, and when.

use crate::record::DeviceInfo;
use std::time::SystemTime;

/// Git revision that the program was built from, with `-dirty` if its sources were changed; `unknown` outside a checkout.
pub const fn revision() -> &'static str {
    env!("LIGHTCUTS_REVISION")
}

/// The processor.
pub(super) fn cpu(threads: usize) -> DeviceInfo {
    DeviceInfo { kind: "cpu".to_owned(), name: cpu_name(), threads: threads as u32 }
}

/// The processor's name where the system tells it (Linux), else its architecture.
fn cpu_name() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    line.map_or(std::env::consts::ARCH, |(_, name)| name.trim()).to_owned()
}

/// The time in UTC, to the second: `2026-11-22T21:21:32Z`.
pub(super) fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}
