fn reflect_at(direction: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    return direction - normal * (2.0 * dot3(normal, direction));
}

// Zero at total reflection.
fn refract_at(direction: vec3<f32>, normal: vec3<f32>, ratio: f32, rules: u32) -> vec3<f32> {
    let leaving = dot3(direction, normal) >= 0.0;
    let facing = select(normal, -normal, leaving);
    var used = ratio;
    if (leaving && rules == RULES_REPAIRED) {
        if (ratio == 0.0) {
            return vec3<f32>(0.0);
        }
        used = 1.0 / ratio;
    }
    let cos_in = -dot3(facing, direction);
    let cos_out_sq = 1.0 - used * used * (1.0 - cos_in * cos_in);
    if (cos_out_sq >= 0.0 && abs(used) <= FAR) {
        return direction * used + facing * (used * cos_in - sqrt(cos_out_sq));
    }
    return vec3<f32>(0.0);
}
