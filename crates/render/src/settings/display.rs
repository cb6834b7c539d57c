//! How a picture is displayed.

use lightcuts_image::{Exposure, GlobalToneMapping, Image, LocalToneMapping, ToneMapping, Transfer};
use serde::{Deserialize, Serialize};

/// From linear light to displayed values; for PNG only.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Display {
    /// Factor on light before anything else. The default is not written: files of jobs stay as they were before it
    /// came.
    #[serde(skip_serializing_if = "Exposure::is_neutral")]
    pub exposure: Exposure,
    /// Tone mapping operator.
    pub tone_mapping: ToneMappingKind,
    /// Parameters of the global operator.
    pub global: GlobalToneMapping,
    /// Parameters of the local operator.
    pub local: LocalToneMapping,
    /// Transfer function; the thesis shows values as they are.
    pub transfer: Transfer,
}

/// Tone mapping operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMappingKind {
    /// Values as they are.
    #[default]
    None,
    /// The thesis' global operator.
    Global,
    /// Reinhard et al. 2002, local: the menu entry that the original left empty.
    Local,
}

impl Display {
    /// Linear light as it is shown, before the transfer curve: exposed, then tone mapped.
    pub fn develop(&self, light: &Image) -> Image {
        self.operator().apply(&self.exposure.apply(light))
    }

    /// The chosen operator with its parameters.
    pub fn operator(&self) -> ToneMapping {
        match self.tone_mapping {
            ToneMappingKind::None => ToneMapping::None,
            ToneMappingKind::Global => ToneMapping::Global(self.global),
            ToneMappingKind::Local => ToneMapping::Local(self.local),
        }
    }
}
