//! What an eye resolves: thresholds, sensitivity to contrast, masking. Formulas as Yee 2004 gives them.

/// The smallest difference in luminance that is seen on a field of luminance `adaptation`; both in cd/m2.
///
/// Ward Larson, Rushmeier and Piatko 1997, table 1; the curve has five pieces in log10.
pub(super) fn threshold_versus_intensity(adaptation: f32) -> f32 {
    let log = adaptation.log10();
    let threshold = if log < -3.94 {
        -2.86
    } else if log < -1.44 {
        (0.405 * log + 1.6).powf(2.18) - 2.86
    } else if log < -0.0184 {
        log - 0.395
    } else if log < 1.9 {
        (0.249 * log + 0.65).powf(2.7) - 0.72
    } else {
        log - 1.255
    };
    10_f32.powf(threshold)
}

/// How sensitive an eye is to contrast when it is adapted to one luminance (Barten 1989).
#[derive(Clone, Copy, Debug)]
pub(super) struct ContrastSensitivity {
    scale: f32,
    decay: f32,
}

impl ContrastSensitivity {
    /// Beyond this exponent the sensitivity is below 1e-12 and its factors leave the range of f32.
    const NOTHING_SEEN: f32 = 80.0;

    /// For an eye adapted to `adaptation` cd/m2, above 0.
    pub(super) fn adapted_to(adaptation: f32) -> Self {
        Self { scale: 440.0 * (1.0 + 0.7 / adaptation).powf(-0.2), decay: 0.3 * (1.0 + 100.0 / adaptation).powf(0.15) }
    }

    /// The sensitivity, the inverse of the smallest visible contrast, at `frequency` cycles per degree.
    pub(super) fn at(self, frequency: f32) -> f32 {
        let exponent = self.decay * frequency;
        if exponent > Self::NOTHING_SEEN {
            return 0.0;
        }
        self.scale * frequency * (-exponent).exp() * (1.0 + 0.06 * exponent.exp()).sqrt()
    }
}

/// How much `contrast`, times the sensitivity to it, raises the threshold of what lies over it; 1 or more (Daly 1993).
pub(super) fn masking(contrast: f32) -> f32 {
    let masked = (392.498 * contrast).powf(0.7);
    let raised = (0.0153 * masked).powf(4.0);
    (1.0 + raised).powf(0.25)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_is_nearly_continuous_and_grows_to_weber_s_law() {
        let at = |log: f32| threshold_versus_intensity(10_f32.powf(log));
        for joint in [-3.94, -1.44, -0.0184, 1.9] {
            let (below, above) = (at(joint - 1e-3), at(joint + 1e-3));
            assert!((below / above - 1.0).abs() < 0.04, "{joint}: {below} {above}");
        }
        assert!((-60..40).all(|i| at(i as f32 / 10.0) <= at((i + 1) as f32 / 10.0)));
        assert!((at(3.0) / 1000.0 - 10_f32.powf(-1.255)).abs() < 1e-4, "5.6 % in daylight");
    }

    #[test]
    fn sensitivity_peaks_at_three_cycles_per_degree_and_rises_with_light() {
        let day = ContrastSensitivity::adapted_to(100.0);
        let peak = day.at(3.248);
        assert!((1..600).all(|i| day.at(i as f32 / 10.0) <= peak * 1.000_01));
        let dusk = ContrastSensitivity::adapted_to(0.1);
        assert!(dusk.at(3.248) < peak / 2.0);
    }

    #[test]
    fn sensitivity_stays_a_number_where_nothing_is_seen() {
        for adaptation in [1e-5, 0.1, 100.0, 1e30] {
            let eye = ContrastSensitivity::adapted_to(adaptation);
            for frequency in [0.0, 1.0, 40.0, 300.0, 1e6, f32::INFINITY] {
                let sensitivity = eye.at(frequency);
                assert!(sensitivity >= 0.0 && sensitivity.is_finite(), "{adaptation} {frequency} {sensitivity}");
            }
        }
        assert!(ContrastSensitivity::adapted_to(100.0).at(240.0) < 1e-12);
    }

    #[test]
    fn weak_contrast_masks_nothing_and_strong_contrast_by_its_power() {
        assert_eq!(masking(0.0), 1.0);
        assert!((masking(0.05) - 1.0).abs() < 0.001);
        let (one, two) = (masking(100.0), masking(200.0));
        assert!((two / one - 2_f32.powf(0.7)).abs() < 1e-3);
    }
}
