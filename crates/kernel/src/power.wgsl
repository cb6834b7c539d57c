const SQRT_HALF_BITS: u32 = 0x3f3504f3u;
const TWO_OVER_LN_2: f32 = 2.8853901;

fn log2_polynomial(x: f32) -> f32 {
    let bits = bitcast<u32>(x) - SQRT_HALF_BITS;
    let exponent = bitcast<i32>(bits) >> 23u;
    let mantissa = bitcast<f32>((bits & 0x007fffffu) + SQRT_HALF_BITS);
    let f = (mantissa - 1.0) / (mantissa + 1.0);
    let s = f * f;
    let series = 1.0 + s * (0.33333334 + s * (0.2 + s * (0.14285715 + s * 0.11111111)));
    return f32(exponent) + f * TWO_OVER_LN_2 * series;
}

fn exp2_polynomial(x: f32) -> f32 {
    if (x < -126.0) {
        return 0.0;
    }
    let y = min(x, 127.0);
    let whole = floor(y + 0.5);
    let r = y - whole;
    let series = 1.0
        + r * (0.6931472
            + r * (0.2402265
                + r * (0.05550411 + r * (0.009618129 + r * (0.0013333558 + r * (0.0001540353 + r * 0.000015252734))))));
    return series * bitcast<f32>(u32(i32(whole) + 127) << 23u);
}

fn power(base: f32, exponent: f32) -> f32 {
    if (exponent == 0.0) {
        return 1.0;
    }
    if (base < MIN_POSITIVE) {
        return 0.0;
    }
    return exp2_polynomial(exponent * log2_polynomial(base));
}
