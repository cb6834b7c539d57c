//! Clusters of VPLs and bounds on the thesis' relevance: what every light tree decides with.

use crate::light::Vpl;
use glam::Vec3;

/// Relative margin by which a bound must miss the threshold before it decides for a whole cluster: above the rounding
/// error of the bounds and of [`is_relevant`] together.
pub const BOUND_MARGIN: f32 = 1e-3;

/// What the VPLs of a cluster have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightCluster {
    /// Lower corner of the box around the positions.
    pub lower: Vec3,
    /// Upper corner of the box around the positions.
    pub upper: Vec3,
    /// Unit axis of the cone around the directions.
    pub axis: Vec3,
    /// Cosine of the cone's half angle, rounded down; -1 where the directions have no common hemisphere.
    pub cos_spread: f32,
    /// Sine of the cone's half angle.
    pub sin_spread: f32,
    /// Least intensity; 0 where the cone is wider than a hemisphere, so that nothing can be said of its least cosine.
    pub min_intensity: f32,
    /// Greatest intensity.
    pub max_intensity: f32,
}

/// Whether the thesis' relevance of a VPL for a point (Eq. 4.2), cosine at the light times intensity over squared
/// distance, reaches a threshold. A point that coincides with the light is always reached.
pub fn is_relevant(vpl: &Vpl, intensity: f32, point: Vec3, threshold: f32) -> bool {
    let to_light = vpl.position - point;
    let dist_sq = to_light.dot(to_light);
    // Without a division, as are the bounds: this is asked for every VPL that they cannot decide about.
    (-vpl.direction.dot(to_light)).max(0.0) * intensity >= threshold * (dist_sq * dist_sq.sqrt())
}

/// Bounds on the relevance of a cluster's VPLs for points, up to [`BOUND_MARGIN`], as fractions without the division:
/// flux is intensity times cosine at the light times a distance, volume the cube of distance that goes with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelevanceBounds {
    /// Numerator of the lower bound; not above 0 where there is none.
    pub least_flux: f32,
    /// Denominator of the lower bound.
    pub greatest_volume: f32,
    /// Numerator of the upper bound, at least 0.
    pub greatest_flux: f32,
    /// Denominator of the upper bound; 0 for a point in the cluster's box.
    pub least_volume: f32,
}

/// Bounds on the relevance of a cluster for all points of a box, given by its corners; for one point both are that.
///
/// With v the vectors from the cluster's positions to the points, a box, and a the angle between v and the cone's axis:
/// |v| cos a = v . axis lies between its values at two corners, |v| between the distances of the nearest and the
/// farthest point. The VPLs' own directions deviate from the axis by at most the cone's half angle s, so the cosine at
/// the light is at most cos(a - s) <= cos a cos s + sin s and at least cos(a + s) >= cos a cos s - sin s (Walter et al.
/// 2005, section 5.3; sin a is bounded by 1, which costs little where a decision is near, at grazing angles, and saves
/// two square roots).
pub fn relevance_bounds(cluster: &LightCluster, lower: Vec3, upper: Vec3) -> RelevanceBounds {
    let (from_upper, from_lower) = (lower - cluster.upper, upper - cluster.lower);
    let outside = from_upper.max(-from_lower).max(Vec3::ZERO);
    let farthest = from_lower.abs().max(from_upper.abs());
    let (near_sq, far_sq) = (outside.dot(outside), farthest.dot(farthest));
    let (a, b) = (cluster.axis * from_upper, cluster.axis * from_lower);
    let (least, greatest) = (a.min(b).dot(Vec3::ONE), a.max(b).dot(Vec3::ONE));
    // The greatest cosine is over the least distance where it is positive, over the greatest where it is not.
    let (far, near) = (far_sq.sqrt(), if greatest > 0.0 { near_sq } else { far_sq }.sqrt());
    let faced = greatest >= near * cluster.cos_spread;
    let widened = (greatest * cluster.cos_spread + near * cluster.sin_spread).min(near);
    RelevanceBounds {
        least_flux: (least * cluster.cos_spread - far * cluster.sin_spread) * cluster.min_intensity,
        greatest_volume: far_sq * far,
        greatest_flux: if faced { near } else { widened.max(0.0) } * cluster.max_intensity,
        least_volume: near_sq * near,
    }
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

/// Compares a cluster's bounds with a threshold, leaving [`BOUND_MARGIN`] to the exact test: for all points of a box.
pub fn decide(cluster: &LightCluster, lower: Vec3, upper: Vec3, threshold: f32) -> Decision {
    let bounds = relevance_bounds(cluster, lower, upper);
    if bounds.greatest_flux < threshold * (1.0 - BOUND_MARGIN) * bounds.least_volume {
        Decision::Reject
    } else if bounds.least_flux >= threshold * (1.0 + BOUND_MARGIN) * bounds.greatest_volume && bounds.least_flux > 0.0
    {
        Decision::Accept
    } else {
        Decision::Descend
    }
}
