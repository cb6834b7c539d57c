//! Directions from uniform random numbers.

use glam::Vec3;

/// Sine and cosine of `turn` full turns, 0..1, within 4e-6: polynomials, so that devices agree.
pub fn sin_cos_turns(turn: f32) -> (f32, f32) {
    // Fold to an eighth of a turn on either side of a quarter, where the Taylor series are short.
    let quarter = (turn * 4.0 + 0.5).floor();
    let x = (turn - quarter * 0.25) * std::f32::consts::TAU;
    let s = x * x;
    let sin = x * (1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 - s * (1.0 / 5_040.0))));
    let cos = 1.0 + s * (-0.5 + s * (1.0 / 24.0 + s * (-1.0 / 720.0 + s * (1.0 / 40_320.0))));
    match (quarter as i32).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Two unit vectors that form a right-handed frame with a unit normal (Duff et al. 2017, "Building an Orthonormal
/// Basis, Revisited").
pub fn frame(normal: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    (
        Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    )
}

/// A unit direction within an angle of a unit normal, distributed in proportion to its cosine. `sin_max` is the sine
/// of the angle (1 for the whole hemisphere). The density is cos / (pi sin_max^2) per steradian.
pub fn sample_cosine_cone(normal: Vec3, sin_max: f32, random: [f32; 2]) -> Vec3 {
    let sin_sq = random[0] * sin_max * sin_max;
    let radius = sin_sq.sqrt();
    let (sin, cos) = sin_cos_turns(random[1]);
    let (tangent, bitangent) = frame(normal);
    tangent * (radius * cos) + bitangent * (radius * sin) + normal * (1.0 - sin_sq).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::random4;

    #[test]
    fn sine_and_cosine() {
        for k in 0..=1000 {
            let turn = k as f32 / 1000.0;
            let (sin, cos) = sin_cos_turns(turn);
            let (s, c) = (turn * std::f32::consts::TAU).sin_cos();
            assert!((sin - s).abs() < 4e-6 && (cos - c).abs() < 4e-6, "{turn}: {sin} {s} {cos} {c}");
        }
    }

    #[test]
    fn frames_are_orthonormal() {
        for k in 0..200 {
            let [a, b, c, _] = random4(k, 0, 0, 1);
            let normal = (Vec3::new(a, b, c) - 0.5).normalize();
            let (t, s) = frame(normal);
            assert!(t.dot(s).abs() < 1e-5 && t.dot(normal).abs() < 1e-5 && (t.cross(s) - normal).length() < 1e-5);
        }
    }

    #[test]
    fn the_mean_cosine_is_that_of_the_density() {
        // Over the cone of 50 degrees the mean of cos under a cosine density is 2/3 (1 - c^3) / (1 - c^2).
        let angle = 50.0_f32.to_radians();
        let n = 100_000;
        let mut sum = 0.0;
        for k in 0..n {
            let [a, b, ..] = random4(k, 0, 0, 7);
            let d = sample_cosine_cone(Vec3::Z, angle.sin(), [a, b]);
            assert!(d.z >= angle.cos() - 1e-5 && (d.length() - 1.0).abs() < 1e-5);
            sum += f64::from(d.z);
        }
        let c = f64::from(angle.cos());
        let expected = 2.0 / 3.0 * (1.0 - c.powi(3)) / (1.0 - c * c);
        assert!((sum / f64::from(n) - expected).abs() < 1e-3);
    }
}
