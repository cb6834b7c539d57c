//! Materials as the format's paper has them: `Kd` and `Ks` are reflectances, `illum` says what else the surface does.
//!
//! L. Ramey, L. Rose, L. Tyerman, "MTL material format (Lightwave, OBJ)", 1995.

use super::{Converter, SHARE};
use glam::Vec3;
use lightcuts_scene::physical::{Scattering, Tint};

/// Least and greatest exponent of the Phong material.
const EXPONENTS: (f32, f32) = (1.0, 1e6);

/// Illumination models without highlights, with mirrors, and with glass.
const WITHOUT_HIGHLIGHT: [u8; 2] = [0, 1];
const MIRRORS: [u8; 3] = [3, 5, 8];
const GLASSES: [u8; 4] = [4, 6, 7, 9];
/// Those that ask for rays, which every material gets here.
const TRACED: std::ops::RangeInclusive<u8> = 3..=7;

impl Converter<'_, '_> {
    pub(super) fn classic(&mut self) -> Scattering {
        let diffuse = self.base_color();
        let is_black = diffuse.color == Vec3::ZERO && diffuse.image.is_none();
        let model = self.illumination();
        match model {
            Some(model) if is_black && MIRRORS.contains(&model) => return self.mirror(),
            Some(model) if is_black && GLASSES.contains(&model) => return self.glass(),
            Some(model) if TRACED.contains(&model) => {
                let name = &self.found.desc.name;
                self.warn(
                    "illum",
                    &format!("mirrors and glass with a diffuse colour are not supported: `{name}` is opaque"),
                );
            }
            _ => {}
        }
        let has_highlight = !model.is_some_and(|model| WITHOUT_HIGHLIGHT.contains(&model));
        let specular = if has_highlight { self.specular() } else { Vec3::ZERO };
        let scale = self.scale(diffuse.color, specular);
        let diffuse = Tint { color: diffuse.color * scale, ..diffuse };
        if specular == Vec3::ZERO {
            return Scattering::Lambert { albedo: diffuse };
        }
        Scattering::Phong { diffuse, specular: (specular * scale).into(), exponent: self.exponent() }
    }

    /// Whether the material is glass by the format.
    pub(super) fn is_glass(&mut self) -> bool {
        let is_black = self.found.texture.is_none() && self.found.desc.diffuse == Vec3::ZERO;
        is_black && self.number("illum").is_some_and(|mode| GLASSES.iter().any(|glass| f32::from(*glass) == mode))
    }

    fn mirror(&mut self) -> Scattering {
        let reflectance = if self.found.gives("specular") { self.specular() } else { Vec3::ONE };
        let scale = self.scale(Vec3::ZERO, reflectance);
        Scattering::Mirror { reflectance: (reflectance * scale).into() }
    }

    fn glass(&mut self) -> Scattering {
        let Some(ior) = self.ior() else {
            let name = &self.found.desc.name;
            self.warn("Ni", &format!("glass of index 1 refracts nothing: `{name}` is taken as opaque and black"));
            return Scattering::Lambert { albedo: Vec3::ZERO.into() };
        };
        let transmittance = self.color("Tf").unwrap_or(Vec3::ONE);
        let transmittance = self.color_within("Tf", transmittance, SHARE);
        let roughness = self.number("Pr").unwrap_or(0.0);
        let roughness = self.within("Pr", roughness, SHARE);
        Scattering::Dielectric { ior, roughness, transmittance }
    }

    fn exponent(&mut self) -> f32 {
        let (least, greatest) = EXPONENTS;
        let exponent = self.found.desc.exponent;
        let used = exponent.clamp(least, greatest);
        // 0 to 1 is common, and next to 1.
        if (0.0..=least).contains(&exponent) { used } else { self.used("Ns", exponent, used) }
    }

    /// Factor that keeps `Kd` and `Ks` together at 1 at most: no surface reflects more light than falls on it.
    fn scale(&mut self, diffuse: Vec3, specular: Vec3) -> f32 {
        let sum = (diffuse + specular).max_element();
        if sum <= 1.0 {
            return 1.0;
        }
        let scale = sum.recip();
        let name = &self.found.desc.name;
        let (keyword, what) = match (diffuse == Vec3::ZERO, specular == Vec3::ZERO) {
            (true, _) => ("Ks", "`Ks` is"),
            (_, true) => ("Kd", "`Kd` is"),
            _ => ("Ks", "`Kd` and `Ks` together are"),
        };
        let message =
            format!("{what} {sum:.4} in the material `{name}`, more than all light: multiplied by {scale:.4}");
        self.warn(keyword, &message);
        scale
    }
}
