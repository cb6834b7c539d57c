const TAU: f32 = 6.28318530717958647692528676655900577;

fn sin_cos_turns(turn: f32) -> vec2<f32> {
    let quarter = floor(turn * 4.0 + 0.5);
    let x = (turn - quarter * 0.25) * TAU;
    let s = x * x;
    let sine = x * (1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 - s * (1.0 / 5040.0))));
    let cosine = 1.0 + s * (-0.5 + s * (1.0 / 24.0 + s * (-1.0 / 720.0 + s * (1.0 / 40320.0))));
    switch (i32(quarter) & 3) {
        case 0: { return vec2<f32>(sine, cosine); }
        case 1: { return vec2<f32>(cosine, -sine); }
        case 2: { return vec2<f32>(-sine, -cosine); }
        default: { return vec2<f32>(-cosine, sine); }
    }
}

struct Frame {
    tangent: vec3<f32>,
    bitangent: vec3<f32>,
}

fn frame(normal: vec3<f32>) -> Frame {
    let sign = copy_sign(1.0, normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    return Frame(
        vec3<f32>(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        vec3<f32>(b, sign + normal.y * normal.y * a, -normal.y),
    );
}

fn sample_cosine_cone(normal: vec3<f32>, sin_max: f32, random: vec2<f32>) -> vec3<f32> {
    let sin_sq = random.x * sin_max * sin_max;
    let radius = sqrt(sin_sq);
    let turned = sin_cos_turns(random.y);
    let axes = frame(normal);
    return axes.tangent * (radius * turned.y) + axes.bitangent * (radius * turned.x)
        + normal * sqrt(max(1.0 - sin_sq, 0.0));
}
