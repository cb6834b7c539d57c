//! Powers and exponentials as polynomials, so that devices agree: library functions differ by up to 13 units in the last
//! place between systems.

/// Bits of the square root of one half: mantissas are brought between it and the square root of two.
const SQRT_HALF_BITS: u32 = 0x3f35_04f3;

/// 2 / ln 2.
const TWO_OVER_LN_2: f32 = 2.885_39;

/// The binary logarithm of a normal number above 0, within 2e-7 or 1e-7 of its value.
///
/// With m the mantissa and f = (m - 1) / (m + 1): ln m = 2 (f + f^3/3 + f^5/5 + ...), |f| <= 0.172.
pub fn log2_polynomial(x: f32) -> f32 {
    let bits = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = bits as i32 >> 23;
    let mantissa = f32::from_bits((bits & 0x007f_ffff) + SQRT_HALF_BITS);
    let f = (mantissa - 1.0) / (mantissa + 1.0);
    let s = f * f;
    let series = 1.0 + s * (0.333_333_34 + s * (0.2 + s * (0.142_857_15 + s * 0.111_111_11)));
    exponent as f32 + f * TWO_OVER_LN_2 * series
}

/// 2^x within 2e-7 of its value for |x| <= 1; else the rounding of x itself decides. 0 below -126, at most 2^127.
///
/// The Taylor series of 2^r on |r| <= 1/2, scaled by the exponent.
pub fn exp2_polynomial(x: f32) -> f32 {
    if x < -126.0 {
        return 0.0;
    }
    let y = x.min(127.0);
    let whole = (y + 0.5).floor();
    let r = y - whole;
    let series = 1.0
        + r * (std::f32::consts::LN_2
            + r * (0.240_226_5
                + r * (0.055_504_11
                    + r * (0.009_618_129 + r * (0.001_333_355_8 + r * (0.000_154_035_3 + r * 0.000_015_252_734))))));
    series * f32::from_bits(((whole as i32 + 127) as u32) << 23)
}

/// A base of at least 0 to a power of at least 0. 0^0 is 1; what is too small to be a normal number is 0.
pub fn power(base: f32, exponent: f32) -> f32 {
    if exponent == 0.0 {
        return 1.0;
    }
    if base < f32::MIN_POSITIVE {
        return 0.0;
    }
    exp2_polynomial(exponent * log2_polynomial(base))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_and_exponentials_are_close() {
        for k in 1..20_000 {
            let x = k as f32 * 0.000_37;
            let error = (f64::from(log2_polynomial(x)) - f64::from(x).log2()).abs();
            assert!(error < 2e-7 * f64::from(x).log2().abs().max(1.0), "{x}: {error}");
            let y = (k as f32 - 10_000.0) * 0.01;
            let relative = (f64::from(exp2_polynomial(y)) / f64::from(y).exp2() - 1.0).abs();
            assert!(relative < 2e-7, "{y}: {relative}");
        }
    }

    #[test]
    fn powers_are_close_where_they_are_seen() {
        for k in 1..=1000 {
            let base = k as f32 / 1000.0;
            for exponent in [0.5, 1.0, 2.0, 20.0, 30.0, 200.0] {
                let exact = f64::from(base).powf(f64::from(exponent));
                let error = (f64::from(power(base, exponent)) - exact).abs();
                assert!(error < 4e-7, "{base}^{exponent}: {error}");
            }
        }
    }

    #[test]
    fn corners() {
        assert_eq!([power(0.0, 0.0), power(0.0, 2.0), power(1.0, 55.0), power(0.5, 2.0)], [1.0, 0.0, 1.0, 0.25]);
        assert_eq!((power(1e-30, 20.0), exp2_polynomial(0.0), exp2_polynomial(-200.0)), (0.0, 1.0, 0.0));
        assert!(exp2_polynomial(1e9).is_finite());
    }
}
