//! The light tree: VPLs in blocks of eight, nodes over ranges of blocks, bounds on the thesis' relevance.

use crate::light::Vpl;
use crate::ray::normalize;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// VPLs of one block; also the width of the SIMD registers that test them.
pub const LANES: usize = 8;

/// Relative margin by which a bound must miss the threshold before it decides for a whole cluster: above the rounding
/// error of the bounds and of [`relevance`] together.
pub const BOUND_MARGIN: f32 = 1e-3;

/// Eight VPLs, component by component, in tree order. Empty lanes are black and attenuated to nothing.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct VplBlock {
    /// Positions: x of all lanes, y of all lanes, z of all lanes.
    pub position: [[f32; LANES]; 3],
    /// Unit directions.
    pub direction: [[f32; LANES]; 3],
    /// Diffuse colours.
    pub diffuse: [[f32; LANES]; 3],
    /// Factors on the contribution.
    pub attenuation: [f32; LANES],
    /// Lengths of the diffuse colours.
    pub intensity: [f32; LANES],
}

impl VplBlock {
    /// The VPL of one lane.
    pub fn vpl(&self, lane: usize) -> Vpl {
        let vector = |of: &[[f32; LANES]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        Vpl {
            position: vector(&self.position),
            direction: vector(&self.direction),
            diffuse: vector(&self.diffuse),
            attenuation: self.attenuation[lane],
            ..Vpl::default()
        }
    }

    /// Puts a VPL into a lane.
    pub fn set(&mut self, lane: usize, vpl: &Vpl) {
        for axis in 0..3 {
            self.position[axis][lane] = vpl.position[axis];
            self.direction[axis][lane] = vpl.direction[axis];
            self.diffuse[axis][lane] = vpl.diffuse[axis];
        }
        self.attenuation[lane] = vpl.attenuation;
        self.intensity[lane] = vpl.intensity();
    }
}

/// A cluster of VPLs: a range of blocks with what they have in common. Nodes stand in depth-first order: the left child
/// of an inner node follows it. 80 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct LightNode {
    /// Lower corner of the box around the positions.
    pub lower: Vec3,
    /// Greatest intensity.
    pub max_intensity: f32,
    /// Upper corner of the box around the positions.
    pub upper: Vec3,
    /// Least intensity.
    pub min_intensity: f32,
    /// Unit axis of the cone around the directions.
    pub axis: Vec3,
    /// Cosine of the cone's half angle, rounded down; -1 where the directions have no common hemisphere.
    pub cos_spread: f32,
    /// First block.
    pub first_block: u32,
    /// Number of blocks; 1 in a leaf.
    pub block_count: u32,
    /// Right child, or 0 in a leaf.
    pub right: u32,
    /// Number of VPLs.
    pub vpl_count: u32,
    /// Centre of the sphere around the box.
    pub center: Vec3,
    /// Radius of the sphere around the box, rounded up.
    pub radius: f32,
}

/// The thesis' relevance of a VPL for a point (Eq. 4.2): cosine at the light times intensity over squared distance.
/// Zero where the point coincides with the light.
pub fn relevance(position: Vec3, direction: Vec3, intensity: f32, point: Vec3) -> f32 {
    let from_light = point - position;
    let dist_sq = from_light.dot(from_light);
    if dist_sq == 0.0 {
        return 0.0;
    }
    direction.dot(normalize(from_light)).max(0.0) * intensity / dist_sq
}

/// Least and greatest relevance that any VPL of a cluster can have for a point, up to [`BOUND_MARGIN`].
///
/// The cluster is bounded by its sphere: seen from the point, directions to its VPLs deviate from the direction to the
/// centre by at most asin(r/d), and their own directions from the axis by at most the cone's half angle. Without
/// trigonometry: cosines of sums of angles from their sines and cosines.
pub fn relevance_bounds(node: &LightNode, point: Vec3) -> (f32, f32) {
    let from_center = point - node.center;
    let dist_sq = from_center.dot(from_center);
    let radius_sq = node.radius * node.radius;
    let outside_box = (node.lower - point).max(point - node.upper).max(Vec3::ZERO);
    let min_dist_sq = outside_box.dot(outside_box);
    if dist_sq <= radius_sq * (1.0 + BOUND_MARGIN) {
        let upper = if min_dist_sq > 0.0 { node.max_intensity / min_dist_sq } else { f32::INFINITY };
        return (0.0, upper);
    }
    let dist = dist_sq.sqrt();
    let sin_sphere = node.radius / dist;
    let cos_sphere = (1.0 - sin_sphere * sin_sphere).max(0.0).sqrt();
    let sin_spread = (1.0 - node.cos_spread * node.cos_spread).max(0.0).sqrt();
    // delta: both deviations together.
    let cos_delta = cos_sphere * node.cos_spread - sin_sphere * sin_spread;
    let sin_delta = sin_sphere * node.cos_spread + cos_sphere * sin_spread;
    let cos_axis = (node.axis.dot(from_center) / dist).clamp(-1.0, 1.0);
    let sin_axis = (1.0 - cos_axis * cos_axis).sqrt();
    // Past half a turn the deviation covers everything.
    let wide = sin_delta < 0.0 || node.cos_spread <= -1.0;
    let cos_upper = if wide || cos_axis >= cos_delta { 1.0 } else { cos_axis * cos_delta + sin_axis * sin_delta };
    // The sum of angles stays below half a turn if and only if its sine is positive.
    let bent = sin_axis * cos_delta + cos_axis * sin_delta;
    let cos_lower = if wide || bent < 0.0 { 0.0 } else { (cos_axis * cos_delta - sin_axis * sin_delta).max(0.0) };
    let (near, far) = ((dist - node.radius).max(0.0), dist + node.radius);
    let upper = cos_upper.max(0.0) * node.max_intensity / (near * near).max(min_dist_sq);
    (cos_lower * node.min_intensity / (far * far), upper)
}

/// What a traversal does with a cluster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// No VPL of it reaches the threshold.
    Reject,
    /// Every VPL of it reaches the threshold.
    Accept,
    /// The bounds cannot tell.
    Descend,
}

/// Compares a cluster's bounds with a threshold, leaving [`BOUND_MARGIN`] to the exact test.
pub fn decide(node: &LightNode, point: Vec3, threshold: f32) -> Decision {
    let (lower, upper) = relevance_bounds(node, point);
    if upper * (1.0 + BOUND_MARGIN) + f32::MIN_POSITIVE < threshold {
        Decision::Reject
    } else if lower * (1.0 - BOUND_MARGIN) >= threshold && lower > 0.0 {
        Decision::Accept
    } else {
        Decision::Descend
    }
}
