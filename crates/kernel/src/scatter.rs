//! Flat materials of the physical model, and what they are at a point: textures looked up, mixes decided.

use crate::bsdf::Bsdf;
use crate::mip::{MipImage, decode_normal, mip_sample};
use crate::ray::NONE;
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// One material here and another there; the other kinds are those of [`crate::bsdf`].
pub const MIX: u32 = 6;

/// Mixes on the way to a material that is none, at most.
pub const MAX_MIXES: u32 = 8;

/// A material. 128 bytes. Images are indices, or [`NONE`].
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Scatter {
    /// Diffuse colour.
    pub color: Vec3,
    /// A kind of [`crate::bsdf`], or [`MIX`].
    pub kind: u32,
    /// Colour of the Phong lobe, of the mirror, of what passes through glass; refractive indices of a metal.
    pub specular: Vec3,
    /// Width of the microfacet distribution; 0 is smooth.
    pub alpha: f32,
    /// Absorption indices of a metal.
    pub absorption: Vec3,
    /// Refractive index inside, relative to outside.
    pub ior: f32,
    /// Emitted radiance.
    pub radiance: Vec3,
    /// Exponent of the Phong lobe.
    pub exponent: f32,
    /// Factor on `color`.
    pub color_image: u32,
    /// Factor on `specular`.
    pub specular_image: u32,
    /// Factor on `radiance`.
    pub radiance_image: u32,
    /// Normals in tangent space.
    pub normal_image: u32,
    /// Where the surface is there.
    pub mask_image: u32,
    /// Least value of the mask where it is.
    pub mask_threshold: f32,
    /// Index of the first float of its energy tables.
    pub table: u32,
    /// Whether its back shines too.
    pub two_sided: u32,
    /// Of a mix, the material where the weight is 0.
    pub first: u32,
    /// Of a mix, the material where it is 1.
    pub second: u32,
    /// Of a mix, the weight.
    pub weight: f32,
    /// Factor on `weight`.
    pub weight_image: u32,
}

/// All images.
#[derive(Debug, Clone, Copy)]
pub struct Images<'a> {
    /// Where each lies.
    pub images: &'a [MipImage],
    /// Pixels of all.
    pub words: &'a [u32],
}

/// Where a surface is looked at, for textures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturePlace {
    /// Coordinates: u to the right, v up.
    pub uv: [f32; 2],
    /// Edge of the footprint in these coordinates; 0 for a point.
    pub width: f32,
}

/// An image at a place; white where there is none.
pub fn image_at(images: &Images<'_>, image: u32, place: &TexturePlace) -> Vec4 {
    if image == NONE {
        return Vec4::ONE;
    }
    mip_sample(images.words, &images.images[image as usize], place.uv, place.width)
}

/// The material that a mix is at a place: each with the probability of its weight. `random` is in 0..1.
pub fn chosen_scatter(scatters: &[Scatter], images: &Images<'_>, index: u32, place: &TexturePlace, random: f32) -> u32 {
    let (mut index, mut random) = (index, random);
    for _ in 0..=MAX_MIXES {
        let scatter = &scatters[index as usize];
        if scatter.kind != MIX {
            break;
        }
        let weight = (scatter.weight * image_at(images, scatter.weight_image, place).x).clamp(0.0, 1.0);
        // What is left of the number after a choice is uniform again.
        (index, random) = if random < weight {
            (scatter.second, random / weight)
        } else {
            (scatter.first, (random - weight) / (1.0 - weight))
        };
    }
    index
}

/// The BSDF of a material that is no mix.
pub fn scatter_bsdf(scatter: &Scatter, images: &Images<'_>, place: &TexturePlace) -> Bsdf {
    let tinted = |color: Vec3, image: u32| color * image_at(images, image, place).truncate();
    Bsdf {
        diffuse: tinted(scatter.color, scatter.color_image),
        kind: scatter.kind,
        specular: tinted(scatter.specular, scatter.specular_image),
        alpha: scatter.alpha,
        absorption: scatter.absorption,
        ior: scatter.ior,
        exponent: scatter.exponent,
        table: scatter.table,
        padding: [0; 2],
    }
}

/// The normal of a normal map in tangent space; (0, 0, 1) where there is none.
pub fn scatter_normal(scatter: &Scatter, images: &Images<'_>, place: &TexturePlace) -> Vec3 {
    if scatter.normal_image == NONE {
        return Vec3::Z;
    }
    decode_normal(image_at(images, scatter.normal_image, place).truncate())
}

/// Radiance of the side that the normal points to, or of both.
pub fn scatter_radiance(scatter: &Scatter, images: &Images<'_>, place: &TexturePlace, is_front: bool) -> Vec3 {
    if !is_front && scatter.two_sided == 0 {
        return Vec3::ZERO;
    }
    scatter.radiance * image_at(images, scatter.radiance_image, place).truncate()
}

/// Whether a surface is there at all.
pub fn is_there(scatter: &Scatter, images: &Images<'_>, place: &TexturePlace) -> bool {
    if scatter.mask_image == NONE {
        return true;
    }
    let pixel = image_at(images, scatter.mask_image, place);
    let has_alpha = images.images[scatter.mask_image as usize].has_alpha != 0;
    (if has_alpha { pixel.w } else { pixel.x }) >= scatter.mask_threshold
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{LAMBERT, MIRROR};

    const NOWHERE: TexturePlace = TexturePlace { uv: [0.0; 2], width: 0.0 };

    fn plain(kind: u32) -> Scatter {
        Scatter {
            kind,
            color_image: NONE,
            specular_image: NONE,
            radiance_image: NONE,
            normal_image: NONE,
            mask_image: NONE,
            weight_image: NONE,
            ..Scatter::zeroed()
        }
    }

    #[test]
    fn mixes_choose_by_weight_and_nest() {
        let mix = |first, second, weight| Scatter { first, second, weight, ..plain(MIX) };
        let scatters = [mix(1, 2, 0.25), mix(2, 3, 0.5), plain(LAMBERT), plain(MIRROR)];
        let images = Images { images: &[], words: &[] };
        let mut counts = [0_u32; 4];
        for k in 0..8000 {
            let random = (k as f32 + 0.5) / 8000.0;
            counts[chosen_scatter(&scatters, &images, 0, &NOWHERE, random) as usize] += 1;
        }
        assert_eq!(counts, [0, 0, 2000 + 3000, 3000]);
    }

    #[test]
    fn the_back_of_a_light_is_dark() {
        let images = Images { images: &[], words: &[] };
        let scatter = Scatter { radiance: Vec3::ONE, ..plain(LAMBERT) };
        assert_eq!(scatter_radiance(&scatter, &images, &NOWHERE, true), Vec3::ONE);
        assert_eq!(scatter_radiance(&scatter, &images, &NOWHERE, false), Vec3::ZERO);
        assert!(is_there(&scatter, &images, &NOWHERE));
        assert_eq!(scatter_normal(&scatter, &images, &NOWHERE), Vec3::Z);
    }
}
