//! Planes of triangles, for shading and for the rounding errors of hits; and primitives made to overlap at their edges.

use crate::shapes::Builder;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use lightcuts_kernel::intersect::Square;
use lightcuts_kernel::ray::normalize_or_zero;
use lightcuts_kernel::rounding::{UNIT, triangle_slack};
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

/// How far primitives reach beyond their edges, in roundings of their greatest coordinate or size, so that rays find no
/// gap between those that meet there: more than the errors of their corners.
const CORNER_ERRORS: f64 = 32.0;

/// The same in roundings of the scene's extent: from so far away rays miss edges by as much.
const RAY_ERRORS: f64 = 16.0;

/// But for this no more than this share of a primitive's size.
const MOST_OF_SIZE: f64 = 1e-4;

/// A triangle is not made larger than this: needles would grow without end.
const MOST_GROWTH: f64 = 1e-3;

/// How far a primitive reaches beyond its edges, in scene units.
fn overlap_of(coordinate: f64, size: f64, extent: f64) -> f64 {
    let unit = f64::from(UNIT);
    coordinate.max(size) * CORNER_ERRORS * unit + (extent * RAY_ERRORS * unit).min(size * MOST_OF_SIZE)
}

/// The planes of all triangles, in file order; what they add to the errors of hits goes to the corners.
pub(super) fn faces(builder: &mut Builder) -> Vec<Face> {
    let Builder { points, corners, .. } = builder;
    points
        .iter()
        .zip(corners)
        .map(|(points, corners)| {
            let face = face(points, corners);
            corners.slack = slack(points, &face);
            face
        })
        .collect()
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

/// Errors of the triangle's tests, and how far its corners are off the rounded plane.
fn slack(points: &[Vec3; 3], face: &Face) -> f32 {
    let off = |p: &Vec3| (face.normal.as_dvec3().dot(p.as_dvec3()) - f64::from(face.offset)).abs() as f32;
    // Growing rounds the corners once more, to as much off the plane as they are.
    2.0 * points.iter().map(off).fold(0.0, f32::max) + triangle_slack(points[1] - points[0], points[2] - points[0])
}

/// Makes triangles and squares reach a little beyond their edges; `extent` is the diagonal of the scene.
pub(super) fn overlap(builder: &mut Builder, extent: f32) {
    let extent = f64::from(extent);
    for points in &mut builder.points {
        *points = grown(points, extent);
    }
    for square in &mut builder.squares {
        let more = square_overlap(square, extent) as f32;
        square.half_width += more;
        square.half_height += more;
    }
    builder.fit_boxes();
}

fn grown(points: &[Vec3; 3], extent: f64) -> [Vec3; 3] {
    let points = points.map(Vec3::as_dvec3);
    about_middle(&points, growth(&points, extent)).map(DVec3::as_vec3)
}

/// A triangle that overlaps others at its edges, made so much smaller that it does not: by twice as much as it grew,
/// for its corners were rounded since.
pub(super) fn without_overlap(points: &[DVec3; 3], extent: f64) -> [DVec3; 3] {
    about_middle(points, -2.0 * growth(points, extent))
}

/// Half width and half height of a square, likewise.
pub(super) fn square_without_overlap(square: &Square, extent: f64) -> [f64; 2] {
    let less = 2.0 * square_overlap(square, extent);
    [square.half_width, square.half_height].map(|half| (f64::from(half) - less).max(0.0))
}

/// How far a square reaches beyond its edges, in scene units.
fn square_overlap(square: &Square, extent: f64) -> f64 {
    let size = square.half_width.min(square.half_height);
    let coordinate = square.center.abs().max_element().max(square.half_width).max(square.half_height);
    overlap_of(f64::from(coordinate), f64::from(size), extent)
}

/// By which share of its size a triangle grows, so that it reaches as far beyond each edge as it is to.
fn growth(points: &[DVec3; 3], extent: f64) -> f64 {
    let [a, b, c] = *points;
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let coordinate = points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let doubled_area = (b - a).cross(c - a).length();
    // The middle is a third of the height away from each edge.
    let overlap = overlap_of(coordinate, longest, extent);
    (overlap * 3.0 * longest / doubled_area.max(f64::MIN_POSITIVE)).min(MOST_GROWTH)
}

fn about_middle(points: &[DVec3; 3], growth: f64) -> [DVec3; 3] {
    let middle = (points[0] + points[1] + points[2]) / 3.0;
    points.map(|p| p + (p - middle) * growth)
}
