//! The thesis' light model (section 3.1): Phong terms without falloff, clamped per light.

use crate::Rules;
use crate::light::{DIRECTIONAL, Light, Vpl, emission_cosine, to_light};
use crate::material::Material;
use crate::power::power;
use crate::ray::normalize_or_zero;
use glam::Vec3;

/// A light as seen from a point, before its visibility is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incidence {
    /// Vector from the point to the light.
    pub to_light: Vec3,
    /// Cosine between the surface's normal and the light.
    pub cos_theta: f32,
    /// Cosine factor of the light.
    pub cos_phi: f32,
}

/// How light arrives at a point with this normal, or `None` where the light or the surface faces away.
pub fn incidence(light: &Light, point: Vec3, normal: Vec3) -> Option<Incidence> {
    let to_light = to_light(light, point);
    let unit = normalize_or_zero(to_light);
    let (cos_theta, cos_phi) = (normal.dot(unit), emission_cosine(light, unit));
    (cos_theta > 0.0 && cos_phi > 0.0).then_some(Incidence { to_light, cos_theta, cos_phi })
}

/// What a visible light adds to a surface, at most 1 per channel. `to_eye` is the vector from the point to the origin
/// of the ray that found it.
///
/// The half vector is that of the UNNORMALISED vectors, as in the original. The original gives [`DIRECTIONAL`] lights
/// no diffuse term.
pub fn phong(light: &Light, material: &Material, at: &Incidence, normal: Vec3, to_eye: Vec3, rules: Rules) -> Vec3 {
    let mut color = light.ambient * material.ambient;
    if rules == Rules::Repaired || light.kind != DIRECTIONAL {
        color += light.diffuse * material.diffuse * at.cos_theta;
    }
    let gloss = light.specular * material.specular;
    if gloss != Vec3::ZERO {
        // A directional light has no distance to weigh against the eye's; its half vector needs unit vectors.
        let eye =
            if light.kind == DIRECTIONAL && rules == Rules::Repaired { normalize_or_zero(to_eye) } else { to_eye };
        let half = normalize_or_zero(at.to_light + eye);
        color += gloss * power(normal.dot(half).max(0.0), material.exponent);
    }
    (color * (light.attenuation * at.cos_phi)).min(Vec3::ONE)
}

/// A VPL as seen from a point, before its visibility is known. Cosines are kept times the distance: without a root for
/// each of the very many that are seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VplIncidence {
    /// Vector from the point to the VPL.
    pub to_light: Vec3,
    /// Product of the cosines at the surface and at the VPL, times the squared distance. Above 0.
    pub cosines: f32,
    /// Squared distance.
    pub dist_sq: f32,
}

/// How light of a VPL arrives at a point with this normal, or `None` where one of them faces away.
pub fn vpl_incidence(vpl: &Vpl, point: Vec3, normal: Vec3) -> Option<VplIncidence> {
    let to_light = vpl.position - point;
    let cosines = normal.dot(to_light).max(0.0) * (-vpl.direction.dot(to_light)).max(0.0);
    (cosines > 0.0).then_some(VplIncidence { to_light, cosines, dist_sq: to_light.dot(to_light) })
}

/// What a visible VPL adds to a surface with this diffuse colour, at most 1 per channel.
pub fn phong_vpl(vpl: &Vpl, diffuse: Vec3, at: &VplIncidence) -> Vec3 {
    (vpl.diffuse * diffuse * (vpl.attenuation * (at.cosines / at.dist_sq))).min(Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{HEMISPHERE, OMNI};
    use bytemuck::Zeroable;

    fn light(kind: u32) -> Light {
        Light {
            kind,
            position: Vec3::new(0.0, 2.0, 0.0),
            direction: Vec3::NEG_Y,
            attenuation: 0.5,
            diffuse: Vec3::ONE,
            ..Light::zeroed()
        }
    }

    fn diffuse() -> Material {
        Material { diffuse: Vec3::splat(0.8), ..Material::zeroed() }
    }

    #[test]
    fn lights_above_a_plane() {
        let point = Vec3::new(2.0, 0.0, 0.0);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        for (kind, expected) in [(OMNI, 0.4 * half), (HEMISPHERE, 0.4 * half * half), (DIRECTIONAL, 0.4)] {
            let light = light(kind);
            let at = incidence(&light, point, Vec3::Y).unwrap();
            let color = phong(&light, &diffuse(), &at, Vec3::Y, Vec3::Y, Rules::Repaired);
            assert!((color.x - expected).abs() < 1e-6, "{kind}: {color}");
        }
        assert!(incidence(&light(OMNI), point, Vec3::NEG_Y).is_none());
    }

    #[test]
    fn the_original_forgets_the_diffuse_term_of_directional_lights() {
        let light = light(DIRECTIONAL);
        let at = incidence(&light, Vec3::ZERO, Vec3::Y).unwrap();
        assert_eq!(phong(&light, &diffuse(), &at, Vec3::Y, Vec3::Y, Rules::Original), Vec3::ZERO);
    }

    #[test]
    fn a_vpl_is_a_hemisphere_light() {
        let light = light(HEMISPHERE);
        let vpl = Vpl {
            position: light.position,
            direction: light.direction,
            diffuse: light.diffuse,
            attenuation: light.attenuation,
            ..Vpl::zeroed()
        };
        let point = Vec3::new(0.7, 0.1, -0.3);
        let (a, b) = (incidence(&light, point, Vec3::Y).unwrap(), vpl_incidence(&vpl, point, Vec3::Y).unwrap());
        assert_eq!(a.to_light, b.to_light);
        assert!((a.cos_theta * a.cos_phi - b.cosines / b.dist_sq).abs() < 1e-6);
        let material = diffuse();
        let expected = phong(&light, &material, &a, Vec3::Y, Vec3::Y, Rules::Repaired);
        assert!((phong_vpl(&vpl, material.diffuse, &b) - expected).abs().max_element() < 1e-6);
        assert!(vpl_incidence(&vpl, point, Vec3::NEG_Y).is_none());
        assert!(vpl_incidence(&vpl, vpl.position, Vec3::Y).is_none());
    }

    #[test]
    fn each_light_is_clamped_to_one() {
        let mut light = light(OMNI);
        light.attenuation = 100.0;
        let at = incidence(&light, Vec3::ZERO, Vec3::Y).unwrap();
        assert_eq!(phong(&light, &diffuse(), &at, Vec3::Y, Vec3::Y, Rules::Repaired), Vec3::ONE);
    }
}
