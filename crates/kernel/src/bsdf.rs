//! Materials of the physical model at one point: value, samples and densities.
//!
//! Directions are unit vectors away from the surface, in its frame, whose normal is +z: `wo` to where light is wanted,
//! `wi` to where it comes from. Values are those of the BSDF, without the cosine. Materials but dielectrics are the
//! same on both sides.
//!
//! Single scattering by microfacets loses the energy of multiple scattering. Tables of each material say how much (see
//! [`energy_at`]); it is compensated by a diffuse lobe, which is reciprocal (Kulla & Conty 2017, "Revisiting Physically
//! Based Shading at Imageworks").

use crate::dielectric::{dielectric_pdf, dielectric_value, sample_dielectric};
use crate::fresnel::{fresnel_conductor, fresnel_dielectric};
use crate::ggx::{ggx_distribution, ggx_masking_shadowing, sample_visible_normal, visible_normal_pdf};
use crate::power::power;
use crate::sampling::{frame, sample_cosine_cone, sin_cos_turns};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::f32::consts::PI;

/// Diffuse.
pub const LAMBERT: u32 = 0;
/// Diffuse with a Phong lobe (Lafortune & Willems 1994).
pub const PHONG: u32 = 1;
/// A metal.
pub const CONDUCTOR: u32 = 2;
/// Glass.
pub const DIELECTRIC: u32 = 3;
/// Diffuse under a clear coat.
pub const PLASTIC: u32 = 4;
/// A perfect mirror.
pub const MIRROR: u32 = 5;

/// Lobes that scatter light evenly in all directions.
pub const DIFFUSE: u32 = 1;
/// Lobes around a direction.
pub const GLOSSY: u32 = 2;
/// Single directions.
pub const SPECULAR: u32 = 4;
/// All lobes.
pub const ALL_LOBES: u32 = DIFFUSE | GLOSSY | SPECULAR;

/// Entries of an energy table, over the square root of the cosine.
pub const ENERGY_ENTRIES: usize = 32;
/// Floats of a material's tables: one for each side, and four averages.
pub const ENERGY_FLOATS: usize = 2 * ENERGY_ENTRIES + 4;

/// A material at one point, textures looked up. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Bsdf {
    /// Diffuse colour.
    pub diffuse: Vec3,
    /// One of the kinds.
    pub kind: u32,
    /// Colour of the Phong lobe, of the mirror, of what passes through glass; refractive indices of a metal.
    pub specular: Vec3,
    /// Width of the microfacet distribution; 0 is smooth.
    pub alpha: f32,
    /// Absorption indices of a metal.
    pub absorption: Vec3,
    /// Refractive index inside, relative to outside.
    pub ior: f32,
    /// Exponent of the Phong lobe.
    pub exponent: f32,
    /// Index of the first float of its energy tables.
    pub table: u32,
    /// Unused.
    pub padding: [u32; 2],
}

/// What a path carries: light to the camera, or importance to a light. They differ where light is refracted, because
/// radiance is compressed in the denser medium (Veach 1997, section 5.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// From the camera: `wi` is where light comes from.
    Radiance,
    /// From a light: `wi` is where the light goes on to.
    Importance,
}

/// A sampled direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// The direction.
    pub wi: Vec3,
    /// BSDF times cosine over density.
    pub weight: Vec3,
    /// Density per steradian; 0 for a single direction.
    pub pdf: f32,
    /// The lobe that it was drawn from: [`SPECULAR`] alone is a single direction.
    pub lobe: u32,
}

/// The lobes that a material has.
pub fn lobes_of(bsdf: &Bsdf) -> u32 {
    let shiny = if bsdf.alpha > 0.0 { GLOSSY } else { SPECULAR };
    match bsdf.kind {
        LAMBERT => DIFFUSE,
        PHONG => DIFFUSE | GLOSSY,
        PLASTIC => DIFFUSE | shiny,
        MIRROR => SPECULAR,
        _ => shiny,
    }
}

