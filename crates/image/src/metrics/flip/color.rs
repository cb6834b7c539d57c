//! Colours as FLIP sees them: an opponent space for filtering, and Lab with the Hunt effect for differences.

/// Linear RGB to XYZ relative to white, for the sRGB primaries and the white point (0.31271, 0.32902); rows sum to 1.
const RGB_TO_XYZ: [[f32; 3]; 3] = [
    [0.433_895_39, 0.376_242_37, 0.189_862_24],
    [0.212_636_82, 0.715_182_98, 0.072_180_2],
    [0.017_752_423, 0.109_465_63, 0.872_781_95],
];

/// Inverse of [`RGB_TO_XYZ`]; rows sum to 1.
const XYZ_TO_RGB: [[f32; 3]; 3] = [
    [3.080_342, -1.537_399, -0.542_943],
    [-0.921_178_4, 1.875_93, 0.045_248_41],
    [0.052_881_293, -0.204_011_21, 1.151_129_9],
];

/// Compresses large colour distances (2020, error redistribution: q_c).
const COMPRESSION: f32 = 0.7;

/// Share of the greatest distance that is mapped to [`KNEE_VALUE`] (p_c), and that value (p_t).
const KNEE: f32 = 0.4;
const KNEE_VALUE: f32 = 0.95;

/// Linear RGB to the opponent channels of YCxCz: achromatic, red-green, blue-yellow, each without its scale.
///
/// The scales of the paper, `116 y - 16`, `500 (x - y)` and `200 (y - z)`, change nothing here: each channel is filtered
/// on its own with weights that sum to 1.
pub(super) fn opponent(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = transform(&RGB_TO_XYZ, rgb);
    [y, x - y, y - z]
}

/// Inverse of [`opponent`], clamped to the colours 0..=1 that a display has.
fn displayable([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    transform(&XYZ_TO_RGB, [y + cx, y, y - cz]).map(|value| value.clamp(0.0, 1.0))
}

fn transform(matrix: &[[f32; 3]; 3], vector: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// Filtered opponent channels to Lab, with chroma that grows with lightness: the Hunt effect (2020, perceptually uniform colour space).
pub(super) fn perceived(opponent: [f32; 3]) -> [f32; 3] {
    hunt(lab(displayable(opponent)))
}

/// CIE 1976 L*a*b* of linear RGB 0..=1.
fn lab(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = transform(&RGB_TO_XYZ, rgb).map(cube_root_or_line);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn cube_root_or_line(value: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if value > DELTA * DELTA * DELTA { value.cbrt() } else { value / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

fn hunt([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    [lightness, 0.01 * lightness * a, 0.01 * lightness * b]
}

/// City-block distance between lightnesses and chromaticities, the latter Euclidean: HyAB (2020, colour metric).
fn hyab(p: [f32; 3], q: [f32; 3]) -> f32 {
    let [lightness, a, b] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    lightness.abs() + (a * a + b * b).sqrt()
}

/// Maps distances of perceived colours to 0..=1.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColorDifference {
    /// Compressed distance between green and blue, the greatest of a display.
    greatest: f32,
}

impl ColorDifference {
    pub(super) fn new() -> Self {
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt(lab(rgb)));
        Self { greatest: hyab(green, blue).powf(COMPRESSION) }
    }

    /// Difference 0..=1 of two colours from [`perceived`] (2020, error redistribution).
    pub(super) fn of(self, reference: [f32; 3], test: [f32; 3]) -> f32 {
        let distance = hyab(reference, test).powf(COMPRESSION);
        let knee = KNEE * self.greatest;
        if distance < knee {
            distance * (KNEE_VALUE / knee)
        } else {
            KNEE_VALUE + (distance - knee) / (self.greatest - knee) * (1.0 - KNEE_VALUE)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrices_are_inverse_and_white_stays_white() {
        for i in 0..3 {
            let mut unit = [0.0; 3];
            unit[i] = 1.0;
            let back = transform(&XYZ_TO_RGB, transform(&RGB_TO_XYZ, unit));
            assert!(back.iter().zip(unit).all(|(a, b)| (a - b).abs() < 1e-6), "{back:?}");
        }
        let [y, cx, cz] = opponent([1.0; 3]);
        assert!((y - 1.0).abs() < 1e-6 && cx.abs() < 1e-6 && cz.abs() < 1e-6);
    }

    #[test]
    fn lab_of_known_colours() {
        // CIE 15: Y of 0.1842 is L* 50; red of sRGB has L* 53.2, a* 80.1, b* 67.2 (its white point is a little other).
        assert!((lab([0.184_186_5; 3])[0] - 50.0).abs() < 1e-3);
        let red = lab([1.0, 0.0, 0.0]);
        assert!(red.iter().zip([53.24, 80.09, 67.20]).all(|(a, b)| (a - b).abs() < 0.15), "{red:?}");
    }

    #[test]
    fn green_and_blue_differ_by_one_and_the_knee_is_continuous() {
        let difference = ColorDifference::new();
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| perceived(opponent(rgb)));
        assert!((difference.of(green, blue) - 1.0).abs() < 1e-5);
        let knee = (KNEE * difference.greatest).powf(1.0 / COMPRESSION);
        let [below, above] = [0.9999, 1.0001].map(|s| difference.of([0.0; 3], [s * knee, 0.0, 0.0]));
        assert!((below - KNEE_VALUE).abs() < 1e-3 && (above - KNEE_VALUE).abs() < 1e-3 && below < above);
        assert_eq!(difference.of(green, green), 0.0);
    }
}
