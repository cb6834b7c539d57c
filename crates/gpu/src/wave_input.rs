//! The samples of a wave, as the device takes them.

use crate::records::{CameraSample, PixelRecord, Place, TileRecord};
use lightcuts_render::device::{Pass, Shifts, Tile};
use rayon::prelude::*;

/// The samples of some tiles, ready for the device.
pub(crate) struct Input {
    pub(crate) samples: Vec<CameraSample>,
    pub(crate) pixels: Vec<PixelRecord>,
    pub(crate) tiles: Vec<TileRecord>,
    pub(crate) places: Vec<Place>,
}

impl Input {
    /// The samples of these tiles, pixel by pixel.
    pub(crate) fn new(pass: &Pass<'_>, tiles: &[Tile]) -> Self {
        let of_tiles: Vec<(Vec<CameraSample>, Vec<u32>)> =
            tiles.par_iter().map(|tile| samples_of(pass, tile)).collect();
        let border = pass.view.filter.border();
        let mut input = Self { samples: Vec::new(), pixels: Vec::new(), tiles: Vec::new(), places: Vec::new() };
        for ((number, tile), (samples, counts)) in (0..).zip(tiles).zip(of_tiles) {
            let (film, pixel) = (input.places.len() as u32, input.pixels.len() as u32);
            let Tile { i, j, width, height } = *tile;
            input.tiles.push(TileRecord { i, j, width, height, film, pixel, padding0: 0, padding1: 0 });
            let mut first = input.samples.len() as u32;
            for count in counts {
                input.pixels.push(PixelRecord { first, count });
                first += count;
            }
            input.samples.extend(samples);
            let rows = 0..height + 2 * border;
            input.places.extend(rows.flat_map(|y| (0..width + 2 * border).map(move |x| Place { tile: number, x, y })));
        }
        input
    }

    /// The tile of a sample.
    pub(crate) fn tile_of(&self, sample: u32) -> usize {
        let starts = |tile: &TileRecord| self.pixels.get(tile.pixel as usize).map_or(u32::MAX, |pixel| pixel.first);
        self.tiles.partition_point(|tile| starts(tile) <= sample) - 1
    }
}

/// The samples of a tile, and how many each pixel has.
fn samples_of(pass: &Pass<'_>, tile: &Tile) -> (Vec<CameraSample>, Vec<u32>) {
    let (mut samples, mut counts, mut shifts) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in tile.pixels() {
        let pixel = j * pass.view.camera.width + i;
        shifts.clear();
        if pass.mask.is_none_or(|mask| mask[pixel as usize]) {
            match pass.shifts {
                Shifts::Sampler(sampler) => sampler.fill(pixel, &mut shifts),
                Shifts::Given(all) => shifts.push(all[pixel as usize]),
            }
        }
        counts.push(shifts.len() as u32);
        let numbered = shifts.iter().zip(pass.first_sample..);
        samples.extend(numbered.map(|(&shift, sample)| CameraSample { pixel, sample, shift }));
    }
    (samples, counts)
}
