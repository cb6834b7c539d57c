//! Colours of other primaries as linear Rec. 709.

use std::fmt;

use crate::Image;
use rayon::prelude::*;

/// A matrix in rows.
pub(crate) type Matrix = [[f64; 3]; 3];

/// Chromaticities that differ by less than this are one: files hold them rounded to three or four digits.
const TOLERANCE: f64 = 1e-3;
/// A determinant below this is that of primaries on one line; those of real sets are above 0.05.
const LEAST_DETERMINANT: f64 = 1e-6;
/// From XYZ to the responses that Bradford's adaptation scales (Lam 1985; as in ICC.1:2022, annex E).
const BRADFORD: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

/// CIE 1931 chromaticities (x, y) of red, green, blue and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Primaries {
    pub(crate) red: [f64; 2],
    pub(crate) green: [f64; 2],
    pub(crate) blue: [f64; 2],
    pub(crate) white: [f64; 2],
}

impl Primaries {
    /// ITU-R BT.709, white D65.
    pub(crate) const REC_709: Self =
        Self { red: [0.64, 0.33], green: [0.30, 0.60], blue: [0.15, 0.06], white: [0.3127, 0.3290] };

    /// Of eight numbers: x and y of red, green, blue, white.
    pub(crate) fn new([rx, ry, gx, gy, bx, by, wx, wy]: [f64; 8]) -> Self {
        Self { red: [rx, ry], green: [gx, gy], blue: [bx, by], white: [wx, wy] }
    }

    fn numbers(&self) -> [f64; 8] {
        let ([rx, ry], [gx, gy], [bx, by], [wx, wy]) = (self.red, self.green, self.blue, self.white);
        [rx, ry, gx, gy, bx, by, wx, wy]
    }

    /// Whether both sets are one, but for rounding.
    pub(crate) fn is_near(&self, other: &Self) -> bool {
        self.numbers().iter().zip(other.numbers()).all(|(a, b)| (a - b).abs() < TOLERANCE)
    }

    /// From RGB of these primaries to XYZ, white having Y = 1. `None` where they span no space of colours.
    pub(crate) fn to_xyz(self) -> Option<Matrix> {
        let full = |[x, y]: [f64; 2]| [x, y, 1.0 - x - y];
        let columns = transposed([self.red, self.green, self.blue].map(full));
        let [x, y] = self.white;
        let is_finite = self.numbers().iter().all(|number| number.is_finite());
        if !is_finite || y < LEAST_DETERMINANT || determinant(columns).abs() < LEAST_DETERMINANT {
            return None;
        }
        let scales = applied(inverse(columns), [x / y, 1.0, (1.0 - x - y) / y]);
        let spans = scales.iter().all(|scale| scale.is_finite() && scale.abs() > LEAST_DETERMINANT);
        spans.then(|| columns.map(|row| std::array::from_fn(|column| row[column] * scales[column])))
    }

    /// From linear RGB of these primaries to linear Rec. 709: their white becomes D65 by Bradford's adaptation, so that grey
    /// stays grey. `None` where they span no space of colours.
    pub(crate) fn to_rec_709(self) -> Option<Matrix> {
        let to_xyz = self.to_xyz()?;
        let from_xyz = inverse(Self::REC_709.to_xyz()?);
        Some(product(from_xyz, product(adaptation(self.white, Self::REC_709.white), to_xyz)))
    }
}

impl fmt::Display for Primaries {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = |[x, y]: [f64; 2]| format!("{x:.4} {y:.4}");
        let [red, green, blue, white] = [self.red, self.green, self.blue, self.white].map(told);
        write!(formatter, "red {red}, green {green}, blue {blue}, white {white}")
    }
}

/// From XYZ under one white to XYZ under another (Bradford).
fn adaptation(from: [f64; 2], to: [f64; 2]) -> Matrix {
    let response = |[x, y]: [f64; 2]| applied(BRADFORD, [x / y, 1.0, (1.0 - x - y) / y]);
    let (from, to) = (response(from), response(to));
    let scaled = std::array::from_fn(|row| BRADFORD[row].map(|value| value * to[row] / from[row]));
    product(inverse(BRADFORD), scaled)
}

/// A matrix times a column.
pub(crate) fn applied(matrix: Matrix, [a, b, c]: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * a + row[1] * b + row[2] * c)
}

