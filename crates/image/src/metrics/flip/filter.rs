//! FLIP's filters, each a convolution along rows and one along columns.

use std::f64::consts::PI;

/// Contrast sensitivity as Gaussians in frequency, `a exp(-b f^2)`, f in cycles per degree (2020, spatial filtering): a, b.
const ACHROMATIC: (f64, f64) = (1.0, 0.0047);
const RED_GREEN: (f64, f64) = (1.0, 0.0053);
const BLUE_YELLOW: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// Width in degrees of the features that are looked for (2020, feature detection: w).
const FEATURE_WIDTH: f64 = 0.082;

/// Weights below this share of the greatest are lost in the rounding of f32 and left out.
const NEGLIGIBLE: f64 = 1e-9;

/// One-dimensional weights, even or odd in their offset, of which half is stored.
#[derive(Clone, Debug)]
pub(super) struct Kernel {
    /// Weights at the offsets 0, 1, 2, ...
    weights: Vec<f32>,
    /// 1 for even kernels, -1 for odd ones.
    mirror: f32,
}

impl Kernel {
    /// The kernel of `weight(offset)` for offsets 0 to `radius` pixels.
    fn new(radius: usize, mirror: f32, weight: impl Fn(f64) -> f64) -> Self {
        let weights: Vec<f64> = (0..=radius).map(|offset| weight(offset as f64)).collect();
        let greatest = weights.iter().fold(0.0, |greatest: f64, weight| greatest.max(weight.abs()));
        let needed = weights.iter().rposition(|weight| weight.abs() > NEGLIGIBLE * greatest).map_or(1, |last| last + 1);
        Self { weights: weights[..needed].iter().map(|weight| *weight as f32).collect(), mirror }
    }

    /// The greatest offset in pixels.
    pub(super) fn radius(&self) -> usize {
        self.weights.len() - 1
    }

    /// Adds the convolution of `source` to `target`: `target[i] += sum of weight(k) * source[i + k * stride]`, where
    /// `source` begins `radius * stride` values before the first target.
    ///
    /// Both sides are taken together, so that an odd kernel gives exactly 0 where the picture is constant.
    fn add(&self, source: &[f32], stride: usize, target: &mut [f32]) {
        let centre = &source[self.radius() * stride..];
        if self.mirror > 0.0 {
            add_scaled(self.weights[0], centre, target);
        }
        for (offset, &weight) in self.weights.iter().enumerate().skip(1) {
            let (left, right) = (&source[(self.radius() - offset) * stride..], &centre[offset * stride..]);
            add_pair(weight, right, self.mirror * weight, left, target);
        }
    }
}

fn add_scaled(weight: f32, source: &[f32], target: &mut [f32]) {
    for (target, source) in target.iter_mut().zip(source) {
        *target += weight * source;
    }
}

fn add_pair(right_weight: f32, right: &[f32], left_weight: f32, left: &[f32], target: &mut [f32]) {
    for ((target, right), left) in target.iter_mut().zip(right).zip(left) {
        *target += right_weight * right + left_weight * left;
    }
}

/// A rectangle of one channel with the same margin on all four sides.
pub(super) struct Margined<'a> {
    /// Rows of `width + 2 * margin` values, `height + 2 * margin` of them.
    pub(super) values: &'a [f32],
    /// Width without the margin.
    pub(super) width: usize,
    /// Height without the margin.
    pub(super) height: usize,
    /// Margin in pixels, at least the radius of every kernel.
    pub(super) margin: usize,
}

impl Margined<'_> {
    /// Filters the rows, those of the upper and lower margin too: `height + 2 * margin` rows of `width` values.
    pub(super) fn along_rows(&self, kernel: &Kernel) -> Vec<f32> {
        let mut filtered = vec![0.0; self.width * (self.height + 2 * self.margin)];
        let rows = self.values.chunks_exact(self.width + 2 * self.margin);
        for (source, target) in rows.zip(filtered.chunks_exact_mut(self.width)) {
            kernel.add(&source[self.margin - kernel.radius()..], 1, target);
        }
        filtered
    }

    /// Filters the columns of what [`Self::along_rows`] made and adds the result to `height` rows of `width` values.
    pub(super) fn add_along_columns(&self, rows: &[f32], kernel: &Kernel, target: &mut [f32]) {
        for (y, target) in target.chunks_exact_mut(self.width).enumerate() {
            kernel.add(&rows[(y + self.margin - kernel.radius()) * self.width..], self.width, target);
        }
    }
}

