//! Bias: whether a picture is brighter or darker than its reference by more than its noise explains.

use rayon::prelude::*;

use crate::{Image, ImageError};

/// The signed mean difference with z-tests over a grid of regions.
///
/// A difference here is test - reference, the mean of the three channels of a pixel. Two questions are asked:
///
/// * Is the whole picture biased? The means of the regions are draws of one quantity if it is not; their mean over its
///   standard error, `mean / (sd / sqrt(regions))`, is [`Self::z`]. Regions are large against the reach of a
///   reconstruction filter, so that the noise of neighbouring pixels may hang together. With one region, z comes from
///   its pixels.
/// * Is some region biased? In each, the mean over its standard error from the region's own pixels, taken as
///   independent, is the region's z; its p value is corrected for the number of regions (Sidak 1967), so that unbiased
///   pictures have a [`Self::worst`] region with p < 0.01 once in a hundred times, not every time.
///
/// p values are two-sided: the chance that unbiased noise gives a |z| at least as great, z being taken as Student's t
/// of as many numbers. Means of many pixels are nearly normal, as that asks for; noise that hangs together between
/// pixels makes the regions' p too small, and rare high values (fireflies) make both unreliable. Where nothing
/// scatters, z is 0 for a mean of 0 and infinite otherwise. NaN comes from non-finite pixels only.
#[derive(Clone, Debug, PartialEq)]
pub struct Bias {
    /// Mean of test - reference over channels and pixels, in the pictures' unit.
    pub mean: f64,
    /// Mean of the regions' means over its standard error.
    pub z: f64,
    /// Two-sided p value of `z`, 0 to 1.
    pub p: f64,
    /// Number of regions: `columns * rows`.
    pub regions: usize,
    /// Number of regions with a corrected p value below [`Self::SIGNIFICANT`].
    pub significant: usize,
    /// The region with the greatest |z|, the first of equal ones; `None` for pictures without pixels.
    pub worst: Option<RegionTest>,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub x: usize,
    /// First row, counted from the top.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// The test of one region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionTest {
    /// Where it lies.
    pub region: Region,
    /// Mean difference, in the pictures' unit.
    pub mean: f64,
    /// Mean difference over its standard error.
    pub z: f64,
    /// Two-sided p value, corrected for the number of regions.
    pub p: f64,
}

impl Bias {
    /// Regions per side where the picture is large enough.
    pub const REGIONS_PER_SIDE: usize = 8;
    /// The corrected p value below which a region is biased.
    pub const SIGNIFICANT: f64 = 0.01;
    /// No region is narrower or lower than this many pixels, unless the picture is: 64 pixels make a mean normal.
    const SMALLEST_SIDE: usize = 8;

    /// Tests in a grid of `regions_per_side` times as many regions, fewer where they would have less than 8 pixels per
    /// side.
    ///
    /// Fails with [`ImageError::SizeMismatch`].
    pub fn test(reference: &Image, test: &Image, regions_per_side: usize) -> Result<Self, ImageError> {
        reference.expect_size_of(test, "the test picture")?;
        let regions = grid(reference.width(), reference.height(), regions_per_side);
        let samples: Vec<Sample> = regions.par_iter().map(|region| sample(reference, test, *region)).collect();
        let tests: Vec<RegionTest> = regions.iter().zip(&samples).map(|(r, s)| s.tested(*r, regions.len())).collect();
        let of_means = Sample::of(samples.iter().map(|sample| sample.mean));
        let overall = if let [only] = &samples[..] { only } else { &of_means };
        Ok(Self {
            mean: samples.iter().fold(0.0, |sum, sample| sum + sample.sum()) / reference.pixels().len().max(1) as f64,
            z: overall.z(),
            p: overall.p(),
            regions: regions.len(),
            significant: tests.iter().filter(|test| test.p < Self::SIGNIFICANT).count(),
            worst: tests.into_iter().reduce(|worst, test| if farther(&test, &worst) { test } else { worst }),
        })
    }
}

/// Whether `a` lies farther out than `b`; NaN lies outside of everything.
fn farther(a: &RegionTest, b: &RegionTest) -> bool {
    a.z.abs().total_cmp(&b.z.abs()).is_gt()
}

/// A grid of regions that covers the picture, row by row, sides as equal as whole pixels allow.
fn grid(width: usize, height: usize, per_side: usize) -> Vec<Region> {
    let cuts = |length: usize| {
        let count = per_side.min(length / Bias::SMALLEST_SIDE).max(1).min(length);
        (0..count).map(move |i| (i * length / count, (i + 1) * length / count))
    };
    let row = |(top, bottom)| {
        cuts(width).map(move |(left, right)| Region { x: left, y: top, width: right - left, height: bottom - top })
    };
    cuts(height).flat_map(row).collect()
}

