//! Memory: how much a picture needs, how much there is, how much was used. Known on Linux only; limits of a container
//! are not looked at.

use crate::exit::Failure;
use lightcuts::rendering::ImageSize;

/// Memory for every pixel, in bytes: films, surfaces seen, layers, the encoded file. Measured: 206 for a render of
/// 2048 x 2048 pixels written as EXR; the rest is for bloom and tone mapping.
const BYTES_PER_PIXEL: u64 = 250;

/// Fails if a picture of this size does not fit into free memory and swap: running out of them would end the process in
/// the middle of the render. Where nobody tells how much is free, every size is let through.
pub(crate) fn require_for(size: ImageSize) -> Result<(), Failure> {
    let need = u64::from(size.width) * u64::from(size.height) * BYTES_PER_PIXEL;
    match free_bytes() {
        Some(free) if free < need => Err(Failure::usage(
            format!("a picture of {} x {} pixels needs about {} of memory", size.width, size.height, mebibytes(need)),
            format!("{} are free, swap included; choose a smaller --size", mebibytes(free)),
        )),
        _ => Ok(()),
    }
}

/// Lets freed memory be used again rather than go back to the system: what tiles yield comes and goes all the time, and a page that
/// is had anew costs about as much as a pixel's rays.
///
/// The GNU allocator gives back what is free above a limit, and moves the limit to twice the size of a large block when that is freed.
/// This one is never touched, so that it takes no memory; other allocators are none the wiser.
pub(crate) fn keep_freed() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(16 << 20)));
}

/// Memory that can be had without pushing other programs out, and free swap, in bytes.
fn free_bytes() -> Option<u64> {
    let of = |key| bytes_of("/proc/meminfo", key);
    Some(of("MemAvailable:")? + of("SwapFree:").unwrap_or(0))
}

/// Most memory that this process had at once so far, in bytes.
pub(crate) fn peak_bytes() -> Option<u64> {
    bytes_of("/proc/self/status", "VmHWM:")
}

/// What a file tells in the line `key 123 kB`, in bytes; Linux writes kB for 1024 bytes. `None` without such a line.
fn bytes_of(file: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// A number of bytes for people, rounded down to whole MiB.
fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", bytes >> 20)
}
