//! Files that hold light, decoded once for all who read them: pictures to compare or develop, and textures.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::exr_picture::decode_exr_picture;
use crate::hdr::{decode_hdr, is_hdr};
use crate::pfm::{decode_pfm, is_pfm};
use crate::{Channels, Frame, Image, ImageError, PictureLimits};

/// The first bytes of an EXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// The first bytes of a PNG file.
const PNG: [u8; 8] = [0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a];

/// A format of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// OpenEXR.
    Exr,
    /// Radiance, RGBE or XYZE.
    Hdr,
    /// Portable float map.
    Pfm,
    /// PNG: code values, not light.
    Png,
}

impl PictureFormat {
    /// Told by the first bytes of a file, not by its name.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        match () {
            () if bytes.starts_with(&EXR) => Some(Self::Exr),
            () if bytes.starts_with(&PNG) => Some(Self::Png),
            () if is_pfm(bytes) => Some(Self::Pfm),
            () if is_hdr(bytes) => Some(Self::Hdr),
            () => None,
        }
    }

    /// The name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exr => "EXR",
            Self::Hdr => "Radiance HDR",
            Self::Pfm => "PFM",
            Self::Png => "PNG",
        }
    }
}

/// What is to be made of a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct LightOptions<'a> {
    /// Layer of an EXR file; `None` for the picture itself.
    pub layer: Option<&'a str>,
    /// Take the numbers as they are stored, for normals and masks; otherwise they are colours and become Rec. 709.
    pub is_data: bool,
    /// What a file may ask for.
    pub limits: PictureLimits,
}

/// The light of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Linear Rec. 709, or the numbers as stored where that was asked for; grey as three equal channels, alpha left out.
    pub image: Image,
    /// The channels of the file.
    pub channels: Channels,
    /// Where the pixels lie.
    pub frame: Frame,
    /// Whether the file's colours are of other primaries, so that colours and data differ.
    pub has_other_primaries: bool,
    /// What a user must know of how the numbers were taken, a sentence each.
    pub remarks: Vec<String>,
}

/// The light in the bytes of an EXR, Radiance HDR or portable float map; `path` is for messages alone. `None` for any other
/// format.
///
/// Allocates nothing that the length of the file does not justify. Fails with [`ImageError::Malformed`] on a damaged file, on
/// one beyond the limits, and where there is no such layer.
pub fn decode_light(path: &Path, bytes: &[u8], options: &LightOptions<'_>) -> Option<Result<Light, ImageError>> {
    let decode = match PictureFormat::of(bytes)? {
        PictureFormat::Exr => decode_exr_picture,
        PictureFormat::Hdr => decode_hdr,
        PictureFormat::Pfm => decode_pfm,
        PictureFormat::Png => return None,
    };
    Some(guarded(path, || decode(path, bytes, options)))
}

/// Reads the light of an EXR, Radiance HDR or portable float map; see [`decode_light`].
///
/// Fails with [`ImageError::Io`] besides.
pub fn read_light(path: impl AsRef<Path>, options: &LightOptions<'_>) -> Result<Light, ImageError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| ImageError::io("read", path, source))?;
    let reason = match PictureFormat::of(&bytes) {
        Some(PictureFormat::Png) => {
            "it is a PNG, which holds what a display shows; expected light: EXR, Radiance HDR or PFM"
        }
        _ => "it is no EXR, Radiance HDR or PFM file",
    };
    let light = decode_light(path, &bytes, options).ok_or_else(|| ImageError::malformed(path, reason))?;
    match (options.layer, PictureFormat::of(&bytes)) {
        (Some(layer), Some(format)) if format != PictureFormat::Exr => {
            Err(ImageError::malformed(path, format!("it has no layer {layer}: only EXR files have layers")))
        }
        _ => light,
    }
}

/// Last resort: whatever a decoder does with damaged data, a file ends in pixels or in an error. Nothing that outlives
/// `decode` is changed by it, so nothing can be left half changed.
pub(crate) fn guarded<T>(path: &Path, decode: impl FnOnce() -> Result<T, ImageError>) -> Result<T, ImageError> {
    catch_unwind(AssertUnwindSafe(decode))
        .unwrap_or_else(|_| Err(ImageError::malformed(path, "the decoder failed on damaged data")))
}