/// Mean and scatter of independent numbers.
struct Sample {
    count: usize,
    mean: f64,
    /// Sum of squared distances from the mean.
    scatter: f64,
}

impl Sample {
    /// In two runs, so that a small scatter around a large mean is not lost.
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let (count, sum) = values.clone().fold((0_usize, 0.0), |(count, sum), value| (count + 1, sum + value));
        // Finite floats never overflow f64 here; an infinite pixel is as little a number as a NaN.
        let mean = if sum.is_finite() { sum / count.max(1) as f64 } else { f64::NAN };
        let scatter = values.map(|value| (value - mean) * (value - mean)).sum();
        Self { count, mean, scatter }
    }

    fn sum(&self) -> f64 {
        self.mean * self.count as f64
    }

    fn freedom(&self) -> f64 {
        self.count.saturating_sub(1) as f64
    }

    /// Mean over its standard error. One number alone tells nothing: 0.
    fn z(&self) -> f64 {
        if self.mean == 0.0 || (self.count < 2 && !self.mean.is_nan()) {
            return 0.0; // also where nothing scatters
        }
        self.mean / (self.scatter / self.freedom() / self.count as f64).sqrt()
    }

    fn tested(&self, region: Region, regions: usize) -> RegionTest {
        RegionTest { region, mean: self.mean, z: self.z(), p: corrected(self.p(), regions) }
    }

    /// Two-sided p value of [`Self::z`], which has Student's distribution.
    fn p(&self) -> f64 {
        two_sided(as_normal(self.z(), self.freedom()))
    }
}

fn sample(reference: &Image, test: &Image, region: Region) -> Sample {
    let rows = region.y..region.y + region.height;
    let columns = region.x..region.x + region.width;
    Sample::of(rows.flat_map(move |y| {
        let (a, b) = (&reference.row(y)[columns.clone()], &test.row(y)[columns.clone()]);
        a.iter()
            .zip(b)
            .map(|(a, b)| (0..3).map(|channel| f64::from(b[channel]) - f64::from(a[channel])).sum::<f64>() / 3.0)
    }))
}

