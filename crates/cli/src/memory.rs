//! Memory: how much a picture needs, how much there is, how much was used. Known on Linux only.

use crate::exit::Failure;
use lightcuts::rendering::ImageSize;

/// Memory for every pixel: films, surfaces seen, layers, the encoded file. Measured: 206 for a render of 2048 x 2048
/// pixels written as EXR; the rest is for bloom and tone mapping.
const BYTES_PER_PIXEL: u64 = 250;

/// Fails if the picture cannot fit: running out of memory would end the process in the middle of the render.
pub(crate) fn require_for(size: ImageSize) -> Result<(), Failure> {
    let need = u64::from(size.width) * u64::from(size.height) * BYTES_PER_PIXEL;
    let is_there = |key| kilobytes("/proc/meminfo", key);
    match (is_there("MemAvailable:"), is_there("SwapFree:")) {
        (Some(memory), swap) if memory + swap.unwrap_or(0) < need => Err(Failure::usage(
            format!("a picture of {} x {} pixels needs about {} of memory", size.width, size.height, told(need)),
            format!("{} are free; ask for a smaller picture", told(memory)),
        )),
        _ => Ok(()),
    }
}

/// Highest resident size of this process so far.
pub(crate) fn peak_bytes() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM:")
}

/// The bytes of a line `key 123 kB`, with kB for 1024 bytes as the kernel means it.
fn kilobytes(file: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

fn told(bytes: u64) -> String {
    format!("{} MiB", bytes >> 20)
}
