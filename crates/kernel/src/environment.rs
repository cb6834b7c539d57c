//! Light from infinitely far away: an image in longitude and latitude, and directions drawn by its brightness.

use crate::sampling::sin_cos_turns;
use crate::texture::arctangent;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::f32::consts::PI;

/// An environment. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Environment {
    /// Factor on the image's radiance.
    pub radiance: Vec3,
    /// Cosine of the turn about +y.
    pub cos: f32,
    /// Sine of the turn.
    pub sin: f32,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// Unused.
    pub padding: u32,
}

/// An environment with its image: pixels, top row first; and sums of their weights, each list from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub struct EnvironmentMap<'a> {
    /// Factor, turn and size.
    pub record: Environment,
    /// Radiance.
    pub pixels: &'a [[f32; 3]],
    /// Sums over the rows: height + 1 numbers.
    pub rows: &'a [f32],
    /// Sums over the pixels of each row: width + 1 numbers per row.
    pub columns: &'a [f32],
}

/// Where a direction lies in the image: columns from the left and rows from the top, each 0..1.
pub fn environment_place(record: &Environment, direction: Vec3) -> [f32; 2] {
    // Turned back.
    let x = record.cos * direction.x - record.sin * direction.z;
    let z = record.sin * direction.x + record.cos * direction.z;
    let u = 0.5 + arctangent(x, -z) * (0.5 / PI);
    let v = arctangent((x * x + z * z).sqrt(), direction.y) * (1.0 / PI);
    [u, v]
}

/// The direction of a place, with the sine of its angle to +y.
pub fn environment_direction(record: &Environment, place: [f32; 2]) -> (Vec3, f32) {
    let (sin_v, cos_v) = sin_cos_turns(place[1] * 0.5);
    let (sin_u, cos_u) = sin_cos_turns(place[0]);
    // At u = 1/2 towards -z, at 3/4 towards +x.
    let (x, z) = (-sin_v * sin_u, sin_v * cos_u);
    let direction = Vec3::new(record.cos * x + record.sin * z, cos_v, record.cos * z - record.sin * x);
    (direction, sin_v)
}

/// Radiance from a direction: bilinear between pixels.
pub fn environment_radiance(map: &EnvironmentMap<'_>, direction: Vec3) -> Vec3 {
    let (width, height) = (map.record.width as i32, map.record.height as i32);
    let [u, v] = environment_place(&map.record, direction);
    let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (x - x0, y - y0);
    let at = |dx: i32, dy: i32| {
        let column = (x0 as i32 + dx).rem_euclid(width);
        let row = (y0 as i32 + dy).clamp(0, height - 1);
        Vec3::from(map.pixels[(row * width + column) as usize])
    };
    let upper = at(0, 0) * (1.0 - fx) + at(1, 0) * fx;
    let lower = at(0, 1) * (1.0 - fx) + at(1, 1) * fx;
    (upper * (1.0 - fy) + lower * fy) * map.record.radiance
}

/// The interval of a list of sums, from 0 to 1, in which a number lies, and where in it.
pub fn interval_of(sums: &[f32], number: f32) -> (u32, f32) {
    let (mut low, mut high) = (0, sums.len() as u32 - 1);
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if sums[middle as usize] <= number {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (from, to) = (sums[low as usize], sums[low as usize + 1]);
    let t = if to > from { (number - from) / (to - from) } else { 0.5 };
    (low, t.clamp(0.0, 1.0 - f32::EPSILON))
}

/// A direction drawn by brightness, with its density per steradian.
pub fn sample_environment(map: &EnvironmentMap<'_>, random: [f32; 2]) -> (Vec3, f32) {
    let (row, v) = interval_of(map.rows, random[1]);
    let (column, u) = interval_of(row_of(map, row), random[0]);
    let place = [(column as f32 + u) / map.record.width as f32, (row as f32 + v) / map.record.height as f32];
    let (direction, sin) = environment_direction(&map.record, place);
    (direction, pixel_pdf(map, column, row, sin))
}

/// The density with which [`sample_environment`] draws a direction.
pub fn environment_pdf(map: &EnvironmentMap<'_>, direction: Vec3) -> f32 {
    let [u, v] = environment_place(&map.record, direction);
    let column = ((u * map.record.width as f32) as u32).min(map.record.width - 1);
    let row = ((v * map.record.height as f32) as u32).min(map.record.height - 1);
    pixel_pdf(map, column, row, (1.0 - direction.y * direction.y).max(0.0).sqrt())
}

fn row_of<'a>(map: &EnvironmentMap<'a>, row: u32) -> &'a [f32] {
    let length = map.record.width as usize + 1;
    &map.columns[row as usize * length..(row as usize + 1) * length]
}

