@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let ray = node_ray(node_rays[n]);
    let hit = closest_hit(ray, params.rules);
    var found = NodeSurface(vec3<f32>(0.0), 0.0, vec3<f32>(0.0), 0u, hit.t, hit.primitive, hit.u, hit.v);
    if (hit.primitive != NONE) {
        let surface = surface_at(ray, hit);
        found.point = surface.point;
        found.epsilon = spawn_epsilon(params.rules, surface.point, hit.t);
        found.normal = surface.normal;
        found.material = surface.material;
    }
    node_surfaces[n] = found;
    node_colors[n] = NodeColor(vec3<f32>(0.0), 0u);
}
