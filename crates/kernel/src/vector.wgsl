const MIN_POSITIVE: f32 = 1.17549435e-38;

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn cross3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
}

fn length3(v: vec3<f32>) -> f32 {
    return square_root(rounded_product(v.x, v.x) + rounded_product(v.y, v.y) + rounded_product(v.z, v.z));
}

fn max_element(v: vec3<f32>) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn min_element(v: vec3<f32>) -> f32 {
    return min(min(v.x, v.y), v.z);
}

fn copy_sign(magnitude: f32, sign: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(magnitude) & 0x7fffffffu) | (bitcast<u32>(sign) & 0x80000000u));
}

// Without `max` a compiler may fuse the product with a sum that it is part of.
fn rounded_product(a: f32, b: f32) -> f32 {
    return max(a * b, -3.4028235e38);
}

fn scaled(v: vec3<f32>, factor: f32) -> vec3<f32> {
    return vec3<f32>(rounded_product(v.x, factor), rounded_product(v.y, factor), rounded_product(v.z, factor));
}

// Cards may be off by some units in the last place. What remains is found in whole numbers, which are exact everywhere; it is
// small, so that its low 32 bits are all of it.
fn quotient(a: f32, b: f32) -> f32 {
    let near = a / b;
    let sign = (bitcast<u32>(a) ^ bitcast<u32>(b)) & 0x80000000u;
    let top = bitcast<u32>(a) & 0x7fffffffu;
    let bottom = bitcast<u32>(b) & 0x7fffffffu;
    let dividend = (top & 0x7fffffu) | 0x800000u;
    let divisor = (bottom & 0x7fffffu) | 0x800000u;
    let is_less = u32(dividend < divisor);
    let exponent = i32(top >> 23u) - i32(bottom >> 23u) + 127 - i32(is_less);
    if (top < 0x800000u || top >= 0x7f800000u || bottom < 0x800000u || bottom >= 0x7f800000u || exponent < 2 || exponent > 252) {
        return near;
    }
    let first = u32(exponent) << 23u;
    var digits = (bitcast<u32>(near) & 0x7fffffffu) - first + 0x800000u;
    var rest = i32((dividend << (23u + is_less)) - digits * divisor);
    for (var k = 0u; k < 4u && rest < 0; k++) {
        digits -= 1u;
        rest += i32(divisor);
    }
    for (var k = 0u; k < 4u && rest >= i32(divisor); k++) {
        digits += 1u;
        rest -= i32(divisor);
    }
    digits += u32(2 * rest > i32(divisor));
    return bitcast<f32>(sign | (first + digits - 0x800000u));
}

// As the quotient.
fn square_root(x: f32) -> f32 {
    let near = sqrt(x);
    let bits = bitcast<u32>(x);
    if (!(x >= MIN_POSITIVE) || bits >= 0x7f800000u) {
        return near;
    }
    let exponent = i32(bits >> 23u) - 127;
    let is_odd = u32(exponent & 1);
    let first = u32((exponent - i32(is_odd)) / 2 + 127) << 23u;
    var digits = bitcast<u32>(near) - first + 0x800000u;
    var rest = i32((((bits & 0x7fffffu) | 0x800000u) << (23u + is_odd)) - digits * digits);
    for (var k = 0u; k < 4u && rest < 0; k++) {
        digits -= 1u;
        rest += i32(2u * digits + 1u);
    }
    for (var k = 0u; k < 4u && rest > i32(2u * digits); k++) {
        rest -= i32(2u * digits + 1u);
        digits += 1u;
    }
    digits += u32(rest > i32(digits));
    return bitcast<f32>(first + digits - 0x800000u);
}
