use crate::Location;
use glam::Vec3;

/// A light source of the thesis' model: no falloff with distance, colours per Phong term.
#[derive(Debug, Clone, PartialEq)]
pub struct LightDesc {
    /// Position, direction and form.
    pub kind: LightKind,
    /// Factor on the light's whole contribution.
    pub attenuation: f32,
    /// Colour of its specular term.
    pub specular: Vec3,
    /// Colour of its diffuse term.
    pub diffuse: Vec3,
    /// Colour of its ambient term.
    pub ambient: Vec3,
    /// Where it was described.
    pub location: Location,
}

/// The forms of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// A point that shines equally in all directions (`OMNI`).
    Omni {
        /// Position in scene units.
        position: Vec3,
    },
    /// A point that shines into the hemisphere around `direction` with a cosine factor (`DIRP`), like a VPL.
    Hemisphere {
        /// Position in scene units.
        position: Vec3,
        /// Axis of the hemisphere, any length but zero.
        direction: Vec3,
    },
    /// Directional light that travels along `direction` (`DIR`).
    Directional {
        /// Direction of travel, any length but zero.
        direction: Vec3,
    },
    /// An emissive square (`SQU_A`), cut into hemisphere lights that share its colour; it is visible too.
    Area {
        /// Centre in scene units.
        center: Vec3,
        /// Side that shines, any length but zero.
        normal: Vec3,
        /// Direction of the edges of length `height`, not parallel to `normal`.
        head: Vec3,
        /// Edge length across `head`, in scene units.
        width: f32,
        /// Edge length along `head`, in scene units.
        height: f32,
        /// Spacing of the hemisphere lights, in scene units.
        spacing: f32,
    },
}

impl LightKind {
    /// Numbers of hemisphere lights (across, along `head`) that an area light is cut into; at least one each way.
    /// `None` for the other kinds.
    pub fn subdivision(&self) -> Option<(u64, u64)> {
        match *self {
            Self::Area { width, height, spacing, .. } => {
                let cells = |length: f32| (f64::from(length) / f64::from(spacing)).floor().max(1.0) as u64;
                Some((cells(width), cells(height)))
            }
            _ => None,
        }
    }
}
