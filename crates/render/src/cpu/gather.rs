//! Which VPLs light a point, and what they add: the plain versions and the choice between them and SIMD.

use super::{HalfSpaces, Tracer};
use crate::light_node::{LANES, LightNode, VplBlock};
use crate::light_tree::{LightTree, Nodes, PackedTree};
use crate::stats::TreeVisits;
use glam::Vec3;
use lightcuts_kernel::light_tree::{Decision, decide, is_relevant};
use lightcuts_kernel::packed_tree::unpack_cluster;
use lightcuts_kernel::phong::{phong_vpl, vpl_incidence};
use lightcuts_kernel::ray::shadow_ray;

/// VPLs of a block that may light a point, a bit per lane. Never empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Candidates {
    pub(crate) block: u32,
    pub(crate) lanes: u8,
    /// Whether all of them are chosen; else each is tested when it is evaluated.
    pub(crate) certain: bool,
}

/// What a point gathered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gathered {
    /// Sum over the chosen VPLs, before the material's E.
    pub(crate) color: Vec3,
    /// Number of chosen VPLs.
    pub(crate) chosen: u32,
    pub(crate) shadow_rays: u64,
}

/// The VPLs of a tree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blocks<'a> {
    pub(crate) vpls: &'a [VplBlock],
    pub(crate) half_spaces: &'a HalfSpaces,
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

/// Nodes above a block in the largest tree: each level divides by eight, and 8^11 is more than 2^32 VPLs.
const MAX_LEVELS: usize = 11;

/// What to do with the clusters of a node, a bit per lane.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Decisions {
    pub(crate) accept: u32,
    pub(crate) descend: u32,
}

/// Appends the VPLs that may light points of a box (its lower and its upper corner), in tree order. Those whose
/// relevance at one of them reaches the threshold, certain or when tested, are exactly the ones that testing every VPL
/// there would find.
pub(crate) fn select(
    tree: &LightTree,
    avx2: bool,
    points: (Vec3, Vec3),
    threshold: f32,
    candidates: &mut Vec<Candidates>,
) -> TreeVisits {
    match &tree.nodes {
        Nodes::Wide(nodes) => select_wide(tree, nodes, avx2, points, threshold, candidates),
        Nodes::Packed(packed) => select_packed(tree, packed, points, threshold, candidates),
    }
}

/// Walks down nodes of eight clusters.
fn select_wide(
    tree: &LightTree,
    nodes: &[LightNode],
    avx2: bool,
    points: (Vec3, Vec3),
    threshold: f32,
    candidates: &mut Vec<Candidates>,
) -> TreeVisits {
    let mut visits = TreeVisits::default();
    if nodes.is_empty() {
        return visits;
    }
    // Nodes on the way down, each with what is left to do there.
    let mut stack = [(0_u32, Decisions::default()); MAX_LEVELS];
    let mut size = 0;
    let (mut index, mut left) = (0, decide_all(&nodes[0], avx2, points, threshold, &mut visits));
    loop {
        let node = &nodes[index as usize];
        if node.node[0] == 0 {
            take_blocks(node, left, candidates, &mut visits);
            left = Decisions::default();
        }
        let mut child = 0;
        let mut pending = left.accept | left.descend;
        while pending != 0 && child == 0 {
            let lane = pending.trailing_zeros() as usize;
            pending &= pending - 1;
            let certain = left.accept >> lane & 1 == 1;
            let first = node.first_block[lane];
            if node.node[lane] == 0 {
                visits.lights += if certain { 0 } else { u64::from(node.vpl_count[lane]) };
                candidates.push(Candidates { block: first, lanes: tree.lanes(first), certain });
            } else if certain {
                let blocks = first..first + node.block_count[lane];
                candidates.extend(blocks.map(|block| Candidates { block, lanes: tree.lanes(block), certain }));
            } else {
                child = node.node[lane];
            }
        }
        if child != 0 {
            stack[size] = (index, Decisions { accept: left.accept & pending, descend: left.descend & pending });
            size += 1;
            (index, left) = (child, decide_all(&nodes[child as usize], avx2, points, threshold, &mut visits));
        } else if size > 0 {
            size -= 1;
            (index, left) = stack[size];
        } else {
            return visits;
        }
    }
}

