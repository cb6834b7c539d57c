//! Rough and smooth boundaries between dielectrics (Walter et al. 2007), as [`crate::bsdf`] has them.

use crate::bsdf::{
    Bsdf, BsdfSample, GLOSSY, SPECULAR, Transport, chance_of_facets, energy_at, lost_transmission, mean_energy,
    reflection_density,
};
use crate::fresnel::fresnel_dielectric;
use crate::ggx::{ggx_distribution, ggx_masking_shadowing, sample_visible_normal, visible_normal_pdf};
use crate::sampling::sample_cosine_cone;
use glam::Vec3;
use std::f32::consts::PI;

/// The value of a rough boundary.
pub(crate) fn dielectric_value(
    bsdf: &Bsdf,
    tables: &[f32],
    lobes: u32,
    wo: Vec3,
    wi: Vec3,
    transport: Transport,
) -> Vec3 {
    if bsdf.alpha == 0.0 || lobes & GLOSSY == 0 {
        return Vec3::ZERO;
    }
    let is_inside = wo.z < 0.0;
    let eta = if is_inside { 1.0 / bsdf.ior } else { bsdf.ior };
    // Seen from the side of wo.
    let (wo, wi) = if is_inside { (-wo, -wi) } else { (wo, wi) };
    let is_reflected = wi.z > 0.0;
    let lost = |of_inside, cos| 1.0 - energy_at(tables, bsdf.table, of_inside, cos);
    let passing = lost_transmission(tables, bsdf.table, is_inside);
    if is_reflected {
        let h = (wo + wi).normalize_or_zero();
        let single = fresnel_dielectric(wo.dot(h), eta) * reflection_density(wo, wi, h, bsdf.alpha);
        let mean_lost = (1.0 - mean_energy(tables, bsdf.table, is_inside)).max(1e-4);
        let lost = lost(is_inside, wo.z) * lost(is_inside, wi.z) / (PI * mean_lost);
        return Vec3::splat(single + lost * (1.0 - passing));
    }
    let mean_lost = (1.0 - mean_energy(tables, bsdf.table, !is_inside)).max(1e-4);
    let lost = lost(is_inside, wo.z) * lost(!is_inside, -wi.z) / (PI * mean_lost) * passing;
    let h = refraction_normal(wo, wi, eta);
    let (cos_o, cos_i) = (wo.dot(h), wi.dot(h));
    let single = if cos_o > 0.0 && cos_i < 0.0 {
        let d = cos_i + cos_o / eta;
        let masked = ggx_distribution(h.z, bsdf.alpha) * ggx_masking_shadowing(wo.z, -wi.z, bsdf.alpha);
        (1.0 - fresnel_dielectric(cos_o, eta)) * masked * cos_o * -cos_i / (wo.z * -wi.z * d * d)
    } else {
        0.0
    };
    let compression = if transport == Transport::Radiance { 1.0 / (eta * eta) } else { 1.0 };
    bsdf.specular * ((single + lost) * compression)
}

/// The microfacet normal, on the side of `wo`, that refracts one direction into the other.
fn refraction_normal(wo: Vec3, wi: Vec3, eta: f32) -> Vec3 {
    let h = (wo + wi * eta).normalize_or_zero();
    if h.z < 0.0 { -h } else { h }
}