/// The quantile of the normal distribution where Student's distribution has `t` (Wallace 1959). From 15 degrees of
/// freedom on, p values down to 0.001 are off by less than 1 %.
fn as_normal(t: f64, freedom: f64) -> f64 {
    if freedom == 0.0 {
        return t;
    }
    (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * (freedom * (t * t / freedom).ln_1p()).sqrt()
}

/// The chance of a |z| at least as great from a standard normal distribution.
fn two_sided(z: f64) -> f64 {
    libm::erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// The chance that at least one of `count` independent tests has a p value as small: 1 - (1 - p)^count (Sidak 1967).
fn corrected(p: f64, count: usize) -> f64 {
    -(count as f64 * (-p).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise of mean `bias`, uniform within 0.5 of it, from SplitMix64 (Steele et al. 2014).
    fn noise(width: usize, height: usize, seed: u64, bias: f32) -> Image {
        let mut state = seed << 32;
        let mut draw = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0 - 0.5 + bias
        };
        Image::from_fn(width, height, |_, _| [draw(), draw(), draw()])
    }

    fn of_noise(width: usize, height: usize, seed: u64, bias: f32) -> Bias {
        Bias::test(&Image::new(width, height), &noise(width, height, seed, bias), 8).unwrap()
    }

    #[test]
    fn a_known_bias_has_its_mean_and_its_z() {
        let (width, height, bias) = (128, 96, 0.01);
        let found = of_noise(width, height, 7, bias);
        // A pixel is the mean of three channels of variance 1 / 12.
        let standard_error = (1.0 / 36.0 / (width * height) as f64).sqrt();
        assert!((found.mean - f64::from(bias)).abs() < 4.0 * standard_error, "{found:?}");
        assert!((found.z / (found.mean / standard_error) - 1.0).abs() < 0.4, "{found:?}");
        assert!(found.p < 1e-6 && found.regions == 64);
        let darker = Bias::test(&noise(width, height, 7, bias), &Image::new(width, height), 8).unwrap();
        assert_eq!((darker.mean, darker.z, darker.p), (-found.mean, -found.z, found.p));
    }

    #[test]
    fn unbiased_noise_raises_an_alarm_as_often_as_p_says() {
        let found: Vec<Bias> = (0..400).map(|seed| of_noise(64, 64, seed, 0.0)).collect();
        let rate = |alarm: &dyn Fn(&Bias) -> bool| found.iter().filter(|bias| alarm(bias)).count() as f64 / 400.0;
        let (whole, worst) = (rate(&|bias| bias.p < 0.05), rate(&|bias| bias.worst.unwrap().p < 0.05));
        let deviation = (0.05_f64 * 0.95 / 400.0).sqrt();
        assert!((whole - 0.05).abs() < 3.0 * deviation, "whole picture: {whole}");
        assert!((worst - 0.05).abs() < 3.0 * deviation, "worst region: {worst}");
        let median = rate(&|bias| bias.p < 0.5);
        assert!((median - 0.5).abs() < 3.0 * (0.25_f64 / 400.0).sqrt(), "{median}");
    }

    #[test]
    fn a_biased_region_is_found() {
        let mut test = noise(80, 64, 3, 0.0);
        (24..32).for_each(|y| (60..70).for_each(|x| test.set(x, y, test.get(x, y).map(|value| value - 0.3))));
        let found = Bias::test(&Image::new(80, 64), &test, 8).unwrap();
        let worst = found.worst.unwrap();
        assert_eq!(worst.region, Region { x: 60, y: 24, width: 10, height: 8 });
        assert!((worst.mean + 0.3).abs() < 0.1 && worst.z < -6.0 && worst.p < 1e-6, "{worst:?}");
        assert_eq!(found.significant, 1);
    }

    #[test]
    fn pictures_without_scatter() {
        let grey = Image::filled(64, 64, [0.5; 3]);
        let same = Bias::test(&grey, &grey, 8).unwrap();
        let worst = same.worst.unwrap();
        assert_eq!((same.mean, same.z, same.p, same.significant), (0.0, 0.0, 1.0, 0));
        assert_eq!((worst.z, worst.p, worst.region.x, worst.region.y), (0.0, 1.0, 0, 0));
        let brighter = Bias::test(&Image::new(64, 64), &grey, 8).unwrap();
        assert_eq!((brighter.mean, brighter.z, brighter.p, brighter.significant), (0.5, f64::INFINITY, 0.0, 64));
        assert_eq!(brighter.worst.unwrap().p, 0.0);
    }

    #[test]
    fn small_and_empty_pictures() {
        let empty = Bias::test(&Image::new(0, 9), &Image::new(0, 9), 8).unwrap();
        assert_eq!((empty.mean, empty.z, empty.p, empty.regions, empty.worst), (0.0, 0.0, 1.0, 0, None));
        let pixel = Bias::test(&Image::new(1, 1), &Image::filled(1, 1, [1.0; 3]), 8).unwrap();
        assert_eq!((pixel.mean, pixel.z, pixel.p, pixel.regions), (1.0, 0.0, 1.0, 1));
        let region_count = |width, height, per_side| grid(width, height, per_side).len();
        assert_eq!(region_count(7, 7, 8), 1);
        assert_eq!(region_count(17, 100, 8), 16);
        assert_eq!(region_count(640, 480, 0), 1);
        assert!(Bias::test(&Image::new(9, 9), &Image::new(9, 8), 8).is_err());
    }

    #[test]
    fn regions_cover_every_pixel_once() {
        let mut hits = Image::new(97, 61);
        for region in grid(97, 61, 8) {
            assert!(region.width >= 8 && region.height >= 7);
            let rows = region.y..region.y + region.height;
            rows.for_each(|y| hits.row_mut(y)[region.x..][..region.width].iter_mut().for_each(|hit| hit[0] += 1.0));
        }
        assert!(hits.pixels().iter().all(|hit| hit[0] == 1.0));
    }

    #[test]
    fn a_value_that_is_no_number_shows() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut test = Image::new(32, 32);
            test.set(20, 9, [0.0, value, 0.0]);
            let found = Bias::test(&Image::new(32, 32), &test, 4).unwrap();
            assert!(found.mean.is_nan() && found.z.is_nan() && found.p.is_nan(), "{value}");
            let worst = found.worst.unwrap();
            assert_eq!((worst.region.x, worst.region.y), (16, 8));
            assert!(worst.z.is_nan());
        }
    }

    #[test]
    fn p_values_of_tables() {
        // Quantiles of Student's distribution, two-sided.
        for (freedom, t, p) in [(15.0, 2.131_450, 0.05), (15.0, 4.072_765, 0.001), (63.0, 1.998_341, 0.05)] {
            let found = two_sided(as_normal(t, freedom));
            assert!((found / p - 1.0).abs() < 0.01, "{freedom} {t}: {found} {p}");
        }
        assert!((two_sided(1.959_964) - 0.05).abs() < 1e-7);
        assert_eq!((two_sided(0.0), two_sided(f64::INFINITY)), (1.0, 0.0));
        assert!((corrected(0.5, 3) - 0.875).abs() < 1e-15);
        assert!((corrected(1e-20, 64) / 64e-20 - 1.0).abs() < 1e-9, "tiny p do not round to 0");
        assert_eq!((corrected(1.0, 64), corrected(0.0, 64)), (1.0, 0.0));
    }
}