/// Walks a binary tree in heap order without a stack: what comes after a subtree follows from its root's number. Twin
/// of what GPUs do.
fn select_packed(
    tree: &LightTree,
    packed: &PackedTree,
    points: (Vec3, Vec3),
    threshold: f32,
    candidates: &mut Vec<Candidates>,
) -> TreeVisits {
    let mut visits = TreeVisits::default();
    let count = tree.blocks.len() as u32;
    // A node with the first of its blocks and their number, blocks past the end included.
    let (mut index, mut first, mut span) = (1_u32, 0, packed.leaves() as u32);
    while first < count {
        visits.nodes += 1;
        let decision = decide(&unpack_cluster(&packed.nodes[index as usize]), points.0, points.1, threshold);
        if decision == Decision::Descend && span > 1 {
            (index, span) = (2 * index, span / 2);
            continue;
        }
        let certain = decision == Decision::Accept;
        if decision != Decision::Reject {
            let blocks = first..(first + span).min(count);
            candidates.extend(blocks.map(|block| Candidates { block, lanes: tree.lanes(block), certain }));
            visits.lights += if certain { 0 } else { u64::from(tree.lanes(first).count_ones()) };
        }
        first += span;
        let climbed = (index + 1).trailing_zeros();
        (index, span) = ((index + 1) >> climbed, span << climbed);
    }
    visits
}

/// Takes the accepted and the undecided blocks of a node that has only blocks, without a branch per block: which are
/// taken is hard to predict.
fn take_blocks(node: &LightNode, decisions: Decisions, candidates: &mut Vec<Candidates>, visits: &mut TreeVisits) {
    let Decisions { accept, descend } = decisions;
    let mut taken = [Candidates { block: 0, lanes: 0, certain: false }; LANES];
    let mut count = 0;
    for lane in 0..LANES {
        let lanes = 0xff_u32 >> (LANES as u32 - node.vpl_count[lane]);
        let certain = accept >> lane & 1 == 1;
        taken[count % LANES] = Candidates { block: node.first_block[lane], lanes: lanes as u8, certain };
        count += ((accept | descend) >> lane & 1) as usize;
        visits.lights += u64::from(node.vpl_count[lane] * (descend >> lane & 1));
    }
    // A copy of known size, cut to its length, is quicker than one of unknown size.
    let length = candidates.len() + count;
    candidates.extend_from_slice(&taken);
    candidates.truncate(length);
}

/// Decides for every cluster of a node.
#[allow(unsafe_code)]
#[inline]
fn decide_all(
    node: &LightNode,
    avx2: bool,
    points: (Vec3, Vec3),
    threshold: f32,
    visits: &mut TreeVisits,
) -> Decisions {
    visits.nodes += u64::from(node.count);
    #[cfg(target_arch = "x86_64")]
    if avx2 {
        // SAFETY: `avx2` is set only where the machine has the feature.
        return unsafe { super::avx2_gather::decide_all(node, points, threshold) };
    }
    (0..node.count as usize).fold(Decisions::default(), |mut decisions, lane| {
        match decide(&node.cluster(lane), points.0, points.1, threshold) {
            Decision::Reject => {}
            Decision::Accept => decisions.accept |= 1 << lane,
            Decision::Descend => decisions.descend |= 1 << lane,
        }
        decisions
    })
}

/// Every VPL, to be tested when evaluated: the plain version that [`select`] is tested against.
pub(crate) fn select_exhaustively(tree: &LightTree, candidates: &mut Vec<Candidates>) -> TreeVisits {
    candidates.extend(tree.every_block(false));
    TreeVisits { lights: tree.vpl_count() as u64, ..TreeVisits::default() }
}

/// Lanes of a block whose relevance reaches the threshold; empty lanes may be among them.
pub(crate) fn relevant_lanes(block: &VplBlock, point: Vec3, threshold: f32) -> u32 {
    let reaches = |lane: &usize| is_relevant(&block.vpl(*lane), block.intensity[*lane], point, threshold);
    (0..LANES).filter(reaches).fold(0, |lanes, lane| lanes | 1 << lane)
}