/// The share of light that a lobe of microfacets sends on, by the cosine of incidence, from outside or inside.
pub fn energy_at(tables: &[f32], table: u32, is_inside: bool, cos: f32) -> f32 {
    let first = table as usize + if is_inside { ENERGY_ENTRIES } else { 0 };
    let place = cos.clamp(0.0, 1.0).sqrt() * (ENERGY_ENTRIES - 1) as f32;
    let k = (place as usize).min(ENERGY_ENTRIES - 2);
    let t = place - k as f32;
    tables[first + k] * (1.0 - t) + tables[first + k + 1] * t
}

/// The mean of [`energy_at`] over the hemisphere, cosine-weighted.
pub fn mean_energy(tables: &[f32], table: u32, is_inside: bool) -> f32 {
    tables[table as usize + 2 * ENERGY_ENTRIES + usize::from(is_inside)]
}

/// Share of the light lost to microfacets that passes through the boundary.
pub fn lost_transmission(tables: &[f32], table: u32, is_inside: bool) -> f32 {
    tables[table as usize + 2 * ENERGY_ENTRIES + 2 + usize::from(is_inside)]
}

/// The value of some lobes, single directions left out.
pub fn bsdf_value(bsdf: &Bsdf, tables: &[f32], lobes: u32, wo: Vec3, wi: Vec3, transport: Transport) -> Vec3 {
    if wo.z == 0.0 || wi.z == 0.0 {
        return Vec3::ZERO;
    }
    if bsdf.kind == DIELECTRIC {
        return dielectric_value(bsdf, tables, lobes, wo, wi, transport);
    }
    let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
    if wi.z <= 0.0 {
        return Vec3::ZERO;
    }
    let mut value = Vec3::ZERO;
    if lobes & DIFFUSE != 0 {
        value += bsdf.diffuse * (diffuse_factor(bsdf, tables, wo.z, wi.z) * (1.0 / PI));
    }
    if lobes & GLOSSY != 0 {
        value += glossy_value(bsdf, tables, wo, wi);
    }
    value
}

/// Factor on a diffuse lobe: what a coat lets through both ways, scaled so that a white ground under it loses nothing.
fn diffuse_factor(bsdf: &Bsdf, tables: &[f32], cos_o: f32, cos_i: f32) -> f32 {
    match bsdf.kind {
        LAMBERT | PHONG => 1.0,
        PLASTIC => {
            let passes = |cos| 1.0 - energy_at(tables, bsdf.table, false, cos);
            passes(cos_o) * passes(cos_i) / (1.0 - mean_energy(tables, bsdf.table, false)).max(1e-4)
        }
        _ => 0.0,
    }
}

/// Lobes about the mirror direction, for directions on the outer side.
fn glossy_value(bsdf: &Bsdf, tables: &[f32], wo: Vec3, wi: Vec3) -> Vec3 {
    match bsdf.kind {
        PHONG => {
            let cos = Vec3::new(-wo.x, -wo.y, wo.z).dot(wi);
            if cos <= 0.0 {
                return Vec3::ZERO;
            }
            bsdf.specular * ((bsdf.exponent + 2.0) / (2.0 * PI) * power(cos.min(1.0), bsdf.exponent))
        }
        CONDUCTOR if bsdf.alpha > 0.0 => {
            let h = (wo + wi).normalize_or_zero();
            let fresnel = fresnel_conductor(wo.dot(h), bsdf.specular, bsdf.absorption);
            fresnel * reflection_density(wo, wi, h, bsdf.alpha) + lost_in_metal(bsdf, tables, wo.z, wi.z)
        }
        PLASTIC if bsdf.alpha > 0.0 => {
            let h = (wo + wi).normalize_or_zero();
            let fresnel = fresnel_dielectric(wo.dot(h), bsdf.ior);
            Vec3::splat(fresnel * reflection_density(wo, wi, h, bsdf.alpha))
        }
        _ => Vec3::ZERO,
    }
}

