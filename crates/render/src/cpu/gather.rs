//! Which VPLs light a point, and what they add: the plain versions and the choice between them and SIMD.

use super::Tracer;
use crate::light_tree::LightTree;
use crate::stats::TreeVisits;
use glam::Vec3;
use lightcuts_kernel::light_tree::{Decision, LANES, VplBlock, decide, relevance};
use lightcuts_kernel::phong::{phong_vpl, vpl_incidence};
use lightcuts_kernel::ray::shadow_ray;

/// VPLs of a block that light a point, a bit per lane. Never empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Chosen {
    pub(crate) block: u32,
    pub(crate) lanes: u32,
}

/// A point that gathers light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receiver {
    pub(crate) point: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) diffuse: Vec3,
    /// Distance from the surface below which shadow rays ignore hits.
    pub(crate) epsilon: f32,
}

/// Working memory of [`evaluate`]: subtrees still to be visited, each with the rays of a packet that enter it.
pub(crate) type PacketStack = Vec<(u32, u32)>;

/// Depth of the deepest light tree: it halves up to 2^32 VPLs.
const MAX_LEVELS: usize = 34;

/// Appends the VPLs whose relevance for a point reaches the threshold, in tree order: exactly those that testing every
/// VPL would find.
pub(crate) fn select(
    tree: &LightTree,
    avx2: bool,
    point: Vec3,
    threshold: f32,
    chosen: &mut Vec<Chosen>,
) -> TreeVisits {
    let mut visits = TreeVisits::default();
    let mut stack = [0_u32; MAX_LEVELS];
    let mut size = usize::from(!tree.nodes.is_empty());
    while size > 0 {
        size -= 1;
        let index = stack[size];
        let node = &tree.nodes[index as usize];
        if node.right == 0 {
            // Eight exact tests cost no more than the bound of their cluster.
            visits.lights += u64::from(node.vpl_count);
            let block = node.first_block;
            let lanes = tree.lanes(block) & relevant_lanes(&tree.blocks[block as usize], avx2, point, threshold);
            if lanes != 0 {
                chosen.push(Chosen { block, lanes });
            }
            continue;
        }
        visits.nodes += 1;
        match decide(node, point, threshold) {
            Decision::Reject => {}
            Decision::Accept => {
                let range = node.first_block..node.first_block + node.block_count;
                chosen.extend(range.map(|block| Chosen { block, lanes: tree.lanes(block) }));
            }
            Decision::Descend => {
                stack[size] = node.right;
                stack[size + 1] = index + 1;
                size += 2;
            }
        }
    }
    visits
}

/// The same VPLs, found by testing every one: the plain version that [`select`] is tested against.
pub(crate) fn select_exhaustively(
    tree: &LightTree,
    point: Vec3,
    threshold: f32,
    chosen: &mut Vec<Chosen>,
) -> TreeVisits {
    for block in 0..tree.blocks.len() as u32 {
        let lanes = tree.lanes(block) & relevant_lanes(&tree.blocks[block as usize], false, point, threshold);
        if lanes != 0 {
            chosen.push(Chosen { block, lanes });
        }
    }
    TreeVisits { lights: tree.vpl_count() as u64, ..TreeVisits::default() }
}

/// Lanes of a block whose relevance reaches the threshold; empty lanes may be among them.
#[allow(unsafe_code)]
fn relevant_lanes(block: &VplBlock, avx2: bool, point: Vec3, threshold: f32) -> u32 {
    #[cfg(target_arch = "x86_64")]
    if avx2 {
        // SAFETY: `avx2` is set only where the machine has the feature.
        return unsafe { super::avx2_gather::relevant_lanes(block, point, threshold) };
    }
    let reaches = |lane: usize| {
        let vpl = block.vpl(lane);
        relevance(vpl.position, vpl.direction, block.intensity[lane], point) >= threshold
    };
    (0..LANES).filter(|&lane| reaches(lane)).fold(0, |lanes, lane| lanes | 1 << lane)
}

/// What the chosen VPLs add at a point, before the material's E, and the number of shadow rays.
///
/// Lanes are summed apart and then in order, so that SIMD and plain code give the same bits.
#[allow(unsafe_code)]
pub(crate) fn evaluate(
    tracer: &Tracer<'_>,
    blocks: &[VplBlock],
    chosen: &[Chosen],
    at: &Receiver,
    stack: &mut PacketStack,
) -> (Vec3, u64) {
    #[cfg(target_arch = "x86_64")]
    if tracer.avx2 {
        // SAFETY: `avx2` is set only where the machine has the feature.
        return unsafe { super::avx2_gather::evaluate(tracer, blocks, chosen, at, stack) };
    }
    let mut sums = [Vec3::ZERO; LANES];
    let mut shadow_rays = 0;
    for Chosen { block, lanes } in chosen {
        let block = &blocks[*block as usize];
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let vpl = block.vpl(lane);
            let Some(incidence) = vpl_incidence(&vpl, at.point, at.normal) else { continue };
            shadow_rays += 1;
            if !tracer.occluded(&shadow_ray(tracer.rules, at.point, incidence.to_light, at.epsilon)) {
                sums[lane] += phong_vpl(&vpl, at.diffuse, &incidence);
            }
        }
    }
    (sums.iter().fold(Vec3::ZERO, |total, &sum| total + sum), shadow_rays)
}
