//! The layouts of the CPU's light tree: VPLs in blocks of eight, nodes of eight clusters each.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::light_tree::LightCluster;

pub(crate) use lightcuts_world::bvh::LANES;

/// Eight VPLs, component by component, in tree order. Empty lanes are black and attenuated to nothing.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct VplBlock {
    /// Positions: x of all lanes, y of all lanes, z of all lanes.
    pub(crate) position: [[f32; LANES]; 3],
    /// Unit directions.
    pub(crate) direction: [[f32; LANES]; 3],
    /// Diffuse colours.
    pub(crate) diffuse: [[f32; LANES]; 3],
    /// Factors on the contribution.
    pub(crate) attenuation: [f32; LANES],
    /// Lengths of the diffuse colours.
    pub(crate) intensity: [f32; LANES],
}

impl VplBlock {
    /// The VPL of one lane.
    pub(crate) fn vpl(&self, lane: usize) -> Vpl {
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
    pub(crate) fn set(&mut self, lane: usize, vpl: &Vpl) {
        for axis in 0..3 {
            self.position[axis][lane] = vpl.position[axis];
            self.direction[axis][lane] = vpl.direction[axis];
            self.diffuse[axis][lane] = vpl.diffuse[axis];
        }
        self.attenuation[lane] = vpl.attenuation;
        self.intensity[lane] = vpl.intensity();
    }
}

/// A range of blocks with what its VPLs have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    /// What its VPLs have in common.
    pub(crate) cluster: LightCluster,
    /// First block.
    pub(crate) first_block: u32,
    /// Number of blocks.
    pub(crate) block_count: u32,
    /// Number of VPLs.
    pub(crate) vpl_count: u32,
    /// Its node, or 0 for a single block (the root is nobody's child).
    pub(crate) node: u32,
}

/// Up to eight clusters, component by component, in the order of their blocks. Empty lanes are zero.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct LightNode {
    /// Lower corners of the boxes.
    pub(crate) lower: [[f32; LANES]; 3],
    /// Upper corners of the boxes.
    pub(crate) upper: [[f32; LANES]; 3],
    /// Axes of the cones.
    pub(crate) axis: [[f32; LANES]; 3],
    /// Cosines of the cones' half angles.
    pub(crate) cos_spread: [f32; LANES],
    /// Sines of the cones' half angles.
    pub(crate) sin_spread: [f32; LANES],
    /// Least intensities.
    pub(crate) min_intensity: [f32; LANES],
    /// Greatest intensities.
    pub(crate) max_intensity: [f32; LANES],
    /// First blocks.
    pub(crate) first_block: [u32; LANES],
    /// Numbers of blocks.
    pub(crate) block_count: [u32; LANES],
    /// Numbers of VPLs.
    pub(crate) vpl_count: [u32; LANES],
    /// Nodes of the clusters, or 0 for single blocks.
    pub(crate) node: [u32; LANES],
    /// Number of clusters; they stand in the first lanes.
    pub(crate) count: u32,
    /// Unused; keeps the record a multiple of 16 bytes.
    pub(crate) padding: [u32; 3],
}

impl LightNode {
    /// The part of one lane.
    #[cfg(test)]
    pub(crate) fn part(&self, lane: usize) -> Part {
        let [first_block, block_count, vpl_count, node] =
            [self.first_block[lane], self.block_count[lane], self.vpl_count[lane], self.node[lane]];
        Part { cluster: self.cluster(lane), first_block, block_count, vpl_count, node }
    }

    /// The cluster of one lane.
    pub(crate) fn cluster(&self, lane: usize) -> LightCluster {
        let vector = |of: &[[f32; LANES]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        LightCluster {
            lower: vector(&self.lower),
            upper: vector(&self.upper),
            axis: vector(&self.axis),
            cos_spread: self.cos_spread[lane],
            sin_spread: self.sin_spread[lane],
            min_intensity: self.min_intensity[lane],
            max_intensity: self.max_intensity[lane],
        }
    }

    /// Appends a part; there is room for eight.
    pub(crate) fn push(&mut self, part: &Part) {
        let cluster = &part.cluster;
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
        self.first_block[lane] = part.first_block;
        self.block_count[lane] = part.block_count;
        self.vpl_count[lane] = part.vpl_count;
        self.node[lane] = part.node;
    }
}
