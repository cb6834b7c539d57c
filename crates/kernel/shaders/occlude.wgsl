struct OccludeParams {
    first: u32,
    count: u32,
    rules: u32,
    first_ray: u32,
    ray_count: u32,
    rays: u32,
    sin_max: f32,
    range: f32,
    stream: u32,
    slots: u32,
    padding0: u32,
    padding1: u32,
}

// Adds some of the rays of ambient occlusion to some hits.
@compute @workgroup_size(64)
fn occlude(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let surface = node_surfaces[n];
    if (surface.primitive == NONE) {
        return;
    }
    if (materials[surface.material].local == 0.0) {
        return;
    }
    let link = node_links[n];
    let sample = samples[link.sample];
    var occluded = 0.0;
    if (params.first_ray > 0u) {
        occluded = node_occlusion[n];
    }
    for (var k = params.first_ray; k < params.first_ray + params.ray_count; k++) {
        let random = random4(sample.pixel, sample.sample, k * params.slots + link.slot, params.stream);
        let stratum = (f32(k) + random.x) / f32(params.rays);
        let direction = sample_cosine_cone(surface.normal, params.sin_max, vec2<f32>(stratum, random.y));
        let hit = closest_hit(Ray(surface.point, surface.epsilon, direction, params.range, false), params.rules);
        if (hit.primitive != NONE) {
            occluded += (params.range - hit.t) / params.range;
        }
    }
    node_occlusion[n] = occluded;
    count_up(COUNTER_OCCLUSION_RAYS, params.ray_count, id.x);
}
