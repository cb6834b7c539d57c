//! FLIP: the error that a viewer sees when two pictures alternate in the same place.
//!
//! Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", for pictures on a display
//! ([`Flip::ldr`]); Andersson et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images", for linear light
//! ([`Flip::hdr`]). Where the papers leave something open, the authors' program `flip_evaluator` 1.7 decides; deviations
//! from it are stated where they are.
//!
//! Per pixel, a colour difference and a feature difference are combined (2020, final difference):
//! `error = colour^(1 - feature)`, 0 to 1. The colour difference is that of Lab colours behind the eye's
//! contrast-sensitivity filters; the feature difference is that of edges and points. The
//! picture is treated in tiles with margins, so that nothing larger than the map is stored.

mod color;
mod exposure;
mod filter;
mod tile;

use rayon::prelude::*;

pub use exposure::Exposures;

use crate::{Image, ImageError, Plane};
use exposure::{Development, Series};
use tile::{Evaluator, Region};

/// Distances at which a pixel is so large, or filters get so wide, that the metric says nothing.
const PIXELS_PER_DEGREE: std::ops::RangeInclusive<f32> = 1.0..=1000.0;

/// FLIP for one way of viewing. The default is that of the papers: a display of 3840 pixels and 0.7 m width, 0.7 m
/// away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// Pixels that one degree of the visual field covers, 1 to 1000.
    pub pixels_per_degree: f32,
}

/// LDR-FLIP of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    /// Error of each pixel, 0 (none) to 1 (greatest).
    pub map: Plane<f32>,
    /// Mean of the map; 0 for empty pictures.
    pub mean: f64,
}

/// HDR-FLIP of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct HdrFlip {
    /// Error of each pixel, 0 (none) to 1 (greatest): the greatest of all exposures.
    pub map: Plane<f32>,
    /// Mean of the map; 0 for empty pictures.
    pub mean: f64,
    /// First exposure compensation, in stops.
    pub start: f32,
    /// Last exposure compensation, in stops.
    pub stop: f32,
    /// Number of exposures.
    pub count: u32,
}

impl Default for Flip {
    fn default() -> Self {
        Self::viewing(0.7, 0.7, 3840)
    }
}

impl Flip {
    /// For a viewer `distance_m` metres away from a display that is `width_m` metres and `width_px` pixels wide.
    pub fn viewing(distance_m: f32, width_m: f32, width_px: u32) -> Self {
        Self { pixels_per_degree: (distance_m * (width_px as f32 / width_m)).to_radians() }
    }

    /// LDR-FLIP of two pictures of sRGB code values, 0..=1; symmetric in its arguments.
    ///
    /// Values outside 0..=1 are clamped; NaN counts as 0. Rows and columns go on beyond the borders with the outermost
    /// pixel. Fails with [`ImageError::SizeMismatch`], or with [`ImageError::Parameter`] for `pixels_per_degree`.
    pub fn ldr(&self, reference: &Image, test: &Image) -> Result<FlipMap, ImageError> {
        let evaluator = self.evaluator(reference, test)?;
        let map = error_map(&evaluator, reference, test, &[Development::Code]);
        Ok(FlipMap { mean: mean(&map), map })
    }

    /// HDR-FLIP of two pictures of linear light: the greatest LDR-FLIP over a series of exposures, each developed with
    /// the ACES tone mapper (2021).
    ///
    /// NaN and infinities count as black, as in the authors' program; a negative value goes through the tone mapper's
    /// formula as it is. Fails with [`ImageError::SizeMismatch`], or with [`ImageError::Parameter`] for
    /// `pixels_per_degree` or the exposures.
    pub fn hdr(&self, reference: &Image, test: &Image, exposures: &Exposures) -> Result<HdrFlip, ImageError> {
        let evaluator = self.evaluator(reference, test)?;
        let series @ Series { start, stop, count } = exposures.series(reference)?;
        let map = error_map(&evaluator, reference, test, &series.developments());
        Ok(HdrFlip { mean: mean(&map), map, start, stop, count })
    }

    fn evaluator(self, reference: &Image, test: &Image) -> Result<Evaluator, ImageError> {
        reference.expect_size_of(test, "the test picture")?;
        if PIXELS_PER_DEGREE.contains(&self.pixels_per_degree) {
            return Ok(Evaluator::new(f64::from(self.pixels_per_degree)));
        }
        Err(ImageError::Parameter {
            parameter: "pixels-per-degree",
            range: "from 1 to 1000",
            value: f64::from(self.pixels_per_degree),
        })
    }
}

