struct FinishParams {
    first: u32,
    count: u32,
    rules: u32,
    // Rays of ambient occlusion, or 0 without it.
    occlusion_rays: u32,
    background: vec3<f32>,
    occlusion_factor: f32,
}

// The colour that a hit of the first pass shows by itself, once all lights are added.
@compute @workgroup_size(64)
fn finish(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let found = node_surfaces[n];
    if (found.primitive == NONE) {
        node_colors[n] = NodeColor(params.background, 0u);
        return;
    }
    let material = materials[found.material];
    if (material.local == 0.0) {
        node_colors[n] = NodeColor(material.glow, 0u);
        return;
    }
    let lit = node_colors[n];
    var color = lit.color;
    if (lit.tally != 0u && material.texture != NONE) {
        let surface = Surface(found.point, found.normal, found.material, 0u);
        let at = surface_point(node_hit(found), surface);
        color += sample_texture(textures[material.texture], material.texture_mode, at, params.rules);
    }
    var open = 1.0;
    if (params.occlusion_rays > 0u) {
        let total = f32(params.occlusion_rays);
        open = (total - node_occlusion[n]) / total * params.occlusion_factor;
    }
    node_colors[n] = NodeColor(color * material.local * open + material.glow, 0u);
}
