//! The light tree: VPLs in blocks of eight, nodes of eight clusters each, bounds on the thesis' relevance.

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

/// A cluster of VPLs: a range of blocks with what they have in common.
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
    /// Least intensity.
    pub min_intensity: f32,
    /// Greatest intensity.
    pub max_intensity: f32,
    /// First block.
    pub first_block: u32,
    /// Number of blocks.
    pub block_count: u32,
    /// Number of VPLs.
    pub vpl_count: u32,
    /// Its node, or 0 for a single block (the root is nobody's child).
    pub node: u32,
}

/// Up to eight clusters, component by component, in the order of their blocks. Empty lanes are zero.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct LightNode {
    /// Lower corners of the boxes.
    pub lower: [[f32; LANES]; 3],
    /// Upper corners of the boxes.
    pub upper: [[f32; LANES]; 3],
    /// Axes of the cones.
    pub axis: [[f32; LANES]; 3],
    /// Cosines of the cones' half angles.
    pub cos_spread: [f32; LANES],
    /// Sines of the cones' half angles.
    pub sin_spread: [f32; LANES],
    /// Least intensities.
    pub min_intensity: [f32; LANES],
    /// Greatest intensities.
    pub max_intensity: [f32; LANES],
    /// First blocks.
    pub first_block: [u32; LANES],
    /// Numbers of blocks.
    pub block_count: [u32; LANES],
    /// Numbers of VPLs.
    pub vpl_count: [u32; LANES],
    /// Nodes of the clusters, or 0 for single blocks.
    pub node: [u32; LANES],
    /// Number of clusters; they stand in the first lanes.
    pub count: u32,
    /// Unused; keeps the record a multiple of 16 bytes.
    pub padding: [u32; 3],
}

impl LightNode {
    /// The cluster of one lane.
    pub fn cluster(&self, lane: usize) -> LightCluster {
        let vector = |of: &[[f32; LANES]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        LightCluster {
            lower: vector(&self.lower),
            upper: vector(&self.upper),
            axis: vector(&self.axis),
            cos_spread: self.cos_spread[lane],
            sin_spread: self.sin_spread[lane],
            min_intensity: self.min_intensity[lane],
            max_intensity: self.max_intensity[lane],
            first_block: self.first_block[lane],
            block_count: self.block_count[lane],
            vpl_count: self.vpl_count[lane],
            node: self.node[lane],
        }
    }

    /// Appends a cluster; there is room for eight.
    pub fn push(&mut self, cluster: &LightCluster) {
        let lane = self.count as usize;
        self.count += 1;
        for axis in 0..3 {
            self.lower[axis][lane] = cluster.lower[axis];
            self.upper[axis][lane] = cluster.upper[axis];
            self.axis[axis][lane] = cluster.axis[axis];
        }
        self.cos_spread[lane] = cluster.cos_spread;
        self.sin_spread[lane] = cluster.sin_spread;
        self.min_intensity[lane] = cluster.min_intensity;
        self.max_intensity[lane] = cluster.max_intensity;
        self.first_block[lane] = cluster.first_block;
        self.block_count[lane] = cluster.block_count;
        self.vpl_count[lane] = cluster.vpl_count;
        self.node[lane] = cluster.node;
    }
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

/// Bounds on what the VPLs of a cluster can be worth for a point, up to [`BOUND_MARGIN`]: least and greatest intensity
/// times cosine at the light, and the squared distances to go with each, farthest and nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelevanceBounds {
    /// Least intensity times cosine.
    pub least_flux: f32,
    /// Greatest intensity times cosine.
    pub greatest_flux: f32,
    /// Squared distance of the farthest corner of the box.
    pub far_sq: f32,
    /// Squared distance of the box; 0 in it.
    pub near_sq: f32,
}

/// Bounds on the relevance of a cluster.
///
/// With v the vectors from the cluster's positions to the point, a box: the cosine between v and the cone's axis lies
/// between the least and greatest v . axis over the greatest and least |v|; the VPLs' own directions deviate from the
/// axis by at most the cone's half angle, which widens both without trigonometry (Walter et al. 2005, section 5.3; the
/// distances are bounded apart from the cosine).
pub fn relevance_bounds(cluster: &LightCluster, point: Vec3) -> RelevanceBounds {
    let (from_upper, from_lower) = (point - cluster.upper, point - cluster.lower);
    let outside = from_upper.max(-from_lower).max(Vec3::ZERO);
    let farthest = from_lower.abs().max(from_upper.abs());
    let (near_sq, far_sq) = (outside.dot(outside), farthest.dot(farthest));
    let (near, far) = (near_sq.sqrt(), far_sq.sqrt());
    let (a, b) = (cluster.axis * from_upper, cluster.axis * from_lower);
    let (least, greatest) = (a.min(b).dot(Vec3::ONE), a.max(b).dot(Vec3::ONE));
    let upper = cos_of_difference(least_magnitude(greatest, near, far), cluster.cos_spread, cluster.sin_spread);
    let lower = cos_of_sum(least_magnitude(least, far, near), cluster.cos_spread, cluster.sin_spread);
    RelevanceBounds {
        least_flux: lower.max(0.0) * cluster.min_intensity,
        greatest_flux: upper.max(0.0) * cluster.max_intensity,
        far_sq,
        near_sq,
    }
}

/// An end of the range of cosines from the same end of the range of v . axis: over one distance where that is
/// positive, over the other where it is negative. From -1 to 1.
fn least_magnitude(along: f32, positive: f32, negative: f32) -> f32 {
    (along / if along > 0.0 { positive } else { negative }).clamp(-1.0, 1.0)
}

/// Cosine of the sum of two angles, the first given by its cosine; -1 past half a turn.
fn cos_of_sum(cosine: f32, cos_spread: f32, sin_spread: f32) -> f32 {
    let sine = (1.0 - cosine * cosine).sqrt();
    // The sum stays below half a turn if and only if its sine is positive.
    let below = sine * cos_spread + cosine * sin_spread >= 0.0;
    if below { cosine * cos_spread - sine * sin_spread } else { -1.0 }
}

/// Cosine of the first angle less the second; 1 where the second is larger, and for a point in the box, which may be
/// faced whatever the cosine (0/0).
fn cos_of_difference(cosine: f32, cos_spread: f32, sin_spread: f32) -> f32 {
    let sine = (1.0 - cosine * cosine).sqrt();
    if cosine < cos_spread { cosine * cos_spread + sine * sin_spread } else { 1.0 }
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
pub fn decide(cluster: &LightCluster, point: Vec3, threshold: f32) -> Decision {
    let bounds = relevance_bounds(cluster, point);
    // Only a true comparison decides: bounds of a point in the box may be NaN.
    if bounds.greatest_flux < threshold * (1.0 - BOUND_MARGIN) * bounds.near_sq {
        Decision::Reject
    } else if bounds.least_flux >= threshold * (1.0 + BOUND_MARGIN) * bounds.far_sq && bounds.least_flux > 0.0 {
        Decision::Accept
    } else {
        Decision::Descend
    }
}