/// The density of [`sample_dielectric`].
pub(crate) fn dielectric_pdf(bsdf: &Bsdf, tables: &[f32], wo: Vec3, wi: Vec3) -> f32 {
    if bsdf.alpha == 0.0 {
        return 0.0;
    }
    let is_inside = wo.z < 0.0;
    let eta = if is_inside { 1.0 / bsdf.ior } else { bsdf.ior };
    let (wo, wi) = if is_inside { (-wo, -wi) } else { (wo, wi) };
    let facets = chance_of_facets(bsdf, tables, is_inside, wo.z);
    let passing = lost_transmission(tables, bsdf.table, is_inside);
    if wi.z > 0.0 {
        let h = (wo + wi).normalize_or_zero();
        let cos = wo.dot(h);
        let of_facets = visible_normal_pdf(wo, h, bsdf.alpha) / (4.0 * cos).max(1e-7) * fresnel_dielectric(cos, eta);
        return facets * of_facets + (1.0 - facets) * (1.0 - passing) * wi.z * (1.0 / PI);
    }
    let h = refraction_normal(wo, wi, eta);
    let (cos_o, cos_i) = (wo.dot(h), wi.dot(h));
    let mut pdf = (1.0 - facets) * passing * -wi.z * (1.0 / PI);
    if cos_o > 0.0 && cos_i < 0.0 {
        let d = cos_i + cos_o / eta;
        let jacobian = -cos_i / (d * d);
        pdf += facets * visible_normal_pdf(wo, h, bsdf.alpha) * jacobian * (1.0 - fresnel_dielectric(cos_o, eta));
    }
    pdf
}

/// A direction drawn from what is reflected and what passes.
pub(crate) fn sample_dielectric(
    bsdf: &Bsdf,
    tables: &[f32],
    lobes: u32,
    wo: Vec3,
    random: [f32; 3],
    transport: Transport,
) -> Option<BsdfSample> {
    let is_inside = wo.z < 0.0;
    let eta = if is_inside { 1.0 / bsdf.ior } else { bsdf.ior };
    let side = if is_inside { -1.0 } else { 1.0 };
    let outer = wo * side;
    let compression = if transport == Transport::Radiance { 1.0 / (eta * eta) } else { 1.0 };
    if lobes & SPECULAR != 0 {
        let reflected = fresnel_dielectric(outer.z, eta);
        let sample = |wi: Vec3, weight| Some(BsdfSample { wi: wi * side, weight, pdf: 0.0, lobe: SPECULAR });
        if random[2] < reflected {
            return sample(Vec3::new(-outer.x, -outer.y, outer.z), Vec3::ONE);
        }
        return sample(refract(outer, Vec3::Z, eta)?, bsdf.specular * compression);
    }
    let facets = chance_of_facets(bsdf, tables, is_inside, outer.z);
    let outer_wi = if random[2] < facets {
        let h = sample_visible_normal(outer, bsdf.alpha, [random[0], random[1]]);
        let cos = outer.dot(h);
        let is_reflected = random[2] / facets < fresnel_dielectric(cos, eta);
        let wi = if is_reflected { h * (2.0 * cos) - outer } else { refract(outer, h, eta)? };
        // Tilted facets may send light to the wrong side, where other facets would meet it.
        if (wi.z > 0.0) != is_reflected {
            return None;
        }
        wi
    } else {
        let rest = (random[2] - facets) / (1.0 - facets).max(1e-6);
        let wi = sample_cosine_cone(Vec3::Z, 1.0, [random[0], random[1]]);
        if rest < lost_transmission(tables, bsdf.table, is_inside) { Vec3::new(wi.x, wi.y, -wi.z) } else { wi }
    };
    let wi = outer_wi * side;
    let pdf = dielectric_pdf(bsdf, tables, wo, wi);
    if pdf <= 0.0 || !pdf.is_finite() || wi.z == 0.0 {
        return None;
    }
    let weight = dielectric_value(bsdf, tables, lobes, wo, wi, transport) * (wi.z.abs() / pdf);
    Some(BsdfSample { wi, weight, pdf, lobe: GLOSSY })
}

/// The refracted direction of `wo` about a normal on its side; `None` at total internal reflection.
pub fn refract(wo: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos_o = wo.dot(normal);
    let sin_t_sq = (1.0 - cos_o * cos_o).max(0.0) / (eta * eta);
    if cos_o <= 0.0 || sin_t_sq >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin_t_sq).sqrt();
    Some((normal * (cos_o / eta - cos_t) - wo * (1.0 / eta)).normalize_or_zero())
}
