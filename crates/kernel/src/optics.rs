//! Mirror and refraction directions.

use crate::Rules;
use glam::Vec3;

/// The direction mirrored at a surface with this normal; the length stays.
pub fn reflect_at(direction: Vec3, normal: Vec3) -> Vec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

/// The unit direction refracted at a surface by Snell's law, or `None` at total reflection. `ratio` is n1/n2 for a ray
/// that enters against the normal.
///
/// The original does not invert the ratio for a ray that leaves.
pub fn refract_at(direction: Vec3, normal: Vec3, ratio: f32, rules: Rules) -> Option<Vec3> {
    let leaving = direction.dot(normal) >= 0.0;
    let facing = if leaving { -normal } else { normal };
    let ratio = if leaving && rules == Rules::Repaired { 1.0 / ratio } else { ratio };
    let cos_in = -facing.dot(direction);
    let cos_out_sq = 1.0 - ratio * ratio * (1.0 - cos_in * cos_in);
    (cos_out_sq >= 0.0 && ratio.is_finite()).then(|| direction * ratio + facing * (ratio * cos_in - cos_out_sq.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;

    #[test]
    fn mirrors_keep_the_angle() {
        assert!((reflect_at(Vec3::new(HALF, -HALF, 0.0), Vec3::Y) - Vec3::new(HALF, HALF, 0.0)).length() < 1e-6);
    }

    #[test]
    fn snell_holds_and_reverses() {
        let direction = Vec3::new(HALF, -HALF, 0.0);
        let inside = refract_at(direction, Vec3::Y, 0.5, Rules::Repaired).unwrap();
        assert!((inside.x - 0.5 * HALF).abs() < 1e-6 && (inside.length() - 1.0).abs() < 1e-6);
        // Out at the bottom of a slab, whose outward normal points down: parallel to the way in.
        let outside = refract_at(inside, Vec3::NEG_Y, 0.5, Rules::Repaired).unwrap();
        assert!((outside - direction).length() < 1e-6);
    }

    #[test]
    fn total_reflection_has_no_refracted_ray() {
        let grazing = Vec3::new(0.9, (1.0_f32 - 0.81).sqrt(), 0.0);
        assert!(refract_at(grazing, Vec3::Y, 0.5, Rules::Repaired).is_none());
        assert!(refract_at(grazing, Vec3::Y, 0.5, Rules::Original).is_some());
    }
}
