//! A sketch of the picture before its first pass: a traced path for a pixel of each cell, in cells that get smaller.
//!
//! It tells cuts what pixels are about as bright as. And where the first pass is broken off, by a person or for want of time, the
//! pixels that it left are those of the sketch: the picture is coarser there, but whole.

use super::pass::SamplePass;
use super::sums::PixelSums;
use bytemuck::Zeroable;
use glam::Vec3;
use rayon::prelude::*;
use std::num::NonZeroU32;

/// Cells of the first, coarsest level at most. It is sampled whatever happens, so that there is something to show everywhere.
const FIRST_CELLS: usize = 256;

/// Pixels whose paths are traced together.
const TOGETHER: usize = 8;

/// Cells beside a cell over which its light is averaged.
const REACH: usize = 2;

/// A sample of a pixel.
#[derive(Debug, Clone, Copy, Zeroable)]
pub(crate) struct Glimpse {
    /// Of no sample where the pixel was not seen.
    pub(crate) sums: PixelSums,
    pub(crate) all: Vec3,
    pub(crate) indirect: Vec3,
}

/// Cells of one size; a cell's pixel is its first one.
struct Level {
    /// Edge in pixels, a power of two.
    cell: usize,
    columns: usize,
    /// Bottom row first. Pixels of the level before are there, not here.
    seen: Vec<Glimpse>,
}

impl Level {
    /// The pixel of a cell, by the cell's number.
    fn pixel(&self, number: usize) -> (usize, usize) {
        (number % self.columns * self.cell, number / self.columns * self.cell)
    }
}

/// Where a glimpse is: one more than its cell's number in the lower bits, and its level in the upper ones. Pictures have fewer than 2^28
/// pixels, and so a dozen levels at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Source(NonZeroU32);

impl Source {
    const CELL_BITS: u32 = 28;

    fn new(level: usize, cell: usize) -> Self {
        Self(NonZeroU32::MIN.saturating_add((level as u32) << Self::CELL_BITS | cell as u32))
    }

    /// Numbers of the level and of the cell.
    fn place(self) -> (usize, usize) {
        let place = self.0.get() - 1;
        ((place >> Self::CELL_BITS) as usize, (place & ((1 << Self::CELL_BITS) - 1)) as usize)
    }
}

/// The cell whose pixel is nearest, along a side of the picture.
fn nearest_cell(at: usize, cell: usize, length: usize) -> usize {
    ((at + cell / 2) / cell).min(length.div_ceil(cell) - 1)
}

/// Levels from the coarsest on, each with cells half as large as the one before.
pub(crate) struct Sketch {
    width: usize,
    height: usize,
    levels: Vec<Level>,
}

