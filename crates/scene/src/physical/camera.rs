use glam::{DVec3, Vec3};

/// The view of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalCamera {
    /// Where it stands, in scene units.
    pub position: DVec3,
    /// View direction, any length but zero.
    pub direction: Vec3,
    /// Up direction, any length but zero, not parallel to `direction`.
    pub up: Vec3,
    /// How much of the scene the picture's height shows.
    pub view: View,
    /// Distance from the camera, along `direction`, from which on surfaces are seen; in scene units.
    pub near: f32,
    /// Radius of the lens, in scene units; 0 for a pinhole, which shows everything sharp.
    pub lens_radius: f32,
    /// Distance of the plane that is sharp, along `direction`; in scene units, above zero.
    pub focus_distance: f32,
}

/// How much the picture's height shows; a wider picture sees more at the sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// Rays from one point.
    Perspective {
        /// Angle between the rays at the middle of the upper and lower edge, in degrees, above 0 and below 180.
        degrees: f32,
    },
    /// Rays parallel to the view direction.
    Orthographic {
        /// Height that is seen, in scene units.
        height: f32,
    },
}

impl Default for PhysicalCamera {
    /// At the origin, looking along -z.
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            direction: Vec3::NEG_Z,
            up: Vec3::Y,
            view: View::Perspective { degrees: 40.0 },
            near: 0.0,
            lens_radius: 0.0,
            focus_distance: 1.0,
        }
    }
}
