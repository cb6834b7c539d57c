struct DirectParams {
    first: u32,
    count: u32,
    rules: u32,
    first_light: u32,
    light_count: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

// Adds some of the scene's lights to some hits.
@compute @workgroup_size(64)
fn direct(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let surface = node_surfaces[n];
    if (surface.primitive == NONE) {
        return;
    }
    let material = materials[surface.material];
    if (material.local == 0.0) {
        return;
    }
    var sum = node_colors[n];
    let to_eye = node_rays[n].origin - surface.point;
    var rays = 0u;
    for (var k = params.first_light; k < params.first_light + params.light_count; k++) {
        let light = lights[k];
        let at = incidence(light, surface.point, surface.normal);
        if (!is_incident(at)) {
            continue;
        }
        var shadow = shadow_ray(params.rules, surface.point, at.to_light, surface.epsilon);
        if (light.kind == DIRECTIONAL) {
            shadow.t_max = FAR;
        }
        rays += 1u;
        if (!any_hit(shadow, params.rules)) {
            sum.tally = 1u;
            sum.color += phong(light, material, at, surface.normal, to_eye, params.rules);
        }
    }
    node_colors[n] = sum;
    count_up(COUNTER_SHADOW_RAYS, rays, id.x);
}