impl Sketch {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self { width: width as usize, height: height as usize, levels: Vec::new() }
    }

    /// Edge of the smallest cells that there are, in pixels.
    pub(crate) fn cell(&self) -> usize {
        self.levels.last().map_or(usize::MAX, |level| level.cell)
    }

    /// Adds a level; returns whether it came to its end. The first one always does.
    pub(crate) fn refine(&mut self, pass: &SamplePass<'_>, stream: u32, is_over: impl Fn() -> bool + Sync) -> bool {
        let is_first = self.levels.is_empty();
        let mut level = self.next_level();
        let (cell, columns) = (level.cell, level.columns);
        let look = |(row, seen): (usize, &mut [Glimpse])| {
            let is_new = |&column: &usize| is_first || !(row.is_multiple_of(2) && column.is_multiple_of(2));
            let places: Vec<usize> = (0..columns).filter(is_new).collect();
            places.chunks(TOGETHER).all(|places| {
                if !is_first && is_over() {
                    return false;
                }
                let pixels: Vec<_> =
                    places.iter().map(|column| ((column * cell) as u32, (row * cell) as u32)).collect();
                for (&column, glimpse) in places.iter().zip(pass.glimpse(&pixels, stream)) {
                    seen[column] = glimpse;
                }
                true
            })
        };
        let is_whole = level.seen.par_chunks_mut(columns).enumerate().map(look).reduce(|| true, |a, b| a & b);
        self.levels.push(level);
        is_whole
    }

    fn next_level(&self) -> Level {
        let columns_of = |cell: usize| self.width.div_ceil(cell);
        let cells_of = |cell: usize| columns_of(cell) * self.height.div_ceil(cell);
        let cell = match self.levels.last() {
            Some(level) => (level.cell / 2).max(1),
            None => (0..usize::BITS).map(|k| 1 << k).find(|&cell| cells_of(cell) <= FIRST_CELLS).unwrap_or(1),
        };
        Level { cell, columns: columns_of(cell), seen: bytemuck::zeroed_vec(cells_of(cell)) }
    }

    /// Where a cell's glimpse is: a larger cell may have the same pixel.
    fn place(&self, mut level: usize, mut column: usize, mut row: usize) -> Source {
        while level > 0 && column.is_multiple_of(2) && row.is_multiple_of(2) {
            (level, column, row) = (level - 1, column / 2, row / 2);
        }
        Source::new(level, row * self.levels[level].columns + column)
    }

    /// What is seen at a source.
    pub(crate) fn glimpse(&self, source: Source) -> &Glimpse {
        let (level, cell) = source.place();
        &self.levels[level].seen[cell]
    }

    /// The source that is nearest to a pixel; nothing before the first level.
    pub(crate) fn nearest(&self, i: usize, j: usize) -> Option<Source> {
        let of_level = |k: usize| {
            let cell = self.levels[k].cell;
            let source = self.place(k, nearest_cell(i, cell, self.width), nearest_cell(j, cell, self.height));
            (self.glimpse(source).sums.samples > 0).then_some(source)
        };
        (0..self.levels.len()).rev().find_map(of_level)
    }

    /// Edge of the blocks that have one nearest source each: half a cell, where cells of all levels begin and end.
    pub(crate) fn block(&self) -> usize {
        self.levels.last().map_or(1, |level| (level.cell / 2).max(1))
    }

    /// The pixels that were seen.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = (usize, usize)> {
        self.levels.iter().flat_map(|level| {
            let seen = level.seen.iter().enumerate().filter(|(_, glimpse)| glimpse.sums.samples > 0);
            seen.map(|(number, _)| level.pixel(number))
        })
    }

    /// Whether a source is the pixel itself.
    pub(crate) fn is_at(&self, source: Source, i: usize, j: usize) -> bool {
        let (level, number) = source.place();
        self.levels[level].pixel(number) == (i, j)
    }

    /// What the light of each pixel is, as a sum of channels, bottom row first: mean over its cell's neighbourhood, of reflected
    /// light only, for a light in the picture says nothing of its surroundings.
    pub(crate) fn smooth_light(&self) -> Vec<f32> {
        let Some(Level { cell, columns, seen }) = self.levels.last() else { return Vec::new() };
        let (last, columns) = (self.levels.len() - 1, *columns);
        let rows = seen.len() / columns;
        let smooth = |row: usize, column: usize| {
            let (mut sum, mut samples) = (0.0, 0);
            for row in row.saturating_sub(REACH)..=(row + REACH).min(rows - 1) {
                for column in column.saturating_sub(REACH)..=(column + REACH).min(columns - 1) {
                    let sums = &self.glimpse(self.place(last, column, row)).sums;
                    (sum, samples) = (sum + sums.reflected, samples + sums.samples);
                }
            }
            (sum / f64::from(samples.max(1))) as f32
        };
        let of_cells: Vec<f32> = (0..rows)
            .into_par_iter()
            .flat_map_iter(|row| (0..columns).map(move |column| smooth(row, column)))
            .collect();
        let mut light: Vec<f32> = bytemuck::zeroed_vec(self.width * self.height);
        light.par_chunks_mut(self.width).enumerate().for_each(|(j, row)| {
            let cells = &of_cells[nearest_cell(j, *cell, self.height) * columns..][..columns];
            row.iter_mut().enumerate().for_each(|(i, light)| *light = cells[nearest_cell(i, *cell, self.width)]);
        });
        light
    }
}
