//! Materials made flat, with their energy tables.

use lightcuts_kernel::bsdf::{CONDUCTOR, DIELECTRIC, ENERGY_FLOATS, LAMBERT, MIRROR, PHONG, PLASTIC};
use lightcuts_kernel::energy::energy_tables;
use lightcuts_kernel::ray::NONE;
use lightcuts_kernel::scatter::{MIX, Scatter};
use lightcuts_scene::physical::{ImageId, Scattering, SurfaceDesc};
use std::collections::HashMap;

/// Narrower microfacet distributions count as smooth: their lobes are sharper than 32-bit floats tell apart.
const LEAST_ALPHA: f32 = 1e-3;

/// All materials, and the energy tables that they share. There is always one table.
pub(super) fn flatten(materials: &[SurfaceDesc]) -> (Vec<Scatter>, Vec<f32>) {
    let mut tables = Tables::default();
    tables.of(LAMBERT, 0.0, 1.0);
    let scatters = materials.iter().map(|desc| scatter(desc, &mut tables)).collect();
    (scatters, tables.floats)
}

/// Whether a material, or an ingredient of a mix, has an image. Mixes lead nowhere in a circle.
pub(super) fn is_textured(scatters: &[Scatter], index: usize) -> bool {
    let Scatter { color_image, specular_image, radiance_image, normal_image, mask_image, weight_image, .. } =
        scatters[index];
    let images = [color_image, specular_image, radiance_image, normal_image, mask_image, weight_image];
    let Scatter { kind, first, second, .. } = scatters[index];
    images.into_iter().any(|image| image != NONE)
        || (kind == MIX && [first, second].into_iter().any(|part| is_textured(scatters, part as usize)))
}

/// Energy tables; materials that lose alike share theirs.
#[derive(Default)]
struct Tables {
    floats: Vec<f32>,
    known: HashMap<(u32, u32, u32), u32>,
}

impl Tables {
    /// Index of a material's first float.
    fn of(&mut self, kind: u32, alpha: f32, ior: f32) -> u32 {
        let floats = &mut self.floats;
        *self.known.entry((kind, alpha.to_bits(), ior.to_bits())).or_insert_with(|| {
            let first = floats.len() as u32;
            debug_assert!(floats.len().is_multiple_of(ENERGY_FLOATS));
            floats.extend(energy_tables(kind, alpha, ior));
            first
        })
    }
}

fn number(image: Option<ImageId>) -> u32 {
    image.map_or(NONE, |image| image.0)
}

fn alpha(roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    if alpha < LEAST_ALPHA { 0.0 } else { alpha }
}

fn scatter(desc: &SurfaceDesc, tables: &mut Tables) -> Scatter {
    let base = Scatter {
        radiance: desc.emission.map_or(glam::Vec3::ZERO, |emission| emission.radiance),
        radiance_image: number(desc.emission.and_then(|emission| emission.image)),
        two_sided: u32::from(desc.emission.is_some_and(|emission| emission.two_sided)),
        normal_image: number(desc.normal_map),
        mask_image: number(desc.alpha.map(|mask| mask.image)),
        mask_threshold: desc.alpha.map_or(0.0, |mask| mask.threshold),
        color_image: NONE,
        specular_image: NONE,
        weight_image: NONE,
        ..bytemuck::Zeroable::zeroed()
    };
    match desc.scattering {
        Scattering::Lambert { albedo } => {
            Scatter { kind: LAMBERT, color: albedo.color, color_image: number(albedo.image), ..base }
        }
        Scattering::Phong { diffuse, specular, exponent } => Scatter {
            kind: PHONG,
            color: diffuse.color,
            color_image: number(diffuse.image),
            specular: specular.color,
            specular_image: number(specular.image),
            exponent,
            ..base
        },
        Scattering::Conductor { eta, k, roughness } => {
            let alpha = alpha(roughness);
            let table = if alpha > 0.0 { tables.of(CONDUCTOR, alpha, 1.0) } else { 0 };
            Scatter { kind: CONDUCTOR, specular: eta, absorption: k, alpha, table, ..base }
        }
        Scattering::Dielectric { ior, roughness, transmittance } => {
            let alpha = alpha(roughness);
            let table = if alpha > 0.0 { tables.of(DIELECTRIC, alpha, ior) } else { 0 };
            Scatter { kind: DIELECTRIC, specular: transmittance, ior, alpha, table, ..base }
        }
        Scattering::Plastic { albedo, ior, roughness } => {
            let alpha = alpha(roughness);
            Scatter {
                kind: PLASTIC,
                color: albedo.color,
                color_image: number(albedo.image),
                ior,
                alpha,
                table: tables.of(PLASTIC, alpha, ior),
                ..base
            }
        }
        Scattering::Mirror { reflectance } => {
            Scatter { kind: MIRROR, specular: reflectance.color, specular_image: number(reflectance.image), ..base }
        }
        Scattering::Mix { first, second, weight, image } => {
            Scatter { kind: MIX, first: first.0, second: second.0, weight, weight_image: number(image), ..base }
        }
    }
}
