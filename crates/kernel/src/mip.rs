//! Images of the physical model: half floats of linear light, with all their mip levels.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// Where an image lies in the words of all images. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct MipImage {
    /// First word of level 0; each level follows the one before, each pixel is two words.
    pub first: u32,
    /// Width of level 0 in pixels.
    pub width: u32,
    /// Height of level 0 in pixels.
    pub height: u32,
    /// Number of levels: each has half the width and height of the one before, rounded down, at least 1.
    pub levels: u32,
    /// Whether it has an alpha channel that says something.
    pub has_alpha: u32,
    /// Unused.
    pub padding: [u32; 3],
}

/// A half float's value.
pub fn half_to_float(bits: u32) -> f32 {
    // The exponent is moved by a multiplication, which is right for subnormals too; images hold no infinities.
    let magnitude = f32::from_bits((bits & 0x7fff) << 13) * f32::from_bits(0x7780_0000);
    if bits & 0x8000 != 0 { -magnitude } else { magnitude }
}

/// A pixel of a level, coordinates repeated without end.
pub fn mip_texel(words: &[u32], first: u32, width: u32, height: u32, x: i32, y: i32) -> Vec4 {
    let (x, y) = (x.rem_euclid(width as i32) as u32, y.rem_euclid(height as i32) as u32);
    let at = (first + 2 * (y * width + x)) as usize;
    let (rg, ba) = (words[at], words[at + 1]);
    Vec4::new(half_to_float(rg & 0xffff), half_to_float(rg >> 16), half_to_float(ba & 0xffff), half_to_float(ba >> 16))
}

/// Bilinear between the pixels of a level. `uv` runs to the right and up, once over the image in 0..1.
pub fn mip_bilinear(words: &[u32], image: &MipImage, level: u32, uv: [f32; 2]) -> Vec4 {
    let (mut first, mut width, mut height) = (image.first, image.width, image.height);
    for _ in 0..level {
        first += 2 * width * height;
        width = (width / 2).max(1);
        height = (height / 2).max(1);
    }
    // Wrapped first, so that far coordinates keep their precision and integers hold them.
    let wrap = |c: f32| c - c.floor();
    let x = wrap(uv[0]) * width as f32 - 0.5;
    let y = wrap(1.0 - uv[1]) * height as f32 - 0.5;
    if !x.is_finite() || !y.is_finite() {
        return Vec4::ZERO;
    }
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let at = |dx: i32, dy: i32| mip_texel(words, first, width, height, x0 as i32 + dx, y0 as i32 + dy);
    let upper = at(0, 0) * (1.0 - fx) + at(1, 0) * fx;
    let lower = at(0, 1) * (1.0 - fx) + at(1, 1) * fx;
    upper * (1.0 - fy) + lower * fy
}

/// The image over a footprint whose edge is `width` times that of the image: trilinear (Williams 1983).
pub fn mip_sample(words: &[u32], image: &MipImage, uv: [f32; 2], width: f32) -> Vec4 {
    let texels = width * image.width.max(image.height) as f32;
    if texels <= 1.0 || image.levels == 1 {
        return mip_bilinear(words, image, 0, uv);
    }
    let level = crate::power::log2_polynomial(texels.min(1e9)).min((image.levels - 1) as f32);
    let below = (level as u32).min(image.levels - 2);
    let t = level - below as f32;
    mip_bilinear(words, image, below, uv) * (1.0 - t) + mip_bilinear(words, image, below + 1, uv) * t
}

/// A normal in tangent space from a pixel of a normal map; (0, 0, 1) where it holds none.
pub fn decode_normal(pixel: Vec3) -> Vec3 {
    let normal = pixel * 2.0 - 1.0;
    let length = normal.length();
    if normal.z <= 0.0 || length < 1e-6 { Vec3::Z } else { normal * (1.0 / length) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_have_their_values() {
        for (bits, value) in
            [(0, 0.0), (0x3c00, 1.0), (0xc000, -2.0), (0x3555, 0.333_251_95), (1, 5.960_464_5e-8), (0x7bff, 65504.0)]
        {
            assert_eq!(half_to_float(bits), value, "{bits:x}");
        }
    }

    /// Two by two pixels: black, red / green, blue, with their mean as level 1.
    fn image() -> (MipImage, Vec<u32>) {
        let one = 0x3c00;
        let quarter = 0x3400;
        let words = vec![0, 0, one, 0, one << 16, 0, 0, one, quarter | quarter << 16, quarter];
        (MipImage { width: 2, height: 2, levels: 2, ..MipImage::zeroed() }, words)
    }

    #[test]
    fn the_image_is_upright_and_repeats() {
        let (image, words) = image();
        let at = |u, v| mip_sample(&words, &image, [u, v], 0.0).truncate();
        assert_eq!([at(0.75, 0.75), at(0.25, 0.25), at(0.75, 0.25)], [Vec3::X, Vec3::Y, Vec3::Z]);
        assert_eq!(at(3.75, -1.25), Vec3::X);
        assert_eq!(at(0.5, 0.75), Vec3::X * 0.5);
        assert_eq!(at(f32::NAN, 0.0), Vec3::ZERO);
    }

    #[test]
    fn a_wide_footprint_sees_the_mean() {
        let (image, words) = image();
        assert_eq!(mip_sample(&words, &image, [0.1, 0.9], 8.0).truncate(), Vec3::splat(0.25));
        let half = mip_sample(&words, &image, [0.75, 0.75], 2.0_f32.sqrt() / 2.0).truncate();
        assert!((half - (Vec3::X + Vec3::splat(0.25)) / 2.0).length() < 1e-6, "{half}");
    }

    #[test]
    fn normal_maps_point_outwards() {
        assert_eq!(decode_normal(Vec3::new(0.5, 0.5, 1.0)), Vec3::Z);
        assert_eq!(decode_normal(Vec3::ZERO), Vec3::Z);
        assert!((decode_normal(Vec3::new(1.0, 0.5, 1.0)) - Vec3::new(1.0, 0.0, 1.0).normalize()).length() < 1e-6);
    }
}
