struct TreeParams {
    lower: vec3<f32>,
    first: u32,
    extent: vec3<f32>,
    count: u32,
    // Number of VPLs, and first node of the level.
    vpl_count: u32,
    level: u32,
    padding0: u32,
    padding1: u32,
}

// The Morton keys of some VPLs, each with its number.
@compute @workgroup_size(64)
fn morton_keys(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        pairs_out[n] = vec2<u32>(morton_key(vpls[n], params.lower, params.extent), n);
    }
}

// Some VPLs in tree order.
@compute @workgroup_size(64)
fn reorder(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        placed[n] = vpls[pairs_in[n].y];
    }
}

// Some leaves, over the VPLs in tree order.
@compute @workgroup_size(64)
fn build_leaves(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let block = params.first + id.x;
    var cluster = empty_cluster();
    var intensity = 0.0;
    for (var k = block * BLOCK_SIZE; k < min((block + 1u) * BLOCK_SIZE, params.vpl_count); k++) {
        cluster = merge_clusters(cluster, vpl_cluster(vpls[k]));
        intensity += vpl_intensity(vpls[k]);
    }
    light_nodes[params.level + block] = pack_cluster(cluster, intensity);
}

// Some nodes of a level, from the level below.
@compute @workgroup_size(64)
fn build_level(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let node = params.level + params.first + id.x;
    let left = light_nodes[2u * node];
    let right = light_nodes[2u * node + 1u];
    light_nodes[node] =
        pack_cluster(merge_clusters(unpack_cluster(left), unpack_cluster(right)), left.intensity + right.intensity);
}
