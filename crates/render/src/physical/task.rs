//! What a tile is to get in a pass: how many samples, of which pixels, with which random numbers.

use crate::film::Tile;
use lightcuts_kernel::rng::random4;

/// What a tile is to get in a pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task {
    /// Number of the tile.
    pub(crate) tile: usize,
    /// Number of the technique.
    pub(crate) technique: usize,
    pub(crate) extent: Extent,
}

/// How many samples a tile gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// So many of every pixel.
    Whole(u32),
    /// One of each of a few pixels, to learn how a technique does; with the number of the probe.
    Probe(u32),
}

impl Extent {
    /// Samples of every pixel.
    pub(crate) fn samples(self) -> u32 {
        match self {
            Self::Whole(samples) => samples,
            Self::Probe(_) => 0,
        }
    }
}

/// Parts of a tile, side by side, of each of which a probe sees a square of two by two pixels: neighbours, as
/// techniques are quickest with them.
const PROBED_PARTS: u32 = 2;

/// Probes of the same pixels, so that their samples can be compared; the next ones see others.
pub(crate) const PROBES_OF_A_GROUP: u32 = 4;

/// Which random numbers a task gets: those of samples from a number on, in a stream.
#[derive(Clone, Copy)]
pub(crate) struct Points {
    pub(crate) first: u32,
    pub(crate) stream: u32,
}

/// A pixel of a tile: its place there, and its column and row in the picture.
pub(super) type Place = (usize, (u32, u32));

/// A tile's pixels in blocks of up to eight neighbours, each with its place in the tile.
pub(super) fn blocks(tile: &Tile) -> impl Iterator<Item = Vec<Place>> {
    const SIZE: [u32; 2] = [4, 2];
    let Tile { i, j, width, height } = *tile;
    let corners = (0..height)
        .step_by(SIZE[1] as usize)
        .flat_map(move |y| (0..width).step_by(SIZE[0] as usize).map(move |x| (x, y)));
    corners.map(move |(left, bottom)| {
        let rows = bottom..(bottom + SIZE[1]).min(height);
        let columns = left..(left + SIZE[0]).min(width);
        rows.flat_map(|y| columns.clone().map(move |x| ((y * width + x) as usize, (i + x, j + y)))).collect()
    })
}

/// The pixels of a probe, each with its place in the tile.
pub(super) fn probed(tile: &Tile, number: u32) -> impl Iterator<Item = Place> {
    let Tile { i, j, width, height } = *tile;
    (0..PROBED_PARTS).flat_map(move |part| {
        let [u, v, ..] = random4(part, number / PROBES_OF_A_GROUP, i, j);
        let (first, end) = (width * part / PROBED_PARTS, width * (part + 1) / PROBED_PARTS);
        let place = |places: u32, random: f32| (places.saturating_sub(1) as f32 * random) as u32;
        let (left, bottom) = (first + place(end - first, u), place(height, v));
        let rows = bottom..(bottom + 2).min(height);
        let columns = left..(left + 2).min(end);
        rows.flat_map(move |y| columns.clone().map(move |x| ((y * width + x) as usize, (i + x, j + y))))
    })
}
