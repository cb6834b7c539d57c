const OMNI: u32 = 0u;
const HEMISPHERE: u32 = 1u;
const DIRECTIONAL: u32 = 2u;

struct Light {
    position: vec3<f32>,
    kind: u32,
    direction: vec3<f32>,
    attenuation: f32,
    specular: vec3<f32>,
    padding0: f32,
    diffuse: vec3<f32>,
    padding1: f32,
    ambient: vec3<f32>,
    padding2: f32,
}

struct Vpl {
    position: vec3<f32>,
    attenuation: f32,
    direction: vec3<f32>,
    padding0: f32,
    diffuse: vec3<f32>,
    padding1: f32,
}

fn vpl_intensity(vpl: Vpl) -> f32 {
    return length3(vpl.diffuse);
}

fn to_light(light: Light, point: vec3<f32>) -> vec3<f32> {
    if (light.kind == DIRECTIONAL) {
        return -light.direction;
    }
    return light.position - point;
}

fn emission_cosine(light: Light, unit_to_light: vec3<f32>) -> f32 {
    if (light.kind == HEMISPHERE) {
        return -dot3(light.direction, unit_to_light);
    }
    return 1.0;
}
