//! A finished render of either model of light.

use lightcuts::device::Device;
use lightcuts::image::{Image, Layers};
use lightcuts::rendering::{Display, Vpl, vpls_to_csv};
use lightcuts::{PhysicalRendering, Rendering, Stats};

/// What a render yields. Its planes are here once: they are most of the memory that writing needs.
pub(crate) struct Picture {
    /// Beauty and AOVs.
    pub(crate) layers: Layers,
    pub(crate) stats: Stats,
    /// None of the physical model, which makes new ones in each pass.
    vpls: Vec<Vpl>,
}

impl From<Rendering> for Picture {
    fn from(mut rendering: Rendering) -> Self {
        let (stats, vpls) = (std::mem::take(&mut rendering.stats), std::mem::take(&mut rendering.vpls));
        Self { layers: rendering.into_layers(), stats, vpls }
    }
}

impl From<PhysicalRendering> for Picture {
    fn from(mut rendering: PhysicalRendering) -> Self {
        let stats = std::mem::take(&mut rendering.stats);
        Self { layers: rendering.into_layers(), stats, vpls: Vec::new() }
    }
}

impl Picture {
    /// The picture as it is shown, before the transfer curve; tone mapping on a device if there is one.
    pub(crate) fn displayed(&self, display: &Display, device: Option<&dyn Device>) -> Image {
        let (operator, beauty) = (display.operator(), display.exposure.apply(self.layers.beauty()));
        let on_device = device.and_then(|device| device.tone_map(&beauty, &operator).ok());
        on_device.unwrap_or_else(|| operator.apply(&beauty))
    }

    /// The VPLs as CSV.
    pub(crate) fn vpls_csv(&self) -> String {
        vpls_to_csv(&self.vpls)
    }
}
