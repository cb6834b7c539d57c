//! Pixel filters as settings name them.

use crate::settings::{Filter, FilterKind};
use lightcuts_kernel::filter::{
    FILTER_BOX, FILTER_GAUSSIAN, FILTER_MITCHELL, FILTER_TRIANGLE, PixelFilter, filter_weight,
};

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

    /// Weight of a sample `x` pixels to the right of and `y` pixels above a pixel's centre.
    pub(crate) fn weight(&self, x: f32, y: f32) -> f32 {
        filter_weight(&self.pixel_filter(), x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::filter::mitchell;

    fn filter(kind: FilterKind) -> Filter {
        Filter { kind, ..Filter::default() }
    }

    #[test]
    fn a_sample_on_a_border_belongs_to_one_pixel() {
        let f = filter(FilterKind::Box);
        assert_eq!((f.weight(-0.5, 0.0), f.weight(0.5, 0.0)), (1.0, 0.0));
    }

    #[test]
    fn filters_fall_off_and_end() {
        for kind in [FilterKind::Triangle, FilterKind::Gaussian, FilterKind::Mitchell] {
            let f = filter(kind);
            let r = f.resolved_radius();
            assert!(f.weight(0.0, 0.0) > f.weight(0.4, 0.0) && f.weight(0.4, 0.0) > 0.0, "{kind:?}");
            assert!(f.weight(r * 0.999, 0.0).abs() < 2e-3 && f.weight(r, 0.0) == 0.0, "{kind:?}");
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
