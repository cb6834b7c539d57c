//! The film: weighted sums of samples, tile by tile.

use crate::settings::Filter;
use glam::{Vec3, Vec4, Vec4Swizzles};
use lightcuts_kernel::filter::{PixelFilter, filter_weight};

/// A rectangle of pixels; j counts from the bottom, as in the thesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// First column.
    pub i: u32,
    /// First row, from the bottom of the picture.
    pub j: u32,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
}

impl Tile {
    /// Tiles of at most `size` x `size` pixels that cover a picture, bottom row first.
    pub fn cover(width: u32, height: u32, size: u32) -> Vec<Self> {
        let starts = |length: u32| (0..length).step_by(size as usize);
        starts(height)
            .flat_map(|j| starts(width).map(move |i| (i, j)))
            .map(|(i, j)| Self { i, j, width: size.min(width - i), height: size.min(height - j) })
            .collect()
    }

    /// Its pixels, bottom row first.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let Self { i, j, width, height } = *self;
        (j..j + height).flat_map(move |j| (i..i + width).map(move |i| (i, j)))
    }
}

/// Weighted sums (rgb, weight) of a rectangle of pixels.
#[derive(Debug, Clone)]
pub struct Film {
    filter: PixelFilter,
    /// Pixels around its tile that samples reach, in each direction.
    border: i64,
    /// First column and row; negative in a tile's border.
    left: i64,
    bottom: i64,
    width: usize,
    height: usize,
    sums: Vec<Vec4>,
}

impl Film {
    /// An empty film for a whole picture, made up of tiles' films.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self::window(&Tile { i: 0, j: 0, width, height }, &Filter::default(), 0)
    }

    /// An empty film for a tile and the pixels around it that its samples reach.
    pub fn around(tile: &Tile, filter: &Filter) -> Self {
        Self::window(tile, filter, filter.border())
    }

    /// The film [`around`](Self::around) a tile from its sums: row by row, the bottom row of the window first, each rgb
    /// and weight. Panics if their number is another.
    pub fn from_sums(tile: &Tile, filter: &Filter, sums: Vec<Vec4>) -> Self {
        let film = Self::around(tile, filter);
        assert_eq!(sums.len(), film.sums.len(), "a sum for each pixel of the window");
        Self { sums, ..film }
    }

    /// Its sums, row by row, the bottom row first: rgb and weight.
    pub fn sums(&self) -> &[Vec4] {
        &self.sums
    }

    fn window(tile: &Tile, filter: &Filter, border: u32) -> Self {
        let (width, height) = ((tile.width + 2 * border) as usize, (tile.height + 2 * border) as usize);
        let border = i64::from(border);
        let (left, bottom) = (i64::from(tile.i) - border, i64::from(tile.j) - border);
        // Zeros of the system: memory of a part that gets no sample is never touched.
        let sums = bytemuck::zeroed_vec(width * height);
        Self { filter: filter.pixel_filter(), border, left, bottom, width, height, sums }
    }

    /// Adds a sample that lies `shift` pixels from the centre of pixel (i, j).
    pub(crate) fn add(&mut self, i: u32, j: u32, shift: [f32; 2], color: Vec3) {
        for y in -self.border..=self.border {
            for x in -self.border..=self.border {
                let weight = filter_weight(&self.filter, shift[0] - x as f32, shift[1] - y as f32);
                if weight != 0.0 {
                    let column = (i64::from(i) + x - self.left) as usize;
                    let row = (i64::from(j) + y - self.bottom) as usize;
                    self.sums[row * self.width + column] += (color * weight).extend(weight);
                }
            }
        }
    }

    /// Adds a tile's film; what lies outside is dropped.
    pub fn merge(&mut self, tile: &Self) {
        for row in 0..tile.height {
            let j = tile.bottom + row as i64 - self.bottom;
            if !(0..self.height as i64).contains(&j) {
                continue;
            }
            for column in 0..tile.width {
                let i = tile.left + column as i64 - self.left;
                if (0..self.width as i64).contains(&i) {
                    self.sums[j as usize * self.width + i as usize] += tile.sums[row * tile.width + column];
                }
            }
        }
    }

    /// The colour of a pixel: weighted mean; black where no sample fell.
    pub(crate) fn mean(&self, i: usize, j: usize) -> Vec3 {
        let sum = self.sums[j * self.width + i];
        if sum.w == 0.0 { Vec3::ZERO } else { sum.xyz() / sum.w }
    }

    /// The same, at most 1.
    pub(crate) fn color(&self, i: usize, j: usize) -> Vec3 {
        self.mean(i, j).min(Vec3::ONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::FilterKind;

    #[test]
    fn tiles_cover_every_pixel_once() {
        let tiles = Tile::cover(37, 19, 16);
        let mut pixels: Vec<(u32, u32)> = tiles.iter().flat_map(Tile::pixels).collect();
        pixels.sort_unstable();
        pixels.dedup();
        assert_eq!(pixels.len(), 37 * 19);
    }

    #[test]
    fn tiled_and_whole_films_agree_for_every_filter() {
        for kind in [FilterKind::Box, FilterKind::Triangle, FilterKind::Gaussian, FilterKind::Mitchell] {
            let filter = Filter { kind, ..Filter::default() };
            let sample =
                |i: u32, j: u32| (Vec3::new(i as f32 * 0.01, j as f32 * 0.02, 0.5), [0.3 - 0.04 * j as f32, -0.2]);
            let mut merged = Film::new(9, 7);
            for tile in Tile::cover(9, 7, 4) {
                let mut film = Film::around(&tile, &filter);
                tile.pixels().for_each(|(i, j)| film.add(i, j, sample(i, j).1, sample(i, j).0));
                merged.merge(&film);
            }
            let whole_tile = Tile { i: 0, j: 0, width: 9, height: 7 };
            let mut whole = Film::around(&whole_tile, &filter);
            whole_tile.pixels().for_each(|(i, j)| whole.add(i, j, sample(i, j).1, sample(i, j).0));
            let mut expected = Film::new(9, 7);
            expected.merge(&whole);
            for j in 0..7 {
                for i in 0..9 {
                    assert!((merged.color(i, j) - expected.color(i, j)).length() < 1e-5, "{kind:?} {i} {j}");
                }
            }
        }
    }

    #[test]
    fn a_constant_picture_stays_constant() {
        let filter = Filter { kind: FilterKind::Mitchell, ..Filter::default() };
        let tile = Tile { i: 0, j: 0, width: 5, height: 5 };
        let mut film = Film::around(&tile, &filter);
        tile.pixels().for_each(|(i, j)| film.add(i, j, [0.1, -0.3], Vec3::splat(0.25)));
        let mut picture = Film::new(5, 5);
        picture.merge(&film);
        assert!((picture.color(0, 4) - 0.25).abs().max_element() < 1e-5);
    }
}
