//! The devices that can render, as they are serialised to JSON.

use lightcuts::device::{DeviceKind, processor_name};
use lightcuts::gpu::{AdapterSummary, DeviceChoice, choose};
use serde::Serialize;

/// Everything that can render.
#[derive(Debug, Serialize)]
pub(super) struct DeviceList {
    pub(super) auto: Auto,
    pub(super) cpu: Cpu,
    /// The best first.
    pub(super) adapters: Vec<Adapter>,
}

/// The default device.
#[derive(Debug, Serialize)]
pub(super) struct Auto {
    /// `cpu`, or the adapter's name.
    pub(super) device: String,
    pub(super) why: String,
}

/// The processor.
#[derive(Debug, Serialize)]
pub(super) struct Cpu {
    pub(super) name: String,
    pub(super) threads: usize,
    /// The vector instructions that are used, if any.
    pub(super) simd: Option<&'static str>,
}

/// A graphics card or software driver.
#[derive(Debug, Serialize)]
pub(super) struct Adapter {
    pub(super) name: String,
    /// `gpu` or `software gpu`.
    pub(super) kind: &'static str,
    pub(super) api: String,
    pub(super) driver: String,
    pub(super) max_binding_bytes: u64,
    pub(super) max_buffer_bytes: u64,
    pub(super) max_storage_buffers: u32,
    pub(super) max_invocations: u32,
    pub(super) subgroup_sizes: [u32; 2],
    pub(super) timestamps: bool,
    /// Why it cannot be used, if so.
    pub(super) unsuited: Option<String>,
}

impl DeviceList {
    pub(super) fn new(adapters: Vec<AdapterSummary>) -> Self {
        Self { auto: auto(&adapters), cpu: cpu(), adapters: adapters.into_iter().map(Adapter::from).collect() }
    }
}

impl From<AdapterSummary> for Adapter {
    fn from(adapter: AdapterSummary) -> Self {
        Self {
            name: adapter.name,
            kind: adapter.kind.name(),
            api: api(&adapter.api).to_owned(),
            driver: adapter.driver,
            max_binding_bytes: adapter.max_binding_bytes,
            max_buffer_bytes: adapter.max_buffer_bytes,
            max_storage_buffers: adapter.max_storage_buffers,
            max_invocations: adapter.max_invocations,
            subgroup_sizes: adapter.subgroup_sizes,
            timestamps: adapter.has_timestamps,
            unsuited: adapter.unsuited,
        }
    }
}

/// The name of a graphics API as its makers write it.
fn api(name: &str) -> &str {
    match name {
        "vulkan" => "Vulkan",
        "metal" => "Metal",
        "dx12" => "DX12",
        other => other,
    }
}

fn cpu() -> Cpu {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    Cpu { name: processor_name(), threads, simd: simd() }
}

#[cfg(target_arch = "x86_64")]
fn simd() -> Option<&'static str> {
    std::arch::is_x86_feature_detected!("avx2").then_some("AVX2")
}

#[cfg(not(target_arch = "x86_64"))]
fn simd() -> Option<&'static str> {
    None
}

fn auto(adapters: &[AdapterSummary]) -> Auto {
    // This choice cannot fail.
    match choose(&DeviceChoice::Auto, adapters).ok().flatten() {
        Some(place) => {
            Auto { device: adapters[place].name.clone(), why: "it is the first suitable graphics card".to_owned() }
        }
        None => Auto { device: "cpu".to_owned(), why: why_no_gpu(adapters).to_owned() },
    }
}

/// Why none of these is a graphics card that can be used.
pub(super) fn why_no_gpu(adapters: &[AdapterSummary]) -> &'static str {
    if adapters.is_empty() {
        "there is no graphics card, or no Vulkan, Metal or DX12 driver for it"
    } else if adapters.iter().any(|adapter| adapter.kind == DeviceKind::Gpu) {
        "no graphics card is suitable"
    } else {
        "there is no graphics card, and a software driver is slower than the CPU renderer itself"
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::devices) fn adapter(name: &str, kind: DeviceKind, unsuited: Option<&str>) -> AdapterSummary {
        AdapterSummary {
            name: name.to_owned(),
            kind,
            driver: "driver 1.2".to_owned(),
            max_buffer_bytes: 1 << 31,
            subgroup_sizes: [8, 32],
            has_timestamps: true,
            unsuited: unsuited.map(str::to_owned),
            ..AdapterSummary::default()
        }
    }

    #[test]
    fn auto_is_explained() {
        let (card, software) = (DeviceKind::Gpu, DeviceKind::SoftwareGpu);
        let of = |adapters: &[AdapterSummary]| auto(adapters);
        let taken = of(&[adapter("old", card, Some("too old")), adapter("new", card, None)]);
        assert_eq!((taken.device.as_str(), taken.why.as_str()), ("new", "it is the first suitable graphics card"));
        for (adapters, why) in [
            (Vec::new(), "no graphics card, or no Vulkan"),
            (vec![adapter("old", card, Some("too old"))], "no graphics card is suitable"),
            (vec![adapter("llvmpipe", software, None)], "slower than the CPU renderer"),
        ] {
            let taken = of(&adapters);
            assert!(taken.device == "cpu" && taken.why.contains(why), "{taken:?}");
        }
    }
}
