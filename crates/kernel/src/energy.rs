//! Tables of the light that microfacets send on, for [`crate::bsdf`].

use crate::bsdf::{CONDUCTOR, DIELECTRIC, ENERGY_ENTRIES, ENERGY_FLOATS, PLASTIC};
use crate::dielectric::refract;
use crate::fresnel::fresnel_dielectric;
use crate::ggx::{ggx_masking, ggx_masking_shadowing, sample_visible_normal};
use glam::Vec3;

/// Directions per entry of a table.
const DIRECTIONS: u32 = 4096;

/// Least cosine of an entry.
const LEAST_COSINE: f32 = 1e-3;

/// Steps of the means' integrals.
const STEPS: u32 = 4096;

/// A material's energy tables: those of a metal that reflects everything, of glass (all that is reflected or passes, from
/// either side), or of a coat's reflection. A smooth coat's are its Fresnel reflectances.
pub fn energy_tables(kind: u32, alpha: f32, ior: f32) -> [f32; ENERGY_FLOATS] {
    let mut tables = [1.0; ENERGY_FLOATS];
    for k in 0..ENERGY_ENTRIES {
        let root = k as f32 / (ENERGY_ENTRIES - 1) as f32;
        let cos = (root * root).max(LEAST_COSINE);
        match kind {
            CONDUCTOR => tables[k] = reflected(cos, alpha, |_| 1.0),
            PLASTIC if alpha == 0.0 => tables[k] = fresnel_dielectric(cos, ior),
            PLASTIC => tables[k] = reflected(cos, alpha, |cos| fresnel_dielectric(cos, ior)),
            DIELECTRIC => {
                tables[k] = sent_on(cos, alpha, ior);
                tables[ENERGY_ENTRIES + k] = sent_on(cos, alpha, 1.0 / ior);
            }
            _ => {}
        }
    }
    let means = [mean(&tables[..ENERGY_ENTRIES]), mean(&tables[ENERGY_ENTRIES..2 * ENERGY_ENTRIES])];
    tables[2 * ENERGY_ENTRIES..2 * ENERGY_ENTRIES + 2].copy_from_slice(&means);
    tables[2 * ENERGY_ENTRIES + 2..].copy_from_slice(&passing(means, ior));
    tables
}

/// A point of a sequence that covers the square evenly (Roberts 2018, the R2 sequence).
fn point(k: u32) -> [f32; 2] {
    const STEP: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    STEP.map(|step| (0.5 + step * f64::from(k)).fract() as f32)
}

/// Mean over the microfacets seen from a direction.
fn over_facets(cos: f32, alpha: f32, of_facet: impl Fn(Vec3, Vec3) -> f32) -> f32 {
    let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let sum: f64 = (0..DIRECTIONS).map(|k| f64::from(of_facet(wo, sample_visible_normal(wo, alpha, point(k))))).sum();
    (sum / f64::from(DIRECTIONS)) as f32
}

/// Share that a microfacet lets through to a direction, given that it is seen from another.
fn shadowing(cos_o: f32, cos_i: f32, alpha: f32) -> f32 {
    ggx_masking_shadowing(cos_o, cos_i, alpha) / ggx_masking(cos_o, alpha)
}

fn reflected(cos: f32, alpha: f32, fresnel: impl Fn(f32) -> f32) -> f32 {
    over_facets(cos, alpha, |wo, h| {
        let cos = wo.dot(h);
        let wi = h * (2.0 * cos) - wo;
        if wi.z > 0.0 { fresnel(cos) * shadowing(wo.z, wi.z, alpha) } else { 0.0 }
    })
}

fn sent_on(cos: f32, alpha: f32, eta: f32) -> f32 {
    let reflected = reflected(cos, alpha, |cos| fresnel_dielectric(cos, eta));
    let refracted = over_facets(cos, alpha, |wo, h| match refract(wo, h, eta) {
        Some(wi) if wi.z < 0.0 => (1.0 - fresnel_dielectric(wo.dot(h), eta)) * shadowing(wo.z, -wi.z, alpha),
        _ => 0.0,
    });
    reflected + refracted
}

/// Cosine-weighted mean of a table, interpolated as it is used: 4 times the integral of E(u^2) u^3.
fn mean(table: &[f32]) -> f32 {
    let at = |k: u32| {
        let u = (f64::from(k) + 0.5) / f64::from(STEPS);
        let place = u * (ENERGY_ENTRIES - 1) as f64;
        let below = (place as usize).min(ENERGY_ENTRIES - 2);
        let t = place - below as f64;
        (f64::from(table[below]) * (1.0 - t) + f64::from(table[below + 1]) * t) * u * u * u
    };
    (4.0 * (0..STEPS).map(at).sum::<f64>() / f64::from(STEPS)) as f32
}

/// Shares of the lost light that pass through the boundary, from outside and from inside. Reciprocity demands that share times
/// loss is in proportion to what passes at all, which is 1 / ior^2 from inside of what it is from outside.
fn passing(means: [f32; 2], ior: f32) -> [f32; 2] {
    let lost = means.map(|mean| (1.0 - mean).max(0.0));
    let outside = 1.0 - mean_fresnel(ior);
    let pass = [outside, outside / (ior * ior)];
    let least = lost[0].min(lost[1]);
    [0, 1].map(|side| if lost[side] > 0.0 { pass[side] * least / lost[side] } else { 0.0 })
}

/// Cosine-weighted mean of the Fresnel reflectance.
fn mean_fresnel(eta: f32) -> f32 {
    let at = |k: u32| {
        let u = (f64::from(k) + 0.5) / f64::from(STEPS);
        f64::from(fresnel_dielectric(u.sqrt() as f32, eta))
    };
    ((0..STEPS).map(at).sum::<f64>() / f64::from(STEPS)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_is_lost_between_fine_facets_and_much_between_coarse_ones() {
        let of = |alpha| energy_tables(CONDUCTOR, alpha, 1.0);
        let (fine, coarse) = (of(0.05), of(1.0));
        // At alpha = 1 and steep incidence the integral is that of c / (1 + c) over 0..1.
        let exact = 1.0 - std::f32::consts::LN_2;
        assert!(fine[ENERGY_ENTRIES - 1] > 0.99 && (coarse[ENERGY_ENTRIES - 1] - exact).abs() < 1e-3, "{coarse:?}");
        assert!(fine.iter().chain(&coarse).all(|e| (0.0..=1.0 + 1e-3).contains(e)));
    }

    #[test]
    fn a_smooth_coat_has_fresnels_mean() {
        let tables = energy_tables(PLASTIC, 0.0, 1.5);
        assert!((tables[2 * ENERGY_ENTRIES] - mean_fresnel(1.5)).abs() < 1e-3);
        // Egan & Hilgeman 1973: the diffuse reflectance of glass is 0.0918.
        assert!((mean_fresnel(1.5) - 0.0918).abs() < 2e-4, "{}", mean_fresnel(1.5));
    }

    #[test]
    fn what_passes_is_reciprocal() {
        let tables = energy_tables(DIELECTRIC, 0.6, 1.5);
        let [mean_o, mean_i, pass_o, pass_i] = tables[2 * ENERGY_ENTRIES..] else { panic!() };
        assert!((pass_o * (1.0 - mean_o) - pass_i * (1.0 - mean_i) * 2.25).abs() < 1e-5);
        assert!((0.0..1.0).contains(&pass_o) && (0.0..1.0).contains(&pass_i));
    }
}
