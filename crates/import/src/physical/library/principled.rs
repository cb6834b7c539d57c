//! Materials with a base colour, a roughness and a metalness: those of Blender, and of all that write `Pr` or `Pm`.
//!
//! Blender writes its "Principled BSDF". `Ks` is its specular level there and no reflectance: 0.5 is the surface of index `Ni`.
//! Without "PBR extensions" `Ns` stands for the roughness, and `illum` 3 for a metal.

use super::super::metal::Metal;
use super::{Converter, IORS, MIN_CONTRAST, SHARE};
use crate::obj::Writer;
use glam::Vec3;
use lightcuts_scene::physical::{Scattering, SurfaceDesc, Tint};

/// Roughness and specular level where a file gives none: the defaults of the Principled BSDF.
const ROUGHNESS: f32 = 0.5;
const SPECULAR_LEVEL: f32 = 0.5;

/// Illumination models by which Blender tells a metal: opaque, and partly transparent.
const METALS: [u8; 2] = [3, 6];

/// Greatest exponent of the Phong material.
const MAX_EXPONENT: f32 = 1e6;

impl Converter<'_, '_> {
    pub(super) fn principled(&mut self) -> Scattering {
        let base = self.base_color();
        let base = Tint { color: self.color_within("Kd", base.color, SHARE), ..base };
        let roughness = self.roughness();
        let coated = self.coated(base, roughness);
        let transmission = if self.is_of_blender() { self.number("Tf").unwrap_or(0.0) } else { 0.0 };
        let transmission = self.within("Tf", transmission, SHARE);
        let body = match self.refracting(base, roughness, transmission) {
            Some(glass) => self.mixed(coated, glass, transmission),
            None => coated,
        };
        let metalness = self.metalness();
        if metalness <= 0.0 {
            return body;
        }
        let metal = metal(base, roughness);
        self.mixed(body, metal, metalness)
    }

    fn roughness(&mut self) -> f32 {
        if let Some(roughness) = self.number("Pr") {
            return self.within("Pr", roughness, SHARE);
        }
        match self.library.writer() {
            Writer::Blender { greatest_exponent } if self.found.gives("exponent") => {
                let exponent = self.within("Ns", self.found.desc.exponent, (0.0, greatest_exponent));
                1.0 - (exponent / greatest_exponent).sqrt()
            }
            _ => ROUGHNESS,
        }
    }

    fn metalness(&mut self) -> f32 {
        if let Some(metalness) = self.number("Pm") {
            return self.within("Pm", metalness, SHARE);
        }
        let is_metal = self.is_of_blender() && self.illumination().is_some_and(|model| METALS.contains(&model));
        // Blender writes the metalness as ambient colour then.
        match (is_metal, self.found.gives("ambient")) {
            (true, true) => self.within("Ka", self.found.desc.ambient.x, SHARE),
            (true, false) => 1.0,
            (false, _) => 0.0,
        }
    }

    /// Diffuse under a coat; without one where the coat would reflect nothing.
    fn coated(&mut self, base: Tint, roughness: f32) -> Scattering {
        let is_given = self.is_of_blender() && self.found.gives("specular");
        let level = if is_given { self.specular().max_element() } else { SPECULAR_LEVEL };
        let ior = self.ior().unwrap_or(1.0);
        // The level scales the reflectance at normal incidence: F0 = 2 level ((n - 1) / (n + 1))^2.
        let root = ((ior - 1.0) / (ior + 1.0)).abs() * (2.0 * level).sqrt();
        let root = root.min((IORS.1 - 1.0) / (IORS.1 + 1.0));
        let ior = ((1.0 + root) / (1.0 - root)).min(IORS.1);
        if ior - 1.0 < MIN_CONTRAST {
            return Scattering::Lambert { albedo: base };
        }
        Scattering::Plastic { albedo: base, ior, roughness }
    }

    /// Glass, if light is to come through. The base colour tints it at both boundaries together.
    fn refracting(&mut self, base: Tint, roughness: f32, transmission: f32) -> Option<Scattering> {
        if transmission <= 0.0 {
            return None;
        }
        let name = self.found.desc.name.clone();
        let Some(ior) = self.ior() else {
            self.warn("Ni", &format!("glass of index 1 refracts nothing: `{name}` is taken as opaque"));
            return None;
        };
        if base.image.is_some() {
            self.warn(
                "Tf",
                &format!("textures of glass are not supported: that of `{name}` is ignored where light passes"),
            );
        }
        let transmittance = Vec3::from_array(base.color.to_array().map(f32::sqrt));
        Some(Scattering::Dielectric { ior, roughness, transmittance })
    }

    /// The second with this share, else the first.
    fn mixed(&mut self, first: Scattering, second: Scattering, share: f32) -> Scattering {
        if share >= 1.0 {
            return second;
        }
        let [first, second] = [first, second].map(|scattering| {
            let name = self.found.desc.name.clone();
            self.push(SurfaceDesc { name, scattering, ..SurfaceDesc::default() })
        });
        Scattering::Mix { first, second, weight: share, image: None }
    }
}

/// A metal. The one of indices has one colour: a texture becomes a Phong lobe as wide, or a mirror.
fn metal(base: Tint, roughness: f32) -> Scattering {
    if base.image.is_none() {
        let Metal { eta, k } = Metal::of_reflectance(base.color);
        return Scattering::Conductor { eta, k, roughness };
    }
    let width_sq = roughness.powi(4);
    // The exponent at which the lobe of a microfacet distribution is as wide (Walter et al. 2007, equation 30).
    let exponent = 2.0 / width_sq - 2.0;
    if exponent >= MAX_EXPONENT {
        return Scattering::Mirror { reflectance: base };
    }
    Scattering::Phong { diffuse: Vec3::ZERO.into(), specular: base, exponent: exponent.max(1.0) }
}
