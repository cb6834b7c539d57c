struct StartParams {
    camera: Camera,
    first: u32,
    count: u32,
    rules: u32,
    padding: u32,
}

@compute @workgroup_size(64)
fn start(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let sample = samples[n];
    let i = sample.pixel % params.camera.width;
    let j = sample.pixel / params.camera.width;
    let ray = camera_ray(params.camera, i, j, sample.shift, params.rules);
    node_rays[n] = NodeRay(ray.origin, ray.t_min, ray.direction, 0u);
    node_links[n] = NodeLink(n, 0u, NONE, NONE, 0.0, 0.0, 0u, 0u);
}
