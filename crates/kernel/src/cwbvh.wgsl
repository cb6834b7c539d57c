const COMPRESSED_STACK_SIZE: u32 = 32u;

struct CompressedNode {
    words: array<vec4<u32>, 5>,
}

struct LeafItem {
    a: vec3<f32>,
    primitive: u32,
    b: vec3<f32>,
    kind: u32,
    c: vec3<f32>,
    index: u32,
}

fn closest_hit(ray: Ray, rules: u32) -> Hit {
    return traverse(ray, rules, false);
}

fn any_hit(ray: Ray, rules: u32) -> bool {
    return traverse(ray, rules, true).primitive != NONE;
}

fn intersect_item(item: LeafItem, ray: Ray, rules: u32) -> Hit {
    if (item.kind == TRIANGLE) {
        let triangle = Triangle(item.a, item.primitive, item.b, 0u, item.c, 0u);
        return intersect_triangle(triangle, ray, min_determinant(rules));
    }
    if (item.kind == SPHERE) {
        return intersect_sphere(Sphere(item.a, item.b.x, item.primitive, array<u32, 3>()), ray, rules);
    }
    return intersect_square(squares[item.index], ray);
}

fn octant_order(direction: vec3<f32>) -> u32 {
    return select(4u, 0u, direction.x < 0.0) | select(2u, 0u, direction.y < 0.0) | select(1u, 0u, direction.z < 0.0);
}

fn enter_children(node: CompressedNode, ray: Ray, reciprocal: vec3<f32>, order: u32, limit: f32) -> vec2<u32> {
    let w0 = node.words[0];
    let scale = vec3<f32>(
        bitcast<f32>((w0.w & 0xffu) << 23u),
        bitcast<f32>(((w0.w >> 8u) & 0xffu) << 23u),
        bitcast<f32>(((w0.w >> 16u) & 0xffu) << 23u),
    );
    let adjusted = scale * reciprocal;
    let offset = (bitcast<vec3<f32>>(w0.xyz) - ray.origin) * reciprocal;
    let negative = reciprocal < vec3<f32>(0.0);
    // Of each axis the planes of all children that the ray meets first and last.
    let near_x = select(node.words[2].xy, node.words[2].zw, negative.x);
    let far_x = select(node.words[2].zw, node.words[2].xy, negative.x);
    let near_y = select(node.words[3].xy, node.words[3].zw, negative.y);
    let far_y = select(node.words[3].zw, node.words[3].xy, negative.y);
    let near_z = select(node.words[4].xy, node.words[4].zw, negative.z);
    let far_z = select(node.words[4].zw, node.words[4].xy, negative.z);
    var entered = vec2<u32>(0u);
    for (var half = 0u; half < 2u; half++) {
        let metas = select(node.words[1].z, node.words[1].w, half == 1u);
        let nx = select(near_x.x, near_x.y, half == 1u);
        let fx = select(far_x.x, far_x.y, half == 1u);
        let ny = select(near_y.x, near_y.y, half == 1u);
        let fy = select(far_y.x, far_y.y, half == 1u);
        let nz = select(near_z.x, near_z.y, half == 1u);
        let fz = select(far_z.x, far_z.y, half == 1u);
        for (var quarter = 0u; quarter < 4u; quarter++) {
            let shift = quarter * 8u;
            let meta_byte = (metas >> shift) & 0xffu;
            if (meta_byte == 0u) {
                continue;
            }
            let near = vec3<f32>(vec3<u32>(nx >> shift, ny >> shift, nz >> shift) & vec3<u32>(0xffu)) * adjusted + offset;
            let far = vec3<f32>(vec3<u32>(fx >> shift, fy >> shift, fz >> shift) & vec3<u32>(0xffu)) * adjusted + offset;
            let entry = max(max(near.x, near.y), max(near.z, ray.t_min));
            let exit = min(min(far.x, far.y), far.z);
            if (entry <= exit * SLAB_SLACK && entry <= limit) {
                if ((meta_byte & 0x18u) == 0x18u) {
                    entered.x |= 1u << ((half * 4u + quarter) ^ order);
                } else {
                    entered.y |= (meta_byte >> 5u) << (meta_byte & 0x1fu);
                }
            }
        }
    }
    return entered;
}

fn traverse(ray: Ray, rules: u32, first: bool) -> Hit {
    var best = no_hit(ray.t_max);
    let reciprocal = safe_reciprocal(ray.direction);
    let order = octant_order(reciprocal);
    var stack: array<vec2<u32>, COMPRESSED_STACK_SIZE>;
    var size = 0u;
    var index = 0u;
    loop {
        let node = compressed_node(index);
        let entered = enter_children(node, ray, reciprocal, order, best.t);
        var leaves = entered.y;
        while (leaves != 0u) {
            let item = node.words[1].y + firstTrailingBit(leaves);
            leaves &= leaves - 1u;
            best = take_nearer(best, intersect_item(leaf_item(item), ray, rules));
            if (first && best.primitive != NONE) {
                return best;
            }
        }
        var group = vec2<u32>(node.words[1].x, (entered.x << 8u) | (node.words[0].w >> 24u));
        if (entered.x == 0u) {
            if (size == 0u) {
                return best;
            }
            size -= 1u;
            group = stack[size];
        }
        let place = firstLeadingBit(group.y);
        group.y &= ~(1u << place);
        if ((group.y >> 8u) != 0u) {
            stack[size] = group;
            size += 1u;
        }
        let slot = (place - 8u) ^ order;
        index = group.x + countOneBits(group.y & 0xffu & ((1u << slot) - 1u));
    }
    return best;
}
