//! Pixel filters: how much a sample counts for a pixel at some distance.

use crate::settings::{Filter, FilterKind};

impl Filter {
    /// Weight of a sample `x` pixels to the right of and `y` pixels above a pixel's centre. Separable; zero from the
    /// radius on, the box excluding its upper end so that a sample on a border belongs to one pixel.
    pub(crate) fn weight(&self, x: f32, y: f32) -> f32 {
        self.along(x) * self.along(y)
    }

    fn along(&self, x: f32) -> f32 {
        let radius = self.resolved_radius();
        if !(-radius..radius).contains(&x) {
            return 0.0;
        }
        match self.kind {
            FilterKind::Box => 1.0,
            FilterKind::Triangle => radius - x.abs(),
            FilterKind::Gaussian => ((-self.alpha * x * x).exp() - (-self.alpha * radius * radius).exp()).max(0.0),
            FilterKind::Mitchell => self.mitchell(x.abs() * 2.0 / radius),
        }
    }

    /// Mitchell & Netravali 1988, "Reconstruction Filters in Computer Graphics", Eq. 8; x in 0..2.
    fn mitchell(&self, x: f32) -> f32 {
        let (b, c) = (self.mitchell_b, self.mitchell_c);
        let value = if x < 1.0 {
            (12.0 - 9.0 * b - 6.0 * c) * x.powi(3) + (-18.0 + 12.0 * b + 6.0 * c) * x.powi(2) + (6.0 - 2.0 * b)
        } else {
            (-b - 6.0 * c) * x.powi(3)
                + (6.0 * b + 30.0 * c) * x.powi(2)
                + (-12.0 * b - 48.0 * c) * x
                + (8.0 * b + 24.0 * c)
        };
        value / 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let f = filter(FilterKind::Mitchell);
        assert!((f.mitchell(0.999_99) - f.mitchell(1.0)).abs() < 1e-4);
        assert!(f.mitchell(1.5) < 0.0);
        assert!((f.mitchell(0.0) - 16.0 / 18.0).abs() < 1e-6);
    }
}
