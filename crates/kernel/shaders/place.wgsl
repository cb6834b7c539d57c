struct PlaceParams {
    first: u32,
    count: u32,
    probability: f32,
    min_illumination: f32,
    attenuation: f32,
    stream: u32,
    padding0: u32,
    padding1: u32,
}

// The numbers of hits of each sample's ray tree.
@compute @workgroup_size(64)
fn root_sizes(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        words[params.first + id.x] = node_links[params.first + id.x].size;
    }
}

// The first layer's ranks are the numbers of hits of the samples before.
@compute @workgroup_size(64)
fn rank_roots(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        node_links[params.first + id.x].rank = words[params.first + id.x];
    }
}

// Hands ranks down one layer: a node's mirrored subtree, then its refracted subtree, then the node itself.
@compute @workgroup_size(64)
fn rank_children(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let link = node_links[params.first + id.x];
    var rank = link.rank;
    if (link.reflected != NONE) {
        node_links[link.reflected].rank = rank;
        rank += node_links[link.reflected].size;
    }
    if (link.refracted != NONE) {
        node_links[link.refracted].rank = rank;
    }
}

fn becomes_vpl(n: u32) -> bool {
    let link = node_links[n];
    let sample = samples[link.sample];
    let color = node_colors[n].color;
    return random4(sample.pixel, sample.sample, link.slot, params.stream).x < params.probability
        && color.x + color.y + color.z >= params.min_illumination;
}

fn rank_of(link: NodeLink) -> u32 {
    return link.rank + link.size - 1u;
}

// Marks the hits that become VPLs, in post-order.
@compute @workgroup_size(64)
fn mark_vpls(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    if (node_surfaces[n].primitive != NONE) {
        words[rank_of(node_links[n])] = select(0u, 1u, becomes_vpl(n));
    }
}

// Writes the VPLs; `words` are now the numbers of VPLs before each hit.
@compute @workgroup_size(64)
fn place_vpls(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let surface = node_surfaces[n];
    if (surface.primitive != NONE && becomes_vpl(n)) {
        placed[words[rank_of(node_links[n])]] = Vpl(
            surface.point + surface.normal * surface.epsilon,
            params.attenuation,
            surface.normal,
            0.0,
            node_colors[n].color,
            0.0,
        );
    }
}