/// Applies `matrix` to every pixel.
pub(crate) fn convert(image: &mut Image, matrix: &Matrix) {
    let of_pixel = |pixel: [f32; 3]| applied(*matrix, pixel.map(f64::from)).map(|value| value as f32);
    image.pixels_mut().par_iter_mut().for_each(|pixel| *pixel = of_pixel(*pixel));
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    let b = transposed(b);
    a.map(|row| b.map(|column| row.iter().zip(column).map(|(a, b)| a * b).sum()))
}

fn transposed(m: Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| m[column][row]))
}

fn determinant(m: Matrix) -> f64 {
    (0..3).map(|i| m[0][i] * cofactor(m, 0, i)).sum()
}

/// With its sign: rows and columns are counted round.
fn cofactor(m: Matrix, row: usize, column: usize) -> f64 {
    let at = |down: usize, right: usize| m[(row + down) % 3][(column + right) % 3];
    at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
}

/// Of a matrix whose determinant is not 0.
pub(crate) fn inverse(m: Matrix) -> Matrix {
    let determinant = determinant(m);
    std::array::from_fn(|row| std::array::from_fn(|column| cofactor(m, column, row) / determinant))
}

#[cfg(test)]
mod tests {
    use super::*;

    const AP0: Primaries =
        Primaries { red: [0.7347, 0.2653], green: [0.0, 1.0], blue: [0.0001, -0.077], white: [0.32168, 0.33767] };

    fn near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < tolerance), "{found:?}, {expected:?}");
    }

    /// The matrix of IEC 61966-2-1.
    #[test]
    fn rec_709_is_that_of_its_standard() {
        let found = Primaries::REC_709.to_xyz().unwrap();
        let expected = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        found.into_iter().zip(expected).for_each(|(found, expected)| near(found, expected, 1e-4));
        let same = Primaries::REC_709.to_rec_709().unwrap();
        near(applied(same, [0.2, 0.7, 0.1]), [0.2, 0.7, 0.1], 1e-12);
    }

    /// The matrix that the ACES project publishes with its Bradford adaptation, from AP0 to Rec. 709.
    #[test]
    fn aces_becomes_what_its_authors_publish() {
        let found = AP0.to_rec_709().unwrap();
        let expected =
            [[2.521_69, -1.134_13, -0.387_56], [-0.276_48, 1.372_72, -0.096_24], [-0.015_38, -0.152_98, 1.168_35]];
        found.into_iter().zip(expected).for_each(|(found, expected)| near(found, expected, 5e-4));
        near(applied(found, [0.5; 3]), [0.5; 3], 1e-12);
    }

    #[test]
    fn grey_stays_grey_for_any_primaries() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64
        };
        for _ in 0..1000 {
            let near = |x: f64, y: f64, [a, b]: [f64; 2]| [x + 0.1 * (a - 0.5), y + 0.1 * (b - 0.5)];
            let mut pair = || [random(), random()];
            let primaries = Primaries {
                red: near(0.66, 0.32, pair()),
                green: near(0.22, 0.7, pair()),
                blue: near(0.14, 0.06, pair()),
                white: near(0.32, 0.33, pair()),
            };
            let matrix = primaries.to_rec_709().unwrap();
            let grey = applied(matrix, [0.3; 3]);
            assert!(grey.iter().all(|value| (value - 0.3).abs() < 1e-9), "{primaries}");
        }
    }

    #[test]
    fn what_spans_no_colours_is_refused() {
        let valid = Primaries::REC_709.numbers();
        for (at, value) in [(0, f64::NAN), (3, f64::INFINITY), (7, 0.0), (7, -0.3)] {
            let mut numbers = valid;
            numbers[at] = value;
            assert_eq!(Primaries::new(numbers).to_rec_709(), None, "{at} {value}");
        }
        assert_eq!(Primaries::new([0.0; 8]).to_rec_709(), None);
        // All on one line.
        assert_eq!(Primaries::new([0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.3, 0.4]).to_rec_709(), None);
        // White on the line between two primaries: one of them would have no weight.
        assert_eq!(Primaries::new([0.6, 0.3, 0.3, 0.6, 0.1, 0.1, 0.45, 0.45]).to_rec_709(), None);
    }
}
