struct ToneParams {
    first: u32,
    count: u32,
    width: u32,
    height: u32,
    // Greatest luminance (global), or what luminance is multiplied by (local).
    white: f32,
    factor: f32,
    // Reach of a blur in pixels; local: least denominator, and greatest difference that counts as even.
    reach: u32,
    floor_: f32,
    epsilon: f32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

// Rec. 709 luminance as the thesis has it, not below 0.
fn luminance(rgb: vec3<f32>) -> f32 {
    return max(0.212671 * rgb.x + 0.715160 * rgb.y + 0.072169 * rgb.z, 0.0);
}

// The luminance of some pixels, and its binary logarithm.
@compute @workgroup_size(64)
fn measure(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        let y = luminance(picture[n].xyz);
        tone_pairs[n] = vec2<f32>(y, log2_polynomial(max(y + params.epsilon, MIN_POSITIVE)));
    }
}

// One curve for the whole picture.
@compute @workgroup_size(64)
fn tone_global(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        let y = luminance(picture[n].xyz);
        let scale = (1.0 + y / params.white / params.white) / (1.0 + y) * params.factor;
        bloomed[n] = vec4<f32>(picture[n].xyz * scale, 0.0);
    }
}

// Scaled luminance, the start of the local operator: its centre, and the adaptation chosen so far with 1 for "open".
@compute @workgroup_size(64)
fn expose(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        plane_in[n] = luminance(picture[n].xyz) * params.factor;
    }
}

// A row-wise Gaussian blur, normalised inside the picture; the result is transposed, so that the next one takes columns.
@compute @workgroup_size(64)
fn blur_transposed(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let x = i32(n % params.width);
    let row = n / params.width;
    var sum = blur_weights[0] * plane_in[n];
    var total = blur_weights[0];
    for (var distance = 1; distance <= i32(params.reach); distance++) {
        let weight = blur_weights[distance];
        if (x >= distance) {
            sum += weight * plane_in[n - u32(distance)];
            total += weight;
        }
        if (x + distance < i32(params.width)) {
            sum += weight * plane_in[n + u32(distance)];
            total += weight;
        }
    }
    plane_out[u32(x) * params.height + row] = sum / total;
}

// Takes the centre where centre and surround are still even.
@compute @workgroup_size(64)
fn adapt(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        let centre = plane_in[n];
        let is_even = abs((centre - plane_out[n]) / (params.floor_ + centre)) < params.epsilon;
        if (tone_pairs[n].y > 0.0 && is_even) {
            tone_pairs[n] = vec2<f32>(centre, 1.0);
        } else {
            tone_pairs[n].y = 0.0;
        }
    }
}

// Starts the adaptation with the smallest centre, open.
@compute @workgroup_size(64)
fn begin_adaptation(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        tone_pairs[params.first + id.x] = vec2<f32>(plane_in[params.first + id.x], 1.0);
    }
}

// A curve per pixel that depends on its surroundings.
@compute @workgroup_size(64)
fn tone_local(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        bloomed[n] = vec4<f32>(picture[n].xyz * (params.factor / (1.0 + tone_pairs[n].x)), 0.0);
    }
}
