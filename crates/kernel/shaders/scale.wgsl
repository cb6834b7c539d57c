struct ScaleParams {
    first: u32,
    count: u32,
    // 1 if photons are to be gathered.
    has_photons: u32,
    min_photons: u32,
    radius: f32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

// The colour that a hit of the second pass shows by itself, once all VPLs are added.
@compute @workgroup_size(64)
fn scale(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let surface = node_surfaces[n];
    var sum = node_colors[n];
    if (surface.primitive == NONE) {
        return;
    }
    let material = materials[surface.material];
    if (material.local == 0.0) {
        return;
    }
    var color = sum.color;
    if (params.has_photons != 0u) {
        let caustics = gather_photons(surface.point, surface.normal, params.radius, params.min_photons);
        color += caustics * material.diffuse;
    }
    node_colors[n] = NodeColor(color * material.local, max(sum.tally, 1u));
}