/// The kernels of the contrast-sensitivity filters: each channel is filtered along rows and columns with the same one;
/// blue-yellow is the sum of two such filters.
#[derive(Clone, Debug)]
pub(super) struct SensitivityKernels {
    pub(super) achromatic: Kernel,
    pub(super) red_green: Kernel,
    pub(super) blue_yellow: [Kernel; 2],
}

impl SensitivityKernels {
    /// For a display of that many pixels per degree of the visual field.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let radius = sensitivity_radius(pixels_per_degree);
        let kernel = |(a, b): (f64, f64), norm: f64| {
            Kernel::new(radius, 1.0, |offset| sensitivity(a, b, offset / pixels_per_degree) / norm)
        };
        let sum = |(a, b): (f64, f64)| mirrored_sum(radius, |offset| sensitivity(a, b, offset / pixels_per_degree));
        // The weights of all pixels sum to 1: in two dimensions that of a separable filter is the square of its sum.
        let total = BLUE_YELLOW.map(|gaussian| sum(gaussian).powi(2)).iter().sum::<f64>().sqrt();
        Self {
            achromatic: kernel(ACHROMATIC, sum(ACHROMATIC)),
            red_green: kernel(RED_GREEN, sum(RED_GREEN)),
            blue_yellow: BLUE_YELLOW.map(|gaussian| kernel(gaussian, total)),
        }
    }
}

/// Three standard deviations of the widest Gaussian, in pixels (2020, spatial filtering).
fn sensitivity_radius(pixels_per_degree: f64) -> usize {
    let widest = BLUE_YELLOW[0].1;
    (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize
}

/// One dimension of the inverse Fourier transform of `a exp(-b f^2)`, `a sqrt(pi / b) exp(-(pi x)^2 / b)` in the paper:
/// its amplitude's root, so that the product over two dimensions has that amplitude. x in degrees.
fn sensitivity(a: f64, b: f64, x: f64) -> f64 {
    (a * (PI / b).sqrt()).sqrt() * (-(PI * x).powi(2) / b).exp()
}

/// The kernels of the feature detectors: a Gaussian and its first two derivatives.
#[derive(Clone, Debug)]
pub(super) struct FeatureKernels {
    pub(super) blur: Kernel,
    pub(super) edge: Kernel,
    pub(super) point: Kernel,
}

impl FeatureKernels {
    /// For a display of that many pixels per degree of the visual field.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * deviation).ceil() as usize;
        let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        let first = |x: f64| x * gaussian(x);
        let second = |x: f64| (x * x / (deviation * deviation) - 1.0) * gaussian(x);
        // The positive weights of a derivative sum to 1, the negative ones to -1 (2020, feature detection).
        let [first_sum, rising, falling] = [
            mirrored_sum(radius, |x| first(x).max(0.0)) / 2.0,
            mirrored_sum(radius, |x| second(x).max(0.0)),
            mirrored_sum(radius, |x| second(x).min(0.0).abs()),
        ];
        let gaussian_sum = mirrored_sum(radius, gaussian);
        Self {
            blur: Kernel::new(radius, 1.0, |x| gaussian(x) / gaussian_sum),
            edge: Kernel::new(radius, -1.0, |x| first(x) / first_sum),
            point: Kernel::new(radius, 1.0, |x| second(x) / if second(x) > 0.0 { rising } else { falling }),
        }
    }
}

