//! Adapters: which ones exist, what they can do, and which one is used.

use lightcuts_render::device::{DeviceFault, DeviceKind};
use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

/// Storage buffers that a program may have at least; programs are within it unless a scene is split.
const MIN_STORAGE_BUFFERS: u32 = 10;
/// Invocations of the largest workgroup.
const MIN_INVOCATIONS: u32 = 256;

/// Which device is wanted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// A graphics card if there is one, else the processor.
    #[default]
    Auto,
    /// The processor.
    Cpu,
    /// The best adapter, a software driver included.
    Gpu,
    /// The first adapter whose name contains this, in any case of letters.
    Named(String),
}

impl FromStr for DeviceChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text.to_lowercase().as_str() {
            "auto" => Self::Auto,
            "cpu" => Self::Cpu,
            "gpu" => Self::Gpu,
            _ => Self::Named(text.to_owned()),
        })
    }
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::Named(name) => name,
        })
    }
}

/// What an adapter is and can do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterSummary {
    /// Name of the card or software driver.
    pub name: String,
    /// [`DeviceKind::Gpu`] or [`DeviceKind::SoftwareGpu`].
    pub kind: DeviceKind,
    /// Vulkan, Metal or DX12.
    pub api: String,
    /// Driver with its version.
    pub driver: String,
    /// Largest storage buffer that a program can be given, in bytes.
    pub max_binding_bytes: u64,
    /// Largest buffer, in bytes.
    pub max_buffer_bytes: u64,
    /// Storage buffers of a program.
    pub max_storage_buffers: u32,
    /// Invocations of a workgroup.
    pub max_invocations: u32,
    /// Least and greatest number of invocations that run in step; informative, nothing depends on it.
    pub subgroup_sizes: [u32; 2],
    /// Whether it can time its own work.
    pub has_timestamps: bool,
    /// Why it cannot be used, if so.
    pub unsuited: Option<String>,
}

impl Default for AdapterSummary {
    /// The least suited adapter: a card without a name that can do just what programs need.
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: DeviceKind::Gpu,
            api: "vulkan".to_owned(),
            driver: String::new(),
            max_binding_bytes: 1 << 27,
            max_buffer_bytes: 1 << 28,
            max_storage_buffers: MIN_STORAGE_BUFFERS,
            max_invocations: MIN_INVOCATIONS,
            subgroup_sizes: [4, 128],
            has_timestamps: false,
            unsuited: None,
        }
    }
}

/// All adapters, the best first: separate cards, built-in ones, virtual and unknown ones, software drivers.
///
/// They are looked for once per process: loading drivers takes time, and some print remarks on their surroundings.
/// Validation layers stay off: they change what is timed.
pub(crate) fn ordered() -> &'static [wgpu::Adapter] {
    static ADAPTERS: OnceLock<Vec<wgpu::Adapter>> = OnceLock::new();
    ADAPTERS.get_or_init(|| {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12,
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        });
        adapters
    })
}

/// Every adapter of this machine, the best first. Empty where there is no driver.
pub fn adapters() -> Vec<AdapterSummary> {
    ordered().iter().map(summary).collect()
}

/// The adapter that a choice takes, by its place in [`adapters`]; `None` for the processor. Fails if what was asked for
/// is not there.
pub fn choose(choice: &DeviceChoice, adapters: &[AdapterSummary]) -> Result<Option<usize>, DeviceFault> {
    let mut suited = adapters.iter().enumerate().filter(|(_, adapter)| adapter.unsuited.is_none());
    let place = |found: Option<(usize, &AdapterSummary)>| found.map(|(place, _)| place);
    match choice {
        DeviceChoice::Cpu => Ok(None),
        DeviceChoice::Auto => Ok(place(suited.find(|(_, adapter)| adapter.kind == DeviceKind::Gpu))),
        DeviceChoice::Gpu => place(suited.next()).map(Some).ok_or_else(|| none_suited(adapters)),
        DeviceChoice::Named(name) => {
            let is_named = |adapter: &AdapterSummary| adapter.name.to_lowercase().contains(&name.to_lowercase());
            place(suited.find(|(_, adapter)| is_named(adapter))).map(Some).ok_or_else(|| {
                match adapters.iter().find(|adapter| is_named(adapter)).and_then(|a| a.unsuited.as_ref()) {
                    Some(why) => DeviceFault::Failed(format!("`{name}` cannot be used: {why}")),
                    None => DeviceFault::Failed(format!("there is no device `{name}`; see `lightcuts devices`")),
                }
            })
        }
    }
}

