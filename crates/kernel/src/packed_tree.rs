//! The light tree of GPUs: a perfect binary tree over blocks of VPLs in Morton order, its nodes packed into 32 bytes.
//!
//! After Lin & Yuksel 2020, "Real-Time Stochastic Lightcuts": the children of node i are 2i and 2i + 1, the root is 1,
//! a level is computed from the one below. Differs: Morton keys interleave positions with normals, leaves are blocks of
//! [`BLOCK_SIZE`] VPLs, and nodes carry what the thesis' relevance is bounded by.

use crate::light::Vpl;
use crate::light_tree::LightCluster;
use crate::ray::normalize_or_zero;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// VPLs of a leaf.
pub const BLOCK_SIZE: u32 = 8;

/// Lower corner of a node without VPLs.
pub const EMPTY_CORNER: f32 = 3e38;

/// Levels of the Morton order; a letter per level: positions are halved, or normals.
const MORTON_LEVELS: u32 = 10;

/// Which levels of the Morton order halve normals, a bit each, the first level in the lowest bit. A normal's sign comes
/// early: it tells walls apart.
const NORMAL_LEVELS: u32 = 0b00_0010_1010;

/// Relative margin against the rounding of sums and differences: two units in the last place.
const ROUNDING: f32 = 2.4e-7;

/// Margin against the rounding of a product of unit vectors.
const COSINE_MARGIN: f32 = 1e-6;

/// A cluster in 32 bytes; what is rounded is rounded outwards.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PackedLightNode {
    /// Lower corner of the box around the positions; [`EMPTY_CORNER`] without VPLs.
    pub lower: Vec3,
    /// Sum of the intensities.
    pub intensity: f32,
    /// Extents of the box along x (lower half) and y, as upper halves of floats.
    pub extent_xy: u32,
    /// Extent along z, as the upper half of a float, and the sine of half the cone's half angle in 65535ths.
    pub extent_z_spread: u32,
    /// The cone's axis on an octahedron, 16 bits each (Cigolle et al. 2014, "A Survey of Efficient Representations for
    /// Independent Unit Vectors").
    pub axis: u32,
    /// Least (lower half) and greatest intensity, as upper halves of floats.
    pub intensities: u32,
}

/// A float of at least 0 rounded up to its upper half.
pub fn round_up_16(x: f32) -> u32 {
    (x.to_bits() + 0xffff) >> 16
}

/// A float of at least 0 rounded down to its upper half.
pub fn round_down_16(x: f32) -> u32 {
    x.to_bits() >> 16
}

/// A float from its upper half, in the lower 16 bits.
pub fn widen_16(half: u32) -> f32 {
    f32::from_bits(half << 16)
}

/// The sign of a number as a factor; that of zeros is 1.
pub fn sign_factor(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

/// A unit vector on an octahedron, 16 bits for each coordinate. Axes are exact.
pub fn pack_axis(axis: Vec3) -> u32 {
    let sum = axis.x.abs() + axis.y.abs() + axis.z.abs();
    if sum == 0.0 {
        return pack_octahedral(0.0, 0.0);
    }
    let (x, y) = (axis.x / sum, axis.y / sum);
    if axis.z < 0.0 {
        return pack_octahedral((1.0 - y.abs()) * sign_factor(x), (1.0 - x.abs()) * sign_factor(y));
    }
    pack_octahedral(x, y)
}

/// Two coordinates in -1..1, 16 bits each.
pub fn pack_octahedral(x: f32, y: f32) -> u32 {
    let whole = |c: f32| ((c * 32_767.0 + 0.5).floor() + 32_767.0) as u32;
    whole(x) | whole(y) << 16
}

/// The unit vector of [`pack_axis`].
pub fn unpack_axis(packed: u32) -> Vec3 {
    let coordinate = |word: u32| ((word & 0xffff) as i32 - 32_767) as f32 * (1.0 / 32_767.0);
    let (x, y) = (coordinate(packed), coordinate(packed >> 16));
    let z = 1.0 - x.abs() - y.abs();
    if z < 0.0 {
        return normalize_or_zero(Vec3::new((1.0 - y.abs()) * sign_factor(x), (1.0 - x.abs()) * sign_factor(y), z));
    }
    normalize_or_zero(Vec3::new(x, y, z))
}

/// A cluster without VPLs.
pub fn empty_cluster() -> LightCluster {
    LightCluster {
        lower: Vec3::splat(EMPTY_CORNER),
        upper: Vec3::splat(-EMPTY_CORNER),
        axis: Vec3::ZERO,
        cos_spread: 1.0,
        sin_spread: 0.0,
        min_intensity: EMPTY_CORNER,
        max_intensity: 0.0,
    }
}

/// Whether a cluster has no VPLs.
pub fn is_empty_cluster(cluster: &LightCluster) -> bool {
    cluster.lower.x >= EMPTY_CORNER
}

/// An extent of a box from its corners, rounded up so far that the lower corner plus it is not below the upper one.
pub fn pack_extent(lower: f32, upper: f32) -> u32 {
    round_up_16((upper - lower) + (lower.abs() + upper.abs()) * ROUNDING)
}

/// Packs a cluster. Its axis is one that [`unpack_axis`] gives, so that the cone fits.
pub fn pack_cluster(cluster: &LightCluster, intensity: f32) -> PackedLightNode {
    if is_empty_cluster(cluster) {
        let axis = pack_axis(cluster.axis);
        return PackedLightNode {
            lower: cluster.lower,
            intensity: 0.0,
            extent_xy: 0,
            extent_z_spread: 0,
            axis,
            intensities: 0,
        };
    }
    let sin_half = ((1.0 - cluster.cos_spread) * 0.5).max(0.0).sqrt();
    let spread = (sin_half * (65_535.0 * (1.0 + COSINE_MARGIN))).ceil().min(65_535.0) as u32;
    let extent = |axis: usize| pack_extent(cluster.lower[axis], cluster.upper[axis]);
    PackedLightNode {
        lower: cluster.lower,
        intensity,
        extent_xy: extent(0) | extent(1) << 16,
        extent_z_spread: extent(2) | spread << 16,
        axis: pack_axis(cluster.axis),
        intensities: round_down_16(cluster.min_intensity) | round_up_16(cluster.max_intensity) << 16,
    }
}

/// The sine of an angle of 0 to pi.
pub fn sine_of(cosine: f32) -> f32 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}

