use super::SurfaceId;
use crate::{Location, MeshDesc, MeshId};
use glam::{DAffine3, DVec3, Vec3};

/// A thing that rays can hit.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalObject {
    /// Name shown to people; may be empty.
    pub name: String,
    /// Its surface.
    pub shape: PhysicalShape,
    /// Its material; a mesh's triangles may name others.
    pub material: SurfaceId,
    /// Where it was described.
    pub location: Location,
}

/// The forms of surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PhysicalShape {
    /// A sphere; its normal points outwards.
    Sphere {
        /// Centre in scene units.
        center: DVec3,
        /// Radius in scene units, above zero.
        radius: f32,
    },
    /// A rectangle.
    Rectangle {
        /// Centre in scene units.
        center: DVec3,
        /// Its normal, any length but zero.
        normal: Vec3,
        /// Direction of the edges of length `height`, not parallel to `normal`.
        head: Vec3,
        /// Edge length across `head`, in scene units, above zero.
        width: f32,
        /// Edge length along `head`, in scene units, above zero.
        height: f32,
    },
    /// An instance of a triangle mesh; a triangle's normal is that about which its corners run counterclockwise.
    Mesh {
        /// The triangles, in the mesh's own space.
        mesh: MeshId,
        /// From the mesh's space to the scene's.
        placement: DAffine3,
        /// Whether vertex normals are interpolated; else each triangle is flat.
        smooth: bool,
        /// Whether the object's material replaces those of the mesh.
        override_material: bool,
    },
}

impl PhysicalShape {
    /// The least box around it in scene units, as lower and upper corner; `None` for a mesh without triangles, or one
    /// that is not among `meshes`.
    pub fn bounds(&self, meshes: &[MeshDesc]) -> Option<(DVec3, DVec3)> {
        match *self {
            Self::Sphere { center, radius } => {
                let reach = DVec3::splat(f64::from(radius));
                Some((center - reach, center + reach))
            }
            Self::Rectangle { center, normal, head, width, height } => {
                let normal = normal.normalize_or_zero();
                let along = (head - normal * head.dot(normal)).normalize_or_zero();
                let reach = (along.cross(normal) * (width / 2.0)).abs() + (along * (height / 2.0)).abs();
                let reach = reach.as_dvec3();
                Some((center - reach, center + reach))
            }
            Self::Mesh { mesh, placement, .. } => {
                let mesh = meshes.get(mesh.0 as usize)?;
                let corners = mesh.triangles.iter().flat_map(|triangle| triangle.positions);
                let points = corners.filter_map(|i| mesh.positions.get(i as usize));
                let boxes =
                    points.map(|point| placement.transform_point3(point.as_dvec3())).map(|point| (point, point));
                boxes.reduce(|(low, high), (a, b)| (low.min(a), high.max(b)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshTriangle;

    #[test]
    fn boxes_are_as_small_as_can_be() {
        let sphere = PhysicalShape::Sphere { center: DVec3::ONE, radius: 2.0 };
        assert_eq!(sphere.bounds(&[]), Some((DVec3::NEG_ONE, DVec3::splat(3.0))));
        let (center, normal, head) = (DVec3::X, Vec3::Y * 3.0, Vec3::new(0.0, 5.0, -2.0));
        let rectangle = PhysicalShape::Rectangle { center, normal, head, width: 2.0, height: 6.0 };
        assert_eq!(rectangle.bounds(&[]), Some((DVec3::new(0.0, 0.0, -3.0), DVec3::new(2.0, 0.0, 3.0))));
        let triangle = MeshTriangle { positions: [0, 1, 2], normals: None, texture_coordinates: None, material: None };
        let mesh = MeshDesc {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::MAX],
            triangles: vec![triangle],
            ..MeshDesc::default()
        };
        let placement = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let shape = PhysicalShape::Mesh { mesh: MeshId(0), placement, smooth: true, override_material: true };
        let (low, high) = shape.bounds(&[mesh]).expect("it has a triangle");
        assert!((low - DVec3::NEG_X).length() < 1e-6 && (high - DVec3::Y).length() < 1e-6, "{low} {high}");
        assert_eq!(shape.bounds(&[MeshDesc::default()]), None);
        assert_eq!(shape.bounds(&[]), None);
    }
}
