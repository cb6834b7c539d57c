//! Devices in words, and which time is shown for which.

use super::document::Notes;
use super::measured::{Found, seconds};
use crate::layout::Time;
use crate::record::{DeviceInfo, Row};
use lightcuts::device::DeviceKind;
use lightcuts::rendering::PassTime;

/// Whether the processor rendered by itself.
pub(super) fn is_cpu(device: &DeviceInfo) -> bool {
    device.kind == DeviceKind::Cpu.name()
}

/// Whether it was a graphics driver that computes on the processor.
pub(super) fn is_software(device: &DeviceInfo) -> bool {
    device.kind == DeviceKind::SoftwareGpu.name()
}

/// The time that is shown for a render: for the CPU, CPU seconds over all threads, which suffer less from other
/// programs; of a GPU elapsed seconds, for the processor only waits for it.
pub(super) fn told_seconds(row: &Row, time: Time) -> f64 {
    let (processor_s, elapsed_s) = seconds(row, time);
    if is_cpu(&row.device) { processor_s } else { elapsed_s }
}

/// The same of a single stage.
pub(super) fn told_pass_seconds(row: &Row, pass: &PassTime) -> f64 {
    if is_cpu(&row.device) { pass.cpu_s } else { pass.wall_s }
}

/// `llvmpipe (software GPU)`, `Name of the processor (CPU, 2 threads)`.
pub(super) fn named(device: &DeviceInfo) -> String {
    let threads = match device.threads {
        0 => String::new(),
        1 => ", 1 thread".to_owned(),
        threads => format!(", {threads} threads"),
    };
    let kind = device.kind.replace("gpu", "GPU").replace("cpu", "CPU");
    format!("{} ({kind}{threads})", device.name)
}

/// A note on figures that a GPU produced.
pub(super) fn note(found: &Found<'_>) -> Option<String> {
    let device = found.rows().iter().map(|row| &row.device).find(|device| !is_cpu(device))?;
    Some(if is_software(device) {
        format!("Rendered on {}: elapsed seconds. {SLOW}", named(device))
    } else {
        format!("Rendered on {}: elapsed seconds.", named(device))
    })
}

/// The same as a number under a table.
pub(super) fn mark(notes: &mut Notes, found: &Found<'_>) -> Option<usize> {
    note(found).map(|text| notes.mark(text))
}

/// What a software driver is.
pub(super) const SLOW: &str =
    "That is not a graphics card but a driver that runs on the processor, and is slower than the CPU renderer itself.";