/// D G / (4 cos cos).
pub(crate) fn reflection_density(wo: Vec3, wi: Vec3, h: Vec3, alpha: f32) -> f32 {
    ggx_distribution(h.z, alpha) * ggx_masking_shadowing(wo.z, wi.z, alpha) / (4.0 * wo.z * wi.z)
}

/// Light between several microfacets of a metal, with a colour that deepens (Fdez-Aguera 2019).
fn lost_in_metal(bsdf: &Bsdf, tables: &[f32], cos_o: f32, cos_i: f32) -> Vec3 {
    let lost = |cos| 1.0 - energy_at(tables, bsdf.table, false, cos);
    let mean = mean_energy(tables, bsdf.table, false);
    let fresnel = mean_conductor(bsdf);
    let color = fresnel * fresnel * mean / (Vec3::ONE - fresnel * (1.0 - mean)).max(Vec3::splat(1e-4));
    color * (lost(cos_o) * lost(cos_i) / (PI * (1.0 - mean).max(1e-4)))
}

/// Cosine-weighted mean of a metal's reflectance: Gauss-Legendre with three points in cos^2.
fn mean_conductor(bsdf: &Bsdf) -> Vec3 {
    const NODES: [(f32, f32); 3] = [(0.112_701_67, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_35, 5.0 / 18.0)];
    let at = |(u, weight): (f32, f32)| fresnel_conductor(u.sqrt(), bsdf.specular, bsdf.absorption) * weight;
    at(NODES[0]) + at(NODES[1]) + at(NODES[2])
}

/// Chances of the lobes when a direction is drawn: diffuse, glossy or specular reflection. The rest is what dielectrics
/// refract.
fn chance_of_shine(bsdf: &Bsdf, tables: &[f32], lobes: u32, cos_o: f32) -> f32 {
    let has = lobes & lobes_of(bsdf);
    if has & DIFFUSE == 0 {
        return 1.0;
    }
    if has & (GLOSSY | SPECULAR) == 0 {
        return 0.0;
    }
    let (diffuse, shine) = if bsdf.kind == PHONG {
        (bsdf.diffuse.max_element(), bsdf.specular.max_element())
    } else {
        let reflected = energy_at(tables, bsdf.table, false, cos_o);
        (bsdf.diffuse.max_element() * (1.0 - reflected), reflected)
    };
    if diffuse + shine > 0.0 { shine / (diffuse + shine) } else { 0.0 }
}

/// Chance that a direction of a rough metal or dielectric is drawn from its microfacets, not from the diffuse lobe that
/// stands for what they lose.
pub(crate) fn chance_of_facets(bsdf: &Bsdf, tables: &[f32], is_inside: bool, cos_o: f32) -> f32 {
    if bsdf.kind == PLASTIC { 1.0 } else { energy_at(tables, bsdf.table, is_inside, cos_o).clamp(0.05, 1.0) }
}

/// The density of [`sample_bsdf`] over some lobes, single directions left out.
pub fn bsdf_pdf(bsdf: &Bsdf, tables: &[f32], lobes: u32, wo: Vec3, wi: Vec3) -> f32 {
    if wo.z == 0.0 || wi.z == 0.0 || lobes & lobes_of(bsdf) & (DIFFUSE | GLOSSY) == 0 {
        return 0.0;
    }
    if bsdf.kind == DIELECTRIC {
        return dielectric_pdf(bsdf, tables, wo, wi);
    }
    let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
    if wi.z <= 0.0 {
        return 0.0;
    }
    let shine = chance_of_shine(bsdf, tables, lobes, wo.z);
    let mut pdf = (1.0 - shine) * wi.z * (1.0 / PI);
    if lobes & GLOSSY != 0 && shine > 0.0 {
        pdf += shine * glossy_pdf(bsdf, tables, wo, wi);
    }
    pdf
}

