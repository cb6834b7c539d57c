//! Rows: clusters of VPLs in 32 bytes.

use crate::functions::case::Case;
use crate::functions::table::{Row, twin};
use lightcuts_kernel::light_tree::LightCluster;
use lightcuts_kernel::packed_tree::{
    PackedLightNode, append_bits, below_cosine, empty_cluster, enclosing_cosine, is_empty_cluster, least_intensity,
    merge_clusters, morton_key, pack_axis, pack_cluster, pack_extent, pack_octahedral, quantize, round_down_16,
    round_up_16, sign_factor, sine_of, unpack_axis, unpack_cluster, vpl_cluster, widen_16,
};

/// Cosines near 0 are differences of numbers near 1, and no packed number can be moved to see what that makes of its result.
const CANCELLED_ULPS: u32 = 1024;

/// The rows.
pub(crate) const ROWS: [Row; 22] = [
    twin("round_up_16", |c| c.put(round_up_16(c.positive()))),
    twin("round_down_16", |c| c.put(round_down_16(c.positive()))),
    twin("widen_16", |c| c.put(widen_16(c.below(0x7f80)))),
    twin("sign_factor", |c| c.put(sign_factor(c.float()))),
    twin("pack_axis", |c| c.put(pack_axis(c.direction()))),
    twin("pack_octahedral", |c| c.put(pack_octahedral(c.between(-1.0, 1.0), c.between(-1.0, 1.0)))),
    twin("unpack_axis", |c| c.put(unpack_axis(axis(c)))),
    twin("unpack_axis", |c| c.put(unpack_axis(c.word()))),
    twin("empty_cluster", |c| c.put(empty_cluster())),
    twin("is_empty_cluster", |c| c.put(is_empty_cluster(&c.cluster()))),
    twin("pack_extent", |c| {
        let (lower, extent) = (c.float(), c.random());
        c.put(pack_extent(lower, c.take(|| lower + extent * lower.abs().max(1e-3))));
    }),
    twin("pack_cluster", |c| c.put(pack_cluster(&c.cluster(), c.positive()))),
    Row { ulps: CANCELLED_ULPS, ..twin("unpack_cluster", |c| c.put(unpack_cluster(&packed(c)))) },
    twin("vpl_cluster", |c| c.put(vpl_cluster(&c.vpl()))),
    twin("sine_of", |c| c.put(sine_of(c.between(-1.0, 1.0)))),
    twin("below_cosine", |c| c.put(below_cosine(c.between(-1.0, 1.0)))),
    twin("least_intensity", |c| c.put(least_intensity(c.positive(), c.between(-1.0, 1.0)))),
    twin("enclosing_cosine", |c| c.put(enclosing_cosine(c.direction(), &c.cluster()))),
    twin("merge_clusters", |c| c.put(merge_clusters(&c.cluster(), &c.cluster()))),
    twin("quantize", |c| c.put(quantize(c.float(), c.float(), c.float(), c.below(16)))),
    twin("morton_key", |c| c.put(morton_key(&c.vpl(), c.point(), c.point()))),
    twin("append_bits", |c| c.put(append_bits(c.word(), [c.word(), c.word(), c.word()], c.below(10)))),
];

/// Two coordinates in -1..1, packed.
fn axis(c: &Case<'_>) -> u32 {
    c.take(|| pack_octahedral(2.0 * c.raw_fraction() - 1.0, 2.0 * c.raw_fraction() - 1.0))
}

fn packed(c: &Case<'_>) -> PackedLightNode {
    c.take(|| {
        let cluster: LightCluster = c.raw_cluster();
        pack_cluster(&cluster, c.random())
    })
}