fn none_suited(adapters: &[AdapterSummary]) -> DeviceFault {
    DeviceFault::Failed(match adapters.first() {
        None => "there is no graphics adapter: no Vulkan, Metal or DX12 driver was found".to_owned(),
        Some(AdapterSummary { name, unsuited, .. }) => {
            format!("`{name}` cannot be used: {}", unsuited.as_deref().unwrap_or("it is not suited"))
        }
    })
}

pub(crate) fn summary(adapter: &wgpu::Adapter) -> AdapterSummary {
    let (info, limits) = (adapter.get_info(), adapter.limits());
    AdapterSummary {
        kind: kind(&info),
        api: info.backend.to_string(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        name: info.name,
        max_binding_bytes: limits.max_storage_buffer_binding_size,
        max_buffer_bytes: limits.max_buffer_size,
        max_storage_buffers: limits.max_storage_buffers_per_shader_stage,
        max_invocations: limits.max_compute_invocations_per_workgroup,
        subgroup_sizes: [info.subgroup_min_size, info.subgroup_max_size],
        has_timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        unsuited: unsuited(&limits),
    }
}

pub(crate) fn kind(info: &wgpu::AdapterInfo) -> DeviceKind {
    if info.device_type == wgpu::DeviceType::Cpu { DeviceKind::SoftwareGpu } else { DeviceKind::Gpu }
}

fn unsuited(limits: &wgpu::Limits) -> Option<String> {
    let (buffers, invocations) =
        (limits.max_storage_buffers_per_shader_stage, limits.max_compute_invocations_per_workgroup);
    if buffers < MIN_STORAGE_BUFFERS {
        return Some(format!("programs need {MIN_STORAGE_BUFFERS} storage buffers, it has {buffers}"));
    }
    (invocations < MIN_INVOCATIONS)
        .then(|| format!("programs need workgroups of {MIN_INVOCATIONS} invocations, it has {invocations}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: DeviceKind) -> AdapterSummary {
        AdapterSummary { name: name.to_owned(), kind, ..AdapterSummary::default() }
    }

    #[test]
    fn auto_takes_a_card_and_no_software_driver() {
        let software = adapter("llvmpipe", DeviceKind::SoftwareGpu);
        let card = adapter("Card 9000", DeviceKind::Gpu);
        let both = [card.clone(), software.clone()];
        assert_eq!(choose(&DeviceChoice::Auto, &both), Ok(Some(0)));
        assert_eq!(choose(&DeviceChoice::Auto, std::slice::from_ref(&software)), Ok(None));
        assert_eq!(choose(&DeviceChoice::Gpu, std::slice::from_ref(&software)), Ok(Some(0)));
        assert_eq!(choose(&DeviceChoice::Cpu, &both), Ok(None));
        assert_eq!(choose(&"LLVM".parse().expect("any text is a choice"), &both), Ok(Some(1)));
        assert!(choose(&DeviceChoice::Named("x".to_owned()), &both).is_err());
        assert!(choose(&DeviceChoice::Gpu, &[]).is_err());
        let old = AdapterSummary { unsuited: Some("it is old".to_owned()), ..card };
        assert_eq!(choose(&DeviceChoice::Auto, std::slice::from_ref(&old)), Ok(None));
        assert!(choose(&DeviceChoice::Named("card".to_owned()), &[old]).unwrap_err().to_string().contains("it is old"));
    }
}
