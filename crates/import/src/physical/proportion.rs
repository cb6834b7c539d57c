//! Spheres that are too large for what stands on them.

use super::build::Builder;
use super::value::Value;
use crate::report::{Tally, counted};
use glam::{DMat3, DVec3};
use lightcuts_scene::MeshDesc;
use lightcuts_scene::physical::{PhysicalObject, PhysicalShape};

/// How many times the size of another object the radius of a sphere may be. Beyond that rounding errors of hits on it are as large as
/// the object, and its ground may be black.
const MAX_RATIO: f64 = 1e6;

impl Builder<'_> {
    /// Warns about spheres that are too large for the smallest object.
    pub(super) fn warn_of_large_spheres(&mut self) {
        let radii: Vec<(usize, f64)> = self.scene.objects.iter().enumerate().filter_map(radius).collect();
        if radii.is_empty() {
            return;
        }
        let extents: Vec<DVec3> = self.scene.meshes.iter().map(extent).collect();
        let sizes = self.scene.objects.iter().map(|object| size(&object.shape, &extents));
        let smallest = sizes.filter(|size| *size > 0.0).fold(f64::INFINITY, f64::min);
        let mut large = Tally::default();
        for (i, _) in radii.into_iter().filter(|(_, radius)| *radius > MAX_RATIO * smallest) {
            let table = self.places.objects[i];
            let span = table.get("radius").map_or(table.span(), Value::span);
            large.note(|| self.reader.source.fault(span, ""));
        }
        large.warn(&mut self.reader.report, |count| {
            let spheres = counted(count, "sphere");
            format!(
                "{spheres} of a radius over 1e6 times the size of the smallest object, {smallest}: may look black there"
            )
        });
    }
}

fn radius((i, object): (usize, &PhysicalObject)) -> Option<(usize, f64)> {
    match object.shape {
        PhysicalShape::Sphere { radius, .. } => Some((i, f64::from(radius))),
        _ => None,
    }
}

/// The longest edge of the box around a shape; of a rectangle, its longer edge.
fn size(shape: &PhysicalShape, extents: &[DVec3]) -> f64 {
    match *shape {
        PhysicalShape::Sphere { radius, .. } => 2.0 * f64::from(radius),
        PhysicalShape::Rectangle { width, height, .. } => f64::from(width.max(height)),
        PhysicalShape::Mesh { mesh, placement, .. } => {
            let DMat3 { x_axis, y_axis, z_axis } = placement.matrix3;
            let reach = DMat3::from_cols(x_axis.abs(), y_axis.abs(), z_axis.abs());
            (reach * extents[mesh.0 as usize]).max_element()
        }
    }
}

/// The edges of the box around a mesh; none of one without vertices.
fn extent(mesh: &MeshDesc) -> DVec3 {
    let Some(first) = mesh.positions.first() else { return DVec3::ZERO };
    let (low, high) = mesh.positions.iter().fold((*first, *first), |(low, high), p| (low.min(*p), high.max(*p)));
    high.as_dvec3() - low.as_dvec3()
}
