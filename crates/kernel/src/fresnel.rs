//! How much a boundary between media reflects.

use glam::Vec3;

/// Share of unpolarised light that a boundary of dielectrics reflects. `cos_i` is the cosine of incidence, at least 0;
/// `eta` the refractive index beyond the boundary relative to that before it. 1 at total internal reflection.
pub fn fresnel_dielectric(cos_i: f32, eta: f32) -> f32 {
    let cos_i = cos_i.clamp(0.0, 1.0);
    let sin_t_sq = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin_t_sq >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin_t_sq).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    (parallel * parallel + perpendicular * perpendicular) * 0.5
}

/// The same of a metal with refractive index `eta` and absorption index `k`, per channel (Born & Wolf, "Principles of
/// Optics", section 14.2).
pub fn fresnel_conductor(cos_i: f32, eta: Vec3, k: Vec3) -> Vec3 {
    let of = |channel: usize| fresnel_conductor_channel(cos_i, eta[channel], k[channel]);
    Vec3::new(of(0), of(1), of(2))
}

/// One channel of [`fresnel_conductor`].
pub fn fresnel_conductor_channel(cos_i: f32, eta: f32, k: f32) -> f32 {
    let cos_sq = cos_i.clamp(0.0, 1.0) * cos_i.clamp(0.0, 1.0);
    let cos = cos_sq.sqrt();
    let sin_sq = 1.0 - cos_sq;
    let (eta_sq, k_sq) = (eta * eta, k * k);
    let t = eta_sq - k_sq - sin_sq;
    let a_sq_plus_b_sq = (t * t + 4.0 * eta_sq * k_sq).sqrt();
    let a = ((a_sq_plus_b_sq + t) * 0.5).max(0.0).sqrt();
    let perpendicular = {
        let (sum, cross) = (a_sq_plus_b_sq + cos_sq, 2.0 * cos * a);
        (sum - cross) / (sum + cross).max(f32::MIN_POSITIVE)
    };
    let (sum, cross) = (cos_sq * a_sq_plus_b_sq + sin_sq * sin_sq, 2.0 * cos * a * sin_sq);
    let parallel = perpendicular * (sum - cross) / (sum + cross).max(f32::MIN_POSITIVE);
    ((parallel + perpendicular) * 0.5).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_by_the_book() {
        assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-6);
        assert!((fresnel_dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-6);
        assert_eq!(fresnel_dielectric(0.0, 1.5), 1.0);
        // Beyond the critical angle of 41.8 degrees everything stays inside.
        assert_eq!(fresnel_dielectric(0.74, 1.0 / 1.5), 1.0);
        assert!(fresnel_dielectric(0.76, 1.0 / 1.5) < 1.0);
        // At Brewster's angle only one polarisation is reflected: ((1 - 2.25) / (1 + 2.25))^2 / 2.
        let brewster = (1.0_f32 / (1.0 + 2.25)).sqrt();
        assert!((fresnel_dielectric(brewster, 1.5) - 0.073_964).abs() < 1e-5);
    }

    #[test]
    fn a_metal_without_absorption_is_a_dielectric() {
        for k in 0..=20 {
            let cos = k as f32 / 20.0;
            assert!((fresnel_conductor_channel(cos, 1.5, 0.0) - fresnel_dielectric(cos, 1.5)).abs() < 1e-5, "{cos}");
        }
    }

    #[test]
    fn metals_reflect_what_tables_say() {
        // At normal incidence ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
        let (n, k) = (Vec3::new(0.2, 1.0, 1.66), Vec3::new(3.9, 2.5, 9.0));
        let expected = ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k);
        assert!((fresnel_conductor(1.0, n, k) - expected).length() < 1e-5);
        assert!((fresnel_conductor(0.0, n, k) - Vec3::ONE).length() < 1e-5);
    }
}
