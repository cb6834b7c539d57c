//! Every metric asked for, in one run.

use std::time::Instant;

use super::flip::{Exposures, Flip, FlipMap, HdrFlip};
use super::{Bias, Metric, NonFinite, PdiffOutcome, PerceptualDiff, count_fireflies, deviation, ssim};
use crate::{ImageError, Picture};

/// The parameters of all metrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricOptions {
    /// Perceptual Image Diff.
    pub pdiff: PerceptualDiff,
    /// Both FLIPs.
    pub flip: Flip,
    /// The exposures of HDR-FLIP.
    pub exposures: Exposures,
    /// Bias is tested in at most this many regions per side.
    pub bias_regions: usize,
}

impl Default for MetricOptions {
    fn default() -> Self {
        Self {
            pdiff: PerceptualDiff::default(),
            flip: Flip::default(),
            exposures: Exposures::default(),
            bias_regions: Bias::REGIONS_PER_SIDE,
        }
    }
}

/// The value of one metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The metric.
    pub metric: Metric,
    /// Its value in [`Metric::unit`]; `None` where it has none: SSIM of a picture smaller than its window.
    ///
    /// PSNR of equal pictures is infinite, and so is the relative bias against a black one. MSE to SMAPE and bias are NaN where the light has a non-finite value.
    pub value: Option<f64>,
    /// Wall time of this metric. Metrics that share work (both of Perceptual Image Diff; MSE and RMSE) charge it to the
    /// first of them; the others took no time.
    pub seconds: f64,
}

/// How a test picture compares with its reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// [`Metric::NonFinite`], then the metrics asked for, once each, in the order asked for.
    pub measured: Vec<Measured>,
    /// Pixels that are no numbers.
    pub non_finite: NonFinite,
    /// Pixels that differ visibly, where asked for.
    pub pdiff: Option<PdiffOutcome>,
    /// The map of FLIP, where asked for.
    pub flip_ldr: Option<FlipMap>,
    /// The map of HDR-FLIP, where asked for.
    pub flip_hdr: Option<HdrFlip>,
    /// The tests for bias, where asked for.
    pub bias: Option<Bias>,
}

/// Measures `test` against `reference`; `told` is called with each metric before it is measured.
///
/// Non-finite pixels are counted first, always, also where `metrics` does not name that count. Fails with
/// [`ImageError::SizeMismatch`], and with [`ImageError::Parameter`] where an option lies outside its range.
pub fn compare(
    reference: &Picture,
    test: &Picture,
    metrics: &[Metric],
    options: &MetricOptions,
    told: &dyn Fn(Metric),
) -> Result<Comparison, ImageError> {
    let mut run = Run { reference, test, options, found: Comparison::default(), mse: None };
    for &metric in [Metric::NonFinite].iter().chain(metrics) {
        if run.found.measured(metric).is_none() {
            told(metric);
            let start = Instant::now();
            let value = run.measure(metric)?;
            run.found.measured.push(Measured { metric, value, seconds: start.elapsed().as_secs_f64() });
        }
    }
    Ok(run.found)
}

impl Comparison {
    /// What was measured of `metric`; `None` where it was not asked for.
    pub fn measured(&self, metric: Metric) -> Option<&Measured> {
        self.measured.iter().find(|measured| measured.metric == metric)
    }

    /// The value of `metric`; `None` where it was not asked for or has none.
    pub fn value(&self, metric: Metric) -> Option<f64> {
        self.measured(metric)?.value
    }
}

/// A comparison on its way.
struct Run<'a> {
    reference: &'a Picture,
    test: &'a Picture,
    options: &'a MetricOptions,
    found: Comparison,
    mse: Option<f64>,
}

