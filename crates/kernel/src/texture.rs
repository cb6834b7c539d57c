//! Textures: where a point lies in an image, and what it adds.

use crate::Rules;
use crate::intersect::{SPHERE, TRIANGLE};
use crate::ray::Hit;
use crate::surface::{Surface, Surfaces};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The image covers the surface once.
pub const STRETCH: u32 = 0;
/// One texel per scene unit, tiled; on meshes, coordinates wrap.
pub const REPEAT: u32 = 1;
/// One texel per scene unit, once; on meshes, nothing outside 0..1.
pub const STRAIGHT: u32 = 2;

/// Texels beyond this distance are taken as at it: integers hold it, with an image's size added.
const FARTHEST_TEXEL: f32 = 1e9;

/// An image in the world's texel buffer. 16 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct Texture {
    /// Index of its first texel.
    pub first: u32,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Unused.
    pub padding: u32,
}

/// A point of a surface for texturing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Coordinates: u to the right, v up, 0..1 over the surface.
    pub uv: [f32; 2],
    /// Size of the surface in scene units, or 0 where it has none (meshes).
    pub size: [f32; 2],
}

/// How many texels a point is from the image's left or upper edge; `size` is that of the surface, or 0.
pub fn place_on_axis(from_top_left: f32, size: f32, image_size: f32, mode: u32) -> f32 {
    let in_units = mode != STRETCH && size > 0.0;
    from_top_left * if in_units { size } else { image_size }
}

/// The texel at a surface point, linear in the image's bytes: nearest in the original, bilinear else. Black outside a
/// [`STRAIGHT`] image.
pub fn sample_texture(texels: &[[u8; 4]], texture: &Texture, mode: u32, at: &SurfacePoint, rules: Rules) -> Vec3 {
    let image_size = [texture.width as f32, texture.height as f32];
    let from_top_left = [at.uv[0], 1.0 - at.uv[1]];
    let place = |axis: usize| place_on_axis(from_top_left[axis], at.size[axis], image_size[axis], mode);
    let (x, y) = (place(0), place(1));
    let outside = !(x >= 0.0 && y >= 0.0 && x <= image_size[0] && y <= image_size[1]);
    if (mode == STRAIGHT && outside) || !x.is_finite() || !y.is_finite() {
        return Vec3::ZERO;
    }
    match rules {
        Rules::Original => texel(texels, texture, mode, x.floor(), y.floor()),
        Rules::Repaired => {
            let (x0, y0) = ((x - 0.5).floor(), (y - 0.5).floor());
            let (fx, fy) = (x - 0.5 - x0, y - 0.5 - y0);
            let row =
                |y| texel(texels, texture, mode, x0, y) * (1.0 - fx) + texel(texels, texture, mode, x0 + 1.0, y) * fx;
            row(y0) * (1.0 - fy) + row(y0 + 1.0) * fy
        }
    }
}

/// One texel; coordinates outside wrap in [`REPEAT`] mode and are clamped in the others.
fn texel(texels: &[[u8; 4]], texture: &Texture, mode: u32, x: f32, y: f32) -> Vec3 {
    let at = texture.first + texel_index(y, texture.height, mode) * texture.width + texel_index(x, texture.width, mode);
    let [r, g, b, _] = texels[at as usize];
    Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0
}

/// A row or column of an image of `size` of them.
pub fn texel_index(place: f32, size: u32, mode: u32) -> u32 {
    let size = size as i32;
    let index = place.clamp(-FARTHEST_TEXEL, FARTHEST_TEXEL) as i32;
    let wrapped = if mode == REPEAT { ((index % size) + size) % size } else { index.clamp(0, size - 1) };
    wrapped as u32
}

/// Longitude and latitude of a unit vector as coordinates 0..1: u turns about +y from -z by way of -x, v runs from -y
/// to +y.
pub fn sphere_coordinates(unit: Vec3) -> [f32; 2] {
    let turn = std::f32::consts::TAU;
    let u = 0.5 + arctangent(unit.x, unit.z) / turn;
    let v = arctangent((unit.x * unit.x + unit.z * unit.z).sqrt(), -unit.y) * (2.0 / turn);
    [u, v]
}

