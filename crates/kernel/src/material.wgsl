struct Material {
    specular: vec3<f32>,
    exponent: f32,
    diffuse: vec3<f32>,
    reflection: f32,
    ambient: vec3<f32>,
    refraction: f32,
    glow: vec3<f32>,
    refraction_ratio: f32,
    local: f32,
    texture: u32,
    texture_mode: u32,
    padding: u32,
}
