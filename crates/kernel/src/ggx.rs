//! The GGX distribution of microfacets (Walter et al. 2007), with Smith's shadowing and the sampling of visible normals (Heitz
//! 2014, 2018). Directions are unit vectors in the frame of the surface, whose normal is +z; `alpha` is the distribution's
//! width, above 0.

use crate::sampling::sin_cos_turns;
use glam::Vec3;
use std::f32::consts::PI;

/// Density of microfacet normals, per steradian of projected area.
pub fn ggx_distribution(cos_h: f32, alpha: f32) -> f32 {
    let a_sq = alpha * alpha;
    // 1 - cos^2 + a^2 cos^2, written so that nothing cancels at small widths.
    let d = (1.0 - cos_h) * (1.0 + cos_h) + a_sq * cos_h * cos_h;
    a_sq / (PI * d * d)
}

/// Smith's Lambda of a direction.
pub fn ggx_lambda(cos: f32, alpha: f32) -> f32 {
    let cos_sq = cos * cos;
    let tan_sq = (1.0 - cos_sq).max(0.0) / cos_sq.max(1e-12);
    ((1.0 + alpha * alpha * tan_sq).sqrt() - 1.0) * 0.5
}

/// Share of the microfacets that is seen from a direction.
pub fn ggx_masking(cos: f32, alpha: f32) -> f32 {
    1.0 / (1.0 + ggx_lambda(cos, alpha))
}

/// Share that is seen from one direction and lit from another, on either side, heights correlated.
pub fn ggx_masking_shadowing(cos_o: f32, cos_i: f32, alpha: f32) -> f32 {
    1.0 / (1.0 + ggx_lambda(cos_o, alpha) + ggx_lambda(cos_i, alpha))
}

/// Density of the normals that [`sample_visible_normal`] draws, per steradian; `wo.z` is above 0.
pub fn visible_normal_pdf(wo: Vec3, h: Vec3, alpha: f32) -> f32 {
    ggx_masking(wo.z, alpha) * wo.dot(h).max(0.0) * ggx_distribution(h.z, alpha) / wo.z.max(1e-7)
}

/// A microfacet normal among those seen from `wo`, whose z is above 0 (Heitz 2018, "Sampling the GGX Distribution of Visible
/// Normals").
#[inline]
pub fn sample_visible_normal(wo: Vec3, alpha: f32, random: [f32; 2]) -> Vec3 {
    let stretched = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize_or_zero();
    let length_sq = stretched.x * stretched.x + stretched.y * stretched.y;
    let tangent =
        if length_sq > 0.0 { Vec3::new(-stretched.y, stretched.x, 0.0) * (1.0 / length_sq.sqrt()) } else { Vec3::X };
    let bitangent = stretched.cross(tangent);
    let radius = random[0].sqrt();
    let (sin, cos) = sin_cos_turns(random[1]);
    let t1 = radius * cos;
    let s = 0.5 * (1.0 + stretched.z);
    let t2 = (1.0 - s) * (1.0 - t1 * t1).max(0.0).sqrt() + s * (radius * sin);
    let t3 = (1.0 - t1 * t1 - t2 * t2).max(0.0).sqrt();
    let normal = tangent * t1 + bitangent * t2 + stretched * t3;
    Vec3::new(alpha * normal.x, alpha * normal.y, normal.z.max(1e-6)).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;

    /// The integral over the hemisphere by midpoints, equal in solid angle.
    fn integral(of: impl Fn(Vec3) -> glam::DVec3) -> glam::DVec3 {
        let steps = 1500_u32;
        let sum: glam::DVec3 = (0..steps * steps)
            .map(|k| {
                let (u, v) = ((k % steps) as f32 + 0.5, (k / steps) as f32 + 0.5);
                let z = u / steps as f32;
                let (sin, cos) = sin_cos_turns(v / steps as f32);
                let r = (1.0 - z * z).sqrt();
                of(Vec3::new(r * cos, r * sin, z))
            })
            .sum();
        sum * (2.0 * std::f64::consts::PI / f64::from(steps * steps))
    }

    fn view(cos: f32) -> Vec3 {
        Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
    }

    #[test]
    fn the_distribution_and_the_density_of_visible_normals_are_normalised() {
        for alpha in [0.1, 0.3, 0.7, 1.0] {
            let area = integral(|h| glam::DVec3::splat(f64::from(ggx_distribution(h.z, alpha) * h.z))).x;
            assert!((area - 1.0).abs() < 2e-3, "{alpha}: {area}");
            for cos in [0.1, 0.5, 1.0] {
                let sum = integral(|h| glam::DVec3::splat(f64::from(visible_normal_pdf(view(cos), h, alpha)))).x;
                assert!((sum - 1.0).abs() < 2e-3, "{alpha} {cos}: {sum}");
            }
        }
    }

    #[test]
    fn samples_have_their_density() {
        // The mean of any function under the samples is its integral under the density: h.z and h.x.
        for (alpha, cos) in [(0.2, 0.3), (0.5, 0.9), (1.0, 0.1)] {
            let wo = view(cos);
            let (n, mut drawn) = (200_000, glam::DVec3::ZERO);
            for k in 0..n {
                let [a, b, ..] = random4(k, 0, 0, 5);
                let h = sample_visible_normal(wo, alpha, [a, b]);
                assert!(h.is_finite() && h.z >= 0.0 && (h.length() - 1.0).abs() < 1e-4);
                drawn += h.as_dvec3();
            }
            drawn /= f64::from(n);
            let expected = integral(|h| h.as_dvec3() * f64::from(visible_normal_pdf(wo, h, alpha)));
            assert!((drawn - expected).length() < 5e-3, "{alpha} {cos}: {drawn} {expected}");
        }
    }
}