/// The greatest error of each pixel over the developments. Tiles are independent, so threads do not matter.
fn error_map(evaluator: &Evaluator, reference: &Image, test: &Image, developments: &[Development]) -> Plane<f32> {
    let regions = Region::tiles(reference.width(), reference.height());
    let tiles: Vec<Vec<f32>> =
        regions.par_iter().map(|region| evaluator.greatest_errors(reference, test, *region, developments)).collect();
    let mut map = Plane::new(reference.width(), reference.height());
    for (region, errors) in regions.iter().zip(&tiles) {
        for (y, row) in errors.chunks_exact(region.width).enumerate() {
            map.row_mut(region.y + y)[region.x..][..region.width].copy_from_slice(row);
        }
    }
    map
}

fn mean(map: &Plane<f32>) -> f64 {
    if map.is_empty() {
        return 0.0;
    }
    let sum: f64 = map.rows().map(|row| row.iter().copied().map(f64::from).sum::<f64>()).sum();
    sum / map.pixels().len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stripes and curves in all three channels, several periods per degree; two `shift`s have little in common.
    fn pattern(width: usize, height: usize, shift: usize) -> Image {
        let step = |value: usize, levels: usize| (value % (levels + 1)) as f32 / levels as f32;
        Image::from_fn(width, height, |x, y| {
            [step(7 * x + 3 * y + shift, 16), step(x * x + y + 2 * shift, 22), step(x + 5 * y * y + 3 * shift, 10)]
        })
    }

    /// [`pattern`] doubled every 50 columns.
    fn lights(width: usize, height: usize, shift: usize) -> Image {
        let pattern = pattern(width, height, shift);
        Image::from_fn(width, height, |x, y| pattern.get(x, y).map(|value| value * (1 << (x / 50)) as f32))
    }

    /// Every second square of 20 pixels dimmed by a tenth.
    fn dimmed(image: &Image) -> Image {
        Image::from_fn(image.width(), image.height(), |x, y| {
            let factor = if (x / 20 + y / 20) % 2 == 0 { 0.9 } else { 1.0 };
            image.get(x, y).map(|value| value * factor)
        })
    }

    fn assert_near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 2e-6, "{found}, expected {expected}");
    }

    // The numbers of the next two tests are those of flip_evaluator 1.7 (Python package) for the same pictures: means of
    // its maps in f64, from evaluate(..., applyMagma=False) with "ppd", "startExposure", ... as stated.

    #[test]
    fn ldr_agrees_with_the_authors_program() {
        let flip = |ppd| Flip { pixels_per_degree: ppd };
        let mean = |flip: Flip, a: &Image, b: &Image| flip.ldr(a, b).unwrap().mean;
        let (a, b) = (pattern(300, 140, 0), pattern(300, 140, 1));
        assert_near(mean(Flip::default(), &a, &b), 0.404_109_60);
        assert_near(mean(flip(30.0), &a, &b), 0.599_244_21);
        assert_near(mean(flip(120.0), &a, &b), 0.260_601_72);
        assert_near(mean(Flip::default(), &a, &dimmed(&a)), 0.165_720_53);
        // Smaller than the filters.
        let (a, b) = (pattern(37, 5, 0), pattern(37, 5, 1));
        let found = Flip::default().ldr(&a, &b).unwrap();
        assert_near(found.mean, 0.428_141_61);
        assert_near(f64::from(found.map.get(20, 3)), 0.549_016_6);
        assert_near(f64::from(found.map.get(36, 4)), 0.555_724_0);
    }

    #[test]
    fn hdr_agrees_with_the_authors_program() {
        let (a, b) = (lights(300, 140, 0), lights(300, 140, 1));
        let found = Flip::default().hdr(&a, &b, &Exposures::Automatic).unwrap();
        assert_near(found.mean, 0.333_865_23);
        assert!((found.start + 3.916_702_7).abs() < 1e-6 && (found.stop + 0.241_963_68).abs() < 1e-6);
        assert_eq!(found.count, 4);
        assert_near(Flip::default().hdr(&a, &dimmed(&a), &Exposures::Automatic).unwrap().mean, 0.074_497_08);
        let fixed = Exposures::Fixed { start: -3.0, stop: 1.0, count: 3 };
        assert_near(Flip::default().hdr(&a, &b, &fixed).unwrap().mean, 0.336_283_14);
    }

    #[test]
    fn the_default_is_the_papers_display() {
        assert!((Flip::default().pixels_per_degree - 67.020_645).abs() < 1e-5);
    }

    #[test]
    fn equal_pictures_have_no_error_and_the_arguments_may_be_exchanged() {
        let (a, b) = (pattern(40, 30, 0), pattern(40, 30, 1));
        let flip = Flip::default();
        let equal = flip.ldr(&a, &a).unwrap();
        assert!(equal.mean == 0.0 && equal.map.pixels().iter().all(|error| *error == 0.0));
        assert_eq!(flip.hdr(&a, &a, &Exposures::Automatic).unwrap().mean, 0.0);
        assert_eq!(flip.ldr(&a, &b).unwrap(), flip.ldr(&b, &a).unwrap());
    }

    #[test]
    fn black_against_white() {
        let (black, white) = (Image::new(64, 64), Image::filled(64, 64, [1.0; 3]));
        // Lightness differs by 100, colour by none: 0.96738 by the paper's equations in f64.
        assert!((Flip::default().ldr(&black, &white).unwrap().mean - 0.967_38).abs() < 1e-4);
        let hdr = Flip::default().hdr(&black, &white, &Exposures::Automatic).unwrap();
        let fixed = Exposures::Fixed { start: -2.0, stop: 2.0, count: 5 };
        assert_eq!(hdr, Flip::default().hdr(&black, &white, &fixed).unwrap());
        assert!((hdr.mean - 0.966_50).abs() < 1e-4, "{}", hdr.mean);
    }

    #[test]
    fn borders_of_tiles_are_invisible() {
        let with_dot_at = |x, y| {
            let mut image = Image::filled(600, 300, [0.5; 3]);
            image.set(x, y, [1.0, 0.2, 0.0]);
            image
        };
        let grey = Image::filled(600, 300, [0.5; 3]);
        let map_around = |x: usize, y: usize| {
            let map = Flip::default().ldr(&grey, &with_dot_at(x, y)).unwrap().map;
            Plane::from_fn(61, 61, |u, v| map.get(x + u - 30, y + v - 30))
        };
        let inside = map_around(100, 60);
        assert!(inside.get(30, 30) > 0.1 && inside.get(0, 0) < 1e-3);
        for (x, y) in [(255, 127), (256, 128), (512, 256), (260, 60)] {
            assert_eq!(map_around(x, y), inside, "a dot at ({x}, {y})");
        }
    }

    #[test]
    fn more_exposures_never_lessen_an_error() {
        let (a, b) = (lights(60, 40, 0), lights(60, 40, 1));
        let map =
            |count, stop| Flip::default().hdr(&a, &b, &Exposures::Fixed { start: -2.0, stop, count }).unwrap().map;
        let (one, two) = (map(1, 2.0), map(2, 2.0));
        assert!(one.pixels().iter().zip(two.pixels()).all(|(one, two)| one <= two));
        assert_ne!(one, two);
        assert_eq!(one, map(1, -2.0));
    }

    #[test]
    fn threads_do_not_matter() {
        let (a, b) = (lights(700, 300, 0), lights(700, 300, 1));
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Flip::default().hdr(&a, &b, &Exposures::Automatic).unwrap())
        };
        assert_eq!(on(1), on(4));
    }

    #[test]
    fn a_nan_stays_near_its_pixel() {
        let a = pattern(80, 40, 0);
        let mut b = a.clone();
        b.set(20, 20, [f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
        let mut black = a.clone();
        black.set(20, 20, [0.0; 3]);
        let found = Flip::default().hdr(&a, &b, &Exposures::Automatic).unwrap();
        assert_eq!(found, Flip::default().hdr(&a, &black, &Exposures::Automatic).unwrap());
        assert!(found.mean > 0.0 && found.map.get(60, 20) == 0.0);
        let broken_reference = Flip::default().hdr(&b, &a, &Exposures::Automatic).unwrap();
        assert!(broken_reference.start.is_finite() && broken_reference.mean.is_finite());
    }

    #[test]
    fn sizes_and_displays_are_checked() {
        let (small, large) = (Image::new(3, 2), Image::new(3, 3));
        let flip = Flip::default();
        assert!(matches!(flip.ldr(&small, &large), Err(ImageError::SizeMismatch { .. })));
        assert!(matches!(flip.hdr(&small, &large, &Exposures::Automatic), Err(ImageError::SizeMismatch { .. })));
        for pixels_per_degree in [0.0, -1.0, 1e9, f32::NAN, f32::INFINITY] {
            assert!(matches!(Flip { pixels_per_degree }.ldr(&small, &small), Err(ImageError::Parameter { .. })));
        }
        for pixels_per_degree in [1.0, 1000.0] {
            assert_eq!(Flip { pixels_per_degree }.ldr(&small, &small).unwrap().mean, 0.0);
        }
        for empty in [Image::new(0, 0), Image::new(0, 4), Image::new(4, 0)] {
            assert_eq!(flip.ldr(&empty, &empty).unwrap().mean, 0.0);
            assert_eq!(flip.hdr(&empty, &empty, &Exposures::Automatic).unwrap().mean, 0.0);
        }
    }
}
