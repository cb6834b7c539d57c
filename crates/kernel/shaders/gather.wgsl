struct GatherParams {
    first: u32,
    count: u32,
    rules: u32,
    threshold: f32,
    // The first VPL and the number of VPLs to add; with a tree, a whole subtree: its root, its first block and its blocks.
    first_vpl: u32,
    vpl_count: u32,
    root: u32,
    first_block: u32,
    block_count: u32,
    // Of all VPLs.
    total_vpls: u32,
    // 1 where every VPL is tested against the threshold by itself, without bounds.
    exhaustive: u32,
    padding: u32,
}

const CHUNK: u32 = 64u;

var<workgroup> chunk: array<Vpl, CHUNK>;

// What a point gathers.
struct Gathered {
    color: vec3<f32>,
    chosen: u32,
    shadow_rays: u32,
}

fn add_vpl(sum: Gathered, vpl: Vpl, surface: NodeSurface, diffuse: vec3<f32>) -> Gathered {
    var gathered = sum;
    gathered.chosen += 1u;
    let at = vpl_incidence(vpl, surface.point, surface.normal);
    if (at.cosines <= 0.0) {
        return gathered;
    }
    gathered.shadow_rays += 1u;
    let shadow = shadow_ray(params.rules, surface.point, at.to_light, surface.epsilon);
    if (!any_hit(shadow, params.rules)) {
        gathered.color += phong_vpl(vpl, diffuse, at);
    }
    return gathered;
}

// Adds some VPLs to some hits: all of them, or those that reach the threshold by themselves. A chunk of VPLs at a time
// is in the memory of a workgroup.
@compute @workgroup_size(64)
fn gather_all(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let n = params.first + min(id.x, params.count - 1u);
    let surface = node_surfaces[n];
    let before = node_colors[n];
    var is_shaded = id.x < params.count && surface.primitive != NONE;
    var diffuse = vec3<f32>(0.0);
    if (is_shaded) {
        let material = materials[surface.material];
        diffuse = material.diffuse;
        is_shaded = material.local != 0.0;
    }
    var sum = Gathered(before.color, 0u, 0u);
    for (var start = 0u; start < params.vpl_count; start += CHUNK) {
        let size = min(CHUNK, params.vpl_count - start);
        workgroupBarrier();
        if (lane < size) {
            chunk[lane] = vpls[params.first_vpl + start + lane];
        }
        workgroupBarrier();
        if (is_shaded) {
            for (var k = 0u; k < size; k++) {
                let vpl = chunk[k];
                if (params.exhaustive == 0u || is_relevant(vpl, vpl_intensity(vpl), surface.point, params.threshold)) {
                    sum = add_vpl(sum, vpl, surface, diffuse);
                }
            }
        }
    }
    if (is_shaded) {
        node_colors[n] = NodeColor(sum.color, max(before.tally, 1u) + sum.chosen);
        count_up(COUNTER_SHADOW_RAYS, sum.shadow_rays, id.x);
        count_up(COUNTER_TREE_LIGHTS, params.exhaustive * params.vpl_count, id.x);
    }
}

// Adds the VPLs of a subtree that reach the threshold to some hits. The tree is perfect, so no stack is needed: the node
// after a finished one is found by its number.
@compute @workgroup_size(64)
fn gather_cut(@builtin(global_invocation_id) id: vec3<u32>) {
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
    let before = node_colors[n];
    var sum = Gathered(before.color, 0u, 0u);
    var visited = 0u;
    var tested = 0u;
    var node = params.root;
    var block = params.first_block;
    var span = params.block_count;
    let end = min(params.first_block + params.block_count, (params.total_vpls + BLOCK_SIZE - 1u) / BLOCK_SIZE);
    while (block < end) {
        visited += 1u;
        let cluster = unpack_cluster(light_nodes[node]);
        let decision = decide(cluster, surface.point, surface.point, params.threshold);
        if (decision == DESCEND && span > 1u) {
            node = 2u * node;
            span /= 2u;
            continue;
        }
        if (decision != REJECT) {
            let last = min((block + span) * BLOCK_SIZE, params.total_vpls);
            for (var k = block * BLOCK_SIZE; k < last; k++) {
                let vpl = vpls[k];
                if (decision == DESCEND) {
                    tested += 1u;
                    if (!is_relevant(vpl, vpl_intensity(vpl), surface.point, params.threshold)) {
                        continue;
                    }
                }
                sum = add_vpl(sum, vpl, surface, material.diffuse);
            }
        }
        block += span;
        let climb = firstTrailingBit(node + 1u);
        node = (node + 1u) >> climb;
        span <<= climb;
    }
    node_colors[n] = NodeColor(sum.color, max(before.tally, 1u) + sum.chosen);
    count_up(COUNTER_SHADOW_RAYS, sum.shadow_rays, id.x);
    count_up(COUNTER_TREE_NODES, visited, id.x);
    count_up(COUNTER_TREE_LIGHTS, tested, id.x);
}