/// The cluster of a node; it holds what was packed.
pub fn unpack_cluster(node: &PackedLightNode) -> LightCluster {
    if node.lower.x >= EMPTY_CORNER {
        return empty_cluster();
    }
    let extent = Vec3::new(
        widen_16(node.extent_xy & 0xffff),
        widen_16(node.extent_xy >> 16),
        widen_16(node.extent_z_spread & 0xffff),
    );
    let sin_half = (node.extent_z_spread >> 16) as f32 * (1.0 / 65_535.0);
    let cos_spread = ((1.0 - ROUNDING) - 2.0 * sin_half * sin_half).max(-1.0);
    LightCluster {
        lower: node.lower,
        upper: node.lower + extent,
        axis: unpack_axis(node.axis),
        cos_spread,
        sin_spread: sine_of(cos_spread),
        min_intensity: widen_16(node.intensities & 0xffff),
        max_intensity: widen_16(node.intensities >> 16),
    }
}

/// A cosine less a margin against rounding, at least -1. It is clamped first: compilers of shaders otherwise add the
/// margin to a part of the sum before.
pub fn below_cosine(cosine: f32) -> f32 {
    cosine.max(COSINE_MARGIN - 1.0) - COSINE_MARGIN
}

/// The cluster of one VPL.
pub fn vpl_cluster(vpl: &Vpl) -> LightCluster {
    let axis = unpack_axis(pack_axis(vpl.direction));
    let cos_spread = below_cosine(axis.dot(vpl.direction));
    let intensity = vpl.intensity();
    LightCluster {
        lower: vpl.position,
        upper: vpl.position,
        axis,
        cos_spread,
        sin_spread: sine_of(cos_spread),
        min_intensity: least_intensity(intensity, cos_spread),
        max_intensity: intensity,
    }
}

/// A lower bound on intensities, where the cone permits one: nothing can be said of the least cosine in one that is
/// wider than a hemisphere.
pub fn least_intensity(intensity: f32, cos_spread: f32) -> f32 {
    if cos_spread > 0.0 { intensity } else { 0.0 }
}

/// The cosine of the half angle of a cone about `axis` that holds the cone of a cluster.
pub fn enclosing_cosine(axis: Vec3, cluster: &LightCluster) -> f32 {
    let cosine = axis.dot(cluster.axis).clamp(-1.0, 1.0);
    // Both half angles together are more than half a turn.
    if cosine <= -cluster.cos_spread || axis == Vec3::ZERO {
        return -1.0;
    }
    let sine = sine_of(cosine);
    below_cosine(cosine * cluster.cos_spread - sine * cluster.sin_spread)
}

/// The cluster of two.
pub fn merge_clusters(a: &LightCluster, b: &LightCluster) -> LightCluster {
    if is_empty_cluster(a) {
        return *b;
    }
    if is_empty_cluster(b) {
        return *a;
    }
    let axis = unpack_axis(pack_axis(normalize_or_zero(a.axis + b.axis)));
    let cos_spread = enclosing_cosine(axis, a).min(enclosing_cosine(axis, b));
    LightCluster {
        lower: a.lower.min(b.lower),
        upper: a.upper.max(b.upper),
        axis,
        cos_spread,
        sin_spread: sine_of(cos_spread),
        min_intensity: least_intensity(a.min_intensity.min(b.min_intensity), cos_spread),
        max_intensity: a.max_intensity.max(b.max_intensity),
    }
}

/// A coordinate's place in `lower` .. `lower + extent`, in whole steps of 2^levels.
pub fn quantize(value: f32, lower: f32, extent: f32, levels: u32) -> u32 {
    if extent <= 0.0 {
        return 0;
    }
    let steps = (1 << levels) as f32;
    ((value - lower) / extent * steps).max(0.0).min(steps - 1.0) as u32
}

