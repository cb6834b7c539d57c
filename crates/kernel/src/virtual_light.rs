//! Virtual point lights of the physical model: points of surfaces that pass light on evenly (Keller 1997).

use crate::bsdf::{Bsdf, PLASTIC, energy_at};
use crate::ray::NONE;
use crate::rounding::UNIT;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A virtual point light. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct VirtualLight {
    /// Position in scene units.
    pub position: Vec3,
    /// Energy table of the coat that light passes on its way out, or [`NONE`].
    pub table: u32,
    /// Unit normal of the surface, on the side that shines.
    pub normal: Vec3,
    /// Unit normal for shading, packed by [`pack_direction`]; see [`shading_normal`].
    pub shading: u32,
    /// Radiant intensity along the normal, of all paths together, in W/sr.
    pub intensity: Vec3,
    /// Whether the shading normal is another than the surface's: 0 or 1.
    pub is_bent: u32,
}

/// Least cosine that counts: of light along a surface rounding decides on which side of it goes.
pub const LEAST_COSINE: f32 = 16.0 * UNIT;

/// A unit vector in two numbers of 16 bits, on an octahedron (Cigolle et al. 2014).
pub fn pack_direction(direction: Vec3) -> u32 {
    let sum = (direction.x.abs() + direction.y.abs() + direction.z.abs()).max(f32::MIN_POSITIVE);
    let (mut x, mut y) = (direction.x / sum, direction.y / sum);
    if direction.z < 0.0 {
        (x, y) = ((1.0 - y.abs()) * 1.0_f32.copysign(x), (1.0 - x.abs()) * 1.0_f32.copysign(y));
    }
    let word = |c: f32| ((c * 0.5 + 0.5) * 65535.0 + 0.5) as u32 & 0xffff;
    word(x) | word(y) << 16
}

/// The vector of [`pack_direction`], within 1e-4.
pub fn unpack_direction(packed: u32) -> Vec3 {
    let number = |word: u32| word as f32 * (2.0 / 65535.0) - 1.0;
    let (mut x, mut y) = (number(packed & 0xffff), number(packed >> 16));
    let z = 1.0 - x.abs() - y.abs();
    if z < 0.0 {
        (x, y) = ((1.0 - y.abs()) * 1.0_f32.copysign(x), (1.0 - x.abs()) * 1.0_f32.copysign(y));
    }
    Vec3::new(x, y, z).normalize_or_zero()
}

/// The shading normal of a virtual light.
pub fn shading_normal(light: &VirtualLight) -> Vec3 {
    if light.is_bent == 0 { light.normal } else { unpack_direction(light.shading) }
}

/// The table of a material's virtual lights.
pub fn virtual_table(bsdf: &Bsdf) -> u32 {
    if bsdf.kind == PLASTIC { bsdf.table } else { NONE }
}

/// The share of a virtual light's intensity that goes in a direction, with the cosine: 0..1. `direction` is a unit vector away
/// from the light.
pub fn virtual_emission(light: &VirtualLight, tables: &[f32], direction: Vec3) -> f32 {
    let cos = light.normal.dot(direction);
    let of_shading = shading_normal(light).dot(direction);
    if cos <= LEAST_COSINE || of_shading <= LEAST_COSINE {
        return 0.0;
    }
    if light.table == NONE { cos } else { cos * (1.0 - energy_at(tables, light.table, false, of_shading)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;

    #[test]
    fn directions_survive_packing() {
        for k in 0..4000 {
            let [a, b, c, _] = random4(k, 0, 0, 1);
            let direction = (Vec3::new(a, b, c) - 0.5).normalize();
            let again = unpack_direction(pack_direction(direction));
            assert!((again - direction).length() < 1e-4, "{direction} {again}");
        }
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            assert!((unpack_direction(pack_direction(axis)) - axis).length() < 1e-4);
        }
    }

    #[test]
    fn nothing_shines_backwards() {
        let light = VirtualLight {
            normal: Vec3::Z,
            table: NONE,
            shading: pack_direction(Vec3::Z),
            intensity: Vec3::ONE,
            ..VirtualLight::zeroed()
        };
        assert_eq!(virtual_emission(&light, &[], Vec3::NEG_Z), 0.0);
        assert!((virtual_emission(&light, &[], Vec3::new(0.6, 0.0, 0.8)) - 0.8).abs() < 1e-6);
    }
}
