struct Incidence {
    to_light: vec3<f32>,
    cos_theta: f32,
    cos_phi: f32,
}

// Neither the light nor the surface faces away.
fn is_incident(at: Incidence) -> bool {
    return at.cos_theta > 0.0 && at.cos_phi > 0.0;
}

fn incidence(light: Light, point: vec3<f32>, normal: vec3<f32>) -> Incidence {
    let towards = to_light(light, point);
    let unit = normalize_or_zero(towards);
    return Incidence(towards, dot3(normal, unit), emission_cosine(light, unit));
}

fn phong(light: Light, material: Material, at: Incidence, normal: vec3<f32>, to_eye: vec3<f32>, rules: u32) -> vec3<f32> {
    var color = light.ambient * material.ambient;
    if (rules == RULES_REPAIRED || light.kind != DIRECTIONAL) {
        color += light.diffuse * material.diffuse * at.cos_theta;
    }
    let gloss = light.specular * material.specular;
    if (any(gloss != vec3<f32>(0.0))) {
        var eye = to_eye;
        if (light.kind == DIRECTIONAL && rules == RULES_REPAIRED) {
            eye = normalize_or_zero(to_eye);
        }
        let half = normalize_or_zero(at.to_light + eye);
        color += gloss * power(max(dot3(normal, half), 0.0), material.exponent);
    }
    return min(color * (light.attenuation * at.cos_phi), vec3<f32>(1.0));
}

struct VplIncidence {
    to_light: vec3<f32>,
    // 0 where one of both faces away.
    cosines: f32,
    dist_sq: f32,
}

fn vpl_incidence(vpl: Vpl, point: vec3<f32>, normal: vec3<f32>) -> VplIncidence {
    let towards = vpl.position - point;
    let cosines = max(dot3(normal, towards), 0.0) * max(-dot3(vpl.direction, towards), 0.0);
    return VplIncidence(towards, cosines, dot3(towards, towards));
}

fn phong_vpl(vpl: Vpl, diffuse: vec3<f32>, at: VplIncidence) -> vec3<f32> {
    return min(vpl.diffuse * diffuse * (vpl.attenuation * (at.cosines / at.dist_sq)), vec3<f32>(1.0));
}