/// The Morton key of a VPL among positions in `lower` .. `lower + extent`: thirty bits, three per level.
pub fn morton_key(vpl: &Vpl, lower: Vec3, extent: Vec3) -> u32 {
    let normal_levels = NORMAL_LEVELS.count_ones();
    let position_levels = MORTON_LEVELS - normal_levels;
    let place = [
        quantize(vpl.position.x, lower.x, extent.x, position_levels),
        quantize(vpl.position.y, lower.y, extent.y, position_levels),
        quantize(vpl.position.z, lower.z, extent.z, position_levels),
    ];
    let normal = [
        quantize(vpl.direction.x, -1.0, 2.0, normal_levels),
        quantize(vpl.direction.y, -1.0, 2.0, normal_levels),
        quantize(vpl.direction.z, -1.0, 2.0, normal_levels),
    ];
    let (mut key, mut next_place, mut next_normal) = (0, position_levels, normal_levels);
    for level in 0..MORTON_LEVELS {
        if NORMAL_LEVELS >> level & 1 == 1 {
            next_normal -= 1;
            key = append_bits(key, normal, next_normal);
        } else {
            next_place -= 1;
            key = append_bits(key, place, next_place);
        }
    }
    key
}

/// A key with one bit more of each of three numbers.
pub fn append_bits(key: u32, numbers: [u32; 3], bit: u32) -> u32 {
    key << 3 | (numbers[0] >> bit & 1) << 2 | (numbers[1] >> bit & 1) << 1 | (numbers[2] >> bit & 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;

    fn vpl(k: u32) -> Vpl {
        let [a, b, c, d] = random4(k, 0, 0, 5);
        let [e, f, g, _] = random4(k, 1, 0, 5);
        Vpl {
            position: (Vec3::new(a, b, c) - 0.5) * 10.0_f32.powf(d * 6.0 - 2.0),
            direction: normalize_or_zero(Vec3::new(e, f, g) - 0.5),
            diffuse: Vec3::new(a, d, e),
            ..Vpl::default()
        }
    }

    fn holds(cluster: &LightCluster, vpl: &Vpl) {
        assert!(
            cluster.lower.cmple(vpl.position).all() && cluster.upper.cmpge(vpl.position).all(),
            "{cluster:?} {vpl:?}"
        );
        assert!(cluster.axis.dot(vpl.direction) >= cluster.cos_spread, "{cluster:?} {vpl:?}");
        assert!(cluster.min_intensity <= vpl.intensity() && cluster.max_intensity >= vpl.intensity());
    }

    #[test]
    fn axes_survive_packing() {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z] {
            assert_eq!(unpack_axis(pack_axis(axis)), axis);
        }
        for k in 0..10_000 {
            let axis = vpl(k).direction;
            assert!((unpack_axis(pack_axis(axis)) - axis).length() < 1e-4);
        }
    }

    #[test]
    fn halves_round_outwards() {
        for k in 0..10_000 {
            let [x, ..] = random4(k, 0, 0, 1);
            let x = x * 1e3;
            assert!(widen_16(round_down_16(x)) <= x && widen_16(round_up_16(x)) >= x);
        }
    }

    #[test]
    fn packed_and_merged_clusters_hold_their_vpls() {
        for k in 0..10_000 {
            let pair = [vpl(2 * k), vpl(2 * k + 1)];
            let mut clusters = pair.map(|vpl| vpl_cluster(&vpl));
            for (cluster, vpl) in clusters.iter_mut().zip(&pair) {
                holds(cluster, vpl);
                *cluster = unpack_cluster(&pack_cluster(cluster, 1.0));
                holds(cluster, vpl);
            }
            let merged = merge_clusters(&clusters[0], &clusters[1]);
            let packed = unpack_cluster(&pack_cluster(&merged, 1.0));
            for vpl in &pair {
                holds(&merged, vpl);
                holds(&packed, vpl);
            }
            for empty in [empty_cluster(), unpack_cluster(&pack_cluster(&empty_cluster(), 0.0))] {
                assert!(is_empty_cluster(&empty));
                assert_eq!(merge_clusters(&merged, &empty), merged);
                assert_eq!(merge_clusters(&empty, &merged), merged);
            }
        }
    }

    #[test]
    fn near_vpls_have_near_keys() {
        let at = |position: Vec3, direction: Vec3| {
            morton_key(&Vpl { position, direction, ..Vpl::default() }, Vec3::ZERO, Vec3::ONE)
        };
        assert!(at(Vec3::ZERO, Vec3::X) < 1 << 30);
        let corner = at(Vec3::splat(0.1), Vec3::X);
        assert!(corner.abs_diff(at(Vec3::splat(0.11), Vec3::X)) < corner.abs_diff(at(Vec3::splat(0.9), Vec3::X)));
        assert_ne!(corner, at(Vec3::splat(0.1), Vec3::NEG_X));
        assert_eq!(at(Vec3::splat(f32::NAN), Vec3::X) >> 30, 0);
    }
}
