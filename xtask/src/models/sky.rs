//! A clear sky in longitude and latitude as a Radiance picture: a gradient, a glow about the sun, the sun itself, a dull ground.

use anyhow::{Context as _, Result};
use bytemuck::Zeroable as _;
use glam::Vec3;
use lightcuts_kernel::environment::{Environment, environment_direction};
use lightcuts_kernel::power::power;
use std::fs;
use std::path::Path;

/// Name of the file.
const FILE: &str = "sky.hdr";
const WIDTH: u32 = 256;
const HEIGHT: u32 = 128;
/// Samples across a pixel, for the rim of the sun.
const SAMPLES: u32 = 4;

/// Radiances, in W per square unit and steradian.
const ZENITH: Vec3 = Vec3::new(0.13, 0.27, 0.62);
const HORIZON: Vec3 = Vec3::new(0.62, 0.68, 0.74);
const GROUND: Vec3 = Vec3::new(0.16, 0.14, 0.12);
const GLOW: Vec3 = Vec3::new(1.5, 1.1, 0.7);
/// Together with its size it gives an irradiance of about 3.5 in red.
const SUN: Vec3 = Vec3::new(920.0, 800.0, 610.0);
/// Cosine of the sun's radius of 2 degrees: larger than life, so that its pixels are a disk.
const SUN_COS: f32 = 0.999_39;
/// Towards the sun, at 35 degrees above the horizon.
const SUN_DIRECTION: Vec3 = Vec3::new(0.0, 0.573_576, -0.819_152);

/// Writes the picture into a folder.
pub(super) fn write(directory: &Path) -> Result<()> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n").into_bytes();
    for (row, column) in (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| (row, column))) {
        bytes.extend(rgbe(pixel(column, row)));
    }
    let path = directory.join(FILE);
    fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

/// Mean radiance of a pixel.
fn pixel(column: u32, row: u32) -> Vec3 {
    let straight = Environment { cos: 1.0, width: WIDTH, height: HEIGHT, ..Environment::zeroed() };
    let place = |i: u32, k: u32, of: u32| (i as f32 + (k as f32 + 0.5) / SAMPLES as f32) / of as f32;
    let radiances = (0..SAMPLES * SAMPLES).map(|k| {
        let place = [place(column, k % SAMPLES, WIDTH), place(row, k / SAMPLES, HEIGHT)];
        radiance(environment_direction(&straight, place).0)
    });
    radiances.sum::<Vec3>() / (SAMPLES * SAMPLES) as f32
}

fn radiance(direction: Vec3) -> Vec3 {
    if direction.y < 0.0 {
        return GROUND;
    }
    let to_sun = direction.dot(SUN_DIRECTION);
    let sky = HORIZON.lerp(ZENITH, direction.y.sqrt());
    let glow = GLOW * power(to_sun.clamp(0.0, 1.0), 24.0);
    sky + glow + if to_sun >= SUN_COS { SUN } else { Vec3::ZERO }
}

/// Three mantissas of 8 bits with a common exponent (Ward 1991).
fn rgbe(color: Vec3) -> [u8; 4] {
    let (mut exponent, mut scale) = (128_u8, 1.0_f32);
    while color.max_element() >= scale {
        (exponent, scale) = (exponent + 1, scale * 2.0);
    }
    while color.max_element() < scale * 0.5 {
        (exponent, scale) = (exponent - 1, scale * 0.5);
    }
    let [r, g, b] = (color * (256.0 / scale)).to_array().map(|c| c as u8);
    [r, g, b, exponent]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_survive_their_encoding() {
        for color in [ZENITH, SUN, GROUND, Vec3::ONE] {
            let [r, g, b, exponent] = rgbe(color);
            let scale = 2.0_f32.powi(i32::from(exponent) - 136);
            let again = Vec3::new(f32::from(r), f32::from(g), f32::from(b)) * scale;
            assert!((again - color).abs().max_element() <= color.max_element() / 128.0, "{color} {again}");
        }
    }

    #[test]
    fn the_sun_gives_the_irradiance_that_is_said() {
        let solid_angle = 2.0 * std::f32::consts::PI * (1.0 - SUN_COS);
        assert!((SUN.x * solid_angle - 3.5).abs() < 0.1, "{}", SUN.x * solid_angle);
    }
}
