//! Pixel filters as settings name them.

use crate::settings::{Filter, FilterKind};
use lightcuts_kernel::filter::{FILTER_BOX, FILTER_GAUSSIAN, FILTER_MITCHELL, FILTER_TRIANGLE, PixelFilter};

impl Filter {
    /// The filter as devices take it.
    pub fn pixel_filter(&self) -> PixelFilter {
        PixelFilter {
            kind: match self.kind {
                FilterKind::Box => FILTER_BOX,
                FilterKind::Triangle => FILTER_TRIANGLE,
                FilterKind::Gaussian => FILTER_GAUSSIAN,
                FilterKind::Mitchell => FILTER_MITCHELL,
            },
            radius: self.resolved_radius(),
            alpha: self.alpha,
            mitchell_b: self.mitchell_b,
            mitchell_c: self.mitchell_c,
            padding: [0; 3],
        }
    }

    /// Pixels beyond its own that a sample can reach, in each direction.
    pub fn border(&self) -> u32 {
        (self.resolved_radius() + 0.5).ceil() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::filter::{filter_weight, mitchell};

    fn filter(kind: FilterKind) -> Filter {
        Filter { kind, ..Filter::default() }
    }

    #[test]
    fn a_sample_on_a_border_belongs_to_one_pixel() {
        let f = filter(FilterKind::Box).pixel_filter();
        assert_eq!((filter_weight(&f, -0.5, 0.0), filter_weight(&f, 0.5, 0.0)), (1.0, 0.0));
    }

    #[test]
    fn filters_fall_off_and_end() {
        for kind in [FilterKind::Triangle, FilterKind::Gaussian, FilterKind::Mitchell] {
            let f = filter(kind).pixel_filter();
            let weight = |x| filter_weight(&f, x, 0.0);
            assert!(weight(0.0) > weight(0.4) && weight(0.4) > 0.0, "{kind:?}");
            assert!(weight(f.radius * 0.999).abs() < 2e-3 && weight(f.radius) == 0.0, "{kind:?}");
        }
    }

    #[test]
    fn mitchell_is_continuous_and_goes_negative() {
        let f = filter(FilterKind::Mitchell).pixel_filter();
        assert!((mitchell(&f, 0.999_99) - mitchell(&f, 1.0)).abs() < 1e-4);
        assert!(mitchell(&f, 1.5) < 0.0);
        assert!((mitchell(&f, 0.0) - 16.0 / 18.0).abs() < 1e-6);
    }
}
