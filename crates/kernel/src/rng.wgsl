const ORIGINAL_MAX: u32 = 0x7fffu;
const ORIGINAL_FACTOR: u32 = 214013u;
const ORIGINAL_SUMMAND: u32 = 2531011u;

fn hash4(key: vec4<u32>) -> vec4<u32> {
    var v = key * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> vec4<u32>(16u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

fn unit_float(word: u32) -> f32 {
    return f32(word >> 8u) * (1.0 / 16777216.0);
}

fn random4(pixel: u32, sample: u32, dimension: u32, stream: u32) -> vec4<f32> {
    let h = hash4(vec4<u32>(pixel, sample, dimension, stream));
    return vec4<f32>(unit_float(h.x), unit_float(h.y), unit_float(h.z), unit_float(h.w));
}

fn stream(seed: u32, purpose: u32) -> u32 {
    return hash4(vec4<u32>(seed, purpose, 0u, 0u)).x;
}

fn original_next(state: u32) -> u32 {
    return state * ORIGINAL_FACTOR + ORIGINAL_SUMMAND;
}

fn original_value(state: u32) -> u32 {
    return (state >> 16u) & ORIGINAL_MAX;
}

fn original_skip(state: u32, count: u32) -> u32 {
    var factor = ORIGINAL_FACTOR;
    var summand = ORIGINAL_SUMMAND;
    var result = state;
    var left = count;
    while (left > 0u) {
        if ((left & 1u) == 1u) {
            result = result * factor + summand;
        }
        summand = summand * (factor + 1u);
        factor = factor * factor;
        left >>= 1u;
    }
    return result;
}
