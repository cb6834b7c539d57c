struct SpawnParams {
    first: u32,
    count: u32,
    rules: u32,
    // First node of the layer, and of the next one.
    layer: u32,
    next: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

// Zero where there is no refracted ray.
fn refracted_direction(n: u32, material: Material) -> vec3<f32> {
    if (!(material.refraction > 0.0)) {
        return vec3<f32>(0.0);
    }
    return refract_at(node_rays[n].direction, node_surfaces[n].normal, material.refraction_ratio, params.rules);
}

// Counts the children of some nodes.
@compute @workgroup_size(64)
fn count_children(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    var reflected = 0u;
    var refracted = 0u;
    if (node_surfaces[n].primitive != NONE) {
        let material = materials[node_surfaces[n].material];
        reflected = select(0u, 1u, material.reflection > 0.0);
        refracted = select(0u, 1u, any(refracted_direction(n, material) != vec3<f32>(0.0)));
    }
    let place = (n - params.layer) * 2u;
    words[place] = reflected;
    words[place + 1u] = refracted;
}

// Makes the children of some nodes; `words` are now the numbers of children before each.
@compute @workgroup_size(64)
fn spawn(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let surface = node_surfaces[n];
    if (surface.primitive == NONE) {
        return;
    }
    let material = materials[surface.material];
    let ray = node_rays[n];
    var link = node_links[n];
    let place = (n - params.layer) * 2u;
    if (material.reflection > 0.0) {
        link.reflected = params.next + words[place];
        link.reflection = material.reflection;
        let direction = reflect_at(ray.direction, surface.normal);
        node_rays[link.reflected] = NodeRay(surface.point, surface.epsilon, direction, ray.inside);
        node_links[link.reflected] = NodeLink(link.sample, 2u * link.slot + 1u, NONE, NONE, 0.0, 0.0, 0u, 0u);
    }
    let direction = refracted_direction(n, material);
    if (any(direction != vec3<f32>(0.0))) {
        link.refracted = params.next + words[place + 1u];
        link.refraction = material.refraction;
        node_rays[link.refracted] = NodeRay(surface.point, surface.epsilon, direction, 1u - ray.inside);
        node_links[link.refracted] = NodeLink(link.sample, 2u * link.slot + 2u, NONE, NONE, 0.0, 0.0, 0u, 0u);
    }
    node_links[n] = link;
}