/// Sum of an even function over the offsets -radius to radius.
fn mirrored_sum(radius: usize, function: impl Fn(f64) -> f64) -> f64 {
    function(0.0) + 2.0 * (1..=radius).map(|offset| function(offset as f64)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernel's weights from its left end to its right end.
    fn unfolded(kernel: &Kernel) -> Vec<f64> {
        let mut weights = vec![0.0_f32; 2 * kernel.radius() + 1];
        let mut impulse = vec![0.0; 4 * kernel.radius() + 1];
        impulse[2 * kernel.radius()] = 1.0;
        kernel.add(&impulse, 1, &mut weights);
        weights.into_iter().rev().map(f64::from).collect()
    }

    fn sum(weights: &[f64]) -> f64 {
        weights.iter().sum()
    }

    #[test]
    fn sensitivity_filters_sum_to_one() {
        for pixels_per_degree in [5.0, 30.0, 67.020_645, 200.0] {
            let SensitivityKernels { achromatic, red_green, blue_yellow } = SensitivityKernels::new(pixels_per_degree);
            assert!((sum(&unfolded(&achromatic)) - 1.0).abs() < 1e-6);
            assert!((sum(&unfolded(&red_green)) - 1.0).abs() < 1e-6);
            let total: f64 = blue_yellow.iter().map(|kernel| sum(&unfolded(kernel)).powi(2)).sum();
            assert!((total - 1.0).abs() < 1e-6, "{total} at {pixels_per_degree}");
        }
    }

    #[test]
    fn the_blue_yellow_filter_is_the_papers_sum_in_two_dimensions() {
        let ppd = 67.020_645;
        let kernels = SensitivityKernels::new(ppd).blue_yellow.each_ref().map(unfolded);
        let radius = (kernels[0].len() / 2) as i32;
        assert_eq!(radius, 10, "3 * sqrt(0.04 / 2) / pi * 67.02 is 9.05");
        let plain = |x: i32, y: i32| -> f64 {
            let squared = f64::from(x * x + y * y) / (ppd * ppd);
            BLUE_YELLOW.iter().map(|(a, b)| a * (PI / b).sqrt() * (-PI * PI * squared / b).exp()).sum()
        };
        let total: f64 = (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| plain(x, y))).sum();
        for (x, y) in [(0, 0), (3, -5), (10, 0), (-10, 10)] {
            let at = |offset: i32| (offset + radius) as usize;
            let found: f64 = kernels.iter().map(|kernel| kernel[at(x)] * kernel[at(y)]).sum();
            assert!((found - plain(x, y) / total).abs() < 1e-8, "{found} at ({x}, {y})");
        }
    }

    #[test]
    fn feature_kernels_are_a_gaussian_and_its_derivatives() {
        for pixels_per_degree in [1.0, 30.0, 67.020_645, 200.0] {
            let FeatureKernels { blur, edge, point } = FeatureKernels::new(pixels_per_degree);
            let positive = |weights: &[f64]| weights.iter().map(|weight| weight.max(0.0)).sum::<f64>();
            let [blur, edge, point] = [blur, edge, point].map(|kernel| unfolded(&kernel));
            assert!((sum(&blur) - 1.0).abs() < 1e-6);
            assert!((positive(&edge) - 1.0).abs() < 1e-6 && sum(&edge).abs() < 1e-6);
            assert!((positive(&point) - 1.0).abs() < 1e-6 && sum(&point).abs() < 1e-6);
            assert!(edge.iter().zip(edge.iter().rev()).all(|(a, b)| *a == -b));
        }
    }

    #[test]
    fn rows_and_columns_are_filtered_alike() {
        let kernel = FeatureKernels::new(20.0).edge;
        let (width, height, margin) = (5, 4, 3);
        let value = |x: usize, y: usize| ((x * x + 3 * y) % 7) as f32;
        let padded = |value: &dyn Fn(usize, usize) -> f32, width: usize, height: usize| -> Vec<f32> {
            let rows = 0..height + 2 * margin;
            rows.flat_map(|y| (0..width + 2 * margin).map(move |x| value(x, y))).collect()
        };
        let values = padded(&value, width, height);
        let transposed = padded(&|x, y| value(y, x), height, width);
        let rows = Margined { values: &values, width, height, margin }.along_rows(&kernel);
        // Columns of the transposed picture; what `along_rows` would have made is the picture without its side margins.
        let inner: Vec<f32> =
            transposed.chunks_exact(height + 2 * margin).flat_map(|row| &row[margin..][..height]).copied().collect();
        let mut columns = vec![0.0; width * height];
        let swapped = Margined { values: &transposed, width: height, height: width, margin };
        swapped.add_along_columns(&inner, &kernel, &mut columns);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            assert_eq!(rows[(y + margin) * width + x], columns[x * height + y]);
        }
    }
}
