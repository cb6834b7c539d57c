struct SeenRecord {
    albedo: vec3<f32>,
    samples: u32,
    normal: vec3<f32>,
    hits: u32,
    depth: f32,
    object: u32,
    selected: u32,
    shaded: u32,
}

// What the samples of some pixels saw.
@compute @workgroup_size(64)
fn see(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let pixel = pixels[params.first + id.x];
    var sum = SeenRecord(vec3<f32>(0.0), pixel.count, vec3<f32>(0.0), 0u, 0.0, 0u, 0u, 0u);
    for (var n = pixel.first; n < pixel.first + pixel.count; n++) {
        sum.selected += node_totals[n].selected;
        sum.shaded += node_totals[n].shaded;
        let surface = node_surfaces[n];
        if (surface.primitive == NONE) {
            continue;
        }
        if (sum.hits == 0u) {
            sum.object = primitive_record(surface.primitive).object;
        }
        sum.hits += 1u;
        sum.albedo += materials[surface.material].diffuse;
        sum.normal += surface.normal;
        sum.depth += surface.t;
    }
    seen[params.first + id.x] = sum;
}
