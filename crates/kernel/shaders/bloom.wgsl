struct BloomParams {
    first: u32,
    count: u32,
    width: u32,
    height: u32,
    radius: f32,
    weight: f32,
    reach: u32,
    padding: u32,
}

// Mixes some pixels with a blurred picture, as `bloom` of the image crate does in double precision.
@compute @workgroup_size(64)
fn bloom(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let x = i32(n % params.width);
    let y = i32(n / params.width);
    let reach = i32(params.reach);
    var sum = vec3<f32>(0.0);
    var weights = 0.0;
    for (var v = max(y - reach, 0); v <= min(y + reach, i32(params.height) - 1); v++) {
        for (var u = max(x - reach, 0); u <= min(x + reach, i32(params.width) - 1); u++) {
            let offset = vec2<f32>(f32(u - x), f32(v - y));
            let distance = sqrt(offset.x * offset.x + offset.y * offset.y);
            let falloff = max((params.radius - distance) / params.radius, 0.0);
            let weight = falloff * falloff * falloff * falloff;
            sum += picture[u32(v) * params.width + u32(u)].xyz * weight;
            weights += weight;
        }
    }
    let own = picture[n].xyz;
    bloomed[n] = vec4<f32>((1.0 - params.weight) * own + params.weight * (sum / weights), 0.0);
}
