use super::ImageId;
use crate::Location;
use glam::{DVec3, Vec3};

/// A light that is not a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct EmitterDesc {
    /// Position, direction and form.
    pub kind: EmitterKind,
    /// Where it was described.
    pub location: Location,
}

/// The forms of light that are not surfaces. Emissive surfaces are objects whose material emits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EmitterKind {
    /// A point that shines equally in all directions.
    Point {
        /// Position in scene units.
        position: DVec3,
        /// Radiant intensity in W/sr.
        intensity: Vec3,
    },
    /// A point that shines into a cone.
    Spot {
        /// Position in scene units.
        position: DVec3,
        /// Axis of the cone, any length but zero.
        direction: Vec3,
        /// Radiant intensity within `inner_degrees` of the axis, in W/sr.
        intensity: Vec3,
        /// Angle from the axis up to which the intensity is full, in degrees.
        inner_degrees: f32,
        /// Angle from the axis from which on it is 0, in degrees, at least `inner_degrees` and at most 180; between
        /// both the intensity falls smoothly with the cosine.
        outer_degrees: f32,
    },
    /// Directional light: parallel rays from infinitely far away.
    Directional {
        /// Direction of travel, any length but zero.
        direction: Vec3,
        /// Irradiance of a surface across it, in W per square unit.
        irradiance: Vec3,
    },
}

/// Light from infinitely far away, all around.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentDesc {
    /// Radiance in W per square unit and steradian; a factor on the image's where there is one.
    pub radiance: Vec3,
    /// Image in longitude and latitude, the top row up, its middle column in the direction -z (turned by `degrees`).
    pub image: Option<ImageId>,
    /// Turn about +y, in degrees, by the right-hand rule.
    pub degrees: f32,
    /// Where it was described.
    pub location: Location,
}
