//! From code values to luminance and colour.

/// Linear RGB to CIE XYZ, D65, row by row: the primaries of Adobe RGB (1998), which Yee 2004 takes for the display's.
const TO_XYZ: [[f32; 3]; 3] =
    [[0.576_700, 0.185_556, 0.188_212], [0.297_361, 0.627_355, 0.075_284_7], [0.027_032_8, 0.070_687_9, 0.991_248]];

/// Reads pixels of code values.
pub(super) struct Decoder {
    gamma: f32,
    swap_red_blue: bool,
    codes: [f32; 256],
    decoded: [f32; 256],
}

impl Decoder {
    /// For a display that makes light `code^gamma` of code values in 0..=1.
    pub(super) fn new(gamma: f32, swap_red_blue: bool) -> Self {
        let codes: [f32; 256] = std::array::from_fn(|code| code as f32 / 255.0);
        Self { gamma, swap_red_blue, codes, decoded: codes.map(|code| code.powf(gamma)) }
    }

    /// The CIE Y of a pixel, 1 for white.
    pub(super) fn luminance(&self, pixel: [f32; 3]) -> f32 {
        dot(TO_XYZ[1], self.linear(pixel))
    }

    /// The a* and b* of CIE L*a*b*.
    pub(super) fn chroma(&self, pixel: [f32; 3]) -> [f32; 2] {
        let rgb = self.linear(pixel);
        let [x, y, z] = TO_XYZ.map(|row| compressed(dot(row, rgb) / (row[0] + row[1] + row[2])));
        [500.0 * (x - y), 200.0 * (y - z)]
    }

    fn linear(&self, [red, green, blue]: [f32; 3]) -> [f32; 3] {
        let [red, green, blue] = [self.decode(red), self.decode(green), self.decode(blue)];
        if self.swap_red_blue { [blue, green, red] } else { [red, green, blue] }
    }

    /// From a table where the value is one of 8 bits: a power costs more than all the rest of a pixel.
    fn decode(&self, value: f32) -> f32 {
        let nearest = usize::from((value * 255.0 + 0.5) as u8);
        if self.codes[nearest] == value {
            return self.decoded[nearest];
        }
        // `max` before `min`: it is what turns a NaN into 0.
        #[allow(clippy::manual_clamp)]
        let clamped = value.max(0.0).min(1.0);
        clamped.powf(self.gamma)
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cube root of CIE L*a*b*, with its straight part near black (CIE 15:2004, with exact constants).
fn compressed(ratio: f32) -> f32 {
    const BEND: f32 = (216.0 / 24_389.0) as f32;
    const SLOPE: f32 = (24_389.0 / 27.0) as f32;
    if ratio > BEND { ratio.powf(1.0 / 3.0) } else { (SLOPE * ratio + 16.0) / 116.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greys_have_no_colour_and_white_has_luminance_one() {
        let decoder = Decoder::new(2.2, false);
        assert!((decoder.luminance([1.0; 3]) - 1.0).abs() < 1e-4);
        assert_eq!(decoder.luminance([0.0; 3]), 0.0);
        for code in [0.0, 0.01, 0.3, 128.0 / 255.0, 1.0] {
            assert!(decoder.chroma([code; 3]).iter().all(|value| value.abs() < 1e-3));
        }
    }

    #[test]
    fn primaries_of_adobe_rgb() {
        // From the standard's chromaticities (0.64, 0.33), (0.21, 0.71), (0.15, 0.06) and white (0.3127, 0.3290).
        let expected = [
            ([1.0, 0.0, 0.0], [89.561, 75.150]),
            ([0.0, 1.0, 0.0], [-137.973, 90.836]),
            ([0.0, 0.0, 1.0], [80.313, -109.377]),
        ];
        let (plain, swapped) = (Decoder::new(2.2, false), Decoder::new(2.2, true));
        for (rgb, chroma) in expected {
            let found = plain.chroma(rgb);
            assert!((0..2).all(|i| (found[i] - chroma[i]).abs() < 0.05), "{rgb:?}: {found:?} {chroma:?}");
            let [r, g, b] = rgb;
            assert_eq!(swapped.chroma([b, g, r]), found);
            assert_eq!(swapped.luminance([b, g, r]), plain.luminance(rgb));
        }
    }

    #[test]
    fn the_table_holds_what_the_power_gives() {
        let decoder = Decoder::new(1.8, false);
        for code in 0..=255_u8 {
            let value = f32::from(code) / 255.0;
            assert_eq!(decoder.decode(value), value.powf(1.8));
            let between = (f32::from(code) + 0.25) / 255.5;
            assert_eq!(decoder.decode(between), between.powf(1.8));
        }
        for (value, expected) in [(f32::NAN, 0.0), (-1.0, 0.0), (f32::INFINITY, 1.0), (3.0, 1.0)] {
            assert_eq!(decoder.decode(value), expected);
        }
    }
}