impl Run<'_> {
    fn measure(&mut self, metric: Metric) -> Result<Option<f64>, ImageError> {
        let (light, test_light) = (self.reference.linear(), self.test.linear());
        let (shown, test_shown) = (self.reference.display(), self.test.display());
        let MetricOptions { flip, exposures, bias_regions, .. } = self.options;
        Ok(Some(match metric {
            Metric::NonFinite => {
                self.found.non_finite = NonFinite::count(light, test_light)?;
                self.found.non_finite.total() as f64
            }
            Metric::PdiffPx => self.pdiff()?.pixels as f64,
            Metric::PdiffPass => f64::from(u8::from(self.pdiff()?.pass)),
            Metric::FlipLdr => self.found.flip_ldr.insert(flip.ldr(shown, test_shown)?).mean,
            Metric::FlipHdr => self.found.flip_hdr.insert(flip.hdr(light, test_light, exposures)?).mean,
            Metric::Mse => self.mse()?,
            Metric::Rmse => self.mse()?.sqrt(),
            Metric::Mae => deviation::mae(light, test_light)?,
            Metric::RelMse => deviation::relmse(light, test_light)?,
            Metric::Mrse => deviation::mrse(light, test_light)?,
            Metric::Smape => deviation::smape(light, test_light)?,
            Metric::Ssim => return ssim(shown, test_shown),
            Metric::Psnr => deviation::psnr(shown, test_shown)?,
            Metric::Bias => self.found.bias.insert(Bias::test(light, test_light, *bias_regions)?).mean,
            Metric::RelBias => deviation::relative_bias(light, test_light)?,
            Metric::Fireflies => count_fireflies(light, test_light)? as f64,
        }))
    }

    fn pdiff(&mut self) -> Result<&PdiffOutcome, ImageError> {
        let outcome = match self.found.pdiff.take() {
            Some(outcome) => outcome,
            None => self.options.pdiff.compare(self.reference.display(), self.test.display())?,
        };
        Ok(self.found.pdiff.insert(outcome))
    }

    fn mse(&mut self) -> Result<f64, ImageError> {
        let mse = match self.mse {
            Some(mse) => mse,
            None => deviation::mse(self.reference.linear(), self.test.linear())?,
        };
        Ok(*self.mse.insert(mse))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Image, Transfer};
    use std::cell::RefCell;

    fn picture(width: usize, height: usize, scale: f32) -> Picture {
        let hash = |x: usize, y: usize, c: usize| (x * 7919 + y * 104_729 + c * 1_299_709) % 1009;
        let value = |x, y, c| scale * hash(x, y, c) as f32 / 1009.0 + 0.02 * x as f32 / width as f32;
        let linear = Image::from_fn(width, height, |x, y| [value(x, y, 0), value(x, y, 1), value(x, y, 2)]);
        Picture::from_linear(linear, Transfer::Srgb)
    }

    fn all(reference: &Picture, test: &Picture) -> Comparison {
        compare(reference, test, &Metric::ALL, &MetricOptions::default(), &|_| ()).unwrap()
    }

    #[test]
    fn metrics_come_in_the_order_asked_for_after_the_count_of_no_numbers() {
        let (a, b) = (picture(20, 16, 1.0), picture(20, 16, 0.9));
        let told = RefCell::new(vec![]);
        let asked = [Metric::Rmse, Metric::PdiffPass, Metric::Mse, Metric::Rmse, Metric::PdiffPx];
        let found =
            compare(&a, &b, &asked, &MetricOptions::default(), &|metric| told.borrow_mut().push(metric)).unwrap();
        let order = [Metric::NonFinite, Metric::Rmse, Metric::PdiffPass, Metric::Mse, Metric::PdiffPx];
        assert_eq!(told.into_inner(), order);
        assert_eq!(found.measured.iter().map(|measured| measured.metric).collect::<Vec<_>>(), order);
        assert_eq!(found.value(Metric::Rmse), found.value(Metric::Mse).map(f64::sqrt));
        assert_eq!(found.value(Metric::Ssim), None);
        assert!(found.pdiff.is_some() && found.flip_ldr.is_none() && found.flip_hdr.is_none() && found.bias.is_none());
    }

    #[test]
    fn the_best_value_of_each_metric_is_that_of_equal_pictures() {
        let a = picture(32, 24, 1.0);
        let found = all(&a, &a);
        for metric in Metric::ALL {
            let expected = match metric {
                Metric::PdiffPass => 1.0,
                Metric::Ssim => found.value(metric).filter(|value| (value - 1.0).abs() < 1e-12).unwrap(),
                Metric::Psnr => f64::INFINITY,
                _ => 0.0,
            };
            assert_eq!(found.value(metric), Some(expected), "{metric}");
        }
    }

    #[test]
    fn every_thread_count_gives_the_same_bits() {
        let (a, b) = (picture(97, 61, 1.0), picture(97, 61, 1.3));
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut found = pool.install(|| all(&a, &b));
            found.measured.iter_mut().for_each(|measured| measured.seconds = 0.0);
            found
        };
        assert_eq!(on(1), on(4));
    }

    #[test]
    fn black_references_and_strange_sizes_are_answers() {
        for (width, height) in [(1, 1), (1, 30), (30, 2), (0, 0), (0, 7), (16, 16)] {
            let black = Picture::from_linear(Image::new(width, height), Transfer::Srgb);
            let found = all(&black, &picture(width, height, 1.0));
            for measured in &found.measured {
                let finite = measured.value.is_none_or(|value| !value.is_nan());
                assert!(finite, "{width} x {height}: {measured:?}");
            }
        }
    }

    #[test]
    fn light_without_a_value_is_nan_and_counted() {
        let a = picture(16, 16, 1.0);
        let mut linear = a.linear().clone();
        linear.set(3, 3, [f32::NAN, 1.0, 1.0]);
        let b = Picture::from_linear(linear, Transfer::Srgb);
        let found = all(&a, &b);
        assert_eq!(found.non_finite, NonFinite { reference: 0, test: 1 });
        for metric in [
            Metric::Mse,
            Metric::Rmse,
            Metric::Mae,
            Metric::RelMse,
            Metric::Mrse,
            Metric::Smape,
            Metric::Bias,
            Metric::RelBias,
        ] {
            assert!(found.value(metric).unwrap().is_nan(), "{metric}");
        }
        for metric in [Metric::PdiffPx, Metric::FlipLdr, Metric::FlipHdr, Metric::Ssim, Metric::Psnr, Metric::Fireflies]
        {
            assert!(found.value(metric).unwrap().is_finite(), "{metric}");
        }
    }

    #[test]
    fn sizes_that_differ_are_an_error() {
        let (a, b) = (picture(16, 16, 1.0), picture(16, 17, 1.0));
        for metric in Metric::ALL {
            let result = compare(&a, &b, &[metric], &MetricOptions::default(), &|_| ());
            assert!(matches!(result, Err(ImageError::SizeMismatch { .. })), "{metric}");
        }
    }
}