fn glossy_pdf(bsdf: &Bsdf, tables: &[f32], wo: Vec3, wi: Vec3) -> f32 {
    match bsdf.kind {
        PHONG => {
            let cos = Vec3::new(-wo.x, -wo.y, wo.z).dot(wi).clamp(0.0, 1.0);
            (bsdf.exponent + 1.0) / (2.0 * PI) * power(cos, bsdf.exponent)
        }
        CONDUCTOR | PLASTIC if bsdf.alpha > 0.0 => {
            let h = (wo + wi).normalize_or_zero();
            let facets = chance_of_facets(bsdf, tables, false, wo.z);
            let of_facets = visible_normal_pdf(wo, h, bsdf.alpha) / (4.0 * wo.dot(h)).max(1e-7);
            facets * of_facets + (1.0 - facets) * wi.z * (1.0 / PI)
        }
        _ => 0.0,
    }
}

/// A direction drawn from some lobes; `None` if there is none. `random[2]` chooses the lobe.
pub fn sample_bsdf(
    bsdf: &Bsdf,
    tables: &[f32],
    lobes: u32,
    wo: Vec3,
    random: [f32; 3],
    transport: Transport,
) -> Option<BsdfSample> {
    let has = lobes & lobes_of(bsdf);
    if has == 0 || wo.z == 0.0 {
        return None;
    }
    if bsdf.kind == DIELECTRIC {
        return sample_dielectric(bsdf, tables, has, wo, random, transport);
    }
    let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
    let outer = wo * side;
    let shine = chance_of_shine(bsdf, tables, lobes, outer.z);
    if random[2] >= shine {
        let wi = sample_cosine_cone(Vec3::Z, 1.0, [random[0], random[1]]);
        return weighted(bsdf, tables, has, outer, wi, side, DIFFUSE);
    }
    if has & SPECULAR != 0 {
        let wi = Vec3::new(-outer.x, -outer.y, outer.z);
        let color = match bsdf.kind {
            MIRROR => bsdf.specular,
            CONDUCTOR => fresnel_conductor(outer.z, bsdf.specular, bsdf.absorption),
            _ => Vec3::splat(fresnel_dielectric(outer.z, bsdf.ior)),
        };
        return Some(BsdfSample { wi: wi * side, weight: color / shine, pdf: 0.0, lobe: SPECULAR });
    }
    // What is left of the number that chose the lobe chooses between microfacets and what they lose.
    let rest = random[2] / shine;
    let wi = if bsdf.kind == PHONG {
        sample_phong(outer, bsdf.exponent, [random[0], random[1]])
    } else if rest < chance_of_facets(bsdf, tables, false, outer.z) {
        let h = sample_visible_normal(outer, bsdf.alpha, [random[0], random[1]]);
        h * (2.0 * outer.dot(h)) - outer
    } else {
        sample_cosine_cone(Vec3::Z, 1.0, [random[0], random[1]])
    };
    weighted(bsdf, tables, has, outer, wi, side, GLOSSY)
}

/// A sample with value and density of all lobes that might have drawn it.
fn weighted(bsdf: &Bsdf, tables: &[f32], lobes: u32, wo: Vec3, wi: Vec3, side: f32, lobe: u32) -> Option<BsdfSample> {
    if wi.z <= 0.0 {
        return None;
    }
    let pdf = bsdf_pdf(bsdf, tables, lobes, wo, wi);
    if pdf <= 0.0 || !pdf.is_finite() {
        return None;
    }
    let weight = bsdf_value(bsdf, tables, lobes, wo, wi, Transport::Radiance) * (wi.z / pdf);
    Some(BsdfSample { wi: wi * side, weight, pdf, lobe })
}

fn sample_phong(wo: Vec3, exponent: f32, random: [f32; 2]) -> Vec3 {
    let cos = power(random[0], 1.0 / (exponent + 1.0));
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = sin_cos_turns(random[1]);
    let axis = Vec3::new(-wo.x, -wo.y, wo.z);
    let (tangent, bitangent) = frame(axis);
    tangent * (sin * c) + bitangent * (sin * s) + axis * cos
}
