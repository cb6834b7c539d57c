// A ray by itself, outside any ray tree.
struct ProbeRay {
    origin: vec3<f32>,
    t_min: f32,
    direction: vec3<f32>,
    t_max: f32,
}

fn probe_ray(n: u32) -> Ray {
    let ray = probe_rays[n];
    return Ray(ray.origin, ray.t_min, ray.direction, ray.t_max, false);
}

// The nearest hits of some rays.
@compute @workgroup_size(64)
fn closest_hits(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        probe_hits[n] = closest_hit(probe_ray(n), params.rules);
    }
}

// Whether some rays hit anything: the primitive is none where they do not.
@compute @workgroup_size(64)
fn any_hits(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        probe_hits[n] = Hit(0.0, select(NONE, 0u, any_hit(probe_ray(n), params.rules)), 0.0, 0.0);
    }
}
