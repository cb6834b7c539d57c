//! The world on the device: one table of its buffers, split where one binding cannot hold them.

use crate::buffers::{Split, accessor};
use crate::context::{Buffer, Context};
use lightcuts_render::device::DeviceFault;
use lightcuts_world::{CompressedHierarchy, World};
use std::collections::BTreeMap;

/// A buffer of the world.
struct Entry<'a> {
    name: &'static str,
    content: &'a [u8],
    stride: usize,
}

/// Every buffer of the world, once.
fn table<'a>(world: &'a World, hierarchy: &'a CompressedHierarchy) -> Vec<Entry<'a>> {
    fn entry<'a, T: bytemuck::NoUninit>(name: &'static str, content: &'a [T]) -> Entry<'a> {
        Entry { name, content: bytemuck::cast_slice(content), stride: size_of::<T>() }
    }
    vec![
        entry("nodes", &hierarchy.nodes),
        entry("items", &hierarchy.items),
        entry("squares", &world.shapes.squares),
        entry("spheres", &world.shapes.spheres),
        entry("primitives", &world.shapes.primitives),
        entry("corners", &world.shapes.corners),
        entry("materials", &world.materials),
        entry("textures", &world.textures),
        entry("texels", &world.texels),
        entry("lights", &world.lights),
    ]
}

/// The world's buffers by name.
#[derive(Debug, Default)]
pub(crate) struct WorldBuffers {
    buffers: BTreeMap<&'static str, Vec<Buffer>>,
    splits: BTreeMap<&'static str, Split>,
}

impl WorldBuffers {
    /// Uploads a world. `max_binding` limits the bytes of a buffer further than the device does.
    pub(crate) fn upload(
        context: &Context,
        world: &World,
        hierarchy: &CompressedHierarchy,
        max_binding: Option<u64>,
    ) -> Result<Self, DeviceFault> {
        let limit = context.limits.max_storage_buffer_binding_size.min(context.limits.max_buffer_size);
        let limit = max_binding.map_or(limit, |asked| limit.min(asked));
        let mut uploaded = Self::default();
        for Entry { name, content, stride } in table(world, hierarchy) {
            let split = split(name, content.len(), stride, limit);
            let part = if split.parts == 1 { content.len().max(1) } else { stride << split.shift };
            let mut parts: Vec<Buffer> = Vec::new();
            for part in content.chunks(part) {
                parts.push(context.upload(name, part)?);
            }
            if parts.is_empty() {
                // Programs are given a buffer of zeros, which nothing refers to.
                parts.push(context.allocate(name, stride as u64)?);
            }
            uploaded.buffers.insert(name, parts);
            uploaded.splits.insert(name, split);
        }
        Ok(uploaded)
    }

    pub(crate) fn split(&self, name: &str) -> Split {
        self.splits.get(name).copied().unwrap_or(Split::WHOLE)
    }

    pub(crate) fn find(&self, name: &str) -> Option<&[Buffer]> {
        self.buffers.get(name).map(Vec::as_slice)
    }
}

/// How a buffer is split so that no part is larger than the limit.
fn split(name: &str, bytes: usize, stride: usize, limit: u64) -> Split {
    if bytes as u64 <= limit || accessor(name).is_none() {
        return Split::WHOLE;
    }
    let shift = (limit / stride as u64).max(1).ilog2();
    Split { parts: (bytes / stride).div_ceil(1 << shift) as u32, shift }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_buffers_are_split_into_powers_of_two() {
        assert_eq!(split("items", 48 * 100, 48, 1 << 27), Split::WHOLE);
        assert_eq!(split("items", 48 * 100, 48, 48 * 40), Split { parts: 4, shift: 5 });
        assert_eq!(split("lights", 80 * 100, 80, 80), Split::WHOLE);
    }
}
