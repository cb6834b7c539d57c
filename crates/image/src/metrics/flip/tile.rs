//! The errors of one rectangle of the pictures.

use super::color::{ColorDifference, opponent, perceived};
use super::exposure::Development;
use super::filter::{FeatureKernels, Kernel, Margined, SensitivityKernels};
use crate::Image;

/// A tile is wide for vector instructions; its planes, margins included, fit a core's cache.
pub(super) const TILE_WIDTH: usize = 256;
pub(super) const TILE_HEIGHT: usize = 128;

/// A rectangle of pixels inside a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Region {
    /// The tiles of a picture, in rows from the top.
    pub(super) fn tiles(width: usize, height: usize) -> Vec<Self> {
        let columns = move || (0..width).step_by(TILE_WIDTH);
        let corners = (0..height).step_by(TILE_HEIGHT).flat_map(|y| columns().map(move |x| (x, y)));
        corners
            .map(|(x, y)| Self { x, y, width: TILE_WIDTH.min(width - x), height: TILE_HEIGHT.min(height - y) })
            .collect()
    }
}

/// FLIP's filters and constants for one display.
#[derive(Clone, Debug)]
pub(super) struct Evaluator {
    sensitivity: SensitivityKernels,
    features: FeatureKernels,
    color_difference: ColorDifference,
    margin: usize,
}

/// What a viewer sees at each pixel of a region.
struct Seen {
    /// Filtered opponent channels: achromatic, red-green, blue-yellow.
    channels: [Vec<f32>; 3],
    /// Strength of edges.
    edges: Vec<f32>,
    /// Strength of points.
    points: Vec<f32>,
}

impl Evaluator {
    /// For a display of that many pixels per degree of the visual field.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let sensitivity = SensitivityKernels::new(pixels_per_degree);
        let features = FeatureKernels::new(pixels_per_degree);
        let SensitivityKernels { achromatic, red_green, blue_yellow: [wide, narrow] } = &sensitivity;
        let FeatureKernels { blur, edge, point } = &features;
        let kernels = [achromatic, red_green, wide, narrow, blur, edge, point];
        let margin = kernels.map(Kernel::radius).into_iter().fold(0, usize::max);
        Self { sensitivity, features, color_difference: ColorDifference::new(), margin }
    }

    /// The greatest error of each pixel of the region over all developments, row by row.
    pub(super) fn greatest_errors(
        &self,
        reference: &Image,
        test: &Image,
        region: Region,
        developments: &[Development],
    ) -> Vec<f32> {
        let mut greatest = vec![0.0_f32; region.width * region.height];
        for development in developments {
            let [reference, test] = [reference, test].map(|image| self.see(image, region, *development));
            for (i, greatest) in greatest.iter_mut().enumerate() {
                *greatest = greatest.max(self.error(&reference, &test, i));
            }
        }
        greatest
    }

    /// The error of pixel `i` (2020, feature difference and final difference).
    fn error(&self, reference: &Seen, test: &Seen, i: usize) -> f32 {
        let [reference_color, test_color] =
            [reference, test].map(|seen| perceived(seen.channels.each_ref().map(|channel| channel[i])));
        let color = self.color_difference.of(reference_color, test_color);
        let edge = (reference.edges[i] - test.edges[i]).abs();
        let point = (reference.points[i] - test.points[i]).abs();
        let feature = (std::f32::consts::FRAC_1_SQRT_2 * edge.max(point)).sqrt();
        // Rounding may lift both a little above 1.
        color.powf((1.0 - feature).max(0.0)).min(1.0)
    }

    fn see(&self, image: &Image, region: Region, development: Development) -> Seen {
        let planes = self.opponent_planes(image, region, development);
        let [y, cx, cz] = planes.each_ref().map(|values| Margined {
            values,
            width: region.width,
            height: region.height,
            margin: self.margin,
        });
        let SensitivityKernels { achromatic, red_green, blue_yellow } = &self.sensitivity;
        let mut blue_yellow_filtered = vec![0.0; region.width * region.height];
        for kernel in blue_yellow {
            cz.add_along_columns(&cz.along_rows(kernel), kernel, &mut blue_yellow_filtered);
        }
        let FeatureKernels { blur, edge, point } = &self.features;
        let blurred = y.along_rows(blur);
        let columns = |rows: &[f32], kernel| columns_of(&y, rows, kernel);
        Seen {
            channels: [
                columns(&y.along_rows(achromatic), achromatic),
                columns_of(&cx, &cx.along_rows(red_green), red_green),
                blue_yellow_filtered,
            ],
            edges: magnitudes(columns(&y.along_rows(edge), blur), &columns(&blurred, edge)),
            points: magnitudes(columns(&y.along_rows(point), blur), &columns(&blurred, point)),
        }
    }

    /// The opponent channels of the region with its margin; beyond the picture its outermost pixels go on.
    fn opponent_planes(&self, image: &Image, region: Region, development: Development) -> [Vec<f32>; 3] {
        let inside = |position: usize, length: usize| position.saturating_sub(self.margin).min(length - 1);
        let mut planes =
            [(); 3].map(|()| Vec::with_capacity((region.width + 2 * self.margin) * (region.height + 2 * self.margin)));
        for y in region.y..region.y + region.height + 2 * self.margin {
            let row = image.row(inside(y, image.height()));
            for x in region.x..region.x + region.width + 2 * self.margin {
                let channels = opponent(development.linear(row[inside(x, row.len())]));
                planes.iter_mut().zip(channels).for_each(|(plane, channel)| plane.push(channel));
            }
        }
        planes
    }
}

fn columns_of(plane: &Margined<'_>, rows: &[f32], kernel: &Kernel) -> Vec<f32> {
    let mut filtered = vec![0.0; plane.width * plane.height];
    plane.add_along_columns(rows, kernel, &mut filtered);
    filtered
}

/// Lengths of the vectors with these components.
fn magnitudes(mut x: Vec<f32>, y: &[f32]) -> Vec<f32> {
    for (x, y) in x.iter_mut().zip(y) {
        *x = (*x * *x + y * y).sqrt();
    }
    x
}
