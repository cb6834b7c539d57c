//! A finished render of either model of light.

use lightcuts::device::Device;
use lightcuts::image::{Image, Layers};
use lightcuts::rendering::{Display, vpls_to_csv};
use lightcuts::{PhysicalRendering, Rendering, Stats};

/// What a render yields.
pub(crate) enum Picture {
    Thesis(Box<Rendering>),
    Physical(Box<PhysicalRendering>),
}

impl Picture {
    pub(crate) fn stats(&self) -> &Stats {
        match self {
            Self::Thesis(rendering) => &rendering.stats,
            Self::Physical(rendering) => &rendering.stats,
        }
    }

    /// Beauty and AOVs.
    pub(crate) fn layers(&self) -> Layers {
        match self {
            Self::Thesis(rendering) => rendering.layers(),
            Self::Physical(rendering) => rendering.layers(),
        }
    }

    /// The picture as it is shown, before the transfer curve; tone mapping on a device if there is one.
    pub(crate) fn displayed(&self, display: &Display, device: Option<&dyn Device>) -> Image {
        match (self, device) {
            (Self::Thesis(rendering), Some(device)) => rendering.displayed_on(display, device),
            (Self::Thesis(rendering), None) => rendering.displayed(display),
            (Self::Physical(rendering), _) => display.develop(&rendering.beauty),
        }
    }

    /// The VPLs as CSV; none of the physical model, which makes new ones in each pass.
    pub(crate) fn vpls_csv(&self) -> String {
        match self {
            Self::Thesis(rendering) => vpls_to_csv(&rendering.vpls),
            Self::Physical(_) => vpls_to_csv(&[]),
        }
    }
}