/// Where the hit lies for texturing.
pub fn surface_point(surfaces: &Surfaces<'_>, hit: &Hit, surface: &Surface) -> SurfacePoint {
    let primitive = surfaces.primitives[hit.primitive as usize];
    let index = primitive.index as usize;
    match primitive.kind {
        TRIANGLE => {
            let [a, b, c] = surfaces.corners[index].texture_coordinates;
            let blend = |i: usize| a[i] * (1.0 - hit.u - hit.v) + b[i] * hit.u + c[i] * hit.v;
            SurfacePoint { uv: [blend(0), blend(1)], size: [0.0; 2] }
        }
        SPHERE => {
            let round = surfaces.spheres[index].radius * std::f32::consts::TAU;
            SurfacePoint { uv: sphere_coordinates(surface.normal), size: [round, round / 2.0] }
        }
        _ => {
            let square = &surfaces.squares[index];
            let offset = surface.point - square.center;
            let size = [2.0 * square.half_width, 2.0 * square.half_height];
            // Seen against the normal with the head upwards, the width runs to the left along `across`.
            let uv = [0.5 - offset.dot(square.across) / size[0], 0.5 + offset.dot(square.along) / size[1]];
            SurfacePoint { uv, size }
        }
    }
}

/// The angle of (x, y) in radians, -pi..pi, within 1e-5 of `y.atan2(x)`: a polynomial, so that devices agree.
/// Abramowitz & Stegun 1964, 4.4.49.
pub fn arctangent(y: f32, x: f32) -> f32 {
    let (small, large) = if y.abs() < x.abs() { (y.abs(), x.abs()) } else { (x.abs(), y.abs()) };
    if large == 0.0 {
        return 0.0;
    }
    let r = small / large;
    let s = r * r;
    let octant = r * (0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1))));
    let quadrant = if y.abs() < x.abs() { octant } else { std::f32::consts::FRAC_PI_2 - octant };
    let half = if x < 0.0 { std::f32::consts::PI - quadrant } else { quadrant };
    half.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two by two: black, red / green, blue.
    const TEXELS: [[u8; 4]; 4] = [[0, 0, 0, 0], [255, 0, 0, 0], [0, 255, 0, 0], [0, 0, 255, 0]];
    const IMAGE: Texture = Texture { first: 0, width: 2, height: 2, padding: 0 };

    fn sample(mode: u32, uv: [f32; 2], size: [f32; 2]) -> Vec3 {
        sample_texture(&TEXELS, &IMAGE, mode, &SurfacePoint { uv, size }, Rules::Original)
    }

    #[test]
    fn the_image_is_upright() {
        assert_eq!(sample(STRETCH, [0.75, 0.75], [9.0; 2]), Vec3::X);
        assert_eq!(sample(STRETCH, [0.25, 0.25], [9.0; 2]), Vec3::Y);
        assert_eq!(sample(STRETCH, [1.0, 0.0], [9.0; 2]), Vec3::Z);
    }

    #[test]
    fn one_texel_per_unit_tiled_or_once() {
        // 4 units wide and high: three and a half units right and half a unit down is the image's second column again.
        let at = [3.5 / 4.0, 3.5 / 4.0];
        assert_eq!(sample(REPEAT, at, [4.0; 2]), Vec3::X);
        assert_eq!(sample(STRAIGHT, at, [4.0; 2]), Vec3::ZERO);
        assert_eq!(sample(STRAIGHT, [1.5 / 4.0, at[1]], [4.0; 2]), Vec3::X);
        assert_eq!(sample(REPEAT, [1.75, -0.25], [0.0; 2]), Vec3::X);
    }

    #[test]
    fn bilinear_between_texel_centres() {
        let at = SurfacePoint { uv: [0.5, 0.75], size: [0.0; 2] };
        assert_eq!(sample_texture(&TEXELS, &IMAGE, STRETCH, &at, Rules::Repaired), Vec3::X * 0.5);
    }

    #[test]
    fn the_arctangent_is_close_everywhere() {
        for k in 1..1000 {
            let angle = (k as f32 / 1000.0 - 0.5) * std::f32::consts::TAU;
            let (y, x) = angle.sin_cos();
            assert!((arctangent(y * 7.0, x * 7.0) - angle).abs() < 2e-5, "{angle}");
        }
        assert_eq!(arctangent(0.0, 0.0), 0.0);
        assert_eq!(sphere_coordinates(Vec3::Y)[1], 1.0);
    }
}
