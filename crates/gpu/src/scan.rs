//! Exclusive prefix sums on the device.

use crate::engine::Engine;
use crate::records::ScanParams;
use lightcuts_render::device::DeviceFault;

/// Numbers that a workgroup sums: 256 invocations of four.
pub(crate) const SCAN_BLOCK: u32 = 1024;

/// Names of the sums of blocks, level by level: 1024^3 numbers are more than a buffer holds.
const LEVELS: [&str; 4] = ["words", "block_sums", "block_sums_2", "block_sums_3"];

impl Engine {
    /// Allocates `words` for this many numbers, with the sums of their blocks.
    pub(crate) fn reserve_words(&mut self, count: u32) -> Result<(), DeviceFault> {
        let mut size = count.max(1);
        for name in LEVELS {
            self.reserve(name, u64::from(size) * 4)?;
            size = size.div_ceil(SCAN_BLOCK);
        }
        Ok(())
    }

    /// Replaces the first `count` of `words` by the sums of those before each; returns the sum of all.
    pub(crate) fn scan_words(&mut self, count: u32) -> Result<u32, DeviceFault> {
        if count == 0 {
            return Ok(0);
        }
        let top = self.scan_level(0, count)?;
        Ok(self.read_as::<u32>(LEVELS[top + 1], 1)?[0])
    }

    /// The same without waiting for the sum.
    pub(crate) fn scan_pending(&mut self, count: u32) -> Result<(), DeviceFault> {
        if count > 0 {
            self.scan_level(0, count)?;
        }
        Ok(())
    }

    /// Sums one level and those above; returns the number of the topmost, whose only block has the sum of all.
    fn scan_level(&mut self, level: usize, count: u32) -> Result<usize, DeviceFault> {
        let (words, sums) = (self.buffer(LEVELS[level]), self.buffer(LEVELS[level + 1]));
        let buffers = [("words", &words), ("block_sums", &sums)];
        let groups = count.div_ceil(SCAN_BLOCK);
        let params = ScanParams { count, padding0: 0, padding1: 0, padding2: 0 };
        self.run_with("scan_blocks", &params, groups * 256, f64::from(count), &buffers)?;
        if groups == 1 {
            return Ok(level);
        }
        let top = self.scan_level(level + 1, groups)?;
        self.run_with("add_block_sums", &params, groups * 256, f64::from(count), &buffers)?;
        Ok(top)
    }
}
