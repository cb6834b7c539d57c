//! Planes of triangles, for shading and for the rounding errors of hits.

use crate::shapes::Builder;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lightcuts_kernel::ray::normalize_or_zero;
use lightcuts_kernel::rounding::triangle_slack;
use lightcuts_kernel::surface::TriangleCorners;

/// A triangle's plane. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Face {
    /// Unit normal about which the corners run counterclockwise; zero where the triangle has no area.
    pub normal: Vec3,
    /// Texture coordinates per scene unit: the root of the ratio of both areas. Negative where the texture is seen
    /// mirrored from the normal's side, so that v grows against normal x tangent.
    pub texture_density: f32,
    /// Unit direction in which u grows; zero where the triangle has no area in the texture.
    pub tangent: Vec3,
    /// The normal's product with the points of the plane, in scene units.
    pub offset: f32,
}

/// Makes the corner opposite to the longest edge the first one, so that planes are exact: of two long edges that run next
/// to each other the product is mostly rounding.
pub(super) fn begin_at_short_edges(builder: &mut Builder) {
    for (points, corners) in builder.points.iter_mut().zip(&mut builder.corners) {
        let opposite = |k: usize| points[(k + 1) % 3].distance_squared(points[(k + 2) % 3]);
        let first = if opposite(0) >= opposite(1).max(opposite(2)) {
            0
        } else if opposite(1) >= opposite(2) {
            1
        } else {
            2
        };
        points.rotate_left(first);
        corners.normals.rotate_left(first);
        corners.texture_coordinates.rotate_left(first);
    }
}

/// The planes of all triangles, in file order.
pub(super) fn faces(builder: &Builder) -> Vec<Face> {
    builder.points.iter().zip(&builder.corners).map(|(points, corners)| face(points, corners)).collect()
}

/// Writes down at the corners what triangles add to the errors of hits on their planes.
pub(super) fn set_slacks(builder: &mut Builder, faces: &[Face]) {
    for ((points, corners), face) in builder.points.iter().zip(&mut builder.corners).zip(faces) {
        corners.slack = slack(points, face);
    }
}

fn face(points: &[Vec3; 3], corners: &TriangleCorners) -> Face {
    let (edge1, edge2) = (points[1] - points[0], points[2] - points[0]);
    let cross = edge1.cross(edge2);
    let [a, b, c] = corners.texture_coordinates;
    let in_texture = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    let area = cross.length().max(f32::MIN_POSITIVE);
    // Corner normals stay on their side where a placement mirrors; the plane's goes with them.
    let normal = normalize_or_zero(cross);
    let mean = corners.normals[0] + corners.normals[1] + corners.normals[2];
    let normal = if normal.dot(mean) < 0.0 { -normal } else { normal };
    let along_u = (edge1 * (c[1] - a[1]) - edge2 * (b[1] - a[1])) * in_texture.signum();
    let along_v = (edge2 * (b[0] - a[0]) - edge1 * (c[0] - a[0])) * in_texture.signum();
    let density = (in_texture.abs() / area).sqrt();
    Face {
        normal,
        texture_density: if along_u.cross(along_v).dot(normal) < 0.0 { -density } else { density },
        tangent: normalize_or_zero(along_u),
        offset: normal.as_dvec3().dot(points[0].as_dvec3()) as f32,
    }
}

/// Errors of the triangle's test, and how far its corners are off the rounded plane.
fn slack(points: &[Vec3; 3], face: &Face) -> f32 {
    let off = |p: &Vec3| (face.normal.as_dvec3().dot(p.as_dvec3()) - f64::from(face.offset)).abs() as f32;
    points.iter().map(off).fold(0.0, f32::max) + triangle_slack(points[1] - points[0], points[2] - points[0])
}
