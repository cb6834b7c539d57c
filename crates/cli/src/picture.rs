//! A finished render of either model of light.

use lightcuts::device::Device;
use lightcuts::image::{Image, Layers};
use lightcuts::rendering::{Display, Vpl, vpls_to_csv};
use lightcuts::{PhysicalRendering, Rendering, Stats};

/// What a render yields. Its planes are here once: they are most of the memory that writing needs.
pub(crate) struct Picture {
    pub(crate) stats: Stats,
    /// A rendering of the physical model until its AOVs are made: a PNG needs none.
    rendering: Option<PhysicalRendering>,
    /// Beauty and AOVs.
    layers: Option<Layers>,
    /// None of the physical model, which makes new ones in each pass.
    vpls: Vec<Vpl>,
}

impl From<Rendering> for Picture {
    fn from(mut rendering: Rendering) -> Self {
        let (stats, vpls) = (std::mem::take(&mut rendering.stats), std::mem::take(&mut rendering.vpls));
        Self { stats, rendering: None, layers: Some(rendering.into_layers()), vpls }
    }
}

impl From<PhysicalRendering> for Picture {
    fn from(mut rendering: PhysicalRendering) -> Self {
        let stats = std::mem::take(&mut rendering.stats);
        Self { stats, rendering: Some(rendering), layers: None, vpls: Vec::new() }
    }
}

impl Picture {
    fn beauty(&self) -> &Image {
        let of_layers = self.layers.as_ref().map(Layers::beauty);
        of_layers.or(self.rendering.as_ref().map(|rendering| &rendering.beauty)).expect("a picture has one of both")
    }

    /// Beauty and AOVs.
    pub(crate) fn layers(&mut self) -> &mut Layers {
        let Self { rendering, layers, .. } = self;
        layers.get_or_insert_with(|| rendering.take().expect("a picture has one of both").into_layers())
    }

    /// The picture as it is shown, before the transfer curve; tone mapping on a device if there is one.
    pub(crate) fn displayed(&self, display: &Display, device: Option<&dyn Device>) -> Image {
        let (operator, beauty) = (display.operator(), display.exposure.apply(self.beauty()));
        let on_device = device.and_then(|device| device.tone_map(&beauty, &operator).ok());
        on_device.unwrap_or_else(|| operator.apply(&beauty))
    }

    /// The VPLs as CSV.
    pub(crate) fn vpls_csv(&self) -> String {
        vpls_to_csv(&self.vpls)
    }
}
