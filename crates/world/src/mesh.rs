//! Meshes placed in the scene.

use glam::{DAffine3, Mat3, Quat, Vec3};
use lightcuts_kernel::ray::normalize_or_zero;
use lightcuts_kernel::surface::TriangleCorners;
use lightcuts_scene::{MeshDesc, MeshTriangle, Transform};

/// From a mesh's space to the scene's.
pub(crate) trait Place {
    /// A position in the scene.
    fn point(&self, p: Vec3) -> Vec3;
    /// A unit normal in the scene, or zero.
    fn normal(&self, n: Vec3) -> Vec3;
    /// Whether the order of corners turns round.
    fn is_mirrored(&self) -> bool;
}

/// The thesis' placement: rotate, scale, translate.
pub(crate) struct Placement {
    rotation: Mat3,
    scale: Vec3,
    translation: Vec3,
}

impl Placement {
    pub(crate) fn new(transform: &Transform) -> Self {
        let rotation = if transform.degrees == 0.0 {
            Mat3::IDENTITY
        } else {
            // The thesis' files turn against the right-hand rule.
            Mat3::from_quat(Quat::from_axis_angle(normalize_or_zero(transform.axis), -transform.degrees.to_radians()))
        };
        Self { rotation, scale: transform.scale, translation: transform.translation }
    }
}

impl Place for Placement {
    fn point(&self, p: Vec3) -> Vec3 {
        (self.rotation * p) * self.scale + self.translation
    }

    /// Normals go with the inverse of the scale.
    fn normal(&self, n: Vec3) -> Vec3 {
        normalize_or_zero((self.rotation * n) / self.scale)
    }

    fn is_mirrored(&self) -> bool {
        self.scale.x * self.scale.y * self.scale.z < 0.0
    }
}

/// Any affine map that keeps volumes.
pub(crate) struct AffinePlacement {
    to_scene: DAffine3,
    /// Normals go with the transposed inverse.
    of_normals: Mat3,
}

impl AffinePlacement {
    pub(crate) fn new(to_scene: DAffine3) -> Self {
        Self { to_scene, of_normals: to_scene.matrix3.inverse().transpose().as_mat3() }
    }
}

impl Place for AffinePlacement {
    fn point(&self, p: Vec3) -> Vec3 {
        self.to_scene.transform_point3(p.as_dvec3()).as_vec3()
    }

    fn normal(&self, n: Vec3) -> Vec3 {
        normalize_or_zero(self.of_normals * n)
    }

    fn is_mirrored(&self) -> bool {
        self.to_scene.matrix3.determinant() < 0.0
    }
}

/// A placed triangle: its corners and what they carry.
pub(crate) fn place_triangle(
    mesh: &MeshDesc,
    triangle: &MeshTriangle,
    placement: &impl Place,
    smooth: bool,
) -> ([Vec3; 3], TriangleCorners) {
    let points = triangle.positions.map(|i| placement.point(mesh.positions[i as usize]));
    let face = normalize_or_zero((points[1] - points[0]).cross(points[2] - points[0]));
    // A mirroring scale turns the corners' order round; the normal must stay on its side.
    let face = if placement.is_mirrored() { -face } else { face };
    let normals = match triangle.normals.filter(|_| smooth) {
        Some(indices) => indices.map(|i| {
            let normal = placement.normal(mesh.normals[i as usize]);
            if normal.is_finite() && normal != Vec3::ZERO { normal } else { face }
        }),
        None => [face; 3],
    };
    let texture_coordinates =
        triangle.texture_coordinates.map_or([[0.0; 2]; 3], |uv| uv.map(|i| mesh.texture_coordinates[i as usize]));
    (points, TriangleCorners { normals, texture_coordinates, slack: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotates_then_scales_then_translates() {
        let placement = Placement::new(&Transform {
            axis: Vec3::Y * 2.0,
            degrees: 90.0,
            scale: Vec3::new(2.0, 1.0, 1.0),
            translation: Vec3::new(0.0, 5.0, 0.0),
        });
        // Against the right-hand rule about +y, +z goes to -x.
        assert!((placement.point(Vec3::Z) - Vec3::new(-2.0, 5.0, 0.0)).length() < 1e-6);
        assert!(
            (placement.normal(Vec3::new(1.0, 0.0, 1.0)) - normalize_or_zero(Vec3::new(-0.5, 0.0, 1.0))).length() < 1e-6
        );
    }

    #[test]
    fn missing_and_useless_normals_become_the_faces() {
        let mesh = MeshDesc {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::ZERO, Vec3::X],
            ..MeshDesc::default()
        };
        let triangle =
            MeshTriangle { positions: [0, 1, 2], normals: Some([0, 1, 0]), texture_coordinates: None, material: None };
        let placement = Placement::new(&Transform::default());
        let (_, smooth) = place_triangle(&mesh, &triangle, &placement, true);
        assert_eq!(smooth.normals, [Vec3::Z, Vec3::X, Vec3::Z]);
        let turned = AffinePlacement::new(DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2));
        let (points, corners) = place_triangle(&mesh, &triangle, &turned, true);
        assert!((points[1] - Vec3::Y).length() < 1e-6 && (corners.normals[1] - Vec3::Y).length() < 1e-6);
        let (_, flat) = place_triangle(&mesh, &triangle, &placement, false);
        assert_eq!(flat.normals, [Vec3::Z; 3]);
    }
}