/// What the candidates add at a point: all of them without a threshold, else those that are certain or reach it.
///
/// Lanes are summed apart and then in order, so that SIMD and plain code give the same bits.
#[allow(unsafe_code)]
pub(crate) fn evaluate(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[Candidates],
    threshold: Option<f32>,
    at: &Receiver,
) -> Gathered {
    #[cfg(target_arch = "x86_64")]
    if tracer.avx2 {
        // SAFETY: `avx2` is set only where the machine has the feature.
        return unsafe { super::avx2_gather::evaluate(tracer, blocks, candidates, threshold, at) };
    }
    let mut sums = [Vec3::ZERO; LANES];
    let mut gathered = Gathered { color: Vec3::ZERO, chosen: 0, shadow_rays: 0 };
    for candidates in candidates {
        let block = &blocks.vpls[candidates.block as usize];
        let tested = threshold.filter(|_| !candidates.certain);
        let relevant = tested.map_or(u32::MAX, |threshold| relevant_lanes(block, at.point, threshold));
        let chosen = u32::from(candidates.lanes) & relevant;
        gathered.chosen += chosen.count_ones();
        for lane in (0..LANES).filter(|lane| chosen >> lane & 1 == 1) {
            let vpl = block.vpl(lane);
            let Some(incidence) = vpl_incidence(&vpl, at.point, at.normal) else { continue };
            gathered.shadow_rays += 1;
            if !tracer.occluded(&shadow_ray(tracer.rules, at.point, incidence.to_light, at.epsilon)) {
                sums[lane] += phong_vpl(&vpl, at.diffuse, &incidence);
            }
        }
    }
    gathered.color = sums.iter().fold(Vec3::ZERO, |total, &sum| total + sum);
    gathered
}

/// [`evaluate`] for at most 32 points, each with its candidates in the order of their blocks. Quicker than one by one
/// where points are neighbours, in the order of how near they are.
#[allow(unsafe_code)]
pub(crate) fn evaluate_together(
    tracer: &Tracer<'_>,
    blocks: &Blocks<'_>,
    candidates: &[&[Candidates]],
    threshold: Option<f32>,
    at: &[Receiver],
) -> Vec<Gathered> {
    #[cfg(target_arch = "x86_64")]
    if tracer.avx2 && at.len() > 1 {
        // SAFETY: `avx2` is set only where the machine has the feature.
        return unsafe { super::avx2_together::evaluate_together(tracer, blocks, candidates, threshold, at) };
    }
    let each = |(at, candidates): (&Receiver, &&[Candidates])| evaluate(tracer, blocks, candidates, threshold, at);
    at.iter().zip(candidates).map(each).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::cpu::Simd;
    use crate::light_tree::TreeLayout;
    use crate::light_tree::tests::scattered;
    use lightcuts_kernel::rng::random4;

    /// The chosen lanes of each block that has any.
    pub(crate) fn chosen(tree: &LightTree, candidates: &[Candidates], point: Vec3, threshold: f32) -> Vec<(u32, u32)> {
        let lanes = |c: &Candidates| {
            let tested = relevant_lanes(&tree.blocks[c.block as usize], point, threshold);
            u32::from(c.lanes) & if c.certain { u32::MAX } else { tested }
        };
        candidates.iter().map(|c| (c.block, lanes(c))).filter(|&(_, lanes)| lanes != 0).collect()
    }

    #[test]
    fn the_tree_selects_what_testing_every_vpl_selects() {
        for count in [1, 9, 290, 3000] {
            let tree = LightTree::build(&scattered(count), TreeLayout::Wide);
            let mut visited = 0;
            for sample in 0..500 {
                let [a, b, c, d] = random4(sample, 6, 0, 3);
                let point = (Vec3::new(a, b, c) - 0.5) * 400.0;
                let threshold = if sample % 10 == 0 { 0.0 } else { 10.0_f32.powf(-8.0 + 4.0 * d) };
                let (mut found, mut expected) = (Vec::new(), Vec::new());
                let visits = select(&tree, Simd::Auto.has_avx2(), (point, point), threshold, &mut found);
                let mut plain = Vec::new();
                assert_eq!(select(&tree, false, (point, point), threshold, &mut plain), visits);
                assert_eq!(plain, found);
                select_exhaustively(&tree, &mut expected);
                let (found, expected) =
                    (chosen(&tree, &found, point, threshold), chosen(&tree, &expected, point, threshold));
                assert_eq!(found, expected, "{count} VPLs at {point}, threshold {threshold}");
                visited += visits.nodes + visits.lights;
            }
            println!("{count} VPLs: {:.1} visits per hit", visited as f64 / 500.0);
        }
    }
}
