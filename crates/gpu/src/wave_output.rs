//! What a wave yields, as the renderer takes it.

use crate::counters::{self, Counter};
use crate::engine::Engine;
use crate::records::SeenRecord;
use crate::wave::Layer;
use crate::wave_input::Input;
use glam::Vec4;
use lightcuts_kernel::light::Vpl;
use lightcuts_render::device::{DeviceFault, Film, Pass, Rays, Seen, Tile, TileResult, TreeVisits, Wants};

impl Engine {
    /// Brings everything back and hands each tile its share; what belongs to no single tile goes to the first.
    pub(crate) fn collect(
        &mut self,
        pass: &Pass<'_>,
        tiles: &[Tile],
        input: &Input,
        layers: &[Layer],
        placed: u32,
    ) -> Result<Vec<TileResult>, DeviceFault> {
        let bytes = |count: usize, size: usize| (count * size) as u64;
        let read = self.read(&[
            ("film_sums", bytes(input.places.len(), size_of::<Vec4>())),
            ("seen", bytes(input.pixels.len(), size_of::<SeenRecord>())),
            ("placed", bytes(placed as usize, size_of::<Vpl>())),
            ("counters", counters::BYTES),
        ])?;
        let sums: Vec<Vec4> = bytemuck::pod_collect_to_vec(&read[0]);
        let seen: Vec<SeenRecord> = bytemuck::pod_collect_to_vec(&read[1]);
        let mut results: Vec<TileResult> = Vec::with_capacity(tiles.len());
        for (tile, record) in tiles.iter().zip(&input.tiles) {
            let film = Film::around(tile, pass.view.filter).sums().len();
            let pixels = (tile.width * tile.height) as usize;
            let mut result = empty_result(pass, *tile);
            result.film = Film::from_sums(tile, pass.view.filter, sums[record.film as usize..][..film].to_vec());
            result.seen =
                seen[record.pixel as usize..][..pixels].iter().map(|record| seen_of(record, pass.wants)).collect();
            for seen in &result.seen {
                result.visits.shaded_hits += seen.shaded;
                result.visits.selected += seen.selected;
            }
            results.push(result);
        }
        if let Some(first) = results.first_mut() {
            first.vpls = bytemuck::pod_collect_to_vec(&read[2]);
            count(first, input, layers, &read[3]);
        }
        match pass.wants {
            Wants::SurfacesAndHits => self.collect_hits(pass, input, layers, &mut results)?,
            Wants::Selections => self.collect_selections(input, layers, &mut results)?,
            _ => {}
        }
        Ok(results)
    }
}

/// What the wave counted.
fn count(result: &mut TileResult, input: &Input, layers: &[Layer], bytes: &[u8]) {
    let sum = |counter| counters::sum(bytes, counter);
    let nodes: u64 = layers.iter().map(|layer| u64::from(layer.count)).sum();
    let primary = input.samples.len() as u64;
    result.rays = Rays {
        primary,
        secondary: nodes - primary,
        shadow: sum(Counter::ShadowRays),
        occlusion: sum(Counter::OcclusionRays),
        photon: 0,
    };
    result.visits.nodes = sum(Counter::TreeNodes);
    result.visits.lights = sum(Counter::TreeLights);
}

/// A tile without anything yet.
pub(crate) fn empty_result(pass: &Pass<'_>, tile: Tile) -> TileResult {
    TileResult {
        tile,
        film: Film::around(&tile, pass.view.filter),
        seen: Vec::new(),
        vpls: Vec::new(),
        hits: Vec::new(),
        selections: Vec::new(),
        rays: Rays::default(),
        visits: TreeVisits::default(),
    }
}

/// What a pass wants of what a pixel's samples saw.
fn seen_of(record: &SeenRecord, wants: Wants<'_>) -> Seen {
    match wants {
        Wants::Colors => Seen::default(),
        Wants::SurfacesAndVpls(_) | Wants::SurfacesAndHits => Seen {
            samples: record.samples,
            hits: record.hits,
            albedo: record.albedo,
            normal: record.normal,
            depth: record.depth,
            object: record.object,
            ..Seen::default()
        },
        Wants::SelectedSums | Wants::Selections => {
            Seen { selected: u64::from(record.selected), shaded: u64::from(record.shaded), ..Seen::default() }
        }
    }
}
