//! Metals by name or colour.

use glam::Vec3;

/// Refractive and absorption index of metals for red, green and blue.
///
/// Measurements of P. B. Johnson and R. W. Christy (1972, 1974) and, for aluminium, A. D. Rakic (1995), at 650, 550 and 450 nm, as
/// refractiveindex.info gives them; the selection is that of the labPBR material standard 1.3.
pub(super) const METALS: [(&str, Metal); 5] = [
    ("gold", Metal { eta: Vec3::new(0.18299, 0.42108, 1.3734), k: Vec3::new(3.4242, 2.3459, 1.7704) }),
    ("silver", Metal { eta: Vec3::new(0.15943, 0.14512, 0.13547), k: Vec3::new(3.9291, 3.19, 2.3808) }),
    ("copper", Metal { eta: Vec3::new(0.27105, 0.67693, 1.3164), k: Vec3::new(3.6092, 2.6248, 2.2921) }),
    ("aluminium", Metal { eta: Vec3::new(1.3456, 0.96521, 0.61722), k: Vec3::new(7.4746, 6.3995, 5.3031) }),
    ("iron", Metal { eta: Vec3::new(2.9114, 2.9497, 2.5845), k: Vec3::new(3.0893, 2.9318, 2.767) }),
];

/// Greatest reflectance of a metal that is given by it: the next one would need an infinite index.
const MAX_REFLECTANCE: f32 = 0.999;

/// What makes a metal look like one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Metal {
    pub(super) eta: Vec3,
    pub(super) k: Vec3,
}

impl Metal {
    /// A metal that reflects this share of light that falls on it straight.
    ///
    /// Many pairs do (Gulbrandsen, "Artist Friendly Metallic Fresnel", JCGT 2014). This one has the refractive index of air:
    /// R = k^2 / (4 + k^2). Without absorption, eta = (1 + sqrt R) / (1 - sqrt R), it would dip to no reflection of one
    /// polarisation at grazing angles, and pass the greatest index that scenes may have from R = 0.961 on.
    pub(super) fn of_reflectance(reflectance: Vec3) -> Self {
        let reflectance = reflectance.clamp(Vec3::ZERO, Vec3::splat(MAX_REFLECTANCE));
        let k = |share: f32| 2.0 * (share / (1.0 - share)).sqrt();
        Self { eta: Vec3::ONE, k: Vec3::from_array(reflectance.to_array().map(k)) }
    }

    /// The share of light that it reflects where it falls on it straight.
    #[cfg(test)]
    fn reflectance(self) -> Vec3 {
        let k_sq = self.k * self.k;
        let (less, more) = (self.eta - 1.0, self.eta + 1.0);
        (less * less + k_sq) / (more * more + k_sq)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reflectance_comes_back() {
        for share in [0.0, 0.04, 0.5, 0.9, 0.97, 0.999] {
            let back = Metal::of_reflectance(Vec3::splat(share)).reflectance();
            assert!((back.x - share).abs() < 1e-5, "{share}: {back}");
        }
        assert!((Metal::of_reflectance(Vec3::ONE).reflectance().x - MAX_REFLECTANCE).abs() < 1e-5);
        assert!(Metal::of_reflectance(Vec3::ONE).k.x < 100.0);
    }

    /// F0 of metals as tables for rendering give them (e.g. Hoffman, "Background: Physics and Math of Shading", 2013).
    #[test]
    fn metals_have_their_colours() {
        let published = [
            ("gold", [1.0, 0.77, 0.34]),
            ("silver", [0.97, 0.96, 0.91]),
            ("copper", [0.96, 0.64, 0.54]),
            ("aluminium", [0.91, 0.91, 0.92]),
            ("iron", [0.56, 0.57, 0.58]),
        ];
        for ((name, metal), (same, color)) in METALS.iter().zip(published) {
            let difference = (metal.reflectance() - Vec3::from_array(color)).abs().max_element();
            assert!(*name == same && difference < 0.1, "{name}: {}", metal.reflectance());
        }
    }
}
