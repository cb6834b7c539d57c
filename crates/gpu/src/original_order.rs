//! What only exact reproduction needs: every hit and every selection, in order.

use crate::engine::Engine;
use crate::records::{NodeColor, NodeLink, NodeSurface};
use crate::wave::Layer;
use crate::wave_input::Input;
use lightcuts_kernel::ray::NONE;
use lightcuts_kernel::surface::Surface;
use lightcuts_render::device::{DeviceFault, Pass, TileResult, TreeHit};

impl Engine {
    /// Every hit in post-order.
    pub(crate) fn collect_hits(
        &mut self,
        pass: &Pass<'_>,
        input: &Input,
        layers: &[Layer],
        results: &mut [TileResult],
    ) -> Result<(), DeviceFault> {
        let nodes: usize = layers.iter().map(|layer| layer.count as usize).sum();
        let surfaces: Vec<NodeSurface> = self.read_as("node_surfaces", nodes)?;
        let links: Vec<NodeLink> = self.read_as("node_links", nodes)?;
        let colors: Vec<NodeColor> = self.read_as("node_colors", nodes)?;
        let hits = surfaces.iter().filter(|surface| surface.primitive != NONE).count();
        let mut ordered = vec![0_u32; hits];
        for (n, link) in links.iter().enumerate() {
            if surfaces[n].primitive != NONE {
                ordered[(link.rank + link.size - 1) as usize] = n as u32;
            }
        }
        for n in ordered {
            let (link, found) = (&links[n as usize], &surfaces[n as usize]);
            let object = pass.view.world.shapes.primitives[found.primitive as usize].object;
            let NodeSurface { point, normal, material, epsilon, .. } = *found;
            results[input.tile_of(link.sample)].hits.push(TreeHit {
                slot: link.slot,
                surface: Surface { point, normal, material, object },
                color: colors[n as usize].color,
                epsilon,
            });
        }
        Ok(())
    }

    /// The number of VPLs that lit each shaded hit, by samples and slots. Nodes of a layer are in that order.
    pub(crate) fn collect_selections(
        &mut self,
        input: &Input,
        layers: &[Layer],
        results: &mut [TileResult],
    ) -> Result<(), DeviceFault> {
        let nodes: usize = layers.iter().map(|layer| layer.count as usize).sum();
        let links: Vec<NodeLink> = self.read_as("node_links", nodes)?;
        let colors: Vec<NodeColor> = self.read_as("node_colors", nodes)?;
        let shaded = links.iter().zip(&colors).filter(|(_, color)| color.tally > 0);
        let mut selections: Vec<(u32, u32)> = shaded.map(|(link, color)| (link.sample, color.tally - 1)).collect();
        // Stable: layers come one after the other.
        selections.sort_by_key(|&(sample, _)| sample);
        for (sample, selected) in selections {
            results[input.tile_of(sample)].selections.push(selected);
        }
        Ok(())
    }
}
