/// A value that may differ between devices: the thesis ran its GPU with other attenuations than its CPU.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerDevice {
    /// Value for the CPU.
    pub cpu: f32,
    /// Value for the GPU.
    pub gpu: f32,
}

impl From<f32> for PerDevice {
    fn from(value: f32) -> Self {
        Self { cpu: value, gpu: value }
    }
}

/// Run parameters that a scene recommends; a job may override each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RunDefaults {
    /// How VPLs are placed.
    pub vpl: Option<VplDefaults>,
    /// The thesis' lightcuts threshold: a VPL counts where its relevance reaches this value.
    pub threshold: Option<PerDevice>,
}

/// Parameters of VPL placement (thesis, Appendix A).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VplDefaults {
    /// Nominal probability that a hit of the first pass becomes a VPL (before the original's generator scales it).
    pub probability: PerDevice,
    /// Least r + g + b of a hit's colour for it to become a VPL.
    pub min_illumination: PerDevice,
    /// Factor on every VPL's light.
    pub attenuation: PerDevice,
}
