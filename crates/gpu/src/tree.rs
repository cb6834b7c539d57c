//! Light trees on the device: built there, or brought there.

use crate::context::Buffer;
use crate::engine::Engine;
use crate::records::{SortParams, TreeParams};
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::packed_tree::{BLOCK_SIZE, PackedLightNode};
use lightcuts_render::device::{DeviceFault, LightTree, PackedTree, position_bounds};

/// Pairs that a workgroup sorts by itself.
const SORT_BLOCK: u32 = 256;
/// Bits that a round of the radix sort takes.
const DIGIT_BITS: u32 = 4;
/// Bits of a Morton key.
const KEY_BITS: u32 = 30;

impl Engine {
    /// Builds the tree over VPLs and returns it; it stays on the device for gathering.
    pub(crate) fn build_tree(&mut self, vpls: &[Vpl]) -> Result<LightTree, DeviceFault> {
        let count = vpls.len() as u32;
        let leaves = count.div_ceil(BLOCK_SIZE).max(1).next_power_of_two();
        self.tree = None;
        self.upload("vpls", vpls)?;
        self.reserve("pairs_in", u64::from(count) * 8)?;
        self.reserve("pairs_out", u64::from(count) * 8)?;
        self.allocate("light_nodes", u64::from(2 * leaves) * size_of::<PackedLightNode>() as u64)?;
        self.reserve_words((count.div_ceil(SORT_BLOCK) << DIGIT_BITS).max(self.capacity.words()))?;
        self.sort_vpls(vpls, count)?;
        self.build_levels(count, leaves)?;
        let nodes: Vec<PackedLightNode> = self.read_as("light_nodes", 2 * leaves as usize)?;
        let pairs: Vec<[u32; 2]> = self.read_as("pairs_in", count as usize)?;
        let order = pairs.iter().map(|pair| pair[1]).collect();
        let tree = LightTree::from_packed(vpls, PackedTree { nodes, order });
        self.tree = Some(tree.id());
        Ok(tree)
    }

    /// Brings VPLs into tree order; `pairs_in` then has their numbers in that order.
    fn sort_vpls(&mut self, vpls: &[Vpl], count: u32) -> Result<(), DeviceFault> {
        let (lower, extent) = position_bounds(vpls);
        let params =
            TreeParams { lower, first: 0, extent, count: 0, vpl_count: count, level: 0, padding0: 0, padding1: 0 };
        let (mut from, mut to) = (self.buffer("pairs_in"), self.buffer("pairs_out"));
        let keys = from.clone();
        let beside = to.clone();
        self.over("morton_keys", count, 1.0, |engine, first, part| {
            let params = TreeParams { first, count: part, ..params };
            let buffers = [("pairs_in", &beside), ("pairs_out", &keys)];
            engine.run_with("morton_keys", &params, part, f64::from(part), &buffers)
        })?;
        let groups = count.div_ceil(SORT_BLOCK);
        for shift in (0..KEY_BITS).step_by(DIGIT_BITS as usize) {
            let params = SortParams { count, shift, groups, first_group: 0 };
            let buffers = [("pairs_in", &from), ("pairs_out", &to)];
            self.over_groups("count_digits", &params, &buffers)?;
            self.scan_pending(groups << DIGIT_BITS)?;
            self.over_groups("scatter", &params, &buffers)?;
            (from, to) = (to, from);
        }
        // An even number of rounds ends where it began.
        debug_assert!(KEY_BITS.div_ceil(DIGIT_BITS).is_multiple_of(2));
        let sorted = self.context.allocate("vpls", u64::from(count) * size_of::<Vpl>() as u64)?;
        let unsorted = self.buffer("vpls");
        self.over("reorder", count, 1.0, |engine, first, part| {
            let params = TreeParams { first, count: part, ..params };
            let buffers = [("pairs_in", &from), ("pairs_out", &to), ("vpls", &unsorted), ("placed", &sorted)];
            engine.run_with("reorder", &params, part, f64::from(part), &buffers)
        })?;
        self.rename("vpls", sorted);
        Ok(())
    }

    /// A program of the radix sort over all groups.
    fn over_groups(
        &mut self,
        entry: &'static str,
        params: &SortParams,
        buffers: &[(&str, &Buffer)],
    ) -> Result<(), DeviceFault> {
        self.over(entry, params.groups, f64::from(SORT_BLOCK), |engine, first_group, groups| {
            let params = SortParams { first_group, ..*params };
            let pairs = groups * SORT_BLOCK;
            engine.run_with(entry, &params, pairs, f64::from(pairs), buffers)
        })
    }

    fn build_levels(&mut self, count: u32, leaves: u32) -> Result<(), DeviceFault> {
        let params = TreeParams { vpl_count: count, level: leaves, ..bytemuck::Zeroable::zeroed() };
        self.over("build_leaves", leaves, f64::from(BLOCK_SIZE), |engine, first, part| {
            let params = TreeParams { first, count: part, ..params };
            engine.run("build_leaves", &params, part, f64::from(part * BLOCK_SIZE))
        })?;
        let mut level = leaves / 2;
        while level > 0 {
            self.over("build_level", level, 1.0, |engine, first, part| {
                let params = TreeParams { first, count: part, level, ..params };
                engine.run("build_level", &params, part, f64::from(part))
            })?;
            level /= 2;
        }
        Ok(())
    }

    /// Makes sure that a tree is on the device.
    pub(crate) fn bring_tree(&mut self, tree: &LightTree) -> Result<(), DeviceFault> {
        if self.tree == Some(tree.id()) {
            return Ok(());
        }
        self.tree = None;
        self.upload("vpls", &tree.ordered_vpls())?;
        match tree.packed() {
            Some(packed) => self.upload("light_nodes", &packed.nodes)?,
            // Without packed nodes only strategies that test every VPL can be used.
            None => self.allocate("light_nodes", 64)?,
        }
        self.tree = Some(tree.id());
        Ok(())
    }
}