/// Density of a pixel's directions: its probability over its solid angle.
fn pixel_pdf(map: &EnvironmentMap<'_>, column: u32, row: u32, sin: f32) -> f32 {
    let sums = row_of(map, row);
    let of_row = map.rows[row as usize + 1] - map.rows[row as usize];
    let of_column = sums[column as usize + 1] - sums[column as usize];
    let pixels = map.record.width as f32 * map.record.height as f32;
    if sin < 1e-7 { 0.0 } else { of_row * of_column * pixels / (2.0 * PI * PI * sin) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;

    fn record() -> Environment {
        let (sin, cos) = 0.7_f32.sin_cos();
        Environment { radiance: Vec3::ONE, cos, sin, width: 8, height: 4, padding: 0 }
    }

    #[test]
    fn places_and_directions_are_inverse() {
        for k in 0..500 {
            let [a, b, ..] = random4(k, 0, 0, 1);
            let (direction, sin) = environment_direction(&record(), [a, b]);
            let [u, v] = environment_place(&record(), direction);
            assert!((direction.length() - 1.0).abs() < 1e-4 && (sin - (1.0 - direction.y.powi(2)).sqrt()).abs() < 1e-4);
            assert!((u - a).abs() < 1e-4 && (v - b).abs() < 1e-4, "{a} {b}: {u} {v}");
        }
        let straight = Environment { cos: 1.0, sin: 0.0, ..record() };
        assert!((environment_direction(&straight, [0.5, 0.5]).0 - Vec3::NEG_Z).length() < 1e-5);
        assert!((environment_direction(&straight, [0.75, 0.5]).0 - Vec3::X).length() < 1e-5);
        assert!((environment_direction(&straight, [0.3, 0.0]).0 - Vec3::Y).length() < 1e-5);
        // A quarter turn by the right-hand rule brings what was at -z to -x.
        let turned = Environment { cos: 0.0, sin: 1.0, ..record() };
        assert!((environment_direction(&turned, [0.5, 0.5]).0 - Vec3::NEG_X).length() < 1e-5);
    }

    #[test]
    fn directions_are_drawn_with_their_density() {
        let pixels: Vec<[f32; 3]> = (0..32).map(|k| [1.0 + (k * 7 % 5) as f32; 3]).collect();
        let weight = |k: usize| f64::from(pixels[k][0]);
        let rows: Vec<f64> = (0..4).map(|r| (0..8).map(|c| weight(r * 8 + c)).sum()).collect();
        let sums = |weights: &[f64]| {
            let total: f64 = weights.iter().sum();
            let mut sum = 0.0;
            let inner = weights.iter().map(|w| {
                sum += w / total;
                sum as f32
            });
            std::iter::once(0.0).chain(inner).collect::<Vec<f32>>()
        };
        let columns: Vec<f32> =
            (0..4).flat_map(|r| sums(&(0..8).map(|c| weight(r * 8 + c)).collect::<Vec<_>>())).collect();
        let map = EnvironmentMap { record: record(), pixels: &pixels, rows: &sums(&rows), columns: &columns };
        let n = 200_000;
        let (mut solid_angle, mut light, mut strays) = (0.0_f64, 0.0_f64, 0);
        for k in 0..n {
            let [a, b, c, d] = random4(k, 0, 0, 2);
            let (direction, pdf) = sample_environment(&map, [a, b]);
            // At the border of two pixels rounding may choose the other one.
            strays += u32::from((environment_pdf(&map, direction) / pdf - 1.0).abs() > 1e-2);
            solid_angle += 1.0 / f64::from(pdf);
            // The integral of the radiance, by the density and by uniform directions.
            light += f64::from(environment_radiance(&map, direction).x) / f64::from(pdf);
            let z = 1.0 - 2.0 * c;
            let (sin, cos) = sin_cos_turns(d);
            let r = (1.0 - z * z).sqrt();
            let uniform = Vec3::new(r * cos, z, r * sin);
            light -= f64::from(environment_radiance(&map, uniform).x) * 4.0 * std::f64::consts::PI;
        }
        solid_angle /= f64::from(n) * 4.0 * std::f64::consts::PI;
        light /= f64::from(n) * 4.0 * std::f64::consts::PI;
        assert!((solid_angle - 1.0).abs() < 0.01, "{solid_angle}");
        assert!(light.abs() < 0.02, "{light}");
        assert!(strays < n / 1000, "{strays}");
    }
}
