// Adds the children's colours and counts to some nodes of a layer; a hit's colour is at most 1.
@compute @workgroup_size(64)
fn sum_layer(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let n = params.first + id.x;
    let found = node_surfaces[n].primitive != NONE;
    var link = node_links[n];
    var sum = node_colors[n];
    var total = NodeTotal(max(sum.tally, 1u) - 1u, min(sum.tally, 1u));
    link.size = select(0u, 1u, found);
    if (link.reflected != NONE) {
        sum.color += node_colors[link.reflected].color * link.reflection;
        total.selected += node_totals[link.reflected].selected;
        total.shaded += node_totals[link.reflected].shaded;
        link.size += node_links[link.reflected].size;
    }
    if (link.refracted != NONE) {
        sum.color += node_colors[link.refracted].color * link.refraction;
        total.selected += node_totals[link.refracted].selected;
        total.shaded += node_totals[link.refracted].shaded;
        link.size += node_links[link.refracted].size;
    }
    if (found) {
        sum.color = min(sum.color, vec3<f32>(1.0));
    }
    node_colors[n] = sum;
    node_totals[n] = total;
    node_links[n] = link;
}
