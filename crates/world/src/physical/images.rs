//! Images made into half floats of linear light, with their mip levels.

use half::f16;
use lightcuts_kernel::mip::MipImage;
use lightcuts_kernel::power::power;
use lightcuts_scene::physical::{PixelImage, Pixels};

/// Packs all images one after the other.
pub(super) fn pack(images: &[PixelImage]) -> (Vec<MipImage>, Vec<u32>) {
    let mut words = Vec::new();
    let packed = images.iter().map(|image| pack_one(image, &mut words)).collect();
    (packed, words)
}

/// A value in the transfer curve of sRGB (IEC 61966-2-1) as linear light.
pub(super) fn linear(value: u8) -> f32 {
    let v = f32::from(value) / 255.0;
    if v <= 0.040_45 { v / 12.92 } else { power((v + 0.055) / 1.055, 2.4) }
}

fn pack_one(image: &PixelImage, words: &mut Vec<u32>) -> MipImage {
    let first = words.len() as u32;
    let (mut width, mut height) = (image.width as usize, image.height as usize);
    let mut pixels = decoded(&image.pixels);
    let has_alpha = match &image.pixels {
        Pixels::Srgb(pixels) | Pixels::Linear(pixels) => pixels.iter().any(|p| p[3] != 255),
        Pixels::Float(_) => false,
    };
    let mut levels = 1;
    store(&pixels, words);
    while width > 1 || height > 1 {
        (pixels, width, height) = halved(&pixels, width, height);
        store(&pixels, words);
        levels += 1;
    }
    MipImage {
        first,
        width: image.width,
        height: image.height,
        levels,
        has_alpha: u32::from(has_alpha),
        padding: [0; 3],
    }
}

fn decoded(pixels: &Pixels) -> Vec<[f32; 4]> {
    let plain = |v: u8| f32::from(v) / 255.0;
    match pixels {
        Pixels::Srgb(pixels) => {
            let curve: Vec<f32> = (0..=255).map(linear).collect();
            let of = |v: u8| curve[usize::from(v)];
            pixels.iter().map(|&[r, g, b, a]| [of(r), of(g), of(b), plain(a)]).collect()
        }
        Pixels::Linear(pixels) => pixels.iter().map(|p| p.map(plain)).collect(),
        Pixels::Float(pixels) => pixels.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect(),
    }
}

/// Half as wide and high, rounded down: each pixel is the mean of those that it covers, by area (of an odd number the
/// middle one counts in part for both sides).
fn halved(pixels: &[[f32; 4]], width: usize, height: usize) -> (Vec<[f32; 4]>, usize, usize) {
    let (half_width, half_height) = ((width / 2).max(1), (height / 2).max(1));
    let mut made = Vec::with_capacity(half_width * half_height);
    for y in 0..half_height {
        for x in 0..half_width {
            let mut sum = [0.0; 4];
            for (row, of_row) in covered(y, half_height, height) {
                for (column, of_column) in covered(x, half_width, width) {
                    for (s, p) in sum.iter_mut().zip(pixels[row * width + column]) {
                        *s += p * of_row * of_column;
                    }
                }
            }
            made.push(sum);
        }
    }
    (made, half_width, half_height)
}

/// The pixels of `size` that one of `small` covers, with their shares, which add up to 1.
fn covered(index: usize, small: usize, size: usize) -> impl Iterator<Item = (usize, f32)> {
    let scale = size as f32 / small as f32;
    let (from, to) = (index as f32 * scale, (index as f32 + 1.0) * scale);
    (from as usize..size.min(to.ceil() as usize))
        .map(move |k| (k, ((to.min(k as f32 + 1.0) - from.max(k as f32)) / scale).max(0.0)))
}

fn store(pixels: &[[f32; 4]], words: &mut Vec<u32>) {
    let half = |value: f32| u32::from(f16::from_f32(value.min(f16::MAX.to_f32())).to_bits());
    words.extend(pixels.iter().flat_map(|&[r, g, b, a]| [half(r) | half(g) << 16, half(b) | half(a) << 16]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::mip::{mip_bilinear, mip_sample};

    #[test]
    fn every_level_has_the_mean() {
        let pixels: Vec<[u8; 4]> = (0..35_u8).map(|k| [k * 7, 255 - k, 9, 128]).collect();
        let mean = |channel: usize| pixels.iter().map(|p| f32::from(p[channel]) / 255.0).sum::<f32>() / 35.0;
        let image = PixelImage { name: String::new(), width: 7, height: 5, pixels: Pixels::Linear(pixels.clone()) };
        let (packed, words) = pack(&[image.clone(), image]);
        assert_eq!((packed[1].levels, packed[1].has_alpha, words.len()), (3, 1, 2 * 2 * (35 + 6 + 1)));
        for image in &packed {
            let top = mip_bilinear(&words, image, 2, [0.3, 0.9]);
            assert!((top.x - mean(0)).abs() < 1e-3 && (top.w - mean(3)).abs() < 1e-3, "{top}");
            assert_eq!(mip_sample(&words, image, [0.1, 0.1], 1e9), top);
            let corner = mip_bilinear(&words, image, 0, [0.5 / 7.0, 1.0 - 0.5 / 5.0]);
            assert!((corner.y - 1.0).abs() < 1e-3, "{corner}");
        }
    }

    #[test]
    fn the_transfer_curve_is_srgbs() {
        assert_eq!((linear(0), linear(255)), (0.0, 1.0));
        assert!((linear(188) - 0.502_886_5).abs() < 1e-5 && (linear(10) - 10.0 / 255.0 / 12.92).abs() < 1e-7);
        let bright = PixelImage { name: String::new(), width: 1, height: 1, pixels: Pixels::Float(vec![[1e9; 3]]) };
        let (packed, words) = pack(&[bright]);
        assert_eq!(mip_bilinear(&words, &packed[0], 0, [0.5; 2]).x, 65504.0);
    }
}
